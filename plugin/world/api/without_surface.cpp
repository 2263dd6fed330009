// A build without skins: bodies have no surface, as with Skinning::None.

#include "world/bodies/soft_body_impl.h"

namespace pliant {

SurfaceView SoftBody::surface() const
{
	return {};
}

void SoftBody::setSurfaceTolerance( btScalar ) {}

btScalar SoftBody::surfaceTolerance() const
{
	return btScalar( m_impl->skin.tolerance );
}

void SoftBody::Impl::keepSurface() {}
void SoftBody::Impl::fadeFromKeptSurface() {}

} // namespace pliant
