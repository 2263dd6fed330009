// Which cells may be asked about breaking: what is known from the last substep is what would be found now.

#include "fracture/cell_places.h"
#include "lattice/pieces.h"
#include "support/shapes.h"

#include <gtest/gtest.h>

#include <numeric>

namespace pliant {
namespace {

TEST( SettledCells, AreTheSameRememberedOrLookedAtAnew )
{
	std::mt19937 random( 3 );
	constexpr int kCoarse = 2;
	Lattice lattice = makeBlockLattice( 12, 8, 8, 0.05f );
	const Octree octree = buildOctree( lattice, kCoarse );
	std::vector<std::uint8_t> isSplit( octree.parent.size(), 0 );
	const auto cutNow = [&] { return selectCut( octree, [&]( std::uint32_t node ) { return isSplit[node] == 0; } ); };
	Cut cut = cutNow();
	std::vector<std::uint32_t> all( lattice.fill.size() );
	std::iota( all.begin(), all.end(), 0u );
	SettledCells kept;
	unsigned version = 0;
	int changed = 0;
	std::size_t fewest = all.size(), most = 0;
	std::vector<std::uint8_t> last;
	for ( int step = 0; step < 200; ++step )
	{
		if ( step % 23 == 5 ) // nodes are split, or merged again
		{
			for ( std::uint32_t node = octree.levelStart[1]; node < std::uint32_t( isSplit.size() ); ++node )
			{
				isSplit[node] = random() % 8 != 0;
			}
			cut = cutNow();
			++version;
		}
		if ( step % 31 == 17 ) // links go
		{
			std::vector<CellLink> gone;
			for ( std::uint32_t cell = 0; cell < std::uint32_t( lattice.cellCount() ); ++cell )
			{
				for ( std::uint32_t k = lattice.linkStart[cell]; k < lattice.linkStart[cell + 1]; ++k )
				{
					if ( lattice.linkTo[k] > cell && random() % 2 == 0 )
					{
						gone.push_back( CellLink{ cell, lattice.linkTo[k] } );
					}
				}
			}
			lattice = withoutLinks( lattice, gone );
			kept.forgetLinks();
		}
		SettledCells anew;
		anew.inherit( kept, all );
		const std::vector<std::uint8_t> wanted = anew.update( lattice, cut, version, kCoarse, 0.01f );
		const std::vector<std::uint8_t>& got = kept.update( lattice, cut, version, kCoarse, 0.01f );
		ASSERT_EQ( got, wanted ) << "step " << step;
		changed += got != last ? 1 : 0;
		last = got;
		const std::size_t count = std::size_t( std::count( got.begin(), got.end(), std::uint8_t( 1 ) ) );
		fewest = std::min( fewest, count );
		most = std::max( most, count );
	}
	EXPECT_GT( changed, 10 );
	EXPECT_GT( most, fewest + 100 );
}

} // namespace
} // namespace pliant
