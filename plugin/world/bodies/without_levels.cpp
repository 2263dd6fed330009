// Stubs for builds without levels of detail: every node is a finest cell.

#include "world/bodies/soft_body_impl.h"
#include "world/step/soft_body_system.h"

namespace pliant {

void SoftBodySystem::adaptLevels( btScalar ) {}

void SoftBodySystem::endCollision( btScalar ) {}

void SoftBody::Impl::changeNodes( SoftBody&, const std::function<void()>&, bool ) {}

int SoftBody::nodeLevel( int ) const
{
	return 0;
}

Adaptivity SoftBody::adaptivity() const
{
	return {};
}

unsigned SoftBody::levelVersion() const
{
	return 0;
}

void SoftBody::requestRefinement( const btVector3&, const btVector3& ) {}
void SoftBody::setFinestLevel( int ) {}

int SoftBody::finestLevel() const
{
	return 0;
}

} // namespace pliant
