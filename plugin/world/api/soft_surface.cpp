// The skin, computed on request into alternating buffers. Steinemann et al. 2008, section 7.

#include "body/levels/levels.h"
#include "lattice/guarded_tasks.h"
#include "surface/skin/skinning.h"
#include "world/bodies/soft_body_impl.h"
#include "world/constants.h"
#include "world/step/soft_body_system.h"
#include "world/stopwatch.h"

#include <algorithm>
#include <cmath>

namespace pliant {

namespace {

/// Whether classifying all nodes takes longer than skinning the vertices again: a node takes some 40 ns, a vertex 30.
bool isSparselyDrawn( int nodes, std::size_t vertices )
{
	return nodes >= kManySkinnedNodes && vertices < std::size_t( kFewVerticesPerNode ) * std::size_t( nodes );
}

/// Updates the pose except for the gradients: rotations and plastic flow.
void measureRotations( const Body& body, SkinBuffers& skin )
{
	if ( skin.areRotationsKnown )
	{
		return;
	}
	skin.areRotationsKnown = true;
	skin.rotations.resize( std::size_t( body.nodeCount() ) * 4 );
	body.nodeRotations( skin.rotations.data() );
	if ( body.hasFlowed() )
	{
		skin.flow.resize( std::size_t( body.nodeCount() ) * 9 );
		body.nodeFlow( skin.flow.data() );
	}
}

/// Reserves memory for as many nodes as the body has capacity for.
void makeSkinScratch( const Body& body, SkinBuffers& skin )
{
	const std::size_t reserved = std::size_t( body.levels()->scratchNodes() + kLanes ),
					  now = std::size_t( kScratchFraction * body.nodes().padded );
	reserveScratch( skin.gradients, 9 * reserved, 9 * now );
	reserveScratch( skin.gradientsScratch, 9 * reserved, 9 * now );
	reserveScratch( skin.rotations, 4 * reserved, 4 * now );
	reserveScratch( skin.maps, kSkinMapFloats * reserved, kSkinMapFloats * now );
	skin.fade.reserveNodes( int( reserved ), now, body.lattice().cellCount() );
}

/// Updates the gradients after a change of levels at unchanged positions: unchanged regions keep theirs, the others are measured.
void followGradients( const Body& body, SkinBuffers& skin )
{
	const LevelChange& change = body.levels()->lastChange();
	skin.gradientsScratch.resize( std::size_t( body.nodes().padded ) * 9 );
	for ( std::size_t i = 0; i < change.source.size(); ++i )
	{
		std::copy_n( skin.gradients.data() + 9 * std::size_t( change.source[i] ), 9, skin.gradientsScratch.data() + 9 * i );
	}
	skin.gradients.swap( skin.gradientsScratch );
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
		measureRotations( *body, skin );
		if ( levels )
		{
			const std::size_t count = std::size_t( body->nodes().padded ) * 9;
			if ( skin.gradients.capacity() == 0 )
			{
				makeSkinScratch( *body, skin );
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
	if ( skin.isRead() )
	{
		skin.fade.keep( body->nodes(), skinPose(), body->lattice().cellCount(), skin.isMapKnown ? &skin.maps : nullptr );
	}
}

// If the body has cracked since its skin was last read there is no matching surface to fade from: the skin then changes at once.
void SoftBody::Impl::fadeFromKeptSurface()
{
	const LevelChange& change = body->levels()->lastChange();
	if ( skin.isRead() && hasNewCracks() )
	{
		skin.fade.clear();
	}
	else if ( skin.isRead() )
	{
		skin.nodesChanged();
		measureRotations( *body, skin );
		followGradients( *body, skin );
		skin.isPoseKnown = true;
		const SkinBinding& shown = binding();
		SkinFade::Nodes nodes{ body->nodes(), skinPose(), change.source, change.keptAs, body->levelFrame(), &change.measured };
		nodes.complex = shown.point.empty() ? nullptr : bodyTemplate->crackComplex().get();
		nodes.cellsInComplex = &body->firstCells();
		skin.fade.start( shown, nodes );
		if ( skin.blend )
		{
			skin.blend->kept.followLevels( change.source, skin.fade.mapsBefore(), skin.fade.mapsNow() );
		}
		return;
	}
	skin.nodesChanged();
	skin.blend ? skin.blend->kept.renumber( change.source ) : void();
}

const CrackView* SoftBody::Impl::shownCracks() const
{
	return crackView && crackVersion == fractureVersion ? crackView.get() : nullptr;
}

SkinTriangles SoftBody::Impl::shownTriangles() const
{
	const CrackView* const cracks = shownCracks();
	return cracks ? cracks->shown() : SkinTriangles{ bodyTemplate->indices(), bodyTemplate->triangleCount() };
}

void SoftBody::Impl::drawSkin( TaskRunner* runner ) const
{
	const double fraction = drawnFraction();
	if ( fraction != 1.0 || !rotateSkin( runner ) )
	{
		skinInFull( runner );
	}
	skin.fraction = fraction;
	skin.isStale = false;
}

bool SoftBody::Impl::rotateSkin( TaskRunner* runner ) const
{
	if ( !skin.rigid.isKept() || skin.fade.isActive() )
	{
		return false;
	}
	measureRotations( *body, skin );
	const double cell = double( bodyTemplate->cellSize() );
	const float* const flow = body->hasFlowed() ? skin.flow.data() : nullptr;
	const RigidSkin::Change change = skin.rigid.classify( body->nodes(), skin.rotations.data(), flow, skin.tolerance * cell, cell );
	if ( change == RigidSkin::Change::Moved )
	{
		const int next = skin.current == skin.full ? ( skin.full + 1 ) % SkinBuffers::kCount
												   : SkinBuffers::kCount - skin.full - skin.current;
		skin.rigid.turn( skin.positions[skin.full], skin.normals[skin.full], skin.positions[next], skin.normals[next], runner );
		skin.origin[next] = skin.origin[skin.full];
		skin.current = next;
		++skin.frame;
	}
	return change != RigidSkin::Change::Bent;
}

void SoftBody::Impl::skinInFull( TaskRunner* runner ) const
{
	const SkinBinding& shown = binding();
	const int next = skin.current == 0 ? 1 : 0;
	SkinPose pose = skinPose();
	if ( pose.fade )
	{
		pose.body = body->levelFrame();
	}
	skin.positions[next].resize( shown.restPosition.size() * 3 );
	skin.normals[next].resize( shown.restPosition.size() * 3 );
	pose.maps = drawnMaps( runner ).data();
	const SkinScratchPool::Borrowed scratch( system ? &system->skinScratch : nullptr );
	pliant::skin( shown, body->nodes(), pose, shownTriangles(), *scratch, skin.positions[next].data(), skin.normals[next].data(), runner );
	skin.origin[next] = worldOrigin();
	skin.current = skin.full = next;
	++skin.frame;
	skin.rigid.forget();
	if ( skin.tolerance > 0.0 && !pose.fade && drawnFraction() == 1.0 && !isSparselyDrawn( body->nodeCount(), shown.restPosition.size() ) )
	{
		skin.rigid.keep( body->nodes(), pose.rotations, pose.flow, pose.gradients != nullptr );
	}
}

// Not a copy of the shown skin, which may be that of an earlier step (setSurfaceTolerance) or lie between two steps (setInterpolation): the
// result of a query must not depend on the drawing.
bool SoftBody::Impl::placeDrawn( std::vector<float>& positions, std::vector<float>& normals, SkinTriangles& triangles ) const
{
	const SkinBinding& shown = binding();
	triangles = shownTriangles();
	if ( shown.kind == Skinning::None || triangles.count == 0 )
	{
		return false;
	}
	SkinPose pose = skinPose();
	if ( pose.fade )
	{
		pose.body = body->levelFrame();
	}
	positions.resize( shown.restPosition.size() * 3 );
	normals.resize( shown.restPosition.size() * 3 );
	const SkinScratchPool::Borrowed scratch( system ? &system->skinScratch : nullptr );
	pliant::skin( shown, body->nodes(), pose, triangles, *scratch, positions.data(), normals.data() );
	return true;
}

void SoftBody::setSurfaceTolerance( btScalar cells )
{
	m_impl->skin.tolerance = cells > 0 && std::isfinite( cells ) ? double( cells ) : 0.0;
}

btScalar SoftBody::surfaceTolerance() const
{
	return btScalar( m_impl->skin.tolerance );
}

const SkinBinding& SoftBody::Impl::currentBinding() const
{
	double discarded = 0.0; // time of a body that is in no world
	if ( hasNewCracks() )
	{
		Stopwatch watch( system ? system->report.fracture : discarded );
		drawFamilyCracks();
		return binding();
	}
	return binding();
}

SurfaceView SoftBody::surface() const
{
	SurfaceView view;
	const Impl& impl = *m_impl;
	double discarded = 0.0; // as above
	const SkinBinding& binding = impl.currentBinding();
	if ( binding.kind == Skinning::None || impl.isInField() )
	{
		return view;
	}
	const CrackView* const cracks = impl.shownCracks();
	const SkinTriangles triangles = impl.shownTriangles();
	const SkinBuffers& skinBuffers = impl.skin;
	if ( impl.system )
	{
		impl.system->noteSkinRequest( *this );
	}
	if ( impl.isSkinStale() )
	{
		Stopwatch watch( impl.system ? impl.system->report.skinning : discarded );
		impl.drawSkin( impl.system ? impl.system->tasks() : nullptr );
	}
	view.origin = skinBuffers.origin[skinBuffers.current];
	view.positions = skinBuffers.positions[skinBuffers.current].data();
	view.normals = skinBuffers.normals[skinBuffers.current].data();
	view.indices = triangles.indices;
	view.vertexCount = int( binding.restPosition.size() );
	view.triangleCount = triangles.count;
	view.topologyVersion = impl.fractureVersion + impl.versionShift;
	view.textureCoordinates = cracks ? cracks->texture.data() : impl.bodyTemplate->textureCoordinates();
	view.triangleSource = cracks ? cracks->sources.data() : nullptr;
	view.frame = skinBuffers.frame;
	return view;
}

// Skins read after the last step will likely be read after this one too: with several threads, the first request of a step computes them
// all. A skin that is no longer read is computed once more than needed.
void SoftBodySystem::noteSkinRequest( const SoftBody& requested )
{
	SkinBuffers& own = requested.impl().skin;
	const unsigned before = m_requestedIn;
	own.requestedIn = m_requestedIn = m_steps;
	if ( before == m_steps || tasks()->threadCount() < 2 )
	{
		return;
	}
	m_stale.clear();
	long long vertices = 0;
	for ( SoftBody* body : m_bodies )
	{
		const SoftBody::Impl& impl = body->impl();
		// New cracks are not drawn in advance: that takes memory, and its time is counted as fracture.
		const bool isWanted = body == &requested || ( before > 0 && impl.skin.requestedIn == before );
		if ( isWanted && impl.isSkinStale() && !impl.hasNewCracks() && impl.binding().kind != Skinning::None )
		{
			m_stale.push_back( body );
			vertices += (long long)( impl.binding().restPosition.size() );
		}
	}
	Stopwatch watch( report.skinning );
	drawSkins( vertices );
}

// As in forAwake: bodies above the mean per thread are processed one after another by all threads together.
void SoftBodySystem::drawSkins( long long vertices )
{
	const auto exceedsMean = [&]( const SoftBody* body ) {
		return (long long)( body->impl().binding().restPosition.size() ) * tasks()->threadCount() > vertices;
	};
	const auto whole = std::partition( m_stale.begin(), m_stale.end(), exceedsMean );
	std::for_each( m_stale.begin(), whole, [this]( const SoftBody* body ) { body->impl().drawSkin( tasks() ); } );
	auto alone = [&whole]( int k ) { whole[k]->impl().drawSkin( nullptr ); };
	runGuarded( tasks(), int( m_stale.end() - whole ), alone );
}

} // namespace pliant
