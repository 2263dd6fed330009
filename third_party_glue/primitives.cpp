// +-----------------------------------------------------------------------------------------------------------------+
// | The two solids every rigid body of the demos is drawn with.                                                      |
// +-----------------------------------------------------------------------------------------------------------------+

#include "third_party_glue/primitives.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

namespace pliant_glue {

Primitive unitCube()
{
	Primitive cube;
	for ( int face = 0; face < 6; ++face )
	{
		const int axis = face / 2;
		const float side = face % 2 == 0 ? 1.0f : -1.0f;
		const int u = ( axis + 1 ) % 3;
		const int v = ( axis + 2 ) % 3;
		const auto first = std::uint32_t( cube.positions.size() / 3 );
		for ( int corner = 0; corner < 4; ++corner )
		{
			float p[3], n[3] = { 0, 0, 0 };
			p[axis] = 0.5f * side;
			p[u] = corner == 1 || corner == 2 ? 0.5f : -0.5f;
			p[v] = corner >= 2 ? 0.5f : -0.5f;
			n[axis] = side;
			cube.positions.insert( cube.positions.end(), p, p + 3 );
			cube.normals.insert( cube.normals.end(), n, n + 3 );
		}
		// Corners run counter-clockwise about +axis; seen from the other side they must run the other way.
		const std::uint32_t b = side > 0 ? 1 : 3, d = side > 0 ? 3 : 1;
		cube.indices.insert( cube.indices.end(), { first, first + b, first + 2, first, first + 2, first + d } );
	}
	return cube;
}

Primitive unitSphere( int subdivisions )
{
	const float t = ( 1.0f + std::sqrt( 5.0f ) ) / 2.0f;
	std::vector<std::array<float, 3>> points = { { -1, t, 0 }, { 1, t, 0 }, { -1, -t, 0 }, { 1, -t, 0 }, { 0, -1, t }, { 0, 1, t },
		{ 0, -1, -t }, { 0, 1, -t }, { t, 0, -1 }, { t, 0, 1 }, { -t, 0, -1 }, { -t, 0, 1 } };
	std::vector<std::uint32_t> triangles = { 0, 11, 5, 0, 5, 1, 0, 1, 7, 0, 7, 10, 0, 10, 11, 1, 5, 9, 5, 11, 4, 11, 10, 2, 10, 7, 6, 7, 1,
		8, 3, 9, 4, 3, 4, 2, 3, 2, 6, 3, 6, 8, 3, 8, 9, 4, 9, 5, 2, 4, 11, 6, 2, 10, 8, 6, 7, 9, 8, 1 };
	for ( int level = 0; level < std::clamp( subdivisions, 0, 6 ); ++level )
	{
		std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
		const auto middle = [&]( std::uint32_t a, std::uint32_t b ) {
			const auto [entry, isNew] = middles.try_emplace( std::minmax( a, b ), std::uint32_t( points.size() ) );
			if ( isNew )
			{
				points.push_back( { points[a][0] + points[b][0], points[a][1] + points[b][1], points[a][2] + points[b][2] } );
				const std::array<float, 3> p = points.back();
				const float scale = std::sqrt( ( 1 + t * t ) / ( p[0] * p[0] + p[1] * p[1] + p[2] * p[2] ) );
				points.back() = { p[0] * scale, p[1] * scale, p[2] * scale };
			}
			return entry->second;
		};
		std::vector<std::uint32_t> finer;
		for ( std::size_t k = 0; k < triangles.size(); k += 3 )
		{
			const std::uint32_t a = triangles[k], b = triangles[k + 1], c = triangles[k + 2];
			const std::uint32_t ab = middle( a, b ), bc = middle( b, c ), ca = middle( c, a );
			finer.insert( finer.end(), { a, ab, ca, b, bc, ab, c, ca, bc, ab, bc, ca } );
		}
		triangles = std::move( finer );
	}
	Primitive sphere;
	sphere.indices = std::move( triangles );
	for ( const std::array<float, 3>& p : points )
	{
		const float length = std::sqrt( p[0] * p[0] + p[1] * p[1] + p[2] * p[2] );
		for ( const float coordinate : p )
		{
			sphere.normals.push_back( coordinate / length );
			sphere.positions.push_back( 0.5f * coordinate / length );
		}
	}
	return sphere;
}

} // namespace pliant_glue
