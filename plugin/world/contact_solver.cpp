#include "pliant/contact_solver.h"

#include "world/ahead.h"

#include <algorithm>
#include <cstdint>
#include <type_traits>
#include <vector>

namespace pliant {

namespace {

/// Manifolds of a share that is converted while the next one is fetched.
constexpr int kShare = 8;

using F4 = btScalar __attribute__( ( vector_size( 4 * sizeof( btScalar ) ), may_alias, aligned( sizeof( btScalar ) ) ) );

using I4 = std::conditional_t<sizeof( btScalar ) == 4, int, long long> __attribute__( ( vector_size( 4 * sizeof( btScalar ) ), may_alias ) );

/// A row between points: nothing turns. `normal` acts on a, and against it on b; where a meets what stands, b is nobody.
struct Row
{
	btScalar normal[4];
	btScalar perSpeed;            ///< Bullet's m_jacDiagABInv
	btScalar inverseA, inverseB;  ///< 1 / kg
	btScalar rhs, cfm, impulse;
	btScalar friction;            ///< share of what presses
	int bodyA, bodyB;             ///< a < 0: it is Bullet's own row that is solved, and this one holds its impulse
	int pressed;                  ///< friction: the row that presses
	double perImpulse;            ///< 1 / perSpeed, in double, as Bullet has it
};

bool isZero( const btVector3& a )
{
	return a.x() == 0 && a.y() == 0 && a.z() == 0;
}

/// What no impulse moves; what has no spin, and moves alike along all axes; all else.
enum class Body : std::uint8_t
{
	Still,
	Point,
	Other
};

Body kindOf( const btSolverBody& body )
{
	if ( !body.m_originalBody )
	{
		return Body::Still;
	}
	const btVector3& inverse = body.m_invMass;
	const bool isEven = body.m_linearFactor.x() == 1 && body.m_linearFactor.y() == 1 && body.m_linearFactor.z() == 1 && inverse.x() == inverse.y() && inverse.x() == inverse.z();
	return isEven && isZero( body.m_angularFactor ) && isZero( body.m_deltaAngularVelocity ) ? Body::Point : Body::Other;
}

inline btScalar along( const Row& row, const btVector3& v )
{
	return row.normal[0] * v.x() + row.normal[1] * v.y() + row.normal[2] * v.z();
}

inline void push( btVector3& v, const Row& row, btScalar inverse, btScalar impulse )
{
	*reinterpret_cast<F4*>( v.m_floats ) += *reinterpret_cast<const F4*>( row.normal ) * inverse * impulse;
}

/// What the row asks for, with what the bodies have taken up so far. Bullet's order of evaluation, without its products with zero:
///     d = rhs - cfm P - n.va / K + n.vb / K
template <bool kHasB>
inline btScalar asked( const Row& row, const btSolverBody* bodies )
{
	btScalar d = row.rhs - row.impulse * row.cfm - along( row, bodies[row.bodyA].m_deltaLinearVelocity ) * row.perSpeed;
	if constexpr ( kHasB )
	{
		d += along( row, bodies[row.bodyB].m_deltaLinearVelocity ) * row.perSpeed;
	}
	return d;
}

/// The bodies take the impulse. Returns what the row was off by, m/s.
template <bool kHasB>
inline btScalar take( const Row& row, btSolverBody* bodies, btScalar impulse )
{
	push( bodies[row.bodyA].m_deltaLinearVelocity, row, row.inverseA, impulse );
	if constexpr ( kHasB )
	{
		push( bodies[row.bodyB].m_deltaLinearVelocity, row, row.inverseB, -impulse );
	}
	return btScalar( impulse * row.perImpulse );
}

/// A contact's least impulse is zero: what d falls short of that is P, to the bit.
template <bool kHasB>
inline btScalar press( Row& row, btSolverBody* bodies )
{
	const btScalar d = asked<kHasB>( row, bodies ), sum = row.impulse + d;
	const btScalar impulse = sum < 0 ? -row.impulse : d;
	row.impulse = sum < 0 ? 0 : sum;
	return take<kHasB>( row, bodies, impulse );
}

// Which rows slip cannot be guessed ahead: no branches.
template <bool kHasB>
inline btScalar rub( Row& row, btSolverBody* bodies, btScalar pressed )
{
	const btScalar high = row.friction * pressed, low = -high, d = asked<kHasB>( row, bodies ), sum = row.impulse + d;
	const btScalar atMost = sum > high ? high : sum, held = sum < low ? low : atMost;
	const I4 isHeld = F4{ held } != F4{ sum };
	const F4 impulse = (F4)( ( (I4)F4{ held - row.impulse } & isHeld ) | ( (I4)F4{ d } & ~isHeld ) );
	row.impulse = held;
	return take<kHasB>( row, bodies, impulse[0] );
}

} // namespace

struct ContactSolver::Rows
{
	bool isInUse = false; ///< of the island at hand
	std::vector<Row> normal, friction; ///< as many as Bullet's
	std::vector<Body> body;

	/// `isLimited`: its least impulse is what ours has.
	void lay( const btSolverConstraint& from, const btSolverBody* bodies, bool isLimited, Row& to ) const;
};

void ContactSolver::Rows::lay( const btSolverConstraint& from, const btSolverBody* bodies, bool isLimited, Row& to ) const
{
	const int a = from.m_solverBodyIdA, b = from.m_solverBodyIdB;
	const Body kindA = body[std::size_t( a )], kindB = body[std::size_t( b )];
	const btVector3 &n1 = from.m_contactNormal1, &n2 = from.m_contactNormal2;
	to.impulse = from.m_appliedImpulse;
	to.pressed = from.m_frictionIndex;
	const bool turned = kindA == Body::Still;
	const bool isOurs = isLimited && kindA != Body::Other && kindB != Body::Other && !( turned && kindB == Body::Still ) && ( turned || kindB == Body::Still || isZero( n1 + n2 ) );
	to.bodyA = !isOurs ? -1 : turned ? b : a;
	if ( !isOurs )
	{
		return;
	}
	const btVector3& axis = turned ? n2 : n1;
	to.normal[0] = axis.x();
	to.normal[1] = axis.y();
	to.normal[2] = axis.z();
	to.normal[3] = 0;
	to.bodyB = kindB == Body::Point && !turned ? b : -1;
	to.perSpeed = from.m_jacDiagABInv;
	to.inverseA = bodies[to.bodyA].m_invMass.x();
	to.inverseB = to.bodyB < 0 ? btScalar( 0 ) : bodies[b].m_invMass.x();
	to.rhs = from.m_rhs;
	to.cfm = from.m_cfm;
	to.friction = from.m_friction;
	to.perImpulse = 1. / from.m_jacDiagABInv;
}

ContactSolver::ContactSolver() : m_rows( std::make_unique<Rows>() ) {}

ContactSolver::~ContactSolver() = default;

bool ContactSolver::isPlain( int jointCount, const btContactSolverInfo& info ) const
{
	auto& self = const_cast<ContactSolver&>( *this ); // Bullet forgot the const
	const int others = SOLVER_RANDMIZE_ORDER | SOLVER_INTERLEAVE_CONTACT_AND_FRICTION_CONSTRAINTS;
	return jointCount == 0 && ( info.m_solverMode & others ) == 0 && m_tmpSolverNonContactConstraintPool.size() == 0 &&
		   m_tmpSolverContactRollingFrictionConstraintPool.size() == 0 && self.getActiveConstraintRowSolverGeneric() == self.getScalarConstraintRowSolverGeneric() &&
		   self.getActiveConstraintRowSolverLowerLimit() == self.getScalarConstraintRowSolverLowerLimit();
}

void ContactSolver::layOut()
{
	Rows& rows = *m_rows;
	const int count = m_tmpSolverBodyPool.size();
	const btSolverBody* const bodies = count > 0 ? &m_tmpSolverBodyPool[0] : nullptr;
	rows.body.resize( std::size_t( count ) );
	std::transform( bodies, bodies + count, rows.body.begin(), kindOf );
	rows.normal.resize( std::size_t( m_tmpSolverContactConstraintPool.size() ) );
	for ( std::size_t i = 0; i < rows.normal.size(); ++i )
	{
		const btSolverConstraint& from = m_tmpSolverContactConstraintPool[int( i )];
		rows.lay( from, bodies, from.m_lowerLimit == 0, rows.normal[i] );
	}
	rows.friction.resize( std::size_t( m_tmpSolverContactFrictionConstraintPool.size() ) );
	for ( std::size_t i = 0; i < rows.friction.size(); ++i )
	{
		rows.lay( m_tmpSolverContactFrictionConstraintPool[int( i )], bodies, true, rows.friction[i] );
	}
}

// Manifolds and bodies lie anywhere: those of the next share are asked for while one is converted.
void ContactSolver::convertContacts( btPersistentManifold** manifolds, int count, const btContactSolverInfo& info )
{
	for ( int first = 0; first < count; first += kShare )
	{
		const int next = first + kShare, afterNext = std::min( next + kShare, count ), later = std::min( afterNext + kShare, count );
		for ( int m = afterNext; m < later; ++m )
		{
			askForManifold( *manifolds[m] );
		}
		for ( int m = next; m < afterNext; ++m )
		{
			for ( const btCollisionObject* object : { manifolds[m]->getBody0(), manifolds[m]->getBody1() } )
			{
				askFor( object, sizeof( btRigidBody ) );
			}
		}
		btSequentialImpulseConstraintSolver::convertContacts( manifolds + first, std::min( kShare, count - first ), info );
	}
}

btScalar ContactSolver::solveGroupCacheFriendlySetup( btCollisionObject** bodies, int bodyCount, btPersistentManifold** manifolds, int manifoldCount,
	btTypedConstraint** joints, int jointCount, const btContactSolverInfo& info, btIDebugDraw* drawer )
{
	const btScalar done =
		btSequentialImpulseConstraintSolver::solveGroupCacheFriendlySetup( bodies, bodyCount, manifolds, manifoldCount, joints, jointCount, info, drawer );
	m_rows->isInUse = isPlain( jointCount, info );
	if ( m_rows->isInUse )
	{
		layOut();
	}
	return done;
}

btScalar ContactSolver::solveSingleIteration( int iteration, btCollisionObject** bodies, int bodyCount, btPersistentManifold** manifolds, int manifoldCount,
	btTypedConstraint** joints, int jointCount, const btContactSolverInfo& info, btIDebugDraw* drawer )
{
	if ( !m_rows->isInUse )
	{
		return btSequentialImpulseConstraintSolver::solveSingleIteration(
			iteration, bodies, bodyCount, manifolds, manifoldCount, joints, jointCount, info, drawer );
	}
	btScalar worst = 0;
	if ( iteration >= info.m_numIterations || m_tmpSolverBodyPool.size() == 0 )
	{
		return worst;
	}
	btSolverBody* const all = &m_tmpSolverBodyPool[0];
	std::vector<Row>& normals = m_rows->normal;
	for ( std::size_t i = 0; i < normals.size(); ++i )
	{
		Row& row = normals[i];
		btScalar off = 0;
		if ( row.bodyA < 0 )
		{
			const btSolverConstraint& bullets = m_tmpSolverContactConstraintPool[int( i )];
			off = m_resolveSingleConstraintRowLowerLimit( all[bullets.m_solverBodyIdA], all[bullets.m_solverBodyIdB], bullets );
			row.impulse = bullets.m_appliedImpulse;
		}
		else
		{
			off = row.bodyB < 0 ? press<false>( row, all ) : press<true>( row, all );
		}
		worst = std::max( worst, off * off );
	}
	for ( std::size_t i = 0; i < m_rows->friction.size(); ++i )
	{
		Row& row = m_rows->friction[i];
		const btScalar pressed = normals[std::size_t( row.pressed )].impulse;
		if ( !( pressed > 0 ) )
		{
			continue;
		}
		btScalar off = 0;
		if ( row.bodyA < 0 )
		{
			btSolverConstraint& bullets = m_tmpSolverContactFrictionConstraintPool[int( i )];
			bullets.m_upperLimit = bullets.m_friction * pressed;
			bullets.m_lowerLimit = -bullets.m_upperLimit;
			off = m_resolveSingleConstraintRowGeneric( all[bullets.m_solverBodyIdA], all[bullets.m_solverBodyIdB], bullets );
		}
		else
		{
			off = row.bodyB < 0 ? rub<false>( row, all, pressed ) : rub<true>( row, all, pressed );
		}
		worst = std::max( worst, off * off );
	}
	return worst;
}

btScalar ContactSolver::solveGroupCacheFriendlyFinish( btCollisionObject** bodies, int bodyCount, const btContactSolverInfo& info )
{
	const auto giveBack = []( const std::vector<Row>& rows, btConstraintArray& to ) {
		for ( std::size_t i = 0; i < rows.size(); ++i )
		{
			to[int( i )].m_appliedImpulse = rows[i].bodyA < 0 ? btScalar( to[int( i )].m_appliedImpulse ) : rows[i].impulse;
		}
	};
	if ( m_rows->isInUse )
	{
		giveBack( m_rows->normal, m_tmpSolverContactConstraintPool );
		giveBack( m_rows->friction, m_tmpSolverContactFrictionConstraintPool );
	}
	m_rows->isInUse = false;
	// Who was touched first is nowhere near by now.
	for ( int i = 0; i < m_tmpSolverBodyPool.size(); ++i )
	{
		if ( const btRigidBody* const body = m_tmpSolverBodyPool[i].m_originalBody )
		{
			askFor( &body->getLinearVelocity(), 2 * sizeof( btVector3 ) );
			askWho( *body );
		}
	}
	return btSequentialImpulseConstraintSolver::solveGroupCacheFriendlyFinish( bodies, bodyCount, info );
}

} // namespace pliant
