// A build without skins: bodies have no surface, as with Skinning::None.

#include "lattice/features.h"
#include "pliant/render/render_mesh.h"
#include "pliant/render/vertex_attributes.h"
#include "world/bodies/soft_body_impl.h"

#include <cmath>

namespace pliant {

SurfaceView SoftBody::surface() const
{
	return {};
}

GpuSurfaceView SoftBody::gpuSurface() const
{
	return {};
}

void SoftBody::setSurfaceTolerance( btScalar cells )
{
	m_impl->skin.tolerance = cells > 0 && std::isfinite( cells ) ? double( cells ) : 0.0; // as with skins, so that it can be read back
}

btScalar SoftBody::surfaceTolerance() const
{
	return btScalar( m_impl->skin.tolerance );
}

bool SoftBody::Impl::placeDrawn( std::vector<float>&, std::vector<float>&, SkinTriangles& ) const
{
	return false;
}

VertexSourceView vertexSources( const SoftBody& )
{
	return {};
}

TangentView restTangents( const SoftBody& )
{
	return {};
}

TangentView tangents( const SoftBody& )
{
	return {};
}

struct RenderMesh::Data
{
	std::shared_ptr<const BodyTemplate> bodyTemplate;
};

RenderMesh::RenderMesh() = default;
RenderMesh::~RenderMesh() = default;

Result<std::shared_ptr<const RenderMesh>> RenderMesh::bind( std::shared_ptr<const BodyTemplate>, const MeshView& )
{
	return { requireFeature( Feature::Surface ), nullptr };
}

int RenderMesh::vertexCount() const
{
	return 0;
}

int RenderMesh::triangleCount() const
{
	return 0;
}

const BodyTemplate& RenderMesh::bodyTemplate() const
{
	return *m_data->bodyTemplate; // of no mesh
}

struct RenderSkin::Impl
{};

RenderSkin::RenderSkin() = default;
RenderSkin::~RenderSkin() = default;

Result<std::unique_ptr<RenderSkin>> RenderSkin::create( std::shared_ptr<const RenderMesh> )
{
	return { requireFeature( Feature::Surface ), nullptr };
}

SurfaceView RenderSkin::surface( const SoftBody& )
{
	return {};
}

GpuSurfaceView RenderSkin::gpuSurface( const SoftBody& )
{
	return {};
}

VertexSourceView RenderSkin::vertexSources( const SoftBody& )
{
	return {};
}

void SoftBody::Impl::keepSurface() {}
void SoftBody::Impl::fadeFromKeptSurface() {}
void SoftBody::Impl::keepDrawn( bool ) {}

} // namespace pliant
