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

} // namespace pliant
