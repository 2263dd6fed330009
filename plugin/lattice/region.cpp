#include "lattice/region.h"

#include "lattice/constants.h"
#include "lattice/reach.h"
#include "pliant/task_runner.h"

#include <algorithm>
#include <array>

namespace pliant {

namespace {

/// Returns the number of cells within the cube of half-width w around each cell, regardless of links, by box counts over the grid. Empty
/// when a lattice position holds two cells or the grid is much larger than the body.
std::vector<std::uint32_t> cubeCounts( const Lattice& lattice, int w )
{
	if ( std::size_t( lattice.extent.x() ) * lattice.extent.y() * lattice.extent.z() > kMaxGridPerCell * lattice.fill.size() + kSmallGrid )
	{
		return {};
	}
	// Pieces keep the coordinates of the body they broke off: only their own bounding box counts.
	Eigen::Matrix<std::int16_t, 3, 1> low = lattice.coordinate[0], high = low;
	for ( const auto& c : lattice.coordinate )
	{
		low = low.cwiseMin( c );
		high = high.cwiseMax( c );
	}
	const int nx = high.x() - low.x() + 1, ny = high.y() - low.y() + 1, nz = high.z() - low.z() + 1;
	const std::size_t positions = std::size_t( nx ) * ny * nz;
	const auto positionOf = [&]( const Eigen::Matrix<std::int16_t, 3, 1>& c ) {
		return ( std::size_t( c.z() - low.z() ) * ny + std::size_t( c.y() - low.y() ) ) * nx + std::size_t( c.x() - low.x() );
	};
	std::vector<std::uint32_t> count( positions, 0 );
	for ( const auto& c : lattice.coordinate )
	{
		if ( count[positionOf( c )]++ != 0 )
		{
			return {};
		}
	}
	const std::array<std::size_t, 3> stride = { 1, std::size_t( nx ), std::size_t( nx ) * ny };
	const std::array<int, 3> length = { nx, ny, nz };
	std::vector<std::uint32_t> line;
	for ( int axis = 0; axis < 3; ++axis )
	{
		const std::size_t block = stride[axis] * std::size_t( length[axis] );
		for ( std::size_t k = 0; k < positions / std::size_t( length[axis] ); ++k )
		{
			const std::size_t first = k / stride[axis] * block + k % stride[axis];
			line.assign( length[axis], 0 );
			for ( int i = 0; i < length[axis]; ++i )
			{
				for ( int j = std::max( 0, i - w ); j <= std::min( length[axis] - 1, i + w ); ++j )
				{
					line[i] += count[first + j * stride[axis]];
				}
			}
			for ( int i = 0; i < length[axis]; ++i )
			{
				count[first + i * stride[axis]] = line[i];
			}
		}
	}
	std::vector<std::uint32_t> perCell;
	perCell.reserve( lattice.coordinate.size() );
	for ( const auto& c : lattice.coordinate )
	{
		perCell.push_back( count[positionOf( c )] );
	}
	return perCell;
}

/// Whether two successive cells are neighbours without a link, as most bodies with cracks have: the counts would differ from the rows.
bool hasSeparateNeighbours( const Lattice& lattice )
{
	for ( std::uint32_t i = 0; i + 1 < std::uint32_t( lattice.cellCount() ); ++i )
	{
		if ( ( lattice.coordinate[i + 1] - lattice.coordinate[i] ).cwiseAbs().maxCoeff() == 1 )
		{
			const auto row = lattice.linkTo.begin() + lattice.linkStart[i], end = lattice.linkTo.begin() + lattice.linkStart[i + 1];
			if ( !std::binary_search( row, end, i + 1 ) )
			{
				return true;
			}
		}
	}
	return false;
}

struct SearchJob
{
	const Lattice* lattice = nullptr;
	int halfWidth = 1;
	std::vector<std::vector<std::uint32_t>> members; // one list per task, regions in sequence
	std::vector<std::uint16_t>* size = nullptr;

	static void run( void* context, int task )
	{
		SearchJob& job = *static_cast<SearchJob*>( context );
		Reach reach( *job.lattice );
		const int end = std::min( job.lattice->cellCount(), ( task + 1 ) * kCellsPerTask );
		for ( int cell = task * kCellsPerTask; cell < end; ++cell )
		{
			const auto& found = reach.from( std::uint32_t( cell ), job.halfWidth );
			( *job.size )[cell] = std::uint16_t( found.size() );
			job.members[task].insert( job.members[task].end(), found.begin(), found.end() );
		}
	}
};

/// Half-width 1: each cell and its linked cells, in order.
void takeLinkRows( const Lattice& lattice, RegionSet& regions )
{
	regions.member.reserve( lattice.linkTo.size() + lattice.fill.size() );
	for ( std::uint32_t cell = 0; cell < std::uint32_t( lattice.cellCount() ); ++cell )
	{
		const auto row = lattice.linkTo.begin() + lattice.linkStart[cell], end = lattice.linkTo.begin() + lattice.linkStart[cell + 1];
		const auto after = std::lower_bound( row, end, cell );
		regions.size[cell] = std::uint16_t( end - row + 1 );
		regions.member.insert( regions.member.end(), row, after );
		regions.member.push_back( cell );
		regions.member.insert( regions.member.end(), after, end );
	}
}

void searchRows( const Lattice& lattice, RegionSet& regions, TaskRunner* runner )
{
	const int tasks = ( lattice.cellCount() + kCellsPerTask - 1 ) / kCellsPerTask;
	SearchJob job{ &lattice, regions.halfWidth, std::vector<std::vector<std::uint32_t>>( tasks ), &regions.size };
	if ( runner )
	{
		runner->run( tasks, &SearchJob::run, &job );
	}
	else
	{
		for ( int task = 0; task < tasks; ++task )
		{
			SearchJob::run( &job, task );
		}
	}
	for ( auto& part : job.members )
	{
		regions.member.insert( regions.member.end(), part.begin(), part.end() );
		part = {};
	}
}

} // namespace

int countComponents( const Lattice& lattice )
{
	const int cells = int( lattice.linkStart.size() ) - 1;
	std::vector<char> seen( cells, 0 );
	std::vector<std::uint32_t> stack;
	int components = 0;
	for ( int first = 0; first < cells; ++first )
	{
		if ( seen[first] )
		{
			continue;
		}
		++components;
		seen[first] = 1;
		stack.assign( 1, std::uint32_t( first ) );
		while ( !stack.empty() )
		{
			const std::uint32_t cell = stack.back();
			stack.pop_back();
			for ( std::uint32_t k = lattice.linkStart[cell]; k < lattice.linkStart[cell + 1]; ++k )
			{
				if ( !seen[lattice.linkTo[k]] )
				{
					seen[lattice.linkTo[k]] = 1;
					stack.push_back( lattice.linkTo[k] );
				}
			}
		}
	}
	return components;
}

RegionSet buildRegions( const Lattice& lattice, int halfWidth, TaskRunner* runner )
{
	RegionSet regions;
	const int cells = lattice.cellCount();
	regions.halfWidth = halfWidth;
	regions.size.resize( cells );

	if ( halfWidth == 1 )
	{
		takeLinkRows( lattice, regions );
	}
	else
	{
		searchRows( lattice, regions, runner );
	}
	regions.start.resize( std::size_t( cells ) + 1, 0 );
	for ( int cell = 0; cell < cells; ++cell )
	{
		regions.start[cell + 1] = regions.start[cell] + regions.size[cell];
	}

	if ( halfWidth == 1 && hasSeparateNeighbours( lattice ) )
	{
		return regions;
	}
	const std::vector<std::uint32_t> cube = cubeCounts( lattice, halfWidth );
	regions.isFullCubes = !cube.empty() &&
		std::equal(
			cube.begin(), cube.end(), regions.size.begin(), regions.size.end(), []( std::uint32_t a, std::uint16_t b ) { return a == b; } );
	return regions;
}

} // namespace pliant
