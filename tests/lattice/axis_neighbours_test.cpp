// Neighbours along the axes, compared with a search through all links of every cell.

#include "lattice/axis_neighbours.h"
#include "support/block_lattice.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace pliant {
namespace {

/// The linked cell one step away along an axis; -1: there is none.
int linkedAt( const Lattice& lattice, int cell, const Eigen::Vector3i& step )
{
	for ( int other = 0; other < lattice.cellCount(); ++other )
	{
		const bool isThere = lattice.coordinate[std::size_t( other )].cast<int>() ==
			lattice.coordinate[std::size_t( cell )].cast<int>() + step;
		const auto first = lattice.linkTo.begin() + lattice.linkStart[std::size_t( cell )],
				   last = lattice.linkTo.begin() + lattice.linkStart[std::size_t( cell ) + 1];
		if ( isThere && std::find( first, last, std::uint32_t( other ) ) != last )
		{
			return other;
		}
	}
	return -1;
}

void unlink( Lattice& lattice, std::uint32_t a, std::uint32_t b )
{
	for ( const auto& [from, to] : { std::pair( a, b ), std::pair( b, a ) } )
	{
		const auto first = lattice.linkTo.begin() + lattice.linkStart[from], last = lattice.linkTo.begin() + lattice.linkStart[from + 1];
		lattice.linkTo.erase( std::find( first, last, to ) );
		for ( std::size_t k = from + 1; k < lattice.linkStart.size(); ++k )
		{
			--lattice.linkStart[k];
		}
	}
}

// No neighbour across a cut link.
TEST( AxisNeighbours, AreThoseThatAreLinked )
{
	Lattice parted = makeBlockLattice( 4, 3, 3, 0.1f );
	unlink( parted, 17, 18 );
	for ( const Lattice& lattice :
		{ makeBlockLattice( 4, 3, 5, 0.1f ), makeBlockLattice( 4, 4, 1, 0.1f ), makeBlockLattice( 1, 1, 1, 0.1f ), parted } )
	{
		const AxisNeighbours beside = findAxisNeighbours( lattice );
		ASSERT_EQ( int( beside.size() ), lattice.cellCount() );
		for ( int cell = 0; cell < lattice.cellCount(); ++cell )
		{
			for ( int side = 0; side < 6; ++side )
			{
				const Eigen::Vector3i step = ( side % 2 == 0 ? -1 : 1 ) * Eigen::Vector3i::Unit( side / 2 );
				EXPECT_EQ( beside[std::size_t( cell )][std::size_t( side )], linkedAt( lattice, cell, step ) ) << cell << ", " << side;
			}
		}
	}
}

} // namespace
} // namespace pliant
