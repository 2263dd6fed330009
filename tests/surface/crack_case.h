#pragma once

// A mesh, its lattice and its cell complex in one line, and sums over the drawing of cells.

#include "surface/skin_case.h"

#include "surface/crack_complex/cell_complex.h"

#include <map>
#include <memory>

namespace pliant::test {

struct CrackCase : SkinCase
{
	std::shared_ptr<const CellComplex> complex;

	CrackCase( Mesh cut, double cellSize, const CrackSettings& settings, Skinning kind = Skinning::NearbyNodes ) :
		SkinCase( std::move( cut ), cellSize, kind )
	{
		LatticeSettings build;
		build.cellSize = float( cellSize );
		const auto made = CellComplex::build( mesh.view(), built.lattice, binding, build, settings );
		EXPECT_TRUE( made.ok() ) << made.status.sentence;
		complex = made.value;
	}

	Vec3d at( std::uint32_t point ) const { return complex->pointRest[point].cast<double>(); }
};

using TrianglePoints = std::array<std::uint32_t, 3>;

/// The drawing of a cell with everything around it broken: points of the complex.
inline std::vector<TrianglePoints> trianglesOfCell( const CellComplex& complex, std::uint32_t cell )
{
	std::vector<TrianglePoints> out;
	for ( std::uint32_t t = complex.cellTriangleStart[cell]; t < complex.cellTriangleStart[cell + 1]; ++t )
	{
		const auto& v = complex.triangle[t];
		out.push_back( { complex.vertexPoint[v[0]], complex.vertexPoint[v[1]], complex.vertexPoint[v[2]] } );
	}
	for ( const std::uint32_t* f = complex.facesOfCell.begin( cell ); f != complex.facesOfCell.end( cell ); ++f )
	{
		for ( std::uint32_t t = complex.face[*f].firstTriangle; t < complex.face[*f].lastTriangle; ++t )
		{
			TrianglePoints p = complex.faceTriangle[t];
			if ( complex.face[*f].cellB == cell )
			{
				std::swap( p[1], p[2] );
			}
			out.push_back( p );
		}
	}
	return out;
}

inline double signedVolume( const Vec3d& a, const Vec3d& b, const Vec3d& c )
{
	return a.dot( b.cross( c ) ) / 6.0;
}

inline double meshVolume( const Mesh& mesh )
{
	const auto at = [&]( std::size_t i ) { return Vec3d( mesh.positions[3 * i], mesh.positions[3 * i + 1], mesh.positions[3 * i + 2] ); };
	double sum = 0.0;
	for ( std::size_t t = 0; t < mesh.triangleCount(); ++t )
	{
		const std::uint32_t* v = &mesh.indices[3 * t];
		sum += signedVolume( at( v[0] ), at( v[1] ), at( v[2] ) );
	}
	return sum;
}

/// Edges that are not used equally often in both directions.
template <class Triangles>
int openEdges( const Triangles& triangles )
{
	std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
	for ( const auto& t : triangles )
	{
		for ( std::size_t k = 0; k < 3; ++k )
		{
			edges[std::minmax( t[k], t[( k + 1 ) % 3] )] += t[k] < t[( k + 1 ) % 3] ? 1 : -1;
		}
	}
	int open = 0;
	for ( const auto& edge : edges )
	{
		open += edge.second != 0;
	}
	return open;
}

/// Edges that are not used exactly once in each direction: where a surface is no manifold.
template <class Triangles>
int oddEdges( const Triangles& triangles )
{
	std::map<std::pair<std::uint32_t, std::uint32_t>, std::pair<int, int>> edges;
	for ( const auto& t : triangles )
	{
		for ( std::size_t k = 0; k < 3; ++k )
		{
			auto& used = edges[std::minmax( t[k], t[( k + 1 ) % 3] )];
			++( t[k] < t[( k + 1 ) % 3] ? used.first : used.second );
		}
	}
	int odd = 0;
	for ( const auto& edge : edges )
	{
		odd += edge.second != std::make_pair( 1, 1 );
	}
	return odd;
}

} // namespace pliant::test
