#pragma once

// Bullet's sequential solver, sooner done with soft bodies. To the bits it is the same: a world may have either.

#include "pliant/export.h"

#include <BulletDynamics/ConstraintSolver/btSequentialImpulseConstraintSolver.h>

#include <memory>

namespace pliant {

struct ContactRows;

/// To be given to a SoftBodyWorld instead of a btSequentialImpulseConstraintSolver. What takes Bullet's solver most of its time with soft
/// bodies is memory: a node that touches something is two rows of 160 bytes and one or two bodies of 256. Here a node is 64 bytes, rows
/// between nodes, or of a node and what stands, are solved four at a time, and what is converted next is asked for ahead. Where islands
/// have joints, in modes other than the default ones, and where Bullet was built with vectors or has been given other rows
/// (setConstraintRowSolverGeneric), it goes Bullet's way.
class PLIANT_API ContactSolver : public btSequentialImpulseConstraintSolver
{
public:
	BT_DECLARE_ALIGNED_ALLOCATOR();

	ContactSolver();
	~ContactSolver() override;
	ContactSolver( const ContactSolver& ) = delete;
	ContactSolver& operator=( const ContactSolver& ) = delete;

protected:
	void convertContacts( btPersistentManifold** manifolds, int count, const btContactSolverInfo& info ) override;
	btScalar solveGroupCacheFriendlySetup( btCollisionObject** bodies, int bodyCount, btPersistentManifold** manifolds, int manifoldCount,
		btTypedConstraint** joints, int jointCount, const btContactSolverInfo& info, btIDebugDraw* drawer ) override;
	void solveGroupCacheFriendlySplitImpulseIterations( btCollisionObject** bodies, int bodyCount, btPersistentManifold** manifolds,
		int manifoldCount, btTypedConstraint** joints, int jointCount, const btContactSolverInfo& info, btIDebugDraw* drawer ) override;
	btScalar solveSingleIteration( int iteration, btCollisionObject** bodies, int bodyCount, btPersistentManifold** manifolds,
		int manifoldCount, btTypedConstraint** joints, int jointCount, const btContactSolverInfo& info, btIDebugDraw* drawer ) override;
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
	bool m_isInUse = false; ///< are our rows, of the island at hand
	int m_jointCount = 0;
};

} // namespace pliant
