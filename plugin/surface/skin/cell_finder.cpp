#include "surface/skin/cell_finder.h"

#include "surface/constants.h"

#include <algorithm>
#include <numeric>

namespace pliant {

namespace {

Grid gridOf( const Lattice& lattice )
{
	Grid grid;
	grid.cellSize = lattice.cellSize;
	grid.corner = lattice.corner;
	grid.extent = lattice.extent;
	return grid;
}

std::vector<std::uint64_t> keysOf( const Lattice& lattice, const Grid& grid )
{
	std::vector<std::uint64_t> keys;
	keys.reserve( lattice.coordinate.size() );
	for ( const auto& at : lattice.coordinate )
	{
		keys.push_back( grid.key( at.x(), at.y(), at.z() ) );
	}
	return keys;
}

} // namespace

CellTree::CellTree( const Lattice& lattice ) : m_lattice( lattice ), m_order( lattice.restCentre.size() )
{
	std::iota( m_order.begin(), m_order.end(), 0u );
	sort( 0, m_order.size(), 0 );
}

void CellTree::sort( std::size_t first, std::size_t last, int axis )
{
	if ( last - first < 2 )
	{
		return;
	}
	const std::size_t middle = ( first + last ) / 2;
	const auto at = [this]( std::size_t k ) { return m_order.begin() + std::ptrdiff_t( k ); };
	std::nth_element( at( first ), at( middle ), at( last ), [&]( std::uint32_t a, std::uint32_t b ) {
		const float p = m_lattice.restCentre[a][axis], q = m_lattice.restCentre[b][axis];
		return p < q || ( p == q && a < b );
	} );
	sort( first, middle, ( axis + 1 ) % 3 );
	sort( middle + 1, last, ( axis + 1 ) % 3 );
}

int CellTree::nearest( const Vec3d& point ) const
{
	Best best;
	search( 0, m_order.size(), 0, point - m_lattice.massCentre, best );
	return int( best.cell );
}

void CellTree::search( std::size_t first, std::size_t last, int axis, const Vec3d& point, Best& best ) const
{
	if ( first == last )
	{
		return;
	}
	const std::size_t middle = ( first + last ) / 2;
	const std::uint32_t cell = m_order[middle];
	const double distance = ( centre( cell ) - point ).squaredNorm();
	if ( distance < best.distance || ( distance == best.distance && cell < best.cell ) )
	{
		best = Best{ cell, distance };
	}
	const double across = point[axis] - centre( cell )[axis];
	const int next = ( axis + 1 ) % 3;
	search( across < 0.0 ? first : middle + 1, across < 0.0 ? middle : last, next, point, best );
	if ( across * across <= best.distance )
	{
		search( across < 0.0 ? middle + 1 : first, across < 0.0 ? last : middle, next, point, best );
	}
}

CellFinder::CellFinder( const Lattice& lattice ) :
	m_lattice( lattice ), m_grid( gridOf( lattice ) ), m_keys( keysOf( lattice, m_grid ) ), m_index( m_grid, m_keys ), m_tree( lattice )
{}

Eigen::Vector3i CellFinder::positionOf( const Vec3d& point ) const
{
	const Vec3d position = ( point - m_lattice.corner ) / double( m_lattice.cellSize );
	const Vec3d most = m_lattice.extent.cast<double>().array() + kFarOut;
	return position.cwiseMax( -kFarOut ).cwiseMin( most ).array().floor().cast<int>();
}

void CellFinder::cellsAround( const Eigen::Vector3i& position, std::vector<std::uint32_t>& cells ) const
{
	cells.clear();
	for ( int z = position.z() - 1; z <= position.z() + 1; ++z )
	{
		for ( int y = position.y() - 1; y <= position.y() + 1; ++y )
		{
			for ( int x = position.x() - 1; x <= position.x() + 1; ++x )
			{
				if ( !m_grid.holds( { x, y, z } ) )
				{
					continue;
				}
				const std::uint64_t key = m_grid.key( x, y, z );
				const std::int32_t found = m_index.find( key );
				for ( std::size_t i = std::size_t( found ); found >= 0 && i < m_keys.size() && m_keys[i] == key; ++i )
				{
					cells.push_back( std::uint32_t( i ) );
				}
			}
		}
	}
}

double CellFinder::inFront( int cell, const Vec3d& point, const Vec3d& outward ) const
{
	const Vec3d centre = m_lattice.restCentre[cell].cast<double>() + m_lattice.massCentre;
	return ( centre - point ).dot( outward ) / m_lattice.cellSize;
}

Vec3d CellFinder::fromMiddle( int cell, const Vec3d& point ) const
{
	return ( point - m_lattice.corner ) / double( m_lattice.cellSize ) - m_lattice.coordinate[cell].cast<double>() - Vec3d::Constant( 0.5 );
}

int CellFinder::owner( const Vec3d& point, const Vec3d& outward, const std::vector<std::uint32_t>& around ) const
{
	int best = -1;
	bool bestIsBehind = false;
	double bestDistance = 0.0;
	for ( const std::uint32_t cell : around )
	{
		const bool isBehind = inFront( int( cell ), point, outward ) <= kFrontSlack;
		const double distance = ( m_lattice.restCentre[cell].cast<double>() + m_lattice.massCentre - point ).squaredNorm();
		if ( best < 0 || isBehind > bestIsBehind || ( isBehind == bestIsBehind && distance < bestDistance ) )
		{
			best = int( cell );
			bestIsBehind = isBehind;
			bestDistance = distance;
		}
	}
	return best >= 0 ? best : m_tree.nearest( point );
}

} // namespace pliant
