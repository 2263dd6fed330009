// The skin, made when it is asked for, in one of two buffers. Steinemann et al. 2008, section 7.

#include "body/levels.h"
#include "surface/skinning.h"
#include "world/constants.h"
#include "world/soft_body_impl.h"
#include "world/soft_body_system.h"
#include "world/stopwatch.h"

namespace pliant {

void SoftBody::Impl::makeSkin( float* positions, float* normals ) const
{
	skin.rotations.resize( std::size_t( body->nodeCount() ) * 4 );
	body->nodeRotations( skin.rotations.data() );
	SkinPose pose{ skin.rotations.data(), nullptr, nullptr };
	if ( const Levels* levels = body->levels() )
	{
		skin.gradients.resize( std::size_t( body->nodes().padded ) * 9 );
		body->nodeDeformations( skin.gradients.data() );
		pose.gradients = skin.gradients.data();
		pose.slotOfCell = levels->cut().slotOfCell.data();
	}
	const SkinTriangles triangles{ bodyTemplate->indices(), bodyTemplate->triangleCount() };
	pliant::skin( bodyTemplate->skin(), body->nodes(), pose, triangles, skin.scratch, positions, normals );
	if ( !skin.offset.empty() )
	{
		// What a change of levels moved the surface by goes away smoothly: 1 - 3 t^2 + 2 t^3.
		const float t = std::min( skin.sinceChange / kLevelFade, 1.0f );
		const float left = 1.0f - t * t * ( 3.0f - 2.0f * t );
		for ( std::size_t k = 0; k < skin.offset.size(); ++k )
		{
			positions[k] += left * skin.offset[k];
		}
		if ( t >= 1.0f )
		{
			skin.offset.clear();
		}
	}
}

void SoftBody::Impl::keepSurface()
{
	if ( skin.frame == 0 )
	{
		return; // nobody has ever looked
	}
	skin.before.resize( bodyTemplate->skin().restPosition.size() * 3 );
	skin.normalsBefore.resize( skin.before.size() );
	makeSkin( skin.before.data(), skin.normalsBefore.data() );
}

void SoftBody::Impl::fadeFromKeptSurface()
{
	if ( skin.frame == 0 )
	{
		return;
	}
	std::vector<float> now( skin.before.size() );
	skin.offset.clear();
	makeSkin( now.data(), skin.normalsBefore.data() );
	skin.offset.resize( now.size() );
	for ( std::size_t k = 0; k < now.size(); ++k )
	{
		skin.offset[k] = skin.before[k] - now[k];
	}
	skin.sinceChange = 0.0f;
	skin.isStale = true;
}

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
		impl.makeSkin( skinBuffers.positions[next].data(), skinBuffers.normals[next].data() );
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
