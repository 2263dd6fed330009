// A build without skins: bodies have no surface, as with Skinning::None.

#include "world/bodies/soft_body_impl.h"

namespace pliant {

SurfaceView SoftBody::surface() const
{
	return {};
}

void SoftBody::setSurfaceTolerance( btScalar cells )
{
	m_impl->skin.tolerance = cells > 0 ? double( cells ) : 0.0; // as with skins, so that it can be read back
}

btScalar SoftBody::surfaceTolerance() const
{
	return btScalar( m_impl->skin.tolerance );
}

bool SoftBody::Impl::placeDrawn( std::vector<float>&, std::vector<float>&, SkinTriangles& ) const
{
	return false;
}

void SoftBody::Impl::keepSurface() {}
void SoftBody::Impl::fadeFromKeptSurface() {}

} // namespace pliant
