#pragma once

// Everything that a cracked body draws, comparable to the bit.

#include "surface/crack_mesh/crack_view.h"

#include <algorithm>
#include <cstdint>
#include <vector>

namespace pliant::test {

/// All data of a corner: position, normal, texture coordinates, its cells and their weights.
using Corner = std::vector<float>;
using Drawing = std::vector<std::vector<Corner>>;

inline Corner cornerOf( const SkinBinding& b, const float* texture, std::uint32_t v )
{
	Corner corner = { texture[2 * std::size_t( v )], texture[2 * std::size_t( v ) + 1] };
	for ( const Vec3& a : { b.restPosition[v], b.restNormal[v], b.normalShiftOf( v ) } )
	{
		corner.insert( corner.end(), a.data(), a.data() + 3 );
	}
	for ( std::uint32_t c = b.carrierOf( v ), k = b.start[c]; k < b.start[c + 1] && b.weight[k] != 0.0f; ++k )
	{
		corner.push_back( float( b.node[k] ) );
		corner.push_back( b.weight[k] );
	}
	const auto placed = std::lower_bound(
		b.placed.begin(), b.placed.end(), v, []( const SkinBinding::Placed& a, std::uint32_t wanted ) { return a.vertex < wanted; } );
	for ( std::size_t k = 0; placed != b.placed.end() && placed->vertex == v && k < 3; ++k )
	{
		corner.insert( corner.end(), { -1.0f, float( b.point[placed->corner[k]] ), placed->weight[k] } );
	}
	return corner;
}

/// The triangles that add to normals, by points: sums are the same to the bit only in the same order.
inline std::vector<Corner> shadingOf( const SkinBinding& b )
{
	std::vector<Corner> shading = {
		{ float( b.restPosition.size() ), float( b.shadedTriangles ), float( b.placed.size() ), float( b.blended.size() ) } };
	for ( const auto& [x, y, z] : b.shading )
	{
		shading.push_back( { float( b.point[x] ), float( b.point[y] ), float( b.point[z] ) } );
	}
	return shading;
}

/// Triangles in a canonical order, each beginning with its smallest corner.
inline Drawing drawingOf( const CrackView& view )
{
	Drawing drawing;
	for ( std::size_t t = 0; t < view.triangles.size(); ++t )
	{
		std::vector<Corner> corners;
		for ( const std::uint32_t v : view.triangles[t] )
		{
			corners.push_back( cornerOf( view.binding, view.texture.data(), v ) );
		}
		std::rotate( corners.begin(), std::min_element( corners.begin(), corners.end() ), corners.end() );
		corners.push_back( { float( view.sources[t] ) } );
		drawing.push_back( corners );
	}
	std::sort( drawing.begin(), drawing.end() );
	drawing.push_back( shadingOf( view.binding ) );
	return drawing;
}

} // namespace pliant::test
