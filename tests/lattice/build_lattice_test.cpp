// Volumes, centres, and invariance: position and orientation of the mesh, order of its triangles, number of threads.

#include "lattice_checks.h"

#include "lattice/inside/grid.h"
#include "lattice/region.h"
#include "pliant/task_runner.h"
#include "support/block_lattice.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

namespace pliant::test {

namespace {

// The first sample above a position, in whole quanta for corners and as a real number for others; the reference implementation counts.
TEST( Grid, FirstSampleAboveAWholeQuantumIsThatOfAnyPlace )
{
	std::mt19937 random( 5 );
	for ( int samples = 1; samples <= 8; ++samples )
	{
		Grid grid;
		ASSERT_TRUE( makeGrid( Vec3d( 0, 0, 0 ), Vec3d( 1.0, 0.3, 7.2 ), 0.1, samples, grid ) );
		for ( int axis = 0; axis < 3; ++axis )
		{
			const std::int64_t end = std::int64_t( grid.extent[axis] ) << grid.bits;
			std::vector<std::int64_t> positions = { -end, -1, 0, 1, end - 1, end, end + 1, 2 * end };
			for ( int k = 0; k < 200; ++k )
			{
				positions.push_back( std::int64_t( random() ) % ( end + 1 ) );
				const std::int64_t sample = grid.sampleAt( int( random() % unsigned( grid.sampleCount( axis ) ) ) );
				positions.insert( positions.end(), { sample - 1, sample, sample + 1 } );
			}
			for ( const std::int64_t place : positions )
			{
				EXPECT_EQ( grid.firstAbove( axis, place ), grid.firstAbove( axis, double( place ) ) )
					<< samples << " samples, at " << place << " of " << end;
				int below = 0;
				while ( below < grid.sampleCount( axis ) && grid.sampleAt( below ) <= place )
				{
					++below;
				}
				EXPECT_EQ( grid.firstAbove( axis, place ), below ) << samples << " samples, at " << place << " of " << end;
				EXPECT_EQ( grid.firstAbove( axis, double( place ) + 0.5 ), below );
			}
		}
	}
}

TEST( Build, CubeBecomesTheFullBlock )
{
	for ( const Mesh& cube : { makeBox( { 0, 0, 0 }, { 1, 1, 1 } ), makeBox( { 0, 0, 0 }, { 1, 1, 1 }, 10 ) } )
	{
		const LatticeBuild build = built( cube, cellsOf( 0.1f ) );
		const Lattice block = makeBlockLattice( 10, 10, 10, 0.1f );
		EXPECT_EQ( build.lattice.coordinate, block.coordinate );
		EXPECT_EQ( build.lattice.fill, block.fill );
		EXPECT_EQ( build.lattice.linkTo, block.linkTo );
		EXPECT_EQ( build.lattice.isSurface, block.isSurface );
		EXPECT_NEAR( ( build.lattice.massCentre - Vec3d( 0.5, 0.5, 0.5 ) ).norm(), 0.0, 1e-7 );
		EXPECT_NEAR( build.report.volume, 1.0, 1e-6 );
		EXPECT_EQ( build.report.cutLinks, 0 );
		EXPECT_EQ( build.report.components, 1 );
	}
}

TEST( Build, PartlyFilledCellsCarryTheirFractionAndCentre )
{
	// Half a cell projects on each side of two whole ones: samples at 1/8, 3/8, 5/8, 7/8 of a cell give exactly one half.
	const LatticeBuild build = built( makeBox( { 0, 0, 0 }, { 3, 1, 1 } ), cellsOf( 1.0f ) );
	EXPECT_EQ( build.lattice.cellCount(), 3 );
	const LatticeBuild half = built( makeBox( { 0, 0, 0 }, { 2.5, 1, 1 } ), cellsOf( 1.0f ) );
	ASSERT_EQ( half.lattice.cellCount(), 3 );
	EXPECT_EQ( half.lattice.fill[0], 0.75f );
	EXPECT_EQ( half.lattice.fill[1], 1.0f );
	EXPECT_EQ( half.lattice.fill[2], 0.75f );
	EXPECT_FLOAT_EQ( half.lattice.restCentre[2].x(), 0.875f );
	EXPECT_NEAR( half.lattice.massCentre.x(), 1.25, 1e-12 );
}

double volumeError( const Mesh& mesh, float d )
{
	return std::abs( built( mesh, cellsOf( d ) ).report.volume / volumeOf( mesh ) - 1.0 );
}

TEST( Build, VolumeConverges )
{
	for ( const Mesh& mesh :
		{ makeSphere( 1.0, 32, 64 ), makeTorus( 1.0, 0.3, 64, 32 ), makeGlob( 1.0, 24 ), rotated( makeBeam( 4.0, 1.0, 8 ), 0.7 ) } )
	{
		EXPECT_LT( volumeError( mesh, 0.2f ), 0.03 );
		EXPECT_LT( volumeError( mesh, 0.1f ), 0.01 );
		EXPECT_LT( volumeError( mesh, 0.05f ), 0.003 );
	}
}

TEST( Build, MassCentreIsTheShapes )
{
	const LatticeBuild build = built( moved( makeSphere( 1.0, 32, 64 ), { 3.0, -2.0, 1.0 } ), cellsOf( 0.1f ) );
	EXPECT_LT( ( build.lattice.massCentre - Vec3d( 3.0, -2.0, 1.0 ) ).norm(), 1e-3 );
}

TEST( Build, TargetIsMetAboutly )
{
	for ( const int target : { 50, 1000, 8000 } )
	{
		for ( const Mesh& mesh : { makeBox( { 0, 0, 0 }, { 1, 2, 3 } ), makeTorus( 1.0, 0.2, 64, 32 ), makeGlob( 1.0, 20 ) } )
		{
			LatticeSettings settings;
			settings.targetCells = target;
			EXPECT_NEAR( built( mesh, settings ).lattice.cellCount(), target, 0.25 * target );
		}
	}
}

// A cube of 1 m and 1 000 kg had 1 070 kg with 500 cells: all samples of a cell that a face cuts lie on the same side of it.
TEST( Build, BoxesHaveTheirVolume )
{
	for ( const int target : { 500, 1000, 2000, 5000 } )
	{
		for ( const Vec3d& size : { Vec3d( 1, 1, 1 ), Vec3d( 0.4, 0.4, 0.8 ), Vec3d( 1, 2, 3 ) } )
		{
			LatticeSettings settings;
			settings.targetCells = target;
			const LatticeBuild build = built( makeBox( { -0.1, 0.2, 0 }, { size.x() - 0.1, size.y() + 0.2, size.z() } ), settings );
			EXPECT_NEAR( build.report.volume / size.prod(), 1.0, 1e-5 ) << size.transpose() << ", " << target;
			EXPECT_NEAR( build.lattice.cellCount(), target, 0.26 * target );
		}
	}
}

TEST( Build, MovingByWholeCellsChangesNothing )
{
	// Vertices on multiples of 2^-10, so that moving them is exact.
	Mesh glob = makeGlob( 1.0, 20 );
	for ( float& x : glob.positions )
	{
		x = std::round( x * 1024.0f ) / 1024.0f;
	}
	const Mesh far = moved( glob, { 16.0, -8.0, 4.0 } );
	const LatticeBuild here = built( glob, cellsOf( 0.125f ) );
	const LatticeBuild there = built( far, cellsOf( 0.125f ) );
	expectEqual( here.lattice, there.lattice );
	EXPECT_EQ( here.lattice.corner + Vec3d( 16.0, -8.0, 4.0 ), there.lattice.corner );
}

TEST( Build, TriangleOrderChangesNothing )
{
	for ( const Mesh& mesh : { makeGlob( 1.0, 20 ), without( makeSphere( 1.0, 24, 48 ), []( std::size_t t ) { return t < 200; } ) } )
	{
		Mesh shuffled = mesh;
		std::uint32_t state = 1;
		for ( std::size_t t = mesh.triangleCount() - 1; t > 0; --t )
		{
			state = state * 1664525u + 1013904223u;
			const std::size_t other = state % ( t + 1 );
			std::swap_ranges( shuffled.indices.begin() + std::ptrdiff_t( 3 * t ), shuffled.indices.begin() + std::ptrdiff_t( 3 * t + 3 ),
				shuffled.indices.begin() + std::ptrdiff_t( 3 * other ) );
			// Nor must the order of a triangle's corners matter, as long as its orientation stays.
			std::rotate( shuffled.indices.begin() + std::ptrdiff_t( 3 * t ),
				shuffled.indices.begin() + std::ptrdiff_t( 3 * t + state / 7 % 3 ),
				shuffled.indices.begin() + std::ptrdiff_t( 3 * t + 3 ) );
		}
		ASSERT_NE( mesh.indices, shuffled.indices );
		expectEqual( built( mesh, cellsOf( 0.1f ) ).lattice, built( shuffled, cellsOf( 0.1f ) ).lattice );
	}
}

TEST( Build, ThreadsChangeNothing )
{
	for ( const Mesh& mesh :
		{ makeBumpySphere( 1.0, 0.2, 60, 60 ), without( makeSphere( 1.0, 24, 48 ), []( std::size_t t ) { return t % 3 == 0; } ) } )
	{
		const Lattice alone = built( mesh, cellsOf( 0.08f ) ).lattice;
		for ( const int threads : { 1, 2, 4, 8 } )
		{
			const std::unique_ptr<TaskRunner> pool = createThreadPool( threads );
			LatticeSettings settings = cellsOf( 0.08f );
			settings.runner = pool.get();
			const Lattice together = built( mesh, settings ).lattice;
			expectEqual( alone, together );
			EXPECT_EQ( alone.massCentre, together.massCentre );
		}
	}
}

TEST( Build, ClosedOpenFlippedUnweldedSoupAllHaveInsides )
{
	const Mesh sphere = makeSphere( 1.0, 32, 64 );
	const double whole = volumeOf( sphere );
	const auto volumeOfBuild = []( const Mesh& mesh ) { return built( mesh, cellsOf( 0.1f ) ).report.volume; };
	EXPECT_NEAR( volumeOfBuild( sphere ), whole, 0.01 * whole );
	EXPECT_NEAR( volumeOfBuild( flipped( sphere ) ), whole, 0.01 * whole );
	EXPECT_NEAR( volumeOfBuild( unwelded( sphere ) ), whole, 0.01 * whole );
	// Every tenth triangle missing, welded and not: holes everywhere.
	const Mesh holes = without( sphere, []( std::size_t t ) { return t % 10 == 3; } );
	EXPECT_NEAR( volumeOfBuild( holes ), whole, 0.05 * whole );
	EXPECT_NEAR( volumeOfBuild( unwelded( holes ) ), whole, 0.05 * whole );
	// Every third triangle inverted.
	Mesh mixed = sphere;
	for ( std::size_t t = 0; t < mixed.triangleCount(); t += 3 )
	{
		std::swap( mixed.indices[3 * t], mixed.indices[3 * t + 1] );
	}
	EXPECT_NEAR( volumeOfBuild( mixed ), whole, 0.01 * whole );
	EXPECT_EQ( built( mixed, cellsOf( 0.1f ) ).report.flippedTriangles, int( ( sphere.triangleCount() + 2 ) / 3 ) );
}

TEST( Build, HalfAShellHoldsWhatItsRimSpans )
{
	// With its mirror image the bowl is a ball: in the plane between them, each has half of the winding number.
	const Mesh bowl = without( makeSphere( 1.0, 32, 64 ), []( std::size_t t ) { return t % 62 >= 31; } );
	const LatticeBuild build = built( bowl, cellsOf( 0.1f ) );
	EXPECT_EQ( build.report.openEdges, 64 );
	EXPECT_NEAR( build.report.volume, 2.0 * std::numbers::pi / 3.0, 0.1 );
	EXPECT_EQ( build.report.components, 1 );
}

TEST( Build, ShellsUniteOrHollowOut )
{
	const Mesh big = makeSphere( 1.0, 32, 64 );
	const Mesh small = makeSphere( 0.5, 32, 64 );
	const double whole = volumeOf( big );
	const double hole = volumeOf( small );
	const auto volumeOfBuild = []( const Mesh& mesh ) { return built( mesh, cellsOf( 0.1f ) ).report.volume; };
	EXPECT_NEAR( volumeOfBuild( joined( big, small ) ), whole, 0.01 * whole );
	EXPECT_NEAR( volumeOfBuild( joined( big, flipped( small ) ) ), whole - hole, 0.01 * whole );
	EXPECT_NEAR( volumeOfBuild( joined( flipped( big ), small ) ), whole - hole, 0.01 * whole );
	EXPECT_NEAR( volumeOfBuild( joined( flipped( big ), flipped( small ) ) ), whole, 0.01 * whole );
	// Side by side, one of them inverted: two balls.
	const LatticeBuild apart = built( joined( big, flipped( moved( small, { 2.0, 0.0, 0.0 } ) ) ), cellsOf( 0.1f ) );
	EXPECT_NEAR( apart.report.volume, whole + hole, 0.01 * whole );
	EXPECT_EQ( apart.report.components, 2 );
	EXPECT_EQ( apart.report.shells, 2 );
	// Overlapping, one of them inverted: the union. Lens of balls 1 and 1/2 at distance 1.2.
	const double d = 1.2;
	const double lens = std::numbers::pi * 0.3 * 0.3 * ( d * d + 2.0 * d * 0.5 - 0.75 + 2.0 * d ) / ( 12.0 * d );
	EXPECT_NEAR( volumeOfBuild( joined( big, flipped( moved( small, { d, 0.0, 0.0 } ) ) ) ), whole + hole - lens, 0.01 * whole );
}

TEST( Build, ThinPlatesKeepTheirVolume )
{
	const Mesh plate = makeBox( { 0, 0, 0 }, { 4, 4, 0.05 } );
	for ( const double angle : { 0.0, 0.3, 0.7, 1.1 } )
	{
		const LatticeBuild build = built( rotated( plate, angle ), cellsOf( 0.5f ) );
		EXPECT_NEAR( build.report.volume, 0.8, 0.1 ) << angle;
		EXPECT_EQ( build.report.components, 1 ) << angle;
	}
	EXPECT_NEAR( built( plate, cellsOf( 0.5f ) ).report.volume, 0.8, 1e-4 );
}

TEST( Build, HairsAndSpecksStillGiveCells )
{
	const Mesh hair = makeBox( { 0, 0, 0 }, { 4, 0.001, 0.001 } );
	const LatticeBuild straight = built( hair, cellsOf( 0.5f ) );
	EXPECT_EQ( straight.lattice.cellCount(), 8 );
	EXPECT_EQ( straight.report.components, 1 );
	EXPECT_NEAR( straight.report.volume, 4e-6, 1e-7 );
	EXPECT_GE( built( rotated( makeBox( { 0, 0, 0 }, { 4, 0.01, 0.01 } ), 0.7 ), cellsOf( 0.5f ) ).lattice.cellCount(), 4 );
	const LatticeBuild speck = built( makeSphere( 0.01, 16, 32 ), cellsOf( 1.0f ) );
	EXPECT_EQ( speck.lattice.cellCount(), 1 );
	EXPECT_NEAR( speck.report.volume, 4.19e-6, 2e-7 );
}

struct Watcher
{
	float last = 0.0f;
	int calls = 0;
	int cancelAt = -1;
	bool wentBack = false;

	static bool watch( float fraction, void* context )
	{
		Watcher& self = *static_cast<Watcher*>( context );
		self.wentBack = self.wentBack || !( fraction >= self.last && fraction <= 1.0f );
		self.last = fraction;
		return self.calls++ != self.cancelAt;
	}
};

TEST( Build, ProgressRisesAndCancelStops )
{
	const Mesh mesh = makeGlob( 1.0, 16 );
	Watcher watcher;
	LatticeSettings settings;
	settings.progress = Watcher::watch;
	settings.progressContext = &watcher;
	built( mesh, settings );
	EXPECT_FALSE( watcher.wentBack );
	EXPECT_EQ( watcher.last, 1.0f );
	ASSERT_GE( watcher.calls, 5 );
	for ( int k = 0; k < watcher.calls; ++k )
	{
		Watcher canceller;
		canceller.cancelAt = k;
		settings.progressContext = &canceller;
		const Result<LatticeBuild> result = buildLattice( mesh.view(), settings );
		EXPECT_EQ( result.status.code, ResultCode::Cancelled ) << k;
		EXPECT_EQ( result.value.lattice.cellCount(), 0 );
		EXPECT_EQ( canceller.calls, k + 1 );
	}
}

ResultCode codeOf( const Mesh& mesh, const LatticeSettings& settings )
{
	const Result<LatticeBuild> result = buildLattice( mesh.view(), settings );
	EXPECT_EQ( result.ok(), result.status.sentence.empty() );
	return result.status.code;
}

TEST( Errors, EachKnobIsChecked )
{
	const float nan = std::numeric_limits<float>::quiet_NaN();
	const float infinity = std::numeric_limits<float>::infinity();
	const Mesh cube = makeBox( { 0, 0, 0 }, { 1, 1, 1 } );
	const auto expectBad = [&]( auto&& change ) {
		LatticeSettings settings;
		change( settings );
		EXPECT_EQ( codeOf( cube, settings ), ResultCode::BadSettings );
	};
	for ( const float bad : { nan, infinity, -1.0f, -infinity } )
	{
		expectBad( [bad]( LatticeSettings& s ) { s.cellSize = bad; } );
		expectBad( [bad]( LatticeSettings& s ) { s.weldTolerance = bad; } );
		expectBad( [bad]( LatticeSettings& s ) { s.minimumFill = bad; } );
		expectBad( [bad]( LatticeSettings& s ) { s.shellThickness = bad; } );
	}
	expectBad( []( LatticeSettings& s ) { s.weldTolerance = 0.02f; } );
	expectBad( []( LatticeSettings& s ) { s.minimumFill = 0.6f; } );
	for ( const int bad : { 0, -1, std::numeric_limits<int>::min(), std::numeric_limits<int>::max() } )
	{
		expectBad( [bad]( LatticeSettings& s ) { s.targetCells = bad; } );
		expectBad( [bad]( LatticeSettings& s ) { s.maxCells = bad; } );
		expectBad( [bad]( LatticeSettings& s ) { s.maxTriangles = bad; } );
		expectBad( [bad]( LatticeSettings& s ) { s.samplesPerEdge = bad; } );
	}
	expectBad( []( LatticeSettings& s ) { s.skinning = Skinning( 7 ); } );
	expectBad( []( LatticeSettings& s ) { s.shell = Shell( 3 ); } );
}

TEST( Errors, TooManyCellsNamesTheKnobAndASizeThatFits )
{
	const Mesh cube = makeBox( { 0, 0, 0 }, { 1, 1, 1 } );
	for ( const float size : { 0.05f, 0.01f, 0.001f, 0.0001f } )
	{
		LatticeSettings settings = cellsOf( size );
		settings.maxCells = 5000;
		const Result<LatticeBuild> result = buildLattice( cube.view(), settings );
		ASSERT_EQ( result.status.code, ResultCode::TooManyCells ) << size;
		EXPECT_NE( result.status.sentence.find( "maxCells" ), std::string::npos );
		const std::size_t at = result.status.sentence.find( "cellSize of " );
		ASSERT_NE( at, std::string::npos );
		settings.cellSize = std::stof( result.status.sentence.substr( at + 12 ) );
		EXPECT_TRUE( buildLattice( cube.view(), settings ).ok() ) << settings.cellSize;
	}
}

TEST( Errors, LimitsAreKept )
{
	const Mesh cube = makeBox( { 0, 0, 0 }, { 1, 1, 1 } );
	LatticeSettings settings;
	settings.maxTriangles = 11;
	EXPECT_EQ( codeOf( cube, settings ), ResultCode::TooManyTriangles );
	settings.maxTriangles = 12;
	EXPECT_EQ( codeOf( cube, settings ), ResultCode::Ok );
	EXPECT_EQ( codeOf( cube, cellsOf( 1e-5f ) ), ResultCode::ExtentOutOfRange );
	EXPECT_EQ( codeOf( moved( cube, { 1e6, 0, 0 } ), cellsOf( 0.1f ) ), ResultCode::ExtentOutOfRange );
}

} // namespace

} // namespace pliant::test
