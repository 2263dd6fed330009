#pragma once

// Samples a surface densely enough that none of its parts is missed.

#include "lattice/constants.h"
#include "lattice/inside/grid.h"
#include "lattice/mesh/weld.h"

#include <algorithm>
#include <cmath>

namespace pliant {

/// Calls visit( point, area ) for points of a triangle, both in cells of the grid (a point from its low corner). Neighbouring points are at
/// most 1 / `density` apart along each axis, within a triangle and across a shared edge; the areas sum to the triangle's. The corners of
/// all but the smallest triangles are visited too, with zero area: they are the outermost points of the drawn surface.
template <class F>
void visitTriangle( const std::array<Vec3d, 3>& corner, double density, F&& visit )
{
	std::size_t first = 0; // start of the longest edge
	double longest = 0.0;
	for ( std::size_t k = 0; k < 3; ++k )
	{
		const double length = ( corner[( k + 1 ) % 3] - corner[k] ).norm();
		if ( length > longest )
		{
			longest = length;
			first = k;
		}
	}
	for ( std::size_t k = 0; k < 3 && longest > kSmallestVisited; ++k )
	{
		visit( corner[k], 0.0 );
	}
	const Vec3d &a = corner[first], &b = corner[( first + 1 ) % 3], &c = corner[( first + 2 ) % 3];
	const double height = longest > 0.0 ? ( b - a ).cross( c - a ).norm() / longest : 0.0;
	// Strips along the longest edge, each divided into pieces: a needle has one strip.
	const int strips = std::max( 1, int( std::ceil( density * height ) ) );
	for ( int strip = 0; strip < strips; ++strip )
	{
		const double up = ( strip + 0.5 ) / strips;
		const Vec3d from = a + up * ( c - a );
		const Vec3d along = ( 1.0 - up ) * ( b - a );
		const double length = ( 1.0 - up ) * longest;
		const int pieces = std::max( 1, int( std::ceil( density * length ) ) );
		for ( int piece = 0; piece < pieces; ++piece )
		{
			visit( Vec3d( from + ( piece + 0.5 ) / pieces * along ), length * height / strips / pieces );
		}
	}
}

/// Every drawn triangle: those that bound the inside, and those left out because they do not.
template <class F>
void visitSurface( const WeldedMesh& mesh, const Grid& grid, double density, F&& visit )
{
	for ( const std::vector<Triangle>* triangles : { &mesh.triangle, &mesh.leftOut } )
	{
		for ( const Triangle& t : *triangles )
		{
			std::array<Vec3d, 3> corner;
			for ( std::size_t k = 0; k < 3; ++k )
			{
				corner[k] = ( mesh.position[t[k]] - grid.corner ) / grid.cellSize;
			}
			visitTriangle( corner, density, visit );
		}
	}
}

/// The lattice position of a point; points outside the grid belong to the outermost positions.
inline Eigen::Vector3i positionOfPoint( const Grid& grid, const Vec3d& point )
{
	return point.array().max( 0.0 ).min( ( grid.extent.array() - 1 ).cast<double>() ).cast<int>();
}

} // namespace pliant
