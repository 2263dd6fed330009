#include "surface/crack_complex/cell_complex.h"

#include "lattice/attempt.h"
#include "surface/crack_complex/complex_builder.h"

#include <algorithm>
#include <chrono>

namespace pliant {

namespace {

Status broken( const char* words )
{
	return { ResultCode::BadSettings, words };
}

} // namespace

Result<std::shared_ptr<const CellComplex>> CellComplex::build(
	const MeshView& mesh, const Lattice& lattice, const SkinBinding& skin, const LatticeSettings& build, const CrackSettings& settings )
{
	using Answer = Result<std::shared_ptr<const CellComplex>>;
	const auto start = std::chrono::steady_clock::now();
	return withinMemory( kNoMemoryToBuild, [&]() -> Answer {
		insist( check( settings ) );
		const auto made = std::make_shared<CellComplex>();
		buildComplex( mesh, lattice, skin, build, settings, *made );
		made->report.seconds = std::chrono::duration<double>( std::chrono::steady_clock::now() - start ).count();
		return Answer::success( made );
	} );
}

std::uint32_t CellComplex::faceBetween( std::uint32_t a, std::uint32_t b ) const
{
	const std::uint32_t low = std::min( a, b ), high = std::max( a, b );
	for ( const std::uint32_t* f = facesOfCell.begin( low ); f != facesOfCell.end( low ); ++f )
	{
		if ( face[*f].cellA == low && face[*f].cellB == high )
		{
			return *f;
		}
	}
	return kNone;
}

namespace {

bool isTableOf( const Table& table, std::size_t rows, std::size_t numbers )
{
	const bool isWhole = table.start.size() == rows + 1 && table.start.front() == 0 && table.start.back() == table.entry.size() &&
		std::is_sorted( table.start.begin(), table.start.end() );
	return isWhole && std::all_of( table.entry.begin(), table.entry.end(), [numbers]( std::uint32_t n ) { return n < numbers; } );
}

/// Calls visit for each triangle that a cell draws, as points.
template <class F>
void forTriangles( const CellComplex& complex, std::uint32_t cell, F&& visit )
{
	for ( std::uint32_t t = complex.cellTriangleStart[cell]; t < complex.cellTriangleStart[cell + 1]; ++t )
	{
		const auto& v = complex.triangle[t];
		visit( std::array<std::uint32_t, 3>{ complex.vertexPoint[v[0]], complex.vertexPoint[v[1]], complex.vertexPoint[v[2]] } );
	}
	for ( const std::uint32_t* f = complex.facesOfCell.begin( cell ); f != complex.facesOfCell.end( cell ); ++f )
	{
		for ( std::uint32_t t = complex.face[*f].firstTriangle; t < complex.face[*f].lastTriangle; ++t )
		{
			std::array<std::uint32_t, 3> corner = complex.faceTriangle[t];
			if ( complex.face[*f].cellB == cell )
			{
				std::swap( corner[1], corner[2] );
			}
			visit( corner );
		}
	}
}

} // namespace

Status validate( const CellComplex& complex )
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
		bool isKnown = true;
		forTriangles( complex, cell, [&]( const std::array<std::uint32_t, 3>& corner ) {
			for ( const std::uint32_t p : corner )
			{
				isKnown = isKnown && p < points && complex.cellsOfPoint.has( p, cell );
			}
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

} // namespace pliant
