#include "surface/skin/skinning.h"
#include "surface/constants.h"
#include "surface/kernels/skin_kernels.h"
#include "surface/skin/skin_fade.h"

#include "threads/parallel.h"

#include <algorithm>
#include <cstddef>

namespace pliant {

namespace {

int chunkCount( std::size_t items )
{
	return int( ( items + kVerticesPerTask - 1 ) / kVerticesPerTask );
}

template <class Work>
void forChunks( std::size_t count, TaskRunner* runner, Work&& work )
{
	auto task = [&]( int chunk ) {
		const std::size_t first = std::size_t( chunk ) * kVerticesPerTask;
		work( first, std::min( count, first + kVerticesPerTask ) );
	};
	runTasks( runner, chunkCount( count ), task );
}

static_assert( sizeof( SkinPosition ) == sizeof( SkinBinding::Placed ) &&
	offsetof( SkinPosition, weight ) == offsetof( SkinBinding::Placed, weight ) );

SkinView viewOf( const SkinBinding& binding, const SkinPose& pose, SkinScratch& scratch, float* positions, float* normals )
{
	const auto orNull = []( const std::vector<std::uint32_t>& list ) { return list.empty() ? nullptr : list.data(); };
	const auto numbers = []( const std::vector<Vec3>& vectors ) { return vectors.empty() ? nullptr : vectors.front().data(); };
	SkinView view;
	view.start = binding.start.data();
	view.node = binding.node.data();
	view.weight = binding.weight.data();
	view.slot = pose.slotOfCell;
	view.map = pose.maps ? pose.maps : scratch.nodeMap.data();
	view.carrier = orNull( binding.carrier );
	view.listed = orNull( binding.blended );
	view.placed = reinterpret_cast<const SkinPosition*>( binding.placed.data() );
	view.restPosition = numbers( binding.restPosition );
	view.restNormal = numbers( binding.restNormal );
	view.normalShift = numbers( binding.normalShift );
	view.shifted = binding.normalShift.size();
	view.normalGroup = binding.normalGroup.data();
	view.position4 = scratch.position.data();
	view.turnedShift = scratch.turnedShift.data();
	view.groupNormal = scratch.groupNormal.data();
	view.positions = positions;
	view.normals = normals;
	return view;
}

/// Sums in the triangles' order on one thread, so that the bits do not depend on the number of threads.
void sumNormals( const SkinKernels& kernels, const SkinView& view, const SkinBinding& binding, const SkinTriangles& triangles )
{
	std::fill( view.groupNormal, view.groupNormal + 4 * std::size_t( binding.normalGroups ), 0.0f );
	if ( !binding.shading.empty() )
	{
		kernels.addAreas( view, binding.shading.front().data(), int( binding.shading.size() ) );
	}
	const int first = int( binding.shadedTriangles );
	kernels.addAreas( view, triangles.indices + 3 * std::size_t( first ), triangles.count - first );
}

/// Grows an array, but never shrinks it, since several skins share it.
void growTo( AlignedArray<float>& array, std::size_t size )
{
	if ( array.size() < size )
	{
		array.resize( size );
	}
}

} // namespace

void allSkinMaps( const NodeState& state, const SkinPose& pose, AlignedArray<float>& maps, TaskRunner* runner )
{
	maps.resize( std::size_t( state.count ) * kSkinMapFloats );
	forChunks( std::size_t( state.count ), runner,
		[&]( std::size_t first, std::size_t last ) { skinMaps( state, pose, maps.data(), int( first ), int( last ) ); } );
	if ( pose.fade )
	{
		pose.fade->ease( state, maps.data() );
	}
}

void skin( const SkinBinding& binding, const NodeState& state, const SkinPose& pose, const SkinTriangles& triangles, SkinScratch& scratch,
	float* positions, float* normals, TaskRunner* runner, const SkinKernels& kernels )
{
	if ( binding.kind == Skinning::None )
	{
		return;
	}
	const std::size_t vertices = binding.restPosition.size();
	growTo( scratch.position, vertices * 4 );
	growTo( scratch.turnedShift, binding.normalShift.size() * 4 );
	growTo( scratch.groupNormal, std::size_t( binding.normalGroups ) * 4 );
	if ( !pose.maps )
	{
		allSkinMaps( state, pose, scratch.nodeMap, runner );
	}

	const SkinView view = viewOf( binding, pose, scratch, positions, normals );
	const std::size_t following = binding.blended.empty() ? vertices : binding.blended.size(), placed = binding.placed.size();
	forChunks( following, runner, [&]( std::size_t first, std::size_t last ) { kernels.followRows( view, first, last ); } );
	if ( pose.fade )
	{
		pose.fade->addTo( positions, scratch.position.data(), pose.body );
	}
	forChunks( placed, runner, [&]( std::size_t first, std::size_t last ) { kernels.placeFromCorners( view, first, last ); } );
	if ( !binding.carrier.empty() )
	{
		forChunks( vertices, runner, [&]( std::size_t first, std::size_t last ) { kernels.carry( view, first, last ); } );
	}
	sumNormals( kernels, view, binding, triangles );
	forChunks( following, runner, [&]( std::size_t first, std::size_t last ) { kernels.writeNormals( view, first, last ); } );
	forChunks( placed, runner, [&]( std::size_t first, std::size_t last ) { kernels.shadeFromCorners( view, first, last ); } );
}

} // namespace pliant
