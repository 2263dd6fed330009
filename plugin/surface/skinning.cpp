#include "surface/four_floats.h"
#include "surface/skin_fade.h"
#include "surface/skinning.h"

#include "threads/parallel.h"

#include <algorithm>
#include <cmath>

namespace pliant {

namespace {

/// Vertices or nodes of one task.
constexpr int kChunk = 2048;

int chunkCount( std::size_t items )
{
	return int( ( items + kChunk - 1 ) / kChunk );
}

/// The blend of the maps a vertex follows.
struct Blend
{
	F4 x{}, y{}, z{};

	/// `slot`: the node that holds a cell; null where cells are nodes.
	Blend( const SkinBinding& binding, const float* maps, const std::uint32_t* slot, std::size_t vertex )
	{
		const std::uint32_t carrier = binding.carrierOf( vertex );
		for ( std::uint32_t k = binding.start[carrier]; k < binding.start[carrier + 1]; ++k )
		{
			const std::uint32_t node = slot ? slot[binding.node[k]] : binding.node[k];
			const float* map = maps + std::size_t( node ) * kSkinMapFloats;
			const float weight = binding.weight[k];
			x += weight * load4( map );
			y += weight * load4( map + 4 );
			z += weight * load4( map + 8 );
		}
	}

	/// The three rows' products with a column, and zero. The column's last entry is 1 for points, 0 for directions.
	F4 apply( F4 column ) const
	{
		const F4 a = x * column, b = y * column, c = z * column, d{};
		const F4 ab = __builtin_shufflevector( a, b, 0, 4, 1, 5 ) + __builtin_shufflevector( a, b, 2, 6, 3, 7 );
		const F4 cd = __builtin_shufflevector( c, d, 0, 4, 1, 5 ) + __builtin_shufflevector( c, d, 2, 6, 3, 7 );
		return __builtin_shufflevector( ab, cd, 0, 1, 4, 5 ) + __builtin_shufflevector( ab, cd, 2, 3, 6, 7 );
	}
};

void write3( float* to, F4 a )
{
	to[0] = a[0];
	to[1] = a[1];
	to[2] = a[2];
}

bool isShifted( const SkinBinding& binding, std::size_t vertex )
{
	return vertex < binding.normalShift.size() && !binding.normalShift[vertex].isZero( 0.0f );
}

/// x = sum w ( x_n + R_n ( X - x0_n ) )   (Steinemann et al. 2008, section 7): the maps are blended first, then applied once.
void writePositions( const SkinBinding& binding, const std::uint32_t* slot, SkinScratch& scratch, float* positions, std::size_t first, std::size_t last )
{
	for ( std::size_t v = first; v < last; ++v )
	{
		const bool isCarried = binding.carrierOf( v ) != v;
		if ( isCarried && !isShifted( binding, v ) )
		{
			if ( v < binding.normalShift.size() )
			{
				store4( scratch.turnedShift.data() + 4 * v, F4{} );
			}
			continue;
		}
		const Vec3& at = binding.restPosition[v];
		const Blend blend( binding, scratch.nodeMap.data(), slot, v );
		if ( !isCarried )
		{
			const F4 x = blend.apply( F4{ at.x(), at.y(), at.z(), 1.0f } );
			store4( scratch.position.data() + 4 * v, x );
			write3( positions + 3 * v, x );
		}
		if ( isShifted( binding, v ) )
		{
			const Vec3& shift = binding.normalShift[v];
			store4( scratch.turnedShift.data() + 4 * v, blend.apply( F4{ shift.x(), shift.y(), shift.z(), 0.0f } ) );
		}
		else if ( v < binding.normalShift.size() )
		{
			store4( scratch.turnedShift.data() + 4 * v, F4{} );
		}
	}
}

/// Once all others have their places.
void writeCarried( const SkinBinding& binding, SkinScratch& scratch, float* positions, std::size_t first, std::size_t last )
{
	for ( std::size_t v = first; v < last; ++v )
	{
		if ( const std::uint32_t carrier = binding.carrierOf( v ); carrier != v )
		{
			const F4 x = load4( scratch.position.data() + 4 * std::size_t( carrier ) );
			store4( scratch.position.data() + 4 * v, x );
			write3( positions + 3 * v, x );
		}
	}
}

F4 cross( F4 a, F4 b )
{
	const F4 c = a * __builtin_shufflevector( b, b, 1, 2, 0, 3 ) - __builtin_shufflevector( a, a, 1, 2, 0, 3 ) * b;
	return __builtin_shufflevector( c, c, 1, 2, 0, 3 );
}

/// Each triangle's normal times twice its area goes to its three corners' groups. In the triangles' order, in one thread: the sums'
/// bits do not depend on the threads.
void sumNormals( const SkinBinding& binding, const SkinTriangles& triangles, const float* positions, float* sums )
{
	const std::uint32_t* group = binding.normalGroup.data();
	std::fill( sums, sums + 4 * std::size_t( binding.normalGroups ), 0.0f );
	for ( int t = 0; t < triangles.count; ++t )
	{
		const std::uint32_t* corner = triangles.indices + 3 * std::size_t( t );
		const F4 a = load4( positions + 4 * std::size_t( corner[0] ) );
		const F4 area = cross( load4( positions + 4 * std::size_t( corner[1] ) ) - a, load4( positions + 4 * std::size_t( corner[2] ) ) - a );
		for ( int k = 0; k < 3; ++k )
		{
			float* sum = sums + 4 * std::size_t( group[corner[k]] );
			store4( sum, load4( sum ) + area );
		}
	}
}

/// A direction that turns along with the vertex's nodes.
F4 turned( const SkinBinding& binding, const float* maps, const std::uint32_t* slot, std::size_t vertex, const Vec3& direction )
{
	return Blend( binding, maps, slot, vertex ).apply( F4{ direction.x(), direction.y(), direction.z(), 0.0f } );
}

float lengthOf( F4 a )
{
	return std::sqrt( ( a[0] * a[0] + a[1] * a[1] ) + a[2] * a[2] );
}

/// A normal that turns along with the vertex's nodes, where the triangles have no area to measure one by.
F4 turnedNormal( const SkinBinding& binding, const float* maps, const std::uint32_t* slot, std::size_t vertex )
{
	const Vec3& n = binding.restNormal[vertex];
	const F4 now = turned( binding, maps, slot, vertex, n );
	const float length = lengthOf( now );
	return length > 0.0f ? now / length : F4{ n.x(), n.y(), n.z(), 0.0f };
}

F4 rootOf( F4 a )
{
	return F4{ std::sqrt( a[0] ), std::sqrt( a[1] ), std::sqrt( a[2] ), std::sqrt( a[3] ) };
}

/// Four directions side by side: component by component. Turns one way and back alike.
struct Four
{
	F4 x, y, z;

	Four( F4 a, F4 b, F4 c, F4 d )
	{
		const F4 ab0 = __builtin_shufflevector( a, b, 0, 4, 1, 5 ), cd0 = __builtin_shufflevector( c, d, 0, 4, 1, 5 );
		const F4 ab1 = __builtin_shufflevector( a, b, 2, 6, 3, 7 ), cd1 = __builtin_shufflevector( c, d, 2, 6, 3, 7 );
		x = __builtin_shufflevector( ab0, cd0, 0, 1, 4, 5 );
		y = __builtin_shufflevector( ab0, cd0, 2, 3, 6, 7 );
		z = __builtin_shufflevector( ab1, cd1, 0, 1, 4, 5 );
	}
	F4 length() const { return rootOf( ( x * x + y * y ) + z * z ); }
};

/// Normals of vertices v to v + 3, to the bit what they are one by one. False where one of them has none to begin with, or shifts end among them.
bool writeFourNormals( const SkinBinding& binding, const SkinScratch& scratch, float* normals, std::size_t v )
{
	const std::size_t shifted = binding.normalShift.size();
	if ( v < shifted && v + 4 > shifted )
	{
		return false;
	}
	const auto sumOf = [&]( std::size_t vertex ) { return load4( scratch.groupNormal.data() + 4 * std::size_t( binding.normalGroup[vertex] ) ); };
	Four n( sumOf( v ), sumOf( v + 1 ), sumOf( v + 2 ), sumOf( v + 3 ) );
	const F4 length = n.length();
	if ( !( length[0] > 0.0f && length[1] > 0.0f && length[2] > 0.0f && length[3] > 0.0f ) )
	{
		return false;
	}
	n.x /= length;
	n.y /= length;
	n.z /= length;
	if ( v < binding.normalShift.size() )
	{
		const float* const from = scratch.turnedShift.data() + 4 * v;
		const Four shift( load4( from ), load4( from + 4 ), load4( from + 8 ), load4( from + 12 ) );
		Four turned = n;
		turned.x += shift.x;
		turned.y += shift.y;
		turned.z += shift.z;
		const F4 shiftedLength = turned.length();
		const auto isShiftedTo = ( ( shift.x != 0.0f ) | ( shift.y != 0.0f ) | ( shift.z != 0.0f ) ) & ( shiftedLength > 0.0f );
		n.x = isShiftedTo ? turned.x / shiftedLength : n.x;
		n.y = isShiftedTo ? turned.y / shiftedLength : n.y;
		n.z = isShiftedTo ? turned.z / shiftedLength : n.z;
	}
	for ( std::size_t k = 0; k < 4; ++k )
	{
		write3( normals + 3 * ( v + k ), F4{ n.x[k], n.y[k], n.z[k], 0.0f } );
	}
	return true;
}

void writeNormals( const SkinBinding& binding, const std::uint32_t* slot, const SkinScratch& scratch, float* normals, std::size_t first, std::size_t last )
{
	const float* const maps = scratch.nodeMap.data();
	for ( std::size_t v = first; v < last; ++v )
	{
		if ( v % 4 == 0 && v + 4 <= last && writeFourNormals( binding, scratch, normals, v ) )
		{
			v += 3;
			continue;
		}
		const F4 sum = load4( scratch.groupNormal.data() + 4 * std::size_t( binding.normalGroup[v] ) );
		const float length = lengthOf( sum );
		F4 normal = length > 0.0f ? sum / length : turnedNormal( binding, maps, slot, v );
		if ( length > 0.0f && isShifted( binding, v ) )
		{
			const F4 shifted = normal + load4( scratch.turnedShift.data() + 4 * v );
			const float shiftedLength = lengthOf( shifted );
			normal = shiftedLength > 0.0f ? shifted / shiftedLength : normal;
		}
		write3( normals + 3 * v, normal );
	}
}

} // namespace

void skin( const SkinBinding& binding, const NodeState& state, const float* rotations, const SkinTriangles& triangles, SkinScratch& scratch,
	float* positions, float* normals, TaskRunner* runner )
{
	SkinPose pose;
	pose.rotations = rotations;
	skin( binding, state, pose, triangles, scratch, positions, normals, runner );
}

void skin( const SkinBinding& binding, const NodeState& state, const SkinPose& pose, const SkinTriangles& triangles, SkinScratch& scratch,
	float* positions, float* normals, TaskRunner* runner )
{
	if ( binding.kind == Skinning::None )
	{
		return;
	}
	const std::size_t vertices = binding.restPosition.size();
	scratch.nodeMap.resize( std::size_t( state.count ) * kSkinMapFloats );
	scratch.position.resize( vertices * 4 );
	scratch.turnedShift.resize( binding.normalShift.size() * 4 );
	scratch.groupNormal.resize( std::size_t( binding.normalGroups ) * 4 );
	auto maps = [&]( int chunk ) {
		skinMaps( state, pose, scratch.nodeMap.data(), chunk * kChunk, std::min( state.count, ( chunk + 1 ) * kChunk ) );
	};
	runTasks( runner, chunkCount( std::size_t( state.count ) ), maps );
	if ( pose.fade )
	{
		pose.fade->ease( state, scratch.nodeMap.data() );
	}

	const auto begin = []( int chunk ) { return std::size_t( chunk ) * kChunk; };
	const auto end = [&]( int chunk ) { return std::min( vertices, begin( chunk + 1 ) ); };
	auto place = [&]( int chunk ) { writePositions( binding, pose.slotOfCell, scratch, positions, begin( chunk ), end( chunk ) ); };
	runTasks( runner, chunkCount( vertices ), place );
	if ( pose.fade )
	{
		pose.fade->addTo( positions, scratch.position.data(), pose.body );
	}
	if ( !binding.carrier.empty() )
	{
		auto carry = [&]( int chunk ) { writeCarried( binding, scratch, positions, begin( chunk ), end( chunk ) ); };
		runTasks( runner, chunkCount( vertices ), carry );
	}
	sumNormals( binding, triangles, scratch.position.data(), scratch.groupNormal.data() );
	auto orient = [&]( int chunk ) { writeNormals( binding, pose.slotOfCell, scratch, normals, begin( chunk ), end( chunk ) ); };
	runTasks( runner, chunkCount( vertices ), orient );
}

} // namespace pliant
