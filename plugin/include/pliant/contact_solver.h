#pragma once

// Bullet's sequential impulse solver, faster with soft bodies. Its results are equal to the bit.

#include "pliant/export.h"

#include <BulletDynamics/ConstraintSolver/btSequentialImpulseConstraintSolver.h>

#include <memory>

namespace pliant {

struct ContactRows;

/// Replaces btSequentialImpulseConstraintSolver as the solver of a SoftBodyWorld. With soft bodies Bullet's solver spends most of its time
/// on memory access: a touching node takes two rows of 160 bytes and one or two solver bodies of 256. Here a node takes 64 bytes, rows
/// between two nodes or between a node and an immovable object are solved four at a time, and contacts to be converted are prefetched.
/// Uses Bullet's own code for islands with joints, in solver modes other than the default, and where Bullet was built with SIMD or has been
/// given other row solvers (setConstraintRowSolverGeneric).
class PLIANT_API ContactSolver : public btSequentialImpulseConstraintSolver
{
public:
	BT_DECLARE_ALIGNED_ALLOCATOR();

	ContactSolver();
	~ContactSolver() override;
	ContactSolver( const ContactSolver& ) = delete;
	ContactSolver& operator=( const ContactSolver& ) = delete;

protected:
	/// As Bullet's, with its own rows where the island allows them; so are the following.
	void convertContacts( btPersistentManifold** manifolds, int count, const btContactSolverInfo& info ) override;
	/// As Bullet's.
	btScalar solveGroupCacheFriendlySetup( btCollisionObject** bodies, int bodyCount, btPersistentManifold** manifolds, int manifoldCount,
		btTypedConstraint** joints, int jointCount, const btContactSolverInfo& info, btIDebugDraw* drawer ) override;
	/// As Bullet's.
	void solveGroupCacheFriendlySplitImpulseIterations( btCollisionObject** bodies, int bodyCount, btPersistentManifold** manifolds,
		int manifoldCount, btTypedConstraint** joints, int jointCount, const btContactSolverInfo& info, btIDebugDraw* drawer ) override;
	/// As Bullet's.
	btScalar solveSingleIteration( int iteration, btCollisionObject** bodies, int bodyCount, btPersistentManifold** manifolds,
		int manifoldCount, btTypedConstraint** joints, int jointCount, const btContactSolverInfo& info, btIDebugDraw* drawer ) override;
	/// As Bullet's.
	btScalar solveGroupCacheFriendlyFinish( btCollisionObject** bodies, int bodyCount, const btContactSolverInfo& info ) override;

private:
	struct Conversion;

	bool isPlain( const btContactSolverInfo& info ) const;
	btSolverBody* solverBodies();
	btScalar pressBullets( int row );
	btScalar rubBullets( int row );
	btScalar rollBullets();
	btScalar pushOutOnce();

	std::unique_ptr<ContactRows> m_rows;
	bool m_isInUse = false; ///< whether m_rows solves the current island
	int m_jointCount = 0;
};

} // namespace pliant
