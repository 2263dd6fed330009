#pragma once

#include "surface/crack_case.h"

#include <algorithm>

namespace pliant::test {

inline Status broken( const char* words )
{
	return { ResultCode::BadSettings, words };
}

inline bool isTableOf( const Table& table, std::size_t rows, std::size_t numbers )
{
	const bool isWhole = table.start.size() == rows + 1 && table.start.front() == 0 && table.start.back() == table.entry.size() &&
		std::is_sorted( table.start.begin(), table.start.end() );
	return isWhole && std::all_of( table.entry.begin(), table.entry.end(), [numbers]( std::uint32_t n ) { return n < numbers; } );
}

/// Checks all invariants of the tables. The sentence names the first one violated.
inline Status validate( const CellComplex& complex )
{
	const std::size_t points = complex.pointCount(), cells = complex.cellCount(), faces = complex.face.size();
	if ( !isTableOf( complex.cellsOfPoint, points, cells ) || !isTableOf( complex.facesOfPoint, points, faces ) ||
		!isTableOf( complex.facesOfCell, cells, faces ) )
	{
		return broken( "A table of the cell complex does not fit its rows." );
	}
	if ( complex.vertexPoint.size() != complex.inputVertices + complex.addedOrigin.size() ||
		complex.triangleSource.size() != complex.triangle.size() || complex.faceAxis.size() != complex.faceTriangle.size() )
	{
		return broken( "Arrays of the cell complex differ in length." );
	}
	for ( std::uint32_t cell = 0; cell < cells; ++cell )
	{
		const std::vector<TrianglePoints> drawn = trianglesOfCell( complex, cell );
		const bool isKnown = std::all_of( drawn.begin(), drawn.end(), [&]( const TrianglePoints& corner ) {
			return std::all_of(
				corner.begin(), corner.end(), [&]( std::uint32_t p ) { return p < points && complex.cellsOfPoint.has( p, cell ); } );
		} );
		if ( !isKnown )
		{
			return broken( "A cell draws a point whose row of cellsOfPoint lacks it." );
		}
	}
	for ( std::uint32_t f = 0; f < faces; ++f )
	{
		if ( complex.face[f].cellA >= complex.face[f].cellB || complex.face[f].cellB >= cells ||
			complex.faceBetween( complex.face[f].cellA, complex.face[f].cellB ) != f )
		{
			return broken( "A face is not found between its cells." );
		}
	}
	return {};
}

} // namespace pliant::test
