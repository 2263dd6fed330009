// Bodies drawn from their family's cracks, compared with the definition of their drawing.

#include "surface/torn_family.h"

#include "surface/skin/rows_of_cells.h"
#include "threads/parallel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

namespace pliant {
namespace {

using namespace test;

class Families : public testing::TestWithParam<float>
{};

TEST_P( Families, EachBodyShowsWhatItWouldByItself )
{
	const CrackCase it( makeSphere( 1.0, 16, 24 ), 0.3, noisy( GetParam() ) );
	Torn torn( it );
	CrackView view;
	int bodies = 0;
	for ( const auto& [fraction, pieces] :
		{ std::pair( 0.02, 1 ), std::pair( 0.05, 4 ), std::pair( 0.0, 1 ), std::pair( 0.3, 6 ), std::pair( 0.9, 2 ) } )
	{
		torn.tear( fraction, pieces, unsigned( 7 + bodies ) );
		for ( const auto& cells : connectedParts( torn.lattice ) )
		{
			torn.family->show( cells, Vec3::Zero(), view );
			EXPECT_EQ( drawingOf( view ), torn.drawingByDefinition( cells ) );
			++bodies;
		}
		torn.expectValid();
	}
	EXPECT_GT( bodies, 50 );
}

/// Where no two triangles share a vertex, each draws its cuts with vertices of its own.
TEST_P( Families, SeamsAreWhatTheyWouldBeByThemselves )
{
	const CrackCase it( unwelded( makeSphere( 1.0, 16, 24 ) ), 0.3, noisy( GetParam() ) );
	Torn torn( it );
	CrackView view;
	for ( unsigned round = 1; round < 3; ++round )
	{
		torn.tear( 0.02, 3, round );
		for ( const auto& cells : connectedParts( torn.lattice ) )
		{
			torn.family->show( cells, Vec3::Zero(), view );
			EXPECT_EQ( drawingOf( view ), torn.drawingByDefinition( cells ) );
		}
		torn.expectValid();
	}
}

TEST_P( Families, AWholeThatBreaksLittleAndMuchShowsWhatItWouldByItself )
{
	const CrackCase it( makeSphere( 1.0, 16, 24 ), 0.3, noisy( GetParam() ) );
	Torn torn( it );
	const std::vector<std::uint32_t> all = connectedParts( torn.lattice )[0];
	CrackView view;
	for ( const double fraction : { 0.01, 0.2, 0.01, 0.1 } )
	{
		torn.tear( fraction, 1, unsigned( 1000.0 * fraction ) );
		ASSERT_EQ( connectedParts( torn.lattice ).size(), 1u );
		torn.family->show( all, Vec3::Zero(), view );
		EXPECT_EQ( drawingOf( view ), torn.drawingByDefinition( all ) );
		torn.expectValid();
	}
}

TEST_P( Families, PlacesAreSeenFromTheBodysOwnCentre )
{
	const CrackCase it( makeSphere( 1.0, 16, 24 ), 0.3, noisy( GetParam() ) );
	Torn torn( it );
	torn.tear( 0.0, 3, 5 );
	const std::vector<std::uint32_t> cells = connectedParts( torn.lattice )[0];
	const Vec3 shift( 0.25f, -0.5f, 1.0f );
	CrackView here, there;
	torn.family->show( cells, Vec3::Zero(), here );
	torn.family->show( cells, shift, there );
	ASSERT_EQ( here.binding.restPosition.size(), there.binding.restPosition.size() );
	for ( std::size_t v = 0; v < here.binding.restPosition.size(); ++v )
	{
		EXPECT_EQ( there.binding.restPosition[v], here.binding.restPosition[v] - shift );
	}
}

/// Crumbs stay attached by faces without links as long as linked faces connect them by another path.
TEST_P( Families, FacesWithoutLinksGoWithThoseThatHeldThem )
{
	const CrackCase it( makeBumpySphere( 1.0, 0.3, 24, 36 ), 0.21, noisy( GetParam() ) );
	Torn torn( it );
	EXPECT_GT( it.complex->heldByFace.entry.size(), 0u );
	CrackView view;
	for ( unsigned round = 1; round < 4; ++round )
	{
		torn.tear( 0.15, 3, round );
		for ( const auto& cells : connectedParts( torn.lattice ) )
		{
			torn.family->show( cells, Vec3::Zero(), view );
			EXPECT_EQ( drawingOf( view ), torn.drawingByDefinition( cells ) );
		}
		torn.expectValid();
	}
}

TEST_P( Families, SeveralThreadsShowWhatOneDoes )
{
	const CrackCase it( makeSphere( 1.0, 16, 24 ), 0.3, noisy( GetParam() ) );
	const std::unique_ptr<TaskRunner> runner = createThreadPool( 3 );
	Torn one( it ), several( it );
	for ( unsigned round = 1; round < 4; ++round )
	{
		one.tear( 0.1, 4, round );
		several.tear( 0.1, 4, round );
		const auto parts = connectedParts( one.lattice );
		std::vector<CrackView> views( parts.size() );
		several.family->catchUp( runner.get() );
		EXPECT_FALSE( several.family->hasNews() );
		auto show = [&]( int k ) { several.family->show( parts[std::size_t( k )], Vec3::Zero(), views[std::size_t( k )] ); };
		runTasks( runner.get(), int( parts.size() ), show );
		for ( std::size_t k = 0; k < parts.size(); ++k )
		{
			CrackView alone;
			one.family->show( parts[k], Vec3::Zero(), alone );
			EXPECT_EQ( views[k].triangles, alone.triangles );
			EXPECT_EQ( drawingOf( views[k] ), drawingOf( alone ) );
		}
		several.expectValid();
	}
}

/// The inside of a large body is numbered in parallel with its outer surface, and the output is divided among threads: every array equals
/// that of one thread.
TEST_P( Families, ABodySharedOutIsWhatOneThreadMakes )
{
	const CrackCase it( makeSphere( 1.0, 24, 36 ), 0.16, noisy( GetParam() ) );
	const std::unique_ptr<TaskRunner> runner = createThreadPool( 3 );
	Torn one( it ), several( it );
	std::size_t most = 0, placed = 0, spared = 0;
	CrackView shared; // keeps its previous contents as long as possible
	for ( unsigned round = 1; round < 3; ++round )
	{
		one.tear( 0.12, 4, round );
		several.tear( 0.12, 4, round );
		for ( const std::vector<std::uint32_t>& part : connectedParts( one.lattice ) )
		{
			CrackView alone;
			one.family->show( part, Vec3( 0.1f, 0.2f, 0.3f ), alone );
			several.family->show( part, Vec3( 0.1f, 0.2f, 0.3f ), shared, runner.get() );
			const SkinBinding &a = alone.binding, &b = shared.binding;
			ASSERT_EQ( alone.triangles, shared.triangles );
			EXPECT_EQ( alone.sources, shared.sources );
			EXPECT_EQ( alone.texture, shared.texture );
			EXPECT_EQ( a.start, b.start );
			EXPECT_EQ( a.node, b.node );
			EXPECT_EQ( a.weight, b.weight );
			EXPECT_EQ( a.restPosition, b.restPosition );
			EXPECT_EQ( a.restNormal, b.restNormal );
			EXPECT_EQ( a.normalShift, b.normalShift );
			EXPECT_EQ( a.normalGroup, b.normalGroup );
			EXPECT_EQ( a.normalGroups, b.normalGroups );
			EXPECT_EQ( a.carrier, b.carrier );
			EXPECT_EQ( a.point, b.point );
			EXPECT_EQ( a.placed, b.placed );
			EXPECT_EQ( a.blended, b.blended );
			EXPECT_EQ( a.shading, b.shading );
			EXPECT_EQ( a.shadedTriangles, b.shadedTriangles );
			placed += a.placed.size();
			const std::set<std::uint32_t> drawn( a.point.begin(), a.point.end() );
			for ( const std::uint32_t cell : part )
			{
				for ( const TrianglePoints& p : trianglesOfCell( *it.complex, cell ) )
				{
					spared += it.complex->panels.isSpared[p[0]] != 0 && drawn.count( p[0] ) == 0 ? 1 : 0;
				}
			}
			most = std::max( most, a.restPosition.size() );
		}
		several.expectValid();
	}
	EXPECT_GT( most, 2048u ); // several shares
	EXPECT_GT( placed, 100u );
	EXPECT_GT( spared, 100u );
}

/// Rows found by the points of the cells that they follow: none is missed, and most others are skipped.
void expectRowsAreFound( const SkinBinding& binding, const CellComplex& complex, const std::vector<std::uint32_t>& cells,
	std::mt19937& random, int& asked, int& held )
{
	std::vector<char> isWanted( cells.size(), 0 );
	for ( int k = 0; k < 3; ++k )
	{
		isWanted[random() % cells.size()] = 1;
	}
	const std::vector<char> holds = rowsThatHold( binding, isWanted ), isNear = rowsAtPointsOf( binding, isWanted, complex, cells );
	ASSERT_EQ( holds.size(), isNear.size() );
	int missed = 0;
	for ( std::size_t row = 0; row < holds.size(); ++row )
	{
		missed += holds[row] != 0 && isNear[row] == 0 ? 1 : 0;
		held += holds[row];
		asked += isNear[row];
	}
	EXPECT_EQ( missed, 0 );
}

TEST_P( Families, RowsThatFollowCellsAreFoundByTheirPoints )
{
	const CrackCase it( makeSphere( 1.0, 16, 24 ), 0.2, noisy( GetParam() ) );
	Torn torn( it );
	std::mt19937 random( 5 );
	int asked = 0, held = 0;
	for ( unsigned round = 1; round < 9; ++round )
	{
		torn.tear( round == 1 ? 0.01 : 0.1, round < 3 ? 1 : 3, round );
		for ( const std::vector<std::uint32_t>& part : connectedParts( torn.lattice ) )
		{
			CrackView view;
			torn.family->show( part, Vec3::Zero(), view );
			expectRowsAreFound( view.binding, *it.complex, part, random, asked, held );
		}
	}
	EXPECT_GT( held, 2000 );
	EXPECT_LT( asked, 2 * held );
}

TEST_P( Families, PreparedTheyAreDrawnTheSame )
{
	const CrackCase it( makeSphere( 1.0, 16, 24 ), 0.3, noisy( GetParam() ) );
	Torn cracked( it ), prepared( it );
	prepared.family->prepare();
	CrackView view, twin;
	for ( unsigned round = 1; round < 4; ++round )
	{
		for ( Torn* const torn : { &cracked, &prepared } )
		{
			torn->tear( 0.02, round < 3 ? 1 : 3, round );
			torn->family->show( connectedParts( torn->lattice )[0], Vec3::Zero(), torn == &cracked ? view : twin );
			torn->expectValid();
		}
		EXPECT_EQ( drawingOf( view ), drawingOf( twin ) );
		prepared.family->prepare(); // changes nothing any more
	}
}

// A body that is thin aslant: some corners have carriers that no chain of faces connects to their cells. Such a side keeps them until its
// first change. In checked builds a bunny that tore was refused.
TEST_P( Families, SidesFarFromACrackKeepUnconnectedCarriers )
{
	for ( const double cell : { 0.21, 0.3, 0.37 } )
	{
		const CrackCase it( makeBumpySphere( 1.0, 0.5, 24, 36 ), cell, noisy( GetParam() ) );
		Torn torn( it );
		torn.tear( 0.0, 2, 3 );
		CrackView view;
		for ( const auto& cells : connectedParts( torn.lattice ) )
		{
			torn.family->show( cells, Vec3::Zero(), view );
			EXPECT_EQ( drawingOf( view ), torn.drawingByDefinition( cells ) );
		}
		torn.expectValid();
	}
}

INSTANTIATE_TEST_SUITE_P( Noise, Families, testing::Values( 0.0f, 0.3f ) );

} // namespace
} // namespace pliant
