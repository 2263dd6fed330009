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
/// `normalRow`: the normal rows of four friction rows. Without branches, since sliding and separation cannot be predicted.
template <bool kHasB>
inline void solveFour( FourRows& row, const FourRows* normalRow, btVector3* change, Lanes& worst )
{
	const Lanes none{};
	FourVelocities a( change, row.a ), b( change, kHasB ? row.b : row.a );
	Lanes d = row.rhs - row.impulse * row.cfm - ( row.normal[0] * a.x + row.normal[1] * a.y + row.normal[2] * a.z ) * row.effectiveMass;
	if constexpr ( kHasB )
	{
		d += ( row.normal[0] * b.x + row.normal[1] * b.y + row.normal[2] * b.z ) * row.effectiveMass;
	}
	Lanes impulse = d, newImpulse = row.impulse + d;
	if ( normalRow )
	{
		const Lanes high = row.friction * normalRow->impulse, low = -high, sum = newImpulse;
		const LaneMask isLow = sum<low, isHigh = sum> high, isOff = ~( normalRow->impulse > none );
		put( newImpulse, isHigh, high );
		put( newImpulse, isLow, low );
		put( impulse, isLow | isHigh, newImpulse - row.impulse );
		put( impulse, isOff, none );
		put( newImpulse, isOff, row.impulse );
	}
	else
	{
		const LaneMask isLow = newImpulse < none; // normal impulses are not negative
		put( impulse, isLow, -row.impulse );
		put( newImpulse, isLow, none );
	}
	row.impulse = newImpulse;
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
inline btScalar unclampedImpulse( const RotatingRow& row, const btSolverBody& body, const btVector3& velocity )
{
	const btScalar turned = -(
		( row.normal.dot( body.getDeltaLinearVelocity() ) + row.cross.dot( body.getDeltaAngularVelocity() ) ) * row.effectiveMass );
	const btScalar moved = row.normal.dot( velocity ) * row.effectiveMass;
	return row.rhs - row.impulse * row.cfm + ( row.isBodyFirst ? turned : moved ) + ( row.isBodyFirst ? moved : turned );
}

inline btScalar applyImpulse( const RotatingRow& row, btSolverBody& body, btVector3& velocity, btScalar impulse )
{
	body.internalApplyImpulse( row.normal * body.internalGetInvMass(), row.angular, impulse );
	velocity -= row.normal * row.inverseMass * impulse;
	return btScalar( impulse * row.inverseEffectiveMass );
}

inline btScalar solveNormal( RotatingRow& row, btSolverBody& body, btVector3& velocity )
{
	const btScalar d = unclampedImpulse( row, body, velocity ), sum = row.impulse + d;
	const btScalar impulse = sum < 0 ? -row.impulse : d;
	row.impulse = sum < 0 ? 0 : sum;
	return applyImpulse( row, body, velocity, impulse );
}

inline btScalar solveFriction( RotatingRow& row, btSolverBody& body, btVector3& velocity, btScalar normalImpulse )
{
	const btScalar high = row.friction * normalImpulse, low = -high, d = unclampedImpulse( row, body, velocity ), sum = row.impulse + d;
	const btScalar newImpulse = sum < low ? low : sum > high ? high : sum;
	const btScalar impulse = sum < low || sum > high ? newImpulse - row.impulse : d;
	row.impulse = newImpulse;
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
		normalRows[kind].clear();
		frictionRows[kind].clear();
		m_openGroups[kind].step.clear();
		m_openGroups[kind].filled.clear();
		m_openGroups[kind].first = 0;
	}
	rotatingNormalRows.clear();
	rotatingFrictionRows.clear();
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
	int step = next, at = int( rotatingNormalRows.size() );
	if ( kind != RowKind::Rotating )
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
			normalRows[int( kind )].emplace_back();
			frictionRows[int( kind )].resize( frictionRows[int( kind )].size() + std::size_t( directions ) );
		}
		step = open.step[four];
		at = int( four ) * kRowLanes + open.filled[four]++;
	}
	else
	{
		rotatingNormalRows.emplace_back();
		rotatingFrictionRows.resize( rotatingFrictionRows.size() + std::size_t( directions ) );
	}
	if ( step == next )
	{
		addStep( kind, kind == RowKind::Rotating ? at : at / kRowLanes );
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

void ContactRows::solveNormalRun( const Run& run, btSolverBody* bodies, Lanes& worst )
{
	btVector3* const velocities = change.data();
	const std::size_t first = std::size_t( run.first ), last = std::size_t( run.last );
	if ( run.kind == RowKind::Static )
	{
		std::for_each( &normalRows[0][first], &normalRows[0][last - 1] + 1,
			[&]( FourRows& row ) { solveFour<false>( row, nullptr, velocities, worst ); } );
	}
	else if ( run.kind == RowKind::Pair )
	{
		std::for_each( &normalRows[1][first], &normalRows[1][last - 1] + 1,
			[&]( FourRows& row ) { solveFour<true>( row, nullptr, velocities, worst ); } );
	}
	else
	{
		std::for_each( &rotatingNormalRows[first], &rotatingNormalRows[last - 1] + 1,
			[&]( RotatingRow& row ) { raiseWorst( solveNormal( row, bodies[row.body], velocities[row.point] ), worst ); } );
	}
}

void ContactRows::solveFrictionRun( const Run& run, btSolverBody* bodies, Lanes& worst )
{
	btVector3* const velocities = change.data();
	const std::size_t each = std::size_t( directions );
	for ( std::size_t k = std::size_t( run.first ) * each, at = std::size_t( run.first ); at < std::size_t( run.last ); ++at )
	{
		for ( const std::size_t end = k + each; k < end; ++k )
		{
			if ( run.kind == RowKind::Static )
			{
				solveFour<false>( frictionRows[0][k], &normalRows[0][at], velocities, worst );
			}
			else if ( run.kind == RowKind::Pair )
			{
				solveFour<true>( frictionRows[1][k], &normalRows[1][at], velocities, worst );
			}
			else if ( rotatingNormalRows[at].impulse > 0 )
			{
				RotatingRow& row = rotatingFrictionRows[k];
				raiseWorst( solveFriction( row, bodies[row.body], velocities[row.point], rotatingNormalRows[at].impulse ), worst );
			}
		}
	}
}

btScalar ContactRows::pushOut( Deep& out, btSolverBody* bodies )
{
	const bool isRotating = out.position.kind == RowKind::Rotating;
	RotatingRow* const rotating = isRotating ? &rotatingNormalRows[std::size_t( out.position.at )] : nullptr;
	const FourRows* const four = isRotating ? nullptr : &normalRows[int( out.position.kind )][std::size_t( out.position.at / kRowLanes )];
	const int lane = out.position.at % kRowLanes;
	const btScalar cfm = isRotating ? rotating->cfm : four->cfm[lane],
				   effectiveMass = isRotating ? rotating->effectiveMass : four->effectiveMass[lane];
	NodePoint& b = points[std::size_t( isRotating ? rotating->point : four->b[lane] )];
	NodePoint* const a = isRotating ? nullptr : &points[std::size_t( four->a[lane] )];
	btSolverBody* const body = isRotating ? &bodies[rotating->body] : nullptr;
	const btVector3 normal = isRotating ? rotating->normal
										: btVector3( four->normal[0][lane], four->normal[1][lane], four->normal[2][lane] );

	const btScalar ofA = -( ( isRotating ? normal.dot( body->getPushVelocity() ) + rotating->cross.dot( body->getTurnVelocity() )
										 : normal.dot( a->pushVelocity ) ) *
		effectiveMass );
	const btScalar ofB = normal.dot( b.pushVelocity ) * effectiveMass;
	const bool isAFirst = !isRotating || rotating->isBodyFirst;
	btScalar impulse = out.rhs - out.impulse * cfm + ( isAFirst ? ofA : ofB ) + ( isAFirst ? ofB : ofA );
	const btScalar sum = out.impulse + impulse;
	impulse = sum < 0 ? -out.impulse : impulse;
	out.impulse = sum < 0 ? 0 : sum;
	if ( isRotating )
	{
		body->internalApplyPushImpulse( normal * body->internalGetInvMass(), rotating->angular, impulse );
	}
	else
	{
		a->pushVelocity += normal * a->inverseMass * impulse;
	}
	b.pushVelocity -= normal * b.inverseMass * impulse;
	return btScalar( impulse * ( isRotating ? rotating->inverseEffectiveMass : four->inverseEffectiveMass[lane] ) );
}

void ContactRows::writeImpulses() const
{
	for ( const Contact& contact : contacts )
	{
		const std::size_t at = std::size_t( contact.position.at );
		if ( contact.position.kind == RowKind::Rotating )
		{
			contact.point->m_appliedImpulse = rotatingNormalRows[at].impulse;
			contact.point->m_appliedImpulseLateral1 = rotatingFrictionRows[at * std::size_t( directions )].impulse;
			contact.point->m_appliedImpulseLateral2 = directions > 1 ? rotatingFrictionRows[at * 2 + 1].impulse
																	 : contact.point->m_appliedImpulseLateral2;
			continue;
		}
		const std::size_t lane = at % kRowLanes, four = at / kRowLanes;
		const FourRows* const frictionGroup = &frictionRows[int( contact.position.kind )][four * std::size_t( directions )];
		contact.point->m_appliedImpulse = normalRows[int( contact.position.kind )][four].impulse[lane];
		contact.point->m_appliedImpulseLateral1 = frictionGroup[0].impulse[lane];
		contact.point->m_appliedImpulseLateral2 = directions > 1 ? frictionGroup[1].impulse[lane] : contact.point->m_appliedImpulseLateral2;
	}
}

void ContactRows::writeVelocities( bool isSplit, btScalar timeStep ) const
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
