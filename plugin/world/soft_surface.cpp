// The skin, made when it is asked for, in one of two buffers. Steinemann et al. 2008, section 7.

#include "body/levels.h"
#include "surface/skinning.h"
#include "world/soft_body_impl.h"
#include "world/soft_body_system.h"
#include "world/stopwatch.h"

namespace pliant {

SkinPose SoftBody::Impl::skinPose() const
{
	SkinPose pose;
	skin.rotations.resize( std::size_t( body->nodeCount() ) * 4 );
	body->nodeRotations( skin.rotations.data() );
	pose.rotations = skin.rotations.data();
	if ( body->hasFlowed() )
	{
		skin.flow.resize( std::size_t( body->nodeCount() ) * 9 );
		body->nodeFlow( skin.flow.data() );
		pose.flow = skin.flow.data();
	}
	if ( const Levels* levels = body->levels() )
	{
		skin.gradients.resize( std::size_t( body->nodes().padded ) * 9 );
		body->nodeDeformations( skin.gradients.data() );
		pose.gradients = skin.gradients.data();
		pose.slotOfCell = levels->cut().slotOfCell.data();
	}
	if ( skin.fade.isActive() )
	{
		pose.fade = &skin.fade;
		pose.body = body->bestFit().rotation.cast<float>();
	}
	return pose;
}

void SoftBody::Impl::keepSurface()
{
	if ( skin.frame > 0 ) // else nobody has ever looked
	{
		skin.fade.keep( body->nodes(), skinPose(), body->lattice().cellCount() );
	}
}

void SoftBody::Impl::fadeFromKeptSurface()
{
	if ( skin.frame > 0 )
	{
		const LevelChange& change = body->levels()->lastChange();
		skin.fade.start( binding(), SkinFade::Nodes{ body->nodes(), skinPose(), change.heir, change.keptAs, body->bestFit().rotation.cast<float>() } );
		skin.isStale = true;
	}
}

const SkinBinding& SoftBody::Impl::binding() const
{
	if ( cracks )
	{
		return cracks->binding();
	}
	const std::shared_ptr<const CellComplex> complex = body->firstCells().empty() ? nullptr : bodyTemplate->crackComplex();
	if ( !complex )
	{
		return bodyTemplate->skin();
	}
	const Vec3 shift = ( body->lattice().massCentre - bodyTemplate->lattice().massCentre ).cast<float>();
	cracks = std::make_unique<CrackSurface>( complex, body->firstCells(), body->lattice(), shift );
	crackTexture.resize( 2 * std::size_t( cracks->vertexCount() ) );
	cracks->textureCoordinates( bodyTemplate->textureCoordinates(), complex->settings.textureTile, 0, crackTexture.data() );
	return cracks->binding();
}

SurfaceView SoftBody::surface() const
{
	SurfaceView view;
	const Impl& impl = *m_impl;
	const SkinBinding& binding = impl.binding();
	if ( binding.kind == Skinning::None )
	{
		return view;
	}
	SkinTriangles triangles{ impl.bodyTemplate->indices(), impl.bodyTemplate->triangleCount() };
	if ( impl.cracks )
	{
		triangles.count = int( impl.cracks->triangles().size() );
		triangles.indices = triangles.count > 0 ? impl.cracks->triangles()[0].data() : nullptr;
	}
	SkinBuffers& skinBuffers = impl.skin;
	if ( skinBuffers.isStale )
	{
		double untold = 0.0; // a body in no world has nobody to tell
		Stopwatch watch( impl.system ? impl.system->report.skinning : untold );
		const int next = 1 - skinBuffers.current;
		skinBuffers.positions[next].resize( binding.restPosition.size() * 3 );
		skinBuffers.normals[next].resize( binding.restPosition.size() * 3 );
		skin( binding, impl.body->nodes(), impl.skinPose(), triangles, skinBuffers.scratch, skinBuffers.positions[next].data(),
			skinBuffers.normals[next].data() );
		skinBuffers.origin[next] = impl.worldOrigin();
		skinBuffers.current = next;
		++skinBuffers.frame;
		skinBuffers.isStale = false;
	}
	view.origin = skinBuffers.origin[skinBuffers.current];
	view.positions = skinBuffers.positions[skinBuffers.current].data();
	view.normals = skinBuffers.normals[skinBuffers.current].data();
	view.indices = triangles.indices;
	view.vertexCount = int( binding.restPosition.size() );
	view.triangleCount = triangles.count;
	view.topologyVersion = impl.fractureVersion;
	view.textureCoordinates = impl.bodyTemplate->textureCoordinates();
	if ( impl.cracks )
	{
		view.textureCoordinates = impl.crackTexture.data();
		view.triangleSource = impl.cracks->sources().data();
	}
	view.frame = skinBuffers.frame;
	return view;
}

} // namespace pliant
