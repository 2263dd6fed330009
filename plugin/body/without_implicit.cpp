// For builds without the implicit step: Elasticity::Implicit is rejected (material.cpp), and Automatic steps explicitly.

#include "body/body.h"

#include "body/implicit_motion.h"
#include "lattice/features.h"

namespace pliant {

bool Body::canStepImplicitly() const
{
	return false;
}

Status Body::implicitStatus() const
{
	return requireFeature( Feature::Implicit );
}

void Body::pushImplicitly( float, float, const Vec3&, TaskRunner* ) {}
void Body::respond( const float*, float*, TaskRunner* ) {}

// Never called: no body has an implicit motion.
Matrix6 ImplicitMotion::rigidMass( int ) const
{
	return Matrix6::Identity();
}

void ImplicitMotion::addMotion( const Vector6&, int ) {}

} // namespace pliant
