#include "pliant/contact_solver.h"

#include "world/solver/contact_rows.h"

#include <algorithm>

namespace pliant {

ContactSolver::ContactSolver() : m_rows( std::make_unique<ContactRows>() ) {}

ContactSolver::~ContactSolver() = default;

bool ContactSolver::isPlain( const btContactSolverInfo& info ) const
{
	auto& self = const_cast<ContactSolver&>( *this ); // Bullet's accessors lack const
	const int others = SOLVER_RANDMIZE_ORDER | SOLVER_INTERLEAVE_CONTACT_AND_FRICTION_CONSTRAINTS;
	return m_jointCount == 0 && ( info.m_solverMode & others ) == 0 && m_tmpSolverNonContactConstraintPool.size() == 0 &&
		self.getActiveConstraintRowSolverGeneric() == self.getScalarConstraintRowSolverGeneric() &&
		self.getActiveConstraintRowSolverLowerLimit() == self.getScalarConstraintRowSolverLowerLimit();
}

btSolverBody* ContactSolver::solverBodies()
{
	return m_tmpSolverBodyPool.size() > 0 ? &m_tmpSolverBodyPool[0] : nullptr;
}

btScalar ContactSolver::solveGroupCacheFriendlySetup( btCollisionObject** bodies, int bodyCount, btPersistentManifold** manifolds,
	int manifoldCount, btTypedConstraint** joints, int jointCount, const btContactSolverInfo& info, btIDebugDraw* drawer )
{
	m_jointCount = jointCount;
	return btSequentialImpulseConstraintSolver::solveGroupCacheFriendlySetup(
		bodies, bodyCount, manifolds, manifoldCount, joints, jointCount, info, drawer );
}

// Contacts without penetration are skipped: Bullet's rows leave them unchanged.
btScalar ContactSolver::pushOutOnce()
{
	btSolverBody* const all = solverBodies();
	btScalar worst = 0;
	for ( ContactRows::Deep& deep : m_rows->deep )
	{
		btScalar off = 0;
		if ( deep.position.kind == RowKind::Bullet )
		{
			const btSolverConstraint& row = m_tmpSolverContactConstraintPool[deep.position.at];
			off = m_resolveSplitPenetrationImpulse( all[row.m_solverBodyIdA], all[row.m_solverBodyIdB], row );
		}
		else
		{
			off = m_rows->pushOut( deep, all );
		}
		worst = std::max( worst, off * off );
	}
	return worst;
}

void ContactSolver::solveGroupCacheFriendlySplitImpulseIterations( btCollisionObject** bodies, int bodyCount,
	btPersistentManifold** manifolds, int manifoldCount, btTypedConstraint** joints, int jointCount, const btContactSolverInfo& info,
	btIDebugDraw* drawer )
{
	if ( !m_isInUse )
	{
		btSequentialImpulseConstraintSolver::solveGroupCacheFriendlySplitImpulseIterations(
			bodies, bodyCount, manifolds, manifoldCount, joints, jointCount, info, drawer );
		return;
	}
	bool isOff = info.m_splitImpulse;
	for ( int iteration = 0; isOff && iteration < info.m_numIterations; ++iteration )
	{
		isOff = !( pushOutOnce() <= info.m_leastSquaresResidualThreshold );
	}
}

btScalar ContactSolver::pressBullets( int at )
{
	btSolverBody* const all = solverBodies();
	const btSolverConstraint& row = m_tmpSolverContactConstraintPool[at];
	return m_resolveSingleConstraintRowLowerLimit( all[row.m_solverBodyIdA], all[row.m_solverBodyIdB], row );
}

btScalar ContactSolver::rubBullets( int at )
{
	btSolverBody* const all = solverBodies();
	const btSolverConstraint& pressing = m_tmpSolverContactConstraintPool[at];
	const btScalar pressed = pressing.m_appliedImpulse;
	btScalar worst = 0;
	for ( int k = 0; pressed > 0 && k < m_rows->directions; ++k )
	{
		btSolverConstraint& row = m_tmpSolverContactFrictionConstraintPool[pressing.m_frictionIndex + k];
		row.m_upperLimit = row.m_friction * pressed;
		row.m_lowerLimit = -row.m_upperLimit;
		const btScalar off = m_resolveSingleConstraintRowGeneric( all[row.m_solverBodyIdA], all[row.m_solverBodyIdB], row );
		worst = std::max( worst, off * off );
	}
	return worst;
}

// Rolling friction of rigid bodies only: the limit is that of a normal impulse of at most 1 N s.
btScalar ContactSolver::rollBullets()
{
	btSolverBody* const all = solverBodies();
	btScalar worst = 0;
	for ( int k = 0; k < m_tmpSolverContactRollingFrictionConstraintPool.size(); ++k )
	{
		btSolverConstraint& row = m_tmpSolverContactRollingFrictionConstraintPool[k];
		const btScalar pressed = m_tmpSolverContactConstraintPool[row.m_frictionIndex].m_appliedImpulse;
		if ( !( pressed > 0 ) )
		{
			continue;
		}
		row.m_upperLimit = std::min( row.m_friction * pressed, row.m_friction );
		row.m_lowerLimit = -row.m_upperLimit;
		const btScalar off = m_resolveSingleConstraintRowGeneric( all[row.m_solverBodyIdA], all[row.m_solverBodyIdB], row );
		worst = std::max( worst, off * off );
	}
	return worst;
}

btScalar ContactSolver::solveSingleIteration( int iteration, btCollisionObject** bodies, int bodyCount, btPersistentManifold** manifolds,
	int manifoldCount, btTypedConstraint** joints, int jointCount, const btContactSolverInfo& info, btIDebugDraw* drawer )
{
	if ( !m_isInUse )
	{
		return btSequentialImpulseConstraintSolver::solveSingleIteration(
			iteration, bodies, bodyCount, manifolds, manifoldCount, joints, jointCount, info, drawer );
	}
	if ( iteration >= info.m_numIterations )
	{
		return 0;
	}
	ContactRows& rows = *m_rows;
	btSolverBody* const all = solverBodies();
	btScalar bullets = 0;
	Lanes worst{};
	for ( const ContactRows::Run& run : rows.runs )
	{
		if ( run.kind != RowKind::Bullet )
		{
			rows.solveNormalRun( run, all, worst );
			continue;
		}
		for ( int k = run.first; k < run.last; ++k )
		{
			const btScalar off = pressBullets( k );
			bullets = std::max( bullets, off * off );
		}
	}
	for ( const ContactRows::Run& run : rows.runs )
	{
		if ( run.kind != RowKind::Bullet )
		{
			rows.solveFrictionRun( run, all, worst );
			continue;
		}
		for ( int k = run.first; k < run.last; ++k )
		{
			bullets = std::max( bullets, rubBullets( k ) );
		}
	}
	bullets = std::max( bullets, rollBullets() );
	return std::max( bullets, std::max( std::max( worst[0], worst[1] ), std::max( worst[2], worst[3] ) ) );
}

btScalar ContactSolver::solveGroupCacheFriendlyFinish( btCollisionObject** bodies, int bodyCount, const btContactSolverInfo& info )
{
	if ( m_isInUse && ( info.m_solverMode & SOLVER_USE_WARMSTARTING ) )
	{
		m_rows->writeImpulses();
	}
	if ( m_isInUse )
	{
		m_rows->writeVelocities( info.m_splitImpulse, info.m_timeStep );
	}
	m_isInUse = false;
	return btSequentialImpulseConstraintSolver::solveGroupCacheFriendlyFinish( bodies, bodyCount, info );
}

} // namespace pliant
