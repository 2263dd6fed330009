// Computes volumes as sums over thin rows: length inside times the row's cross-section.

#include "lattice/build/slivers.h"

#include "lattice/constants.h"

#include <algorithm>
#include <cmath>

namespace pliant {

namespace {

/// The contribution of one run to one cell.
struct Piece
{
	std::uint64_t key;
	double volume; ///< in cells
	Vec3d middle;  ///< in cells, from the grid's low corner
};

/// Rows across the mesh's box, `rows` along its longest side, and the cross-section of each.
struct FineRows
{
	Grid grid;
	std::vector<InsideRun> runs;
	double area = 0.0;
};

bool makeFineRows( const WeldedMesh& mesh, const InsideField& field, int rows, int axis, double maxCrossings, FineRows& out )
{
	const Vec3d size = mesh.high - mesh.low;
	if ( !makeGrid( mesh.low, mesh.high, size.maxCoeff() / rows, 1, out.grid ) )
	{
		return false;
	}
	const SnappedSurface surface( mesh, field, out.grid );
	if ( surface.expectedCrossings() > maxCrossings )
	{
		return false;
	}
	out.runs = insideRuns( surface, surface.makeRows( axis, nullptr ) );
	// Runs shorter than the welding tolerance are rounding errors.
	const auto isNothing = [&mesh]( const InsideRun& run ) { return run.to - run.from <= mesh.tolerance; };
	out.runs.erase( std::remove_if( out.runs.begin(), out.runs.end(), isNothing ), out.runs.end() );
	const int u = ( axis + 1 ) % 3;
	const int v = ( axis + 2 ) % 3;
	out.area = size[u] / out.grid.extent[u] * ( size[v] / out.grid.extent[v] );
	return true;
}

/// Splits a run at cell borders.
void cutRun( const FineRows& fine, const InsideRun& run, int axis, const Grid& grid, std::vector<Piece>& out )
{
	Vec3d at;
	const double quantum = fine.grid.quantum();
	at[( axis + 1 ) % 3] = fine.grid.corner[( axis + 1 ) % 3] + quantum * fine.grid.sampleAt( run.u );
	at[( axis + 2 ) % 3] = fine.grid.corner[( axis + 2 ) % 3] + quantum * fine.grid.sampleAt( run.v );
	const double d = grid.cellSize;
	const double from = ( run.from - grid.corner[axis] ) / d;
	const double to = ( run.to - grid.corner[axis] ) / d;
	for ( double cell = std::floor( from ); cell < to; cell += 1.0 )
	{
		const double low = std::max( from, cell );
		const double high = std::min( to, cell + 1.0 );
		at[axis] = grid.corner[axis] + 0.5 * ( low + high ) * d;
		const Vec3d middle = ( at - grid.corner ) / d;
		// A mesh may protrude minimally from its grid.
		const Eigen::Vector3i position = middle.array().floor().cast<int>().max( 0 ).min( grid.extent.array() - 1 );
		const double volume = ( high - low ) * fine.area / ( d * d );
		if ( volume > 0.0 )
		{
			out.push_back( { grid.key( position.x(), position.y(), position.z() ), volume,
				middle.cwiseMax( position.cast<double>() ).cwiseMin( ( position.array() + 1 ).cast<double>().matrix() ) } );
		}
	}
}

std::vector<CellDraft> gather( std::vector<Piece>& pieces )
{
	std::stable_sort( pieces.begin(), pieces.end(), []( const Piece& a, const Piece& b ) { return a.key < b.key; } );
	std::vector<CellDraft> cells;
	for ( std::size_t first = 0, last = 0; first < pieces.size(); first = last )
	{
		double volume = 0.0;
		Vec3d moment = Vec3d::Zero();
		for ( ; last < pieces.size() && pieces[last].key == pieces[first].key; ++last )
		{
			volume += pieces[last].volume;
			moment += pieces[last].volume * pieces[last].middle;
		}
		const float fill = float( std::min( volume, 1.0 ) );
		if ( fill > 0.0f )
		{
			cells.push_back( { pieces[first].key, Parts::kNone, fill, moment / volume } );
		}
	}
	return cells;
}

} // namespace

std::vector<CellDraft> findSliverCells( const WeldedMesh& mesh, const InsideField& field, const Grid& grid, double maxCrossings )
{
	// With a winding number query per interval, fine rows would take too long; an open surface without an inside is a sheet.
	if ( !field.isClosed() )
	{
		return {};
	}
	for ( const int rows : kSliverRows )
	{
		for ( int axis = 0; axis < 3; ++axis )
		{
			FineRows fine;
			if ( !makeFineRows( mesh, field, rows, axis, maxCrossings, fine ) || fine.runs.empty() )
			{
				continue;
			}
			std::vector<Piece> pieces;
			for ( const InsideRun& run : fine.runs )
			{
				cutRun( fine, run, axis, grid, pieces );
			}
			if ( std::vector<CellDraft> cells = gather( pieces ); !cells.empty() )
			{
				return cells;
			}
		}
	}
	return {};
}

void linkAllNeighbours( const std::vector<CellDraft>& cells, const Grid& grid, Lattice& lattice )
{
	std::vector<std::uint64_t> keys;
	for ( const CellDraft& cell : cells )
	{
		keys.push_back( cell.key );
	}
	const PositionIndex index( grid, keys );
	lattice.linkStart.assign( 1, 0 );
	lattice.linkTo.clear();
	lattice.isSurface.assign( cells.size(), 1 );
	for ( std::size_t i = 0; i < cells.size(); ++i )
	{
		for ( int code = 0; code < 27; ++code )
		{
			const Eigen::Vector3i at = grid.at( cells[i].key ) + Eigen::Vector3i( code % 3 - 1, code / 3 % 3 - 1, code / 9 - 1 );
			const std::int32_t other = grid.holds( at ) ? index.find( grid.key( at.x(), at.y(), at.z() ) ) : PositionIndex::kNone;
			if ( other != PositionIndex::kNone && std::size_t( other ) != i )
			{
				lattice.linkTo.push_back( std::uint32_t( other ) );
			}
		}
		lattice.linkStart.push_back( std::uint32_t( lattice.linkTo.size() ) );
		lattice.isSurface[i] = cells[i].fill < 1.0f || lattice.linkStart[i + 1] - lattice.linkStart[i] != kNeighbours;
	}
}

double estimateVolume( const WeldedMesh& mesh, const InsideField& field, double maxCrossings )
{
	double volume = 0.0;
	int axes = 0;
	for ( int axis = 0; axis < 3; ++axis )
	{
		FineRows fine;
		if ( makeFineRows( mesh, field, kEstimateRows, axis, maxCrossings, fine ) )
		{
			++axes;
			for ( const InsideRun& run : fine.runs )
			{
				volume += fine.area * ( run.to - run.from );
			}
		}
	}
	return axes > 0 ? volume / axes : 0.0;
}

} // namespace pliant
