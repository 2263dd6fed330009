// The surface as material: its cells, their masses and links, and solids that must stay as they are.

#include "lattice_checks.h"

#include "pliant/task_runner.h"
#include "support/block_lattice.h"

#include <cmath>

namespace pliant::test {

namespace {

Mesh unitSheet()
{
	Mesh mesh;
	mesh.addVertex( 0, 0, 0 );
	mesh.addVertex( 1, 0, 0 );
	mesh.addVertex( 1, 1, 0 );
	mesh.addVertex( 0, 1, 0 );
	mesh.addQuad( 0, 1, 2, 3 );
	return mesh;
}

LatticeSettings shellOf( float cellSize, Shell shell, float thickness = 0.0f )
{
	LatticeSettings settings = cellsOf( cellSize );
	settings.shell = shell;
	settings.shellThickness = thickness;
	return settings;
}

TEST( ShellCells, ASheetIsOneLayerOfFullCells )
{
	const LatticeBuild build = built( unitSheet(), cellsOf( 0.1f ) );
	const Lattice layer = makeBlockLattice( 10, 10, 1, 0.1f );
	EXPECT_EQ( build.lattice.coordinate, layer.coordinate );
	EXPECT_EQ( build.lattice.linkTo, layer.linkTo );
	EXPECT_EQ( build.report.shellCells, 100 );
	EXPECT_EQ( build.report.samplesPerEdge, 0 );
	EXPECT_NEAR( build.report.volume, 0.1, 0.004 );
	for ( const Vec3& centre : build.lattice.restCentre )
	{
		EXPECT_NEAR( centre.z(), 0.0f, 1e-6f );
	}
}

TEST( ShellCells, WeighAreaTimesThickness )
{
	EXPECT_NEAR( built( unitSheet(), shellOf( 0.1f, Shell::WhereNeeded, 0.02f ) ).report.volume, 0.02, 2e-4 );
	// The same rotated, except for corners that are raised to the least fill.
	EXPECT_NEAR( built( rotated( unitSheet(), 0.6 ), shellOf( 0.1f, Shell::WhereNeeded, 0.02f ) ).report.volume, 0.02, 0.002 );
	// 6 m^2, 1 cm thick.
	EXPECT_NEAR( built( makeBox( { 0, 0, 0 }, { 1, 1, 1 } ), shellOf( 0.07f, Shell::Always, 0.01f ) ).report.volume, 0.06, 0.003 );
	for ( const float fill : built( unitSheet(), shellOf( 0.1f, Shell::WhereNeeded, 1e-9f ) ).lattice.fill )
	{
		EXPECT_FLOAT_EQ( fill, 0.03f );
	}
}

TEST( ShellCells, ASlantedSheetHoldsTogetherInOneLayer )
{
	for ( const double angle : { 0.1, 0.3, 0.6, 1.1 } )
	{
		const LatticeBuild build = built( rotated( unitSheet(), angle ), cellsOf( 0.05f ) );
		EXPECT_EQ( build.report.components, 1 ) << angle;
		EXPECT_GE( build.lattice.cellCount(), 400 ) << angle;
		EXPECT_LE( build.lattice.cellCount(), 800 ) << angle; // two for each cell's face where it lies along a diagonal
	}
}

TEST( ShellCells, SheetsThatDoNotTouchStayApart )
{
	const Mesh sheet = makeBox( { 0, 0, 0 }, { 1, 1, 0 }, 20 ); // both sides drawn
	const LatticeBuild build = built( joined( sheet, moved( sheet, { 0, 0, 0.15 } ) ), cellsOf( 0.1f ) );
	EXPECT_EQ( build.report.components, 2 );
	EXPECT_EQ( build.report.shellCells, 200 );
}

/// Links between cells of full fill and others.
int linksAcross( const Lattice& lattice )
{
	int links = 0;
	for ( int i = 0; i < lattice.cellCount(); ++i )
	{
		for ( std::uint32_t k = lattice.linkStart[std::size_t( i )]; k < lattice.linkStart[std::size_t( i ) + 1]; ++k )
		{
			links += lattice.fill[std::size_t( i )] == 1.0f && lattice.fill[lattice.linkTo[k]] < 1.0f;
		}
	}
	return links;
}

TEST( ShellCells, AFinTooThinForCellsHangsOnItsBody )
{
	const Mesh cube = makeBox( { 0, 0, 0 }, { 1, 1, 1 } );
	const Mesh fin = makeBox( { 0.95, 0.21, 0.549 }, { 2, 0.79, 0.5495 } );
	LatticeSettings settings = cellsOf( 0.1f );
	settings.shell = Shell::Never;
	const LatticeBuild bare = built( joined( cube, fin ), settings );
	EXPECT_EQ( bare.lattice.cellCount(), 1000 );
	settings.shell = Shell::WhereNeeded;
	const LatticeBuild build = built( joined( cube, fin ), settings );
	EXPECT_EQ( build.report.components, 1 );
	EXPECT_EQ( build.report.shellCells, build.lattice.cellCount() - 1000 );
	EXPECT_EQ( build.report.shellCells, 60 ); // 10 along, 6 across
	EXPECT_GE( linksAcross( build.lattice ), 6 );
	EXPECT_NEAR( build.report.volume, 1.0, 0.005 ); // a fin as thin as paper has little mass
	// The body's own cells and links are unchanged.
	EXPECT_EQ( std::count( build.lattice.fill.begin(), build.lattice.fill.end(), 1.0f ), 1000 );
}

TEST( ShellCells, SolidsAreLeftAlone )
{
	for ( const Mesh& mesh : { makeBox( { 0, 0, 0 }, { 1, 2, 3 }, 4 ), makeSphere( 1.0, 32, 64 ), makeTorus( 1.0, 0.3, 64, 32 ),
			  makeGlob( 1.0, 20 ), makeBumpySphere( 1.0, 0.2, 60, 60 ) } )
	{
		for ( const int cells : { 50, 800, 3000 } )
		{
			LatticeSettings settings;
			settings.targetCells = cells;
			const LatticeBuild needed = built( mesh, settings );
			settings.shell = Shell::Never;
			expectEqual( needed.lattice, built( mesh, settings ).lattice );
			EXPECT_EQ( needed.report.shellCells, 0 );
		}
	}
}

TEST( ShellCells, TargetIsMetAboutly )
{
	for ( const Mesh& mesh :
		{ unitSheet(), rotated( unitSheet(), 0.6 ), rotated( makeBox( { 0, 0, 0 }, { 1, 0.02, 0 } ), 0.4 ), makeSphere( 1.0, 32, 64 ) } )
	{
		for ( const int target : { 50, 1000, 8000 } )
		{
			LatticeSettings settings;
			settings.targetCells = target;
			settings.shell = Shell::Always;
			EXPECT_NEAR( built( mesh, settings ).lattice.cellCount(), target, 0.3 * target );
		}
	}
}

TEST( ShellCells, ThreadsChangeNothing )
{
	const Mesh mesh = joined( makeSphere( 1.0, 24, 48 ), rotated( unitSheet(), 0.6 ) );
	const Lattice alone = built( mesh, cellsOf( 0.08f ) ).lattice;
	const std::unique_ptr<TaskRunner> pool = createThreadPool( 4 );
	LatticeSettings settings = cellsOf( 0.08f );
	settings.runner = pool.get();
	expectEqual( alone, built( mesh, settings ).lattice );
}

// A sphere of 10 000 triangles without a tenth of them was refused as "too many triangles", although its inside can be found in a fraction
// of a second.
TEST( ShellCells, ManyHolesAreNoReasonToRefuse )
{
	const Mesh hull = without( makeSphere( 0.5, 50, 102 ), []( std::size_t t ) { return t % 10 == 3; } );
	LatticeSettings settings;
	settings.targetCells = 800;
	const LatticeBuild build = built( hull, settings );
	EXPECT_NEAR( build.report.volume, 0.52, 0.05 );
	EXPECT_GT( build.report.samplesPerEdge, 1 );
	EXPECT_EQ( build.report.components, 1 );
}

// The sentences give the true reason: neither mesh has too many triangles. Both name the setting.
TEST( ShellCells, RefusalsNameTheirCause )
{
	LatticeSettings settings;
	settings.shell = Shell::Never;
	const Result<LatticeBuild> sheet = buildLattice( unitSheet().view(), settings );
	EXPECT_EQ( sheet.status.code, ResultCode::ZeroVolume );
	EXPECT_NE( sheet.status.sentence.find( "LatticeSettings::shell" ), std::string::npos );
	Mesh line = unitSheet();
	line.positions = { 0, 0, 0, 1, 0, 0, 2, 0, 0, 3, 0, 0 };
	settings.shell = Shell::WhereNeeded;
	EXPECT_EQ( buildLattice( line.view(), settings ).status.sentence, "No triangle of the mesh has an area." );
}

} // namespace

} // namespace pliant::test
