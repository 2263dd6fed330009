#include "lattice/pieces.h"

#include "lattice/constants.h"
#include "lattice/table.h"
#include "lattice/union_find.h"

#include <algorithm>

namespace pliant {

namespace {

/// Returns both directions of every link in the order of the rows, by counting sort. `links` ascend, so that the links to a cell from lower
/// cells are in order and precede the links from it.
std::vector<CellLink> bothDirections( const std::vector<CellLink>& links, std::size_t cells )
{
	std::vector<std::uint32_t> start;
	std::vector<CellLink> both;
	const auto forBoth = [&links]( auto&& visit ) {
		for ( const CellLink& link : links )
		{
			visit( link.b, CellLink{ link.b, link.a } );
		}
		for ( const CellLink& link : links )
		{
			visit( link.a, link );
		}
	};
	sortIntoRows( cells, forBoth, start, both );
	return both;
}

bool isSurfaceCell( const Lattice& lattice, std::size_t cell )
{
	return lattice.fill[cell] < 1.0f || lattice.linkStart[cell + 1] - lattice.linkStart[cell] != kNeighbours;
}

} // namespace

Lattice withoutLinks( const Lattice& lattice, const std::vector<CellLink>& links )
{
	const std::vector<CellLink> removed = bothDirections( links, lattice.fill.size() );
	Lattice result = lattice;
	auto next = removed.begin();
	std::uint32_t kept = 0;
	const std::uint32_t cells = std::uint32_t( lattice.cellCount() );
	for ( std::uint32_t i = 0; i < cells; ++i )
	{
		// Copies the rows without losses up to the next row with one.
		const std::uint32_t end = next == removed.end() ? cells : next->a, first = lattice.linkStart[i], lost = first - kept;
		std::copy( lattice.linkTo.begin() + first, lattice.linkTo.begin() + lattice.linkStart[end], result.linkTo.begin() + kept );
		kept += lattice.linkStart[end] - first;
		for ( ; i < end; ++i )
		{
			result.linkStart[i] -= lost;
		}
		if ( i == cells )
		{
			break;
		}
		result.linkStart[i] = kept;
		for ( std::uint32_t k = lattice.linkStart[i]; k < lattice.linkStart[i + 1]; ++k )
		{
			if ( next != removed.end() && next->a == i && next->b == lattice.linkTo[k] )
			{
				++next;
				continue;
			}
			result.linkTo[kept++] = lattice.linkTo[k];
		}
	}
	result.linkStart.back() = kept;
	result.linkTo.resize( kept );
	for ( const CellLink& link : removed )
	{
		result.isSurface[link.a] = 1;
	}
	return result;
}

Lattice withLinks( const Lattice& lattice, const std::vector<CellLink>& links )
{
	const std::vector<CellLink> added = bothDirections( links, lattice.fill.size() );
	Lattice result = lattice;
	result.linkTo.clear();
	result.linkTo.reserve( lattice.linkTo.size() + added.size() );
	auto next = added.begin();
	for ( std::uint32_t i = 0; i < std::uint32_t( lattice.cellCount() ); ++i )
	{
		result.linkStart[i] = std::uint32_t( result.linkTo.size() );
		std::uint32_t k = lattice.linkStart[i];
		for ( ; next != added.end() && next->a == i; ++next )
		{
			for ( ; k < lattice.linkStart[i + 1] && lattice.linkTo[k] < next->b; ++k )
			{
				result.linkTo.push_back( lattice.linkTo[k] );
			}
			result.linkTo.push_back( next->b );
		}
		result.linkTo.insert( result.linkTo.end(), lattice.linkTo.begin() + k, lattice.linkTo.begin() + lattice.linkStart[i + 1] );
	}
	result.linkStart.back() = std::uint32_t( result.linkTo.size() );
	for ( const CellLink& link : added )
	{
		result.isSurface[link.a] = isSurfaceCell( result, link.a ) ? 1 : 0;
	}
	return result;
}

// Rows store both directions: each cell considers only lower neighbours.
std::vector<std::vector<std::uint32_t>> connectedParts( const Lattice& lattice )
{
	const std::uint32_t count = std::uint32_t( lattice.cellCount() );
	UnionFind sets( count );
	for ( std::uint32_t i = 0; i < count; ++i )
	{
		std::uint32_t own = i;
		for ( std::uint32_t k = lattice.linkStart[i]; k < lattice.linkStart[i + 1] && lattice.linkTo[k] < i; ++k )
		{
			if ( const std::uint32_t other = sets.find( lattice.linkTo[k] ); other != own )
			{
				sets.join( own, other );
				own = std::min( own, other );
			}
		}
	}
	std::vector<std::size_t> partOf( count, count ); // of each set, by its number
	std::vector<std::vector<std::uint32_t>> cells;
	for ( std::uint32_t i = 0; i < count; ++i )
	{
		std::size_t& part = partOf[sets.find( i )];
		if ( part == count )
		{
			part = cells.size();
			cells.emplace_back();
		}
		cells[part].push_back( i );
	}
	return cells;
}

Lattice extractCells( const Lattice& lattice, const std::vector<std::uint32_t>& cells )
{
	std::vector<std::uint32_t> numberOf( lattice.fill.size(), 0 );
	double mass = 0.0;
	Vec3d centre = Vec3d::Zero();
	std::size_t links = 0;
	for ( std::size_t i = 0; i < cells.size(); ++i )
	{
		links += lattice.linkStart[cells[i] + 1] - lattice.linkStart[cells[i]];
		numberOf[cells[i]] = std::uint32_t( i );
		mass += lattice.fill[cells[i]];
		centre += double( lattice.fill[cells[i]] ) * lattice.restCentre[cells[i]].cast<double>();
	}
	centre /= mass;

	Lattice part;
	part.cellSize = lattice.cellSize;
	part.corner = lattice.corner;
	part.massCentre = lattice.massCentre + centre;
	part.extent = lattice.extent;
	part.overhang = lattice.overhang;
	part.coordinate.reserve( cells.size() );
	part.fill.reserve( cells.size() );
	part.restCentre.reserve( cells.size() );
	part.isSurface.reserve( cells.size() );
	part.patch.reserve( lattice.patch.empty() ? 0 : cells.size() );
	part.edgeFaceStart.assign( lattice.patch.empty() ? 0 : 1, 0 );
	part.linkTo.reserve( links );
	part.linkStart.reserve( cells.size() + 1 );
	part.linkStart.push_back( 0 );
	for ( const std::uint32_t cell : cells )
	{
		part.coordinate.push_back( lattice.coordinate[cell] );
		part.fill.push_back( lattice.fill[cell] );
		part.restCentre.push_back( ( lattice.restCentre[cell].cast<double>() - centre ).cast<float>() );
		part.isSurface.push_back( lattice.isSurface[cell] );
		if ( !lattice.patch.empty() )
		{
			part.patch.push_back( lattice.patch[cell] );
			part.edgeFace.insert( part.edgeFace.end(), lattice.edgeFace.begin() + lattice.edgeFaceStart[cell],
				lattice.edgeFace.begin() + lattice.edgeFaceStart[cell + 1] );
			part.edgeFaceStart.push_back( std::uint32_t( part.edgeFace.size() ) );
		}
		for ( std::uint32_t k = lattice.linkStart[cell]; k < lattice.linkStart[cell + 1]; ++k )
		{
			part.linkTo.push_back( numberOf[lattice.linkTo[k]] );
		}
		part.linkStart.push_back( std::uint32_t( part.linkTo.size() ) );
	}
	return part;
}

} // namespace pliant
