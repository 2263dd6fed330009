// A block is complete and fully linked; validate() detects each violated invariant.

#include "lattice/lattice.h"
#include "support/block_lattice.h"

#include <gtest/gtest.h>

#include <functional>

namespace pliant {

namespace {

TEST( BlockLattice, HasEveryCellAndLink )
{
	const Lattice block = makeBlockLattice( 4, 3, 2, 0.5f );
	ASSERT_TRUE( validate( block ).ok() ) << validate( block ).sentence;
	EXPECT_EQ( block.cellCount(), 24 );
	// Along an axis with n cells: 3n - 2 ordered pairs, including each cell with itself; the product minus the cells themselves, halved.
	EXPECT_EQ( block.linkCount(), ( ( 3 * 4 - 2 ) * ( 3 * 3 - 2 ) * ( 3 * 2 - 2 ) - 24 ) / 2 );
	EXPECT_EQ( block.massCentre, Vec3d::Zero() );
	EXPECT_EQ( block.restCentre.front(), Vec3( -0.75f, -0.5f, -0.25f ) );
}

TEST( BlockLattice, OnlyInnerCellsAreNotSurface )
{
	const Lattice block = makeBlockLattice( 5, 5, 5, 1.0f );
	int inner = 0;
	for ( int i = 0; i < block.cellCount(); ++i )
	{
		inner += block.isSurface[std::size_t( i )] == 0;
	}
	EXPECT_EQ( inner, 27 );
}

TEST( BlockLattice, OneCellStandsAlone )
{
	const Lattice block = makeBlockLattice( 1, 1, 1, 2.0f );
	EXPECT_TRUE( validate( block ).ok() );
	EXPECT_EQ( block.linkCount(), 0 );
}

TEST( LatticeLaws, EachBrokenLawIsSeen )
{
	using Break = std::function<void( Lattice& )>;
	const std::vector<std::pair<const char*, Break>> breaks = {
		{ "missing fill", []( Lattice& l ) { l.fill.pop_back(); } },
		{ "short linkStart", []( Lattice& l ) { l.linkStart.pop_back(); } },
		{ "zero cell size", []( Lattice& l ) { l.cellSize = 0.0f; } },
		{ "NaN corner", []( Lattice& l ) { l.corner.x() = std::nan( "" ); } },
		{ "extent too small", []( Lattice& l ) { l.extent.x() = 2; } },
		{ "order", []( Lattice& l ) { std::swap( l.coordinate[0], l.coordinate[1] ); } },
		{ "overfull", []( Lattice& l ) { l.fill[3] = 1.5f; } },
		{ "NaN fill", []( Lattice& l ) { l.fill[3] = std::nanf( "" ); } },
		{ "centre outside its cell", []( Lattice& l ) { l.restCentre[0].x() -= 1.0f; } },
		{ "mass centre", []( Lattice& l ) { l.restCentre[0].x() += 0.2f; } },
		{ "link to itself", []( Lattice& l ) { l.linkTo[0] = 0; } },
		{ "link to nowhere", []( Lattice& l ) { l.linkTo[0] = 1000; } },
		{ "links out of order", []( Lattice& l ) { std::swap( l.linkTo[0], l.linkTo[1] ); } },
		{ "one-way link",
			[]( Lattice& l ) {
				l.linkTo.erase( l.linkTo.begin() );
				for ( std::size_t i = 1; i < l.linkStart.size(); ++i )
				{
					--l.linkStart[i];
				}
			} },
		{ "surface mark", []( Lattice& l ) { l.isSurface[13] = 1; } },
	};
	for ( const auto& [name, breakLaw] : breaks )
	{
		Lattice lattice = makeBlockLattice( 3, 3, 3, 1.0f );
		ASSERT_TRUE( validate( lattice ).ok() );
		breakLaw( lattice );
		EXPECT_FALSE( validate( lattice ).ok() ) << name;
		EXPECT_FALSE( validate( lattice ).sentence.empty() ) << name;
	}
}

TEST( ResultCodes, EveryCodeHasItsName )
{
	EXPECT_STREQ( toString( ResultCode::Ok ), "Ok" );
	EXPECT_STREQ( toString( ResultCode::TooManyCells ), "TooManyCells" );
	EXPECT_STREQ( toString( ResultCode::TooFolded ), "TooFolded" );
	EXPECT_STREQ( toString( ResultCode( 12345 ) ), "unknown" );
	for ( int code = 0; code <= int( ResultCode::BadSnapshot ); ++code )
	{
		EXPECT_STRNE( toString( ResultCode( code ) ), "unknown" ) << code;
	}
}

} // namespace

} // namespace pliant
