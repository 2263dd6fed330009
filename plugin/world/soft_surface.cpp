// The skin, made when it is asked for, in one of two buffers. Steinemann et al. 2008, section 7.

#include "body/levels.h"
#include "surface/skinning.h"
#include "world/soft_body_impl.h"
#include "world/soft_body_system.h"
#include "world/stopwatch.h"

#include <algorithm>

namespace pliant {

namespace {

/// What of the pose is cheap, or a node's own: everything but the gradients.
void measureTurns( const Body& body, SkinBuffers& skin )
{
	skin.rotations.resize( std::size_t( body.nodeCount() ) * 4 );
	body.nodeRotations( skin.rotations.data() );
	if ( body.hasFlowed() )
	{
		skin.flow.resize( std::size_t( body.nodeCount() ) * 9 );
		body.nodeFlow( skin.flow.data() );
	}
}

/// For as many nodes as the body has room for.
void makeSkinRoom( const Body& body, SkinBuffers& skin )
{
	const std::size_t reserved = std::size_t( body.levels()->roomNodes() + kLanes ), now = std::size_t( kRoomShare * body.nodes().padded );
	makeRoom( skin.gradients, 9 * reserved, 9 * now );
	makeRoom( skin.gradientsRoom, 9 * reserved, 9 * now );
	makeRoom( skin.rotations, 4 * reserved, 4 * now );
	makeRoom( skin.scratch.nodeMap, kSkinMapFloats * reserved, kSkinMapFloats * now );
	skin.fade.reserveNodes( int( reserved ), now, body.lattice().cellCount() );
}

/// After a change of levels, with nothing moved: a region that holds what it held is stretched as it was.
void followGradients( const Body& body, SkinBuffers& skin )
{
	const LevelChange& change = body.levels()->lastChange();
	skin.gradientsRoom.resize( std::size_t( body.nodes().padded ) * 9 );
	for ( std::size_t i = 0; i < change.heir.size(); ++i )
	{
		std::copy_n( skin.gradients.data() + 9 * std::size_t( change.heir[i] ), 9, skin.gradientsRoom.data() + 9 * i );
	}
	skin.gradients.swap( skin.gradientsRoom );
	std::vector<float> measured( change.measured.size() * 9 );
	body.nodeDeformationsOf( change.measured, measured.data() );
	for ( std::size_t k = 0; k < change.measured.size(); ++k )
	{
		std::copy_n( measured.data() + 9 * k, 9, skin.gradients.data() + 9 * std::size_t( change.measured[k] ) );
	}
}

} // namespace

SkinPose SoftBody::Impl::skinPose() const
{
	const Levels* const levels = body->levels();
	if ( !skin.isPoseKnown )
	{
		measureTurns( *body, skin );
		if ( levels )
		{
			const std::size_t count = std::size_t( body->nodes().padded ) * 9;
			if ( skin.gradients.capacity() == 0 )
			{
				makeSkinRoom( *body, skin );
			}
			skin.gradients.resize( count );
			body->nodeDeformations( skin.gradients.data() );
		}
		skin.isPoseKnown = true;
	}
	SkinPose pose;
	pose.rotations = skin.rotations.data();
	pose.flow = body->hasFlowed() ? skin.flow.data() : nullptr;
	if ( levels )
	{
		pose.gradients = skin.gradients.data();
		pose.slotOfCell = levels->cut().slotOfCell.data();
	}
	pose.fade = skin.fade.isActive() ? &skin.fade : nullptr;
	return pose;
}

void SoftBody::Impl::keepSurface()
{
	if ( skin.frame > 0 ) // else nobody has ever looked
	{
		skin.fade.keep( body->nodes(), skinPose(), body->lattice().cellCount(), skin.isStale ? nullptr : &skin.scratch.nodeMap );
	}
}

// Where it has cracked since anybody looked there is no surface to go on from: the new one is drawn when it is asked for, and jumps with its cracks.
void SoftBody::Impl::fadeFromKeptSurface()
{
	if ( skin.frame > 0 && hasNewCracks() )
	{
		skin.fade.clear();
	}
	else if ( skin.frame > 0 )
	{
		const LevelChange& change = body->levels()->lastChange();
		measureTurns( *body, skin );
		followGradients( *body, skin );
		skin.isPoseKnown = true;
		skin.fade.start( binding(), SkinFade::Nodes{ body->nodes(), skinPose(), change.heir, change.keptAs, body->levelFrame(), &change.measured } );
		skin.isStale = true;
		return;
	}
	skin.nodesMoved();
}

namespace {

void showCracks( const CrackView& cracks, unsigned since, SurfaceView& view )
{
	view.textureCoordinates = cracks.texture;
	view.triangleSource = cracks.sources;
	view.changedSince = since;
	view.firstNewVertex = int( cracks.change.firstNewVertex );
	view.firstNewTriangle = int( cracks.change.firstNewTriangle );
	view.firstChangedTriangle = int( cracks.change.firstChanged );
	view.lastChangedTriangle = int( cracks.change.lastChanged );
}

} // namespace

SurfaceView SoftBody::surface() const
{
	SurfaceView view;
	const Impl& impl = *m_impl;
	double unheard = 0.0; // a body in no world has nobody to tell
	const auto drawnCracks = [&]() -> const SkinBinding& {
		Stopwatch watch( impl.system ? impl.system->report.fracture : unheard );
		impl.drawKin();
		return impl.binding();
	};
	const SkinBinding& binding = impl.hasNewCracks() ? drawnCracks() : impl.binding();
	if ( binding.kind == Skinning::None )
	{
		return view;
	}
	SkinTriangles triangles{ impl.bodyTemplate->indices(), impl.bodyTemplate->triangleCount() };
	const CrackView* const cracks = impl.crackView && impl.crackVersion == impl.fractureVersion ? impl.crackView.get() : nullptr;
	if ( cracks )
	{
		triangles.count = cracks->triangleCount;
		triangles.indices = triangles.count > 0 ? cracks->triangles->data() : nullptr;
	}
	SkinBuffers& skinBuffers = impl.skin;
	if ( skinBuffers.isStale )
	{
		double untold = 0.0; // a body in no world has nobody to tell
		Stopwatch watch( impl.system ? impl.system->report.skinning : untold );
		const int next = 1 - skinBuffers.current;
		SkinPose pose = impl.skinPose();
		if ( pose.fade )
		{
			pose.body = impl.body->levelFrame();
		}
		skinBuffers.positions[next].resize( binding.restPosition.size() * 3 );
		skinBuffers.normals[next].resize( binding.restPosition.size() * 3 );
		skin( binding, impl.body->nodes(), pose, triangles, skinBuffers.scratch, skinBuffers.positions[next].data(),
			skinBuffers.normals[next].data(), impl.system ? impl.system->tasks() : nullptr );
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
	view.changedSince = view.topologyVersion;
	if ( cracks )
	{
		showCracks( *cracks, impl.crackVersionBefore, view );
	}
	view.frame = skinBuffers.frame;
	return view;
}

} // namespace pliant
