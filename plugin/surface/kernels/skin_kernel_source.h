// The skin's kernels. Each skin_kernels_<target>.cpp defines PLIANT_SKIN_TABLE and PLIANT_SKIN_NAME and includes this file once. No
// template or inline function of another header is instantiated here (matching/kernels/kernel_source.h explains why). Pointers are copied
// from the view before a loop, because the compiler must assume that every store changes the view.

#pragma once

#include "surface/kernels/skin_kernels.h"

#if defined( __x86_64__ ) || defined( __i386__ )
	#include <immintrin.h>
#endif

namespace pliant {

namespace {

#define PLIANT_LANE_WIDTH 4
#include "matching/kernels/lane.h"

/// The rows of a vertex's affine map, blended from those of its nodes.
struct Blend
{
	F4 x, y, z;

	/// Products of the three rows with a column, and zero. The column's last entry is 1 for positions, 0 for directions.
	F4 apply( F4 column ) const
	{
		const F4 a = x * column, b = y * column, c = z * column, d{};
		const F4 ab = __builtin_shufflevector( a, b, 0, 4, 1, 5 ) + __builtin_shufflevector( a, b, 2, 6, 3, 7 );
		const F4 cd = __builtin_shufflevector( c, d, 0, 4, 1, 5 ) + __builtin_shufflevector( c, d, 2, 6, 3, 7 );
		return __builtin_shufflevector( ab, cd, 0, 1, 4, 5 ) + __builtin_shufflevector( ab, cd, 2, 3, 6, 7 );
	}
};

struct Rows
{
	const std::uint32_t *start, *node, *slot;
	const float *weight, *map;

	explicit Rows( const SkinView& view ) :
		start( view.start ), node( view.node ), slot( view.slot ), weight( view.weight ), map( view.map )
	{}

	Blend of( std::size_t vertex ) const
	{
		Blend sum = {};
		const std::uint32_t end = start[vertex + 1];
		for ( std::uint32_t k = start[vertex]; k < end; ++k )
		{
			const std::uint32_t carries = slot ? slot[node[k]] : node[k];
			const float* const at = map + std::size_t( carries ) * kSkinMapFloats;
			const float w = weight[k];
			sum.x += w * load4( at );
			sum.y += w * load4( at + 4 );
			sum.z += w * load4( at + 8 );
		}
		return sum;
	}
};

void store3( float* to, F4 a )
{
	to[0] = a[0];
	to[1] = a[1];
	to[2] = a[2];
}

F4 column( const float* three, float last )
{
	return F4{ three[0], three[1], three[2], last };
}

bool isZero( const float* three )
{
	return three[0] == 0.0f && three[1] == 0.0f && three[2] == 0.0f;
}

void followRows( const SkinView& view, std::size_t first, std::size_t last )
{
	const Rows rows( view );
	const std::uint32_t *const listed = view.listed, *const carriers = view.carrier;
	const float *const rest = view.restPosition, *const shifts = view.normalShift;
	float *const positions4 = view.position4, *const turnedShift = view.turnedShift, *const positions = view.positions;
	const std::size_t shifted = view.shifted;
	for ( std::size_t k = first; k < last; ++k )
	{
		const std::size_t v = listed ? listed[k] : k, carrier = carriers ? carriers[v] : v;
		const bool isShifted = v < shifted && !isZero( shifts + 3 * v );
		F4 turned = {};
		if ( carrier == v || isShifted )
		{
			const Blend blend = rows.of( carrier );
			if ( carrier == v )
			{
				const F4 x = blend.apply( column( rest + 3 * v, 1.0f ) );
				store4( positions4 + 4 * v, x );
				store3( positions + 3 * v, x );
			}
			turned = isShifted ? blend.apply( column( shifts + 3 * v, 0.0f ) ) : turned;
		}
		if ( v < shifted )
		{
			store4( turnedShift + 4 * v, turned );
		}
	}
}

void placeFromCorners( const SkinView& view, std::size_t first, std::size_t last )
{
	const SkinPosition* const placed = view.placed;
	const std::uint32_t* const carriers = view.carrier;
	float *const positions4 = view.position4, *const positions = view.positions;
	const auto at = [positions4]( std::uint32_t vertex ) { return load4( positions4 + 4 * std::size_t( vertex ) ); };
	for ( std::size_t k = first; k < last; ++k )
	{
		const SkinPosition& of = placed[k];
		const std::size_t v = of.vertex;
		if ( !carriers || carriers[v] == v )
		{
			const F4 x = ( of.weight[0] * at( of.corner[0] ) + of.weight[1] * at( of.corner[1] ) ) + of.weight[2] * at( of.corner[2] );
			store4( positions4 + 4 * v, x );
			store3( positions + 3 * v, x );
		}
	}
}

void carry( const SkinView& view, std::size_t first, std::size_t last )
{
	const std::uint32_t* const carriers = view.carrier;
	float *const positions4 = view.position4, *const positions = view.positions;
	for ( std::size_t v = first; v < last; ++v )
	{
		if ( const std::size_t carrier = carriers[v]; carrier != v )
		{
			const F4 x = load4( positions4 + 4 * carrier );
			store4( positions4 + 4 * v, x );
			store3( positions + 3 * v, x );
		}
	}
}

F4 cross( F4 a, F4 b )
{
	const F4 c = a * __builtin_shufflevector( b, b, 1, 2, 0, 3 ) - __builtin_shufflevector( a, a, 1, 2, 0, 3 ) * b;
	return __builtin_shufflevector( c, c, 1, 2, 0, 3 );
}

void addAreas( const SkinView& view, const std::uint32_t* corners, int triangles )
{
	const std::uint32_t* const group = view.normalGroup;
	const float* const positions4 = view.position4;
	float* const sums = view.groupNormal;
	const auto at = [positions4]( std::uint32_t vertex ) { return load4( positions4 + 4 * std::size_t( vertex ) ); };
	for ( int t = 0; t < triangles; ++t, corners += 3 )
	{
		const F4 a = at( corners[0] );
		const F4 area = cross( at( corners[1] ) - a, at( corners[2] ) - a );
		for ( int k = 0; k < 3; ++k )
		{
			float* const sum = sums + 4 * std::size_t( group[corners[k]] );
			store4( sum, load4( sum ) + area );
		}
	}
}

float lengthOf( F4 a )
{
	return __builtin_sqrtf( ( a[0] * a[0] + a[1] * a[1] ) + a[2] * a[2] );
}

/// Four directions, stored by component. The transposition is its own inverse.
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
	F4 length() const { return squareRoot( ( x * x + y * y ) + z * z ); }
	/// Returns false and changes nothing where one of them is zero.
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
	F4 operator[]( int k ) const { return F4{ x[k], y[k], z[k], 0.0f }; }
};

/// Sums of areas and shifts, from which normals are computed.
struct Normals
{
	const std::uint32_t* group;
	const float *sums, *turnedShift;
	std::size_t shifted;

	explicit Normals( const SkinView& view ) :
		group( view.normalGroup ), sums( view.groupNormal ), turnedShift( view.turnedShift ), shifted( view.shifted )
	{}

	F4 sumOf( std::size_t vertex ) const { return load4( sums + 4 * std::size_t( group[vertex] ) ); }
	F4 shiftOf( std::size_t vertex ) const { return load4( turnedShift + 4 * vertex ); }

	/// Writes four vertices, with the same bits as one by one. Returns false where one has no area sum, or only some are shifted.
	bool writeFour( const std::size_t ( &v )[4], float* normals ) const
	{
		if ( v[0] < shifted && v[3] >= shifted )
		{
			return false;
		}
		Four n( sumOf( v[0] ), sumOf( v[1] ), sumOf( v[2] ), sumOf( v[3] ) );
		if ( !n.normalize() )
		{
			return false;
		}
		if ( v[0] < shifted )
		{
			shift( n, Four( shiftOf( v[0] ), shiftOf( v[1] ), shiftOf( v[2] ), shiftOf( v[3] ) ) );
		}
		for ( int k = 0; k < 4; ++k )
		{
			store3( normals + 3 * v[k], n[k] );
		}
		return true;
	}
	static void shift( Four& n, const Four& by )
	{
		Four moved = n;
		moved.x += by.x;
		moved.y += by.y;
		moved.z += by.z;
		const F4 length = moved.length();
		const auto isMoved = ( ( by.x != 0.0f ) | ( by.y != 0.0f ) | ( by.z != 0.0f ) ) & ( length > 0.0f );
		n.x = isMoved ? moved.x / length : n.x;
		n.y = isMoved ? moved.y / length : n.y;
		n.z = isMoved ? moved.z / length : n.z;
	}
};

/// The rest normal rotated with the vertex's nodes, for vertices whose triangles have no area.
F4 turnedNormal( const SkinView& view, std::size_t vertex )
{
	const F4 rest = column( view.restNormal + 3 * vertex, 0.0f );
	const F4 now = Rows( view ).of( view.carrier ? view.carrier[vertex] : vertex ).apply( rest );
	const float length = lengthOf( now );
	return length > 0.0f ? now / length : rest;
}

F4 normalOf( const SkinView& view, const Normals& normals, std::size_t vertex )
{
	const F4 sum = normals.sumOf( vertex );
	const float length = lengthOf( sum );
	if ( !( length > 0.0f ) )
	{
		return turnedNormal( view, vertex );
	}
	const F4 normal = sum / length;
	if ( vertex >= view.shifted || isZero( view.normalShift + 3 * vertex ) )
	{
		return normal;
	}
	const F4 moved = normal + normals.shiftOf( vertex );
	const float movedLength = lengthOf( moved );
	return movedLength > 0.0f ? moved / movedLength : normal;
}

void writeNormals( const SkinView& view, std::size_t first, std::size_t last )
{
	const Normals normals( view );
	const std::uint32_t* const listed = view.listed;
	float* const to = view.normals;
	const auto at = [listed]( std::size_t k ) { return listed ? std::size_t( listed[k] ) : k; };
	for ( std::size_t k = first; k < last; ++k )
	{
		if ( k % 4 == 0 && k + 4 <= last )
		{
			const std::size_t four[4] = { at( k ), at( k + 1 ), at( k + 2 ), at( k + 3 ) };
			if ( normals.writeFour( four, to ) )
			{
				k += 3;
				continue;
			}
		}
		store3( to + 3 * at( k ), normalOf( view, normals, at( k ) ) );
	}
}

void shadeFromCorners( const SkinView& view, std::size_t first, std::size_t last )
{
	const SkinPosition* const of = view.placed;
	float* const normals = view.normals;
	const auto at = [normals]( std::uint32_t vertex ) { return column( normals + 3 * std::size_t( vertex ), 0.0f ); };
	const auto sumOf = [&]( std::size_t k ) {
		return ( of[k].weight[0] * at( of[k].corner[0] ) + of[k].weight[1] * at( of[k].corner[1] ) ) +
			of[k].weight[2] * at( of[k].corner[2] );
	};
	for ( std::size_t k = first; k < last; ++k )
	{
		const std::size_t end = k + 4 < last ? k + 4 : last;
		const auto within = [&]( std::size_t i ) { return i < end ? i : end - 1; };
		Four n( sumOf( k ), sumOf( within( k + 1 ) ), sumOf( within( k + 2 ) ), sumOf( end - 1 ) );
		if ( n.normalize() )
		{
			for ( std::size_t i = 0; k + i < end; ++i )
			{
				store3( normals + 3 * std::size_t( of[k + i].vertex ), n[int( i )] );
			}
			k = end - 1;
			continue;
		}
		const F4 sum = sumOf( k );
		const float length = lengthOf( sum );
		store3( normals + 3 * std::size_t( of[k].vertex ), length > 0.0f ? sum / length : at( of[k].corner[0] ) );
	}
}

} // namespace

extern const SkinKernels PLIANT_SKIN_TABLE;
const SkinKernels PLIANT_SKIN_TABLE = {
	&followRows, &placeFromCorners, &carry, &addAreas, &writeNormals, &shadeFromCorners, PLIANT_SKIN_NAME };

} // namespace pliant
