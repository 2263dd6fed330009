#include "world/solver/contact_rows.h"

#include "world/bodies/prefetch.h"
#include "world/constants.h"

#include <BulletDynamics/Dynamics/btRigidBody.h>
#include <LinearMath/btTransformUtil.h>

#include <algorithm>

namespace pliant {

namespace {

/// Incomplete groups that are searched before a new one is started.
constexpr std::size_t kMostSearched = 16;

/// `to` becomes `yes` where `which` is set, and is unchanged elsewhere.
inline void put( Lanes& to, const LaneMask& which, const Lanes& yes )
{
	to = (Lanes)( ( (LaneMask)yes & which ) | ( (LaneMask)to & ~which ) );
}

/// Velocities of four nodes, axis by axis.
struct FourVelocities
{
	Lanes x, y, z;

	FourVelocities( const btVector3* of, const int* at ) :
		x{ of[at[0]].m_floats[0], of[at[1]].m_floats[0], of[at[2]].m_floats[0], of[at[3]].m_floats[0] },
		y{ of[at[0]].m_floats[1], of[at[1]].m_floats[1], of[at[2]].m_floats[1], of[at[3]].m_floats[1] }, z{ of[at[0]].m_floats[2],
																											 of[at[1]].m_floats[2],
																											 of[at[2]].m_floats[2],
																											 of[at[3]].m_floats[2] }
	{}
	void put( btVector3* to, const int* at ) const
	{
		for ( int lane = 0; lane < kRowLanes; ++lane )
		{
			btScalar* const v = to[at[lane]].m_floats;
			v[0] = x[lane];
			v[1] = y[lane];
			v[2] = z[lane];
		}
	}
};

/// Solves four rows at once, in Bullet's order of evaluation, without its products with zero:
///     d = rhs - cfm P - n.va / K + n.vb / K,    P + d  at least 0, or within  +- friction times the normal impulse
/// `presses`: the normal rows of four friction rows. Without branches, since sliding and separation cannot be predicted.
template <bool kHasB>
inline void solveFour( FourRows& row, const FourRows* presses, btVector3* change, Lanes& worst )
{
	const Lanes none{};
	FourVelocities a( change, row.a ), b( change, kHasB ? row.b : row.a );
	Lanes d = row.rhs - row.impulse * row.cfm - ( row.normal[0] * a.x + row.normal[1] * a.y + row.normal[2] * a.z ) * row.effectiveMass;
	if constexpr ( kHasB )
	{
		d += ( row.normal[0] * b.x + row.normal[1] * b.y + row.normal[2] * b.z ) * row.effectiveMass;
	}
	Lanes impulse = d, held = row.impulse + d;
	if ( presses )
	{
		const Lanes high = row.friction * presses->impulse, low = -high, sum = held;
		const LaneMask isLow = sum<low, isHigh = sum> high, isOff = ~( presses->impulse > none );
		put( held, isHigh, high );
		put( held, isLow, low );
		put( impulse, isLow | isHigh, held - row.impulse );
		put( impulse, isOff, none );
		put( held, isOff, row.impulse );
	}
	else
	{
		const LaneMask isLow = held < none; // normal impulses are not negative
		put( impulse, isLow, -row.impulse );
		put( held, isLow, none );
	}
	row.impulse = held;
	const Lanes forA = row.inverseA, forB = row.inverseB;
	a.x += row.normal[0] * forA * impulse;
	a.y += row.normal[1] * forA * impulse;
	a.z += row.normal[2] * forA * impulse;
	a.put( change, row.a );
	if constexpr ( kHasB )
	{
		b.x -= row.normal[0] * forB * impulse;
		b.y -= row.normal[1] * forB * impulse;
		b.z -= row.normal[2] * forB * impulse;
		b.put( change, row.b );
	}
	Lanes off;
	for ( int lane = 0; lane < kRowLanes; ++lane )
	{
		off[lane] = btScalar( impulse[lane] * row.inverseEffectiveMass[lane] );
	}
	off *= off;
	put( worst, off > worst, off );
}

/// The unclamped impulse of a node and a rotating body. Bullet evaluates the first body first.
inline btScalar unclampedImpulse( const RollingRow& row, const btSolverBody& body, const btVector3& velocity )
{
	const btScalar turned = -(
		( row.normal.dot( body.getDeltaLinearVelocity() ) + row.cross.dot( body.getDeltaAngularVelocity() ) ) * row.effectiveMass );
	const btScalar moved = row.normal.dot( velocity ) * row.effectiveMass;
	return row.rhs - row.impulse * row.cfm + ( row.isBodyFirst ? turned : moved ) + ( row.isBodyFirst ? moved : turned );
}

inline btScalar applyImpulse( const RollingRow& row, btSolverBody& body, btVector3& velocity, btScalar impulse )
{
	body.internalApplyImpulse( row.normal * body.internalGetInvMass(), row.angular, impulse );
	velocity -= row.normal * row.inverseMass * impulse;
	return btScalar( impulse * row.inverseEffectiveMass );
}

inline btScalar press( RollingRow& row, btSolverBody& body, btVector3& velocity )
{
	const btScalar d = unclampedImpulse( row, body, velocity ), sum = row.impulse + d;
	const btScalar impulse = sum < 0 ? -row.impulse : d;
	row.impulse = sum < 0 ? 0 : sum;
	return applyImpulse( row, body, velocity, impulse );
}

inline btScalar rub( RollingRow& row, btSolverBody& body, btVector3& velocity, btScalar pressed )
{
	const btScalar high = row.friction * pressed, low = -high, d = unclampedImpulse( row, body, velocity ), sum = row.impulse + d;
	const btScalar held = sum < low ? low : sum > high ? high : sum;
	const btScalar impulse = sum < low || sum > high ? held - row.impulse : d;
	row.impulse = held;
	return applyImpulse( row, body, velocity, impulse );
}

void raiseWorst( btScalar off, Lanes& worst )
{
	worst[0] = std::max( worst[0], off * off );
}

} // namespace

void FourRows::set( int lane, const RowData& data, int pointA, btScalar inverseOfA, int pointB, btScalar inverseOfB )
{
	normal[0][lane] = data.normal.x();
	normal[1][lane] = data.normal.y();
	normal[2][lane] = data.normal.z();
	effectiveMass[lane] = data.effectiveMass;
	inverseA[lane] = inverseOfA;
	inverseB[lane] = inverseOfB;
	rhs[lane] = data.rhs;
	cfm[lane] = data.cfm;
	impulse[lane] = data.impulse;
	friction[lane] = data.friction;
	inverseEffectiveMass[lane] = 1. / data.effectiveMass;
	a[lane] = pointA;
	b[lane] = pointB;
}

void ContactRows::clear( int directionCount )
{
	directions = directionCount;
	runs.clear();
	m_stepCount = 0;
	for ( int kind = 0; kind < 2; ++kind )
	{
		press[kind].clear();
		rub[kind].clear();
		m_openGroups[kind].step.clear();
		m_openGroups[kind].filled.clear();
		m_openGroups[kind].first = 0;
	}
	turnPress.clear();
	turnRub.clear();
	contacts.clear();
	deep.clear();
	points.assign( 1, NodePoint{ btVector3( 0, 0, 0 ), btVector3( 0, 0, 0 ), nullptr, 0, -1 } );
	change.assign( 1, btVector3( 0, 0, 0 ) );
}

int ContactRows::addPoint( btRigidBody& body )
{
	points.push_back( NodePoint{ body.getLinearVelocity(), btVector3( 0, 0, 0 ), &body, body.getInvMass(), -1 } );
	change.push_back( btVector3( 0, 0, 0 ) );
	return int( points.size() ) - 1;
}

RowPosition ContactRows::allocate( RowKind kind, int a, int b )
{
	const int next = m_stepCount, after = std::max( points[std::size_t( a )].step, b > 0 ? points[std::size_t( b )].step : -1 );
	int step = next, at = int( turnPress.size() );
	if ( kind != RowKind::Turning )
	{
		OpenGroups& open = m_openGroups[int( kind )];
		while ( open.first < open.filled.size() && open.filled[open.first] == kRowLanes )
		{
			++open.first;
		}
		// Steps of one kind ascend.
		std::size_t four = std::size_t(
			std::upper_bound( open.step.begin() + std::ptrdiff_t( open.first ), open.step.end(), after ) - open.step.begin() );
		const std::size_t last = std::min( open.step.size(), four + kMostSearched );
		while ( four < last && open.filled[four] == kRowLanes )
		{
			++four;
		}
		if ( four >= last )
		{
			four = open.step.size();
			open.step.push_back( next );
			open.filled.push_back( 0 );
			press[int( kind )].emplace_back();
			rub[int( kind )].resize( rub[int( kind )].size() + std::size_t( directions ) );
		}
		step = open.step[four];
		at = int( four ) * kRowLanes + open.filled[four]++;
	}
	else
	{
		turnPress.emplace_back();
		turnRub.resize( turnRub.size() + std::size_t( directions ) );
	}
	if ( step == next )
	{
		addStep( kind, kind == RowKind::Turning ? at : at / kRowLanes );
	}
	points[std::size_t( a )].step = step;
	points[std::size_t( b )].step = b > 0 ? step : -1;
	return RowPosition{ kind, at };
}

void ContactRows::addStep( RowKind kind, int at )
{
	++m_stepCount;
	if ( !runs.empty() && runs.back().kind == kind && runs.back().last == at )
	{
		++runs.back().last;
		return;
	}
	runs.push_back( Run{ kind, at, at + 1 } );
}

void ContactRows::pressRun( const Run& run, btSolverBody* bodies, Lanes& worst )
{
	btVector3* const velocities = change.data();
	const std::size_t first = std::size_t( run.first ), last = std::size_t( run.last );
	if ( run.kind == RowKind::Static )
	{
		std::for_each(
			&press[0][first], &press[0][last - 1] + 1, [&]( FourRows& row ) { solveFour<false>( row, nullptr, velocities, worst ); } );
	}
	else if ( run.kind == RowKind::Pair )
	{
		std::for_each(
			&press[1][first], &press[1][last - 1] + 1, [&]( FourRows& row ) { solveFour<true>( row, nullptr, velocities, worst ); } );
	}
	else
	{
		std::for_each( &turnPress[first], &turnPress[last - 1] + 1,
			[&]( RollingRow& row ) { raiseWorst( pliant::press( row, bodies[row.body], velocities[row.point] ), worst ); } );
	}
}

void ContactRows::rubRun( const Run& run, btSolverBody* bodies, Lanes& worst )
{
	btVector3* const velocities = change.data();
	const std::size_t each = std::size_t( directions );
	for ( std::size_t k = std::size_t( run.first ) * each, at = std::size_t( run.first ); at < std::size_t( run.last ); ++at )
	{
		for ( const std::size_t end = k + each; k < end; ++k )
		{
			if ( run.kind == RowKind::Static )
			{
				solveFour<false>( rub[0][k], &press[0][at], velocities, worst );
			}
			else if ( run.kind == RowKind::Pair )
			{
				solveFour<true>( rub[1][k], &press[1][at], velocities, worst );
			}
			else if ( turnPress[at].impulse > 0 )
			{
				RollingRow& row = turnRub[k];
				raiseWorst( pliant::rub( row, bodies[row.body], velocities[row.point], turnPress[at].impulse ), worst );
			}
		}
	}
}

btScalar ContactRows::pushOut( Deep& out, btSolverBody* bodies )
{
	const bool turns = out.position.kind == RowKind::Turning;
	RollingRow* const turning = turns ? &turnPress[std::size_t( out.position.at )] : nullptr;
	const FourRows* const four = turns ? nullptr : &press[int( out.position.kind )][std::size_t( out.position.at / kRowLanes )];
	const int lane = out.position.at % kRowLanes;
	const btScalar cfm = turns ? turning->cfm : four->cfm[lane], effectiveMass = turns ? turning->effectiveMass : four->effectiveMass[lane];
	NodePoint& b = points[std::size_t( turns ? turning->point : four->b[lane] )];
	NodePoint* const a = turns ? nullptr : &points[std::size_t( four->a[lane] )];
	btSolverBody* const body = turns ? &bodies[turning->body] : nullptr;
	const btVector3 normal = turns ? turning->normal : btVector3( four->normal[0][lane], four->normal[1][lane], four->normal[2][lane] );

	const btScalar ofA = -(
		( turns ? normal.dot( body->getPushVelocity() ) + turning->cross.dot( body->getTurnVelocity() ) : normal.dot( a->pushVelocity ) ) *
		effectiveMass );
	const btScalar ofB = normal.dot( b.pushVelocity ) * effectiveMass;
	const bool isAFirst = !turns || turning->isBodyFirst;
	btScalar impulse = out.rhs - out.impulse * cfm + ( isAFirst ? ofA : ofB ) + ( isAFirst ? ofB : ofA );
	const btScalar sum = out.impulse + impulse;
	impulse = sum < 0 ? -out.impulse : impulse;
	out.impulse = sum < 0 ? 0 : sum;
	if ( turns )
	{
		body->internalApplyPushImpulse( normal * body->internalGetInvMass(), turning->angular, impulse );
	}
	else
	{
		a->pushVelocity += normal * a->inverseMass * impulse;
	}
	b.pushVelocity -= normal * b.inverseMass * impulse;
	return btScalar( impulse * ( turns ? turning->inverseEffectiveMass : four->inverseEffectiveMass[lane] ) );
}

void ContactRows::giveBackImpulses() const
{
	for ( const Contact& contact : contacts )
	{
		const std::size_t at = std::size_t( contact.position.at );
		if ( contact.position.kind == RowKind::Turning )
		{
			contact.point->m_appliedImpulse = turnPress[at].impulse;
			contact.point->m_appliedImpulseLateral1 = turnRub[at * std::size_t( directions )].impulse;
			contact.point->m_appliedImpulseLateral2 = directions > 1 ? turnRub[at * 2 + 1].impulse
																	 : contact.point->m_appliedImpulseLateral2;
			continue;
		}
		const std::size_t lane = at % kRowLanes, four = at / kRowLanes;
		const FourRows* const rubs = &rub[int( contact.position.kind )][four * std::size_t( directions )];
		contact.point->m_appliedImpulse = press[int( contact.position.kind )][four].impulse[lane];
		contact.point->m_appliedImpulseLateral1 = rubs[0].impulse[lane];
		contact.point->m_appliedImpulseLateral2 = directions > 1 ? rubs[1].impulse[lane] : contact.point->m_appliedImpulseLateral2;
	}
}

void ContactRows::restoreVelocities( bool isSplit, btScalar timeStep ) const
{
	for ( std::size_t i = 1; i < points.size(); ++i )
	{
		prefetch( &points[std::min( i + kProxiesAhead, points.size() - 1 )].body->getLinearVelocity(), sizeof( btVector3 ) );
		const NodePoint& point = points[i];
		setWhole( const_cast<btVector3&>( point.body->getLinearVelocity() ), point.velocity + change[i] );
		point.body->setCompanionId( -1 );
		if ( isSplit && !point.pushVelocity.isZero() )
		{
			btTransform moved;
			btTransformUtil::integrateTransform(
				point.body->getWorldTransform(), point.pushVelocity, btVector3( 0, 0, 0 ), timeStep, moved );
			point.body->setWorldTransform( moved );
		}
	}
}

} // namespace pliant
