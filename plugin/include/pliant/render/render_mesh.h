#pragma once

// Further render meshes of one body: levels of detail, parts with materials of their own, a hull. Each is bound to the cells as the mesh
// that the template was built from is, and breaks with them.

#include "pliant/body_template.h"
#include "pliant/render/gpu_surface.h"
#include "pliant/render/vertex_source.h"
#include "pliant/soft_body.h"

#include <memory>

namespace pliant {

/// A mesh bound to the cells of a template: immutable, shared by any number of RenderSkins.
class PLIANT_API RenderMesh
{
public:
	/// Binds a mesh in the coordinates of the mesh that the template was built from. Its own one may have Skinning::None. Parts of the mesh
	/// outside of all cells follow the nearest cell. Errors: those of BodyTemplate::build for its mesh; BadArgument for a null template,
	/// and in a build without Feature::Surface; OutOfMemory.
	static Result<std::shared_ptr<const RenderMesh>> bind( std::shared_ptr<const BodyTemplate> bodyTemplate, const MeshView& mesh );
	~RenderMesh();
	RenderMesh( const RenderMesh& ) = delete;
	RenderMesh& operator=( const RenderMesh& ) = delete;

	[[nodiscard]] int vertexCount() const;   ///< as in the input
	[[nodiscard]] int triangleCount() const; ///< as in the input
	/// The template that it is bound to. Valid as long as the mesh.
	[[nodiscard]] const BodyTemplate& bodyTemplate() const;

	/// @cond INTERNAL
	struct Data;
	const Data& data() const { return *m_data; }
	/// @endcond

private:
	RenderMesh();
	std::unique_ptr<Data> m_data;
};

/// A render mesh on one body, with its last drawn state. Make one for each body and mesh, fragments too. It does not refer to the body
/// between calls. Changes of levels show at once here, where the body's own skin fades them.
class PLIANT_API RenderSkin
{
public:
	/// Errors: BadArgument for null; OutOfMemory.
	static Result<std::unique_ptr<RenderSkin>> create( std::shared_ptr<const RenderMesh> mesh );
	~RenderSkin();
	RenderSkin( const RenderSkin& ) = delete;
	RenderSkin& operator=( const RenderSkin& ) = delete;

	/// As SoftBody::surface, of this mesh: computed if the body has moved. Pointers stay valid until the call after the next. Empty for a
	/// body of another template, and for a broken body if the cracks of the mesh cannot be computed. Use one skin with the same body
	/// always: for another one everything is recomputed, and data that a renderer keeps by `topologyVersion` may be that of the first.
	SurfaceView surface( const SoftBody& body );
	/// As SoftBody::gpuSurface, of this mesh. Pointers stay valid until the next step or call. Empty as above.
	GpuSurfaceView gpuSurface( const SoftBody& body );
	/// As vertexSources, of this mesh. Pointers stay valid until the next call after the body breaks. Empty as above.
	VertexSourceView vertexSources( const SoftBody& body );

private:
	RenderSkin();
	struct Impl;
	std::unique_ptr<Impl> m_impl;
};

} // namespace pliant
