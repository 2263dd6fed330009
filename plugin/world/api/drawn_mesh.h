#pragma once

// Common to the skins of a body, of its template's mesh and of further meshes.

#include "pliant/render/gpu_surface.h"
#include "world/bodies/soft_body_impl.h"

namespace pliant {

class CrackPatches;

/// Draws the cracks of a body from its own links, along the cuts that it has had.
void showOwnCracks( const SoftBody::Impl& impl, const std::shared_ptr<const CrackPatches>& patches, CrackView& view );

/// The version of the cracks that a game sees, also across a restored state: no two shapes of a body have the same.
inline unsigned shownVersion( const SoftBody::Impl& impl )
{
	return impl.fractureVersion + impl.versionShift;
}

/// A mesh as it is drawn now.
struct DrawnMesh
{
	const SkinBinding& binding;
	SkinTriangles triangles;
	std::shared_ptr<const SkinTables> whole; ///< null: the body is cracked
	bool hasOffsets = true;                  ///< those of the body's fade
	const float* texture = nullptr;
	const std::uint32_t* sources = nullptr;
};

/// Updates tables and transforms.
GpuSurfaceView gpuView( const SoftBody::Impl& impl, const DrawnMesh& mesh, GpuSkin& gpu );

} // namespace pliant
