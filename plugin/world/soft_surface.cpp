// The skin, made when it is asked for, in one of two buffers. Steinemann et al. 2008, section 7.

#include "surface/skinning.h"
#include "world/soft_body_impl.h"
#include "world/soft_body_system.h"
#include "world/stopwatch.h"

namespace pliant {

SurfaceView SoftBody::surface() const
{
	SurfaceView view;
	const Impl& impl = *m_impl;
	const SkinBinding& binding = impl.bodyTemplate->skin();
	if ( binding.kind == Skinning::None )
	{
		return view;
	}
	SkinBuffers& skinBuffers = impl.skin;
	if ( skinBuffers.isStale )
	{
		double untold = 0.0; // a body in no world has nobody to tell
		Stopwatch watch( impl.system ? impl.system->report.skinning : untold );
		const int next = 1 - skinBuffers.current;
		skinBuffers.positions[next].resize( binding.restPosition.size() * 3 );
		skinBuffers.normals[next].resize( binding.restPosition.size() * 3 );
		skinBuffers.rotations.resize( std::size_t( impl.body->nodeCount() ) * 4 );
		impl.body->nodeRotations( skinBuffers.rotations.data() );
		const SkinTriangles triangles{ impl.bodyTemplate->indices(), impl.bodyTemplate->triangleCount() };
		skin( binding, impl.body->nodes(), skinBuffers.rotations.data(), triangles, skinBuffers.scratch, skinBuffers.positions[next].data(),
			skinBuffers.normals[next].data() );
		skinBuffers.origin[next] = impl.worldOrigin();
		skinBuffers.current = next;
		++skinBuffers.frame;
		skinBuffers.isStale = false;
	}
	view.origin = skinBuffers.origin[skinBuffers.current];
	view.positions = skinBuffers.positions[skinBuffers.current].data();
	view.normals = skinBuffers.normals[skinBuffers.current].data();
	view.indices = impl.bodyTemplate->indices();
	view.vertexCount = impl.bodyTemplate->vertexCount();
	view.triangleCount = impl.bodyTemplate->triangleCount();
	view.frame = skinBuffers.frame;
	return view;
}

} // namespace pliant
