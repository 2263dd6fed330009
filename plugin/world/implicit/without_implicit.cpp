// Stubs for builds without the implicit step: Elasticity::Implicit is refused (material.cpp), and Automatic steps explicitly.

#include "world/implicit/implicit_choice.h"
#include "world/implicit/implicit_solve.h"

namespace pliant {

void ImplicitChoice::choose( const std::vector<SoftBody*>&, btDiscreteDynamicsWorld&, btScalar, int ) {}

void ImplicitSolve::before(
	const std::vector<SoftBody*>&, Attachments&, const JointGroup::Joints&, btDispatcher&, const btContactSolverInfo&, TaskRunner* )
{}
void ImplicitSolve::after() {}
void ImplicitSolve::forget( const btCollisionObject& ) {}

bool ImplicitReach::takesPart( int, const btCollisionObject& ) const
{
	return false;
}

bool resolvesVibrations( const SoftBody&, double )
{
	return false;
}

int ImplicitSolve::blockOf( const SoftBody& ) const
{
	return -1;
}

int ImplicitSolve::blockOfIsland( int ) const
{
	return -1;
}

int ImplicitSolve::softPart( const SoftBody& ) const
{
	return -1;
}

int ImplicitSolve::rigidPart( int, btCollisionObject& )
{
	return -1;
}

} // namespace pliant
