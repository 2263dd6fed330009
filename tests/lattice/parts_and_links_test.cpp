// Several pieces of material in one lattice position, and links that the surface cuts.

#include "lattice_checks.h"

#include "lattice/region.h"

#include <map>

namespace pliant::test {

namespace {

/// Links between cells whose centres lie on different sides of x, both above y, in the mesh's coordinates.
int linksAcross( const Lattice& lattice, double x, double y )
{
	int count = 0;
	for ( int i = 0; i < lattice.cellCount(); ++i )
	{
		const Vec3d a = lattice.massCentre + lattice.restCentre[std::size_t( i )].cast<double>();
		for ( int j = i + 1; j < lattice.cellCount(); ++j )
		{
			const Vec3d b = lattice.massCentre + lattice.restCentre[std::size_t( j )].cast<double>();
			count += areLinked( lattice, i, j ) && ( a.x() < x ) != ( b.x() < x ) && a.y() > y && b.y() > y;
		}
	}
	return count;
}

/// A block with a slit from the top, made of three boxes that overlap, so that the union of shells is tested too.
Mesh makeSlitBlock( double from, double to )
{
	return joined(
		makeBox( { 0, 0, 0 }, { 4, 1, 1 } ), joined( makeBox( { 0, 0, 0 }, { from, 4, 1 } ), makeBox( { to, 0, 0 }, { 4, 4, 1 } ) ) );
}

TEST( Parts, TwoPlatesInOneCellAreTwoCells )
{
	const Mesh plates = joined( makeBox( { 0, 0, 0 }, { 4, 4, 0.3 } ), makeBox( { 0, 0, 0.6 }, { 4, 4, 0.9 } ) );
	const LatticeBuild build = built( plates, cellsOf( 1.0f ) );
	EXPECT_EQ( build.lattice.cellCount(), 32 );
	EXPECT_EQ( build.report.splitCells, 16 );
	EXPECT_EQ( build.report.components, 2 );
	EXPECT_EQ( build.lattice.extent, Eigen::Vector3i( 4, 4, 1 ) );
	for ( int i = 0; i < 32; i += 2 )
	{
		EXPECT_EQ( build.lattice.coordinate[std::size_t( i )], build.lattice.coordinate[std::size_t( i ) + 1] );
		EXPECT_FALSE( areLinked( build.lattice, i, i + 1 ) );
		EXPECT_GT( build.lattice.restCentre[std::size_t( i ) + 1].z() - build.lattice.restCentre[std::size_t( i )].z(), 0.4f );
	}
}

TEST( Parts, ASlitSeparatesWhereverItLies )
{
	// Between samples, on a sample, on the border of two cells; each far thinner than a cell.
	for ( const auto& [from, to] :
		std::map<double, double>{ { 1.83, 1.86 }, { 1.90, 1.95 }, { 1.99, 2.01 }, { 2.0, 2.02 }, { 2.2, 2.201 } } )
	{
		const LatticeBuild build = built( makeSlitBlock( from, to ), cellsOf( 0.5f ) );
		EXPECT_EQ( linksAcross( build.lattice, 0.5 * ( from + to ), 1.01 ), 0 ) << from;
		EXPECT_GT( linksAcross( build.lattice, 0.5 * ( from + to ), 0.0 ), 0 ) << from;
		EXPECT_EQ( build.report.components, 1 ) << from;
		EXPECT_GT( build.report.cutLinks, 0 ) << from;
	}
	// Checks the counting itself: without a slit there are links.
	const LatticeBuild whole = built( makeSlitBlock( 2.0, 2.0 ), cellsOf( 0.5f ) );
	EXPECT_GT( linksAcross( whole.lattice, 2.0, 1.01 ), 0 );
	EXPECT_EQ( whole.report.cutLinks, 0 );
	EXPECT_EQ( whole.report.splitCells, 0 );
}

TEST( Parts, FingersSideBySideStayApart )
{
	const Mesh fingers = joined( makeBox( { 0, 0, 0 }, { 1.98, 6, 2 } ), makeBox( { 2.02, 0, 0 }, { 4, 6, 2 } ) );
	const LatticeBuild build = built( fingers, cellsOf( 1.0f ) );
	EXPECT_EQ( build.lattice.cellCount(), 4 * 6 * 2 );
	EXPECT_EQ( build.report.splitCells, 0 );
	EXPECT_EQ( build.report.components, 2 );
	// Rotated in any direction, too.
	for ( const double angle : { 0.2, 0.5, 0.9, 1.4 } )
	{
		EXPECT_EQ( built( rotated( fingers, angle ), cellsOf( 1.0f ) ).report.components, 2 ) << angle;
	}
}

TEST( Parts, AGluedPairIsOneBody )
{
	// Both boxes draw the wall between them.
	const Mesh pair = joined( makeBox( { 0, 0, 0 }, { 2, 2, 2 } ), makeBox( { 2, 0, 0 }, { 4, 2, 2 } ) );
	const LatticeBuild build = built( pair, cellsOf( 0.5f ) );
	EXPECT_EQ( build.report.droppedTriangles, 4 );
	EXPECT_EQ( build.report.components, 1 );
	expectEqual( build.lattice, built( makeBox( { 0, 0, 0 }, { 4, 2, 2 } ), cellsOf( 0.5f ) ).lattice );
}

TEST( Parts, SolidBodiesOfAnyShapeAreOnePiece )
{
	for ( const Mesh& mesh :
		{ makeSphere( 1.0, 24, 48 ), makeTorus( 1.0, 0.3, 48, 24 ), makeGlob( 1.0, 20 ), makeBumpySphere( 1.0, 0.2, 60, 60 ) } )
	{
		for ( const float size : { 0.3f, 0.15f, 0.08f } )
		{
			const LatticeBuild build = built( rotated( mesh, 0.4 ), cellsOf( size ) );
			EXPECT_EQ( build.report.components, 1 ) << size;
			EXPECT_LT( build.report.cutLinks, build.lattice.linkCount() / 100 ) << size;
		}
	}
}

TEST( Links, BoxesTouchingAtACornerOnlyAreTwo )
{
	const Mesh pair = joined( makeBox( { 0, 0, 0 }, { 1, 1, 1 } ), makeBox( { 1, 1, 1 }, { 2, 2, 2 } ) );
	const LatticeBuild build = built( pair, cellsOf( 1.0f ) );
	EXPECT_EQ( build.lattice.cellCount(), 2 );
	EXPECT_EQ( build.report.components, 2 );
}

TEST( Links, ASlantedSheetHoldsTogether )
{
	for ( const double angle : { 0.3, 0.8, 1.3, 2.0 } )
	{
		const Mesh sheet = rotated( makeBox( { 0, 0, 0 }, { 4, 4, 0.15 } ), angle );
		EXPECT_EQ( built( sheet, cellsOf( 0.5f ) ).report.components, 1 ) << angle;
	}
}

} // namespace

} // namespace pliant::test
