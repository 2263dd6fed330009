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

struct AllNumbers
{
	std::size_t operator[]( std::size_t k ) const { return k; }
};

/// Entries first to last - 1 of a list of vertices.
template <class Numbers>
struct Some
{
	Numbers number;
	std::size_t first, last;
};

/// work( some ), a task each, of the vertices that follow their rows: all, where none is placed.
template <class Work>
void forBlended( const SkinBinding& binding, TaskRunner* runner, Work&& work )
{
	const std::size_t count = binding.blended.empty() ? binding.restPosition.size() : binding.blended.size();
	auto task = [&]( int chunk ) {
		const std::size_t first = std::size_t( chunk ) * kChunk, last = std::min( count, first + kChunk );
		binding.blended.empty() ? work( Some<AllNumbers>{ {}, first, last } ) : work( Some<const std::uint32_t*>{ binding.blended.data(), first, last } );
	};
	runTasks( runner, chunkCount( count ), task );
}

/// x = sum w ( x_n + R_n ( X - x0_n ) )   (Steinemann et al. 2008, section 7): the maps are blended first, then applied once.
template <class Numbers>
void writePositions( const SkinBinding& binding, const std::uint32_t* slot, SkinScratch& scratch, float* positions, const Some<Numbers>& some )
{
	for ( std::size_t k = some.first; k < some.last; ++k )
	{
		const std::size_t v = some.number[k];
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

/// x = sum w_k x_k over the corners of the triangle it lies in, once they have their places.
void placeFromCorners( const SkinBinding& binding, SkinScratch& scratch, float* positions, std::size_t first, std::size_t last )
{
	const auto at = [&scratch]( std::uint32_t vertex ) { return load4( scratch.position.data() + 4 * std::size_t( vertex ) ); };
	for ( std::size_t k = first; k < last; ++k )
	{
		const SkinBinding::Placed& of = binding.placed[k];
		if ( binding.carrierOf( of.vertex ) == of.vertex )
		{
			const F4 x = ( of.weight[0] * at( of.corner[0] ) + of.weight[1] * at( of.corner[1] ) ) + of.weight[2] * at( of.corner[2] );
			store4( scratch.position.data() + 4 * std::size_t( of.vertex ), x );
			write3( positions + 3 * std::size_t( of.vertex ), x );
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

/// Each triangle's normal times twice its area goes to its three corners' groups.
void addAreas( const std::uint32_t* group, const SkinTriangles& triangles, const float* positions, float* sums )
{
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

/// In the triangles' order, in one thread: the sums' bits do not depend on the threads.
void sumNormals( const SkinBinding& binding, const SkinTriangles& triangles, const float* positions, float* sums )
{
	const std::uint32_t* const group = binding.normalGroup.data();
	std::fill( sums, sums + 4 * std::size_t( binding.normalGroups ), 0.0f );
	if ( !binding.shading.empty() )
	{
		addAreas( group, { binding.shading.front().data(), int( binding.shading.size() ) }, positions, sums );
	}
	const int first = int( binding.shadedTriangles );
	addAreas( group, { triangles.indices + 3 * std::size_t( first ), triangles.count - first }, positions, sums );
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
	/// False, with nothing done, where one of them is zero.
	bool normalize()
	{
		const F4 l = length();
		const bool isGood = l[0] > 0.0f && l[1] > 0.0f && l[2] > 0.0f && l[3] > 0.0f;
		if ( isGood )
		{
			x /= l;
			y /= l;
			z /= l;
		}
		return isGood;
	}
	F4 operator[]( std::size_t k ) const { return F4{ x[k], y[k], z[k], 0.0f }; }
};

/// Normals of four vertices, to the bit what they are one by one. False where one of them has none to begin with, or shifts end among them.
bool writeFourNormals( const SkinBinding& binding, const SkinScratch& scratch, float* normals, const std::array<std::size_t, 4>& v )
{
	const std::size_t shifted = binding.normalShift.size();
	if ( v[0] < shifted && v[3] >= shifted )
	{
		return false;
	}
	const auto sumOf = [&]( std::size_t vertex ) { return load4( scratch.groupNormal.data() + 4 * std::size_t( binding.normalGroup[vertex] ) ); };
	Four n( sumOf( v[0] ), sumOf( v[1] ), sumOf( v[2] ), sumOf( v[3] ) );
	if ( !n.normalize() )
	{
		return false;
	}
	if ( v[0] < shifted )
	{
		const auto shiftOf = [&]( std::size_t vertex ) { return load4( scratch.turnedShift.data() + 4 * vertex ); };
		const Four shift( shiftOf( v[0] ), shiftOf( v[1] ), shiftOf( v[2] ), shiftOf( v[3] ) );
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
		write3( normals + 3 * v[k], n[k] );
	}
	return true;
}

template <class Numbers>
void writeNormals( const SkinBinding& binding, const std::uint32_t* slot, const SkinScratch& scratch, float* normals, const Some<Numbers>& some )
{
	const float* const maps = scratch.nodeMap.data();
	const Numbers& at = some.number;
	for ( std::size_t k = some.first; k < some.last; ++k )
	{
		if ( k % 4 == 0 && k + 4 <= some.last && writeFourNormals( binding, scratch, normals, { at[k], at[k + 1], at[k + 2], at[k + 3] } ) )
		{
			k += 3;
			continue;
		}
		const std::size_t v = at[k];
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

/// n = sum w_k n_k / | sum w_k n_k |, as a renderer shades between the corners of a triangle; the first one's, where they cancel.
void shadeFromCorners( const SkinBinding& binding, float* normals, std::size_t first, std::size_t last )
{
	const auto at = [normals]( std::uint32_t vertex ) {
		const float* const n = normals + 3 * std::size_t( vertex );
		return F4{ n[0], n[1], n[2], 0.0f };
	};
	const SkinBinding::Placed* const of = binding.placed.data();
	const auto sumOf = [&]( std::size_t k ) { return ( of[k].weight[0] * at( of[k].corner[0] ) + of[k].weight[1] * at( of[k].corner[1] ) ) + of[k].weight[2] * at( of[k].corner[2] ); };
	for ( std::size_t k = first; k < last; ++k )
	{
		const std::size_t end = std::min( k + 4, last );
		Four n( sumOf( k ), sumOf( std::min( k + 1, end - 1 ) ), sumOf( std::min( k + 2, end - 1 ) ), sumOf( end - 1 ) );
		if ( n.normalize() )
		{
			for ( std::size_t i = 0; k + i < end; ++i )
			{
				write3( normals + 3 * std::size_t( of[k + i].vertex ), n[i] );
			}
			k = end - 1;
			continue;
		}
		const F4 sum = sumOf( k );
		const float length = lengthOf( sum );
		write3( normals + 3 * std::size_t( of[k].vertex ), length > 0.0f ? sum / length : at( of[k].corner[0] ) );
	}
}

/// work( first, last ), a task each, of the vertices that are placed.
template <class Work>
void forPlaced( const SkinBinding& binding, TaskRunner* runner, Work&& work )
{
	auto task = [&]( int chunk ) {
		const std::size_t first = std::size_t( chunk ) * kChunk;
		work( first, std::min( binding.placed.size(), first + kChunk ) );
	};
	runTasks( runner, chunkCount( binding.placed.size() ), task );
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

	forBlended( binding, runner, [&]( const auto& some ) { writePositions( binding, pose.slotOfCell, scratch, positions, some ); } );
	if ( pose.fade )
	{
		pose.fade->addTo( positions, scratch.position.data(), pose.body );
	}
	forPlaced( binding, runner, [&]( std::size_t first, std::size_t last ) { placeFromCorners( binding, scratch, positions, first, last ); } );
	if ( !binding.carrier.empty() )
	{
		auto carry = [&]( int chunk ) {
			const std::size_t first = std::size_t( chunk ) * kChunk;
			writeCarried( binding, scratch, positions, first, std::min( vertices, first + kChunk ) );
		};
		runTasks( runner, chunkCount( vertices ), carry );
	}
	sumNormals( binding, triangles, scratch.position.data(), scratch.groupNormal.data() );
	forBlended( binding, runner, [&]( const auto& some ) { writeNormals( binding, pose.slotOfCell, scratch, normals, some ); } );
	forPlaced( binding, runner, [&]( std::size_t first, std::size_t last ) { shadeFromCorners( binding, normals, first, last ); } );
}

} // namespace pliant
