#pragma once

// A lattice without a mesh.

#include "lattice/constants.h"
#include "lattice/lattice.h"

#include <cstdint>
#include <vector>

namespace pliant {

inline void linkBlock( Lattice& lattice )
{
	const Eigen::Vector3i n = lattice.extent;
	lattice.linkStart.push_back( 0 );
	for ( const auto& at : lattice.coordinate )
	{
		const Eigen::Vector3i low = ( at.cast<int>().array() - 1 ).max( 0 );
		const Eigen::Vector3i high = ( at.cast<int>().array() + 1 ).min( n.array() - 1 );
		for ( int z = low.z(); z <= high.z(); ++z )
		{
			for ( int y = low.y(); y <= high.y(); ++y )
			{
				for ( int x = low.x(); x <= high.x(); ++x )
				{
					if ( x != at.x() || y != at.y() || z != at.z() )
					{
						lattice.linkTo.push_back( std::uint32_t( ( z * n.y() + y ) * n.x() + x ) );
					}
				}
			}
		}
		lattice.linkStart.push_back( std::uint32_t( lattice.linkTo.size() ) );
		const std::uint32_t links = lattice.linkStart.back() - *( lattice.linkStart.end() - 2 );
		lattice.isSurface.push_back( links == kNeighbours ? 0 : 1 );
	}
}

/// Returns a full box of nx x ny x nz cells of edge `cellSize` with all links. Counts are at least 1.
inline Lattice makeBlockLattice( int nx, int ny, int nz, float cellSize )
{
	Lattice lattice;
	lattice.cellSize = cellSize;
	lattice.extent = Eigen::Vector3i( nx, ny, nz );
	lattice.corner = -0.5 * double( cellSize ) * lattice.extent.cast<double>();
	const std::size_t count = std::size_t( nx ) * std::size_t( ny ) * std::size_t( nz );
	lattice.coordinate.reserve( count );
	lattice.restCentre.reserve( count );
	for ( int z = 0; z < nz; ++z )
	{
		for ( int y = 0; y < ny; ++y )
		{
			for ( int x = 0; x < nx; ++x )
			{
				const Vec3d centre = Vec3d( x + 0.5, y + 0.5, z + 0.5 ) - 0.5 * lattice.extent.cast<double>();
				lattice.coordinate.emplace_back( std::int16_t( x ), std::int16_t( y ), std::int16_t( z ) );
				lattice.restCentre.push_back( ( double( cellSize ) * centre ).cast<float>() );
			}
		}
	}
	lattice.fill.assign( count, 1.0f );
	linkBlock( lattice );
	return lattice;
}

} // namespace pliant
