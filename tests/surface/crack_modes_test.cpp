// The papers' own methods of drawing faces, and meshes that are not closed.

#include "surface/drawn_by_definition.h"

#include "surface/crack_shapes/gradient_noise.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace pliant {
namespace {

using namespace test;

CrackSettings drawnAs( CrackFaces faces, float noise = 0.0f )
{
	CrackSettings settings = noisy( noise );
	settings.faces = faces;
	return settings;
}

double areaOf( const CellComplex& complex )
{
	double sum = 0.0;
	for ( const CrackFace& face : complex.face )
	{
		sum += double( face.area );
	}
	return sum;
}

TEST( CrackModes, BricksAreWholeSquares )
{
	const CrackCase it( makeSphere( 1.0, 24, 32 ), 0.2, drawnAs( CrackFaces::Bricks ) );
	int whole = 0;
	for ( const CrackFace& face : it.complex->face )
	{
		const double squares = double( face.area ) / ( 0.2 * 0.2 );
		EXPECT_NEAR( squares, std::round( squares ), 1e-4 ); // more than one if a cell was given a crumb
		whole += std::lround( squares ) == 1;
	}
	EXPECT_GT( whole, 0.8 * double( it.complex->face.size() ) );
	DrawnCracks surface( it.complex );
	surface.breakFaces( facesBetween( *it.complex, shatter( it.lattice(), 8, 1 ) ) );
	expectValid( surface );
	expectNoSeams( surface );
}

TEST( CrackModes, MarchingSquaresComesNearTheExactFaces )
{
	const Mesh mesh = makeSphere( 1.0, 24, 32 );
	const double exact = areaOf( *CrackCase( mesh, 0.2, drawnAs( CrackFaces::Exact ) ).complex );
	const CrackCase it( mesh, 0.2, drawnAs( CrackFaces::MarchingSquares ) );
	const double bricks = areaOf( *CrackCase( mesh, 0.2, drawnAs( CrackFaces::Bricks ) ).complex );
	EXPECT_NEAR( areaOf( *it.complex ) / exact, 1.0, 0.01 );
	EXPECT_GT( bricks / exact, 1.2 );
	// Its corners lie inside or on the surface, not beyond.
	for ( const auto& t : it.complex->faceTriangle )
	{
		for ( const std::uint32_t p : t )
		{
			EXPECT_LT( ( it.at( p ) + it.lattice().massCentre ).norm(), 1.0 + 1e-6 );
		}
	}
	DrawnCracks surface( it.complex );
	surface.breakFaces( facesBetween( *it.complex, shatter( it.lattice(), 8, 1 ) ) );
	expectValid( surface );
	expectNoSeams( surface );
}

/// A sphere with a hole: closed by a cap that is not drawn, so that only the hole stays open.
TEST( CrackModes, HolesStayTheOnlyOpenPlaces )
{
	const Mesh mesh = without( makeSphere( 1.0, 16, 24 ), []( std::size_t t ) { return t < 40; } );
	for ( const float noise : { 0.0f, 0.3f } )
	{
		const CrackCase it( mesh, 0.25, drawnAs( CrackFaces::Exact, noise ) );
		EXPECT_EQ( it.complex->report.fallbacks, 0 );
		int open = 0;
		double highest = -1.0, lowest = 1.0;
		for ( std::uint32_t cell = 0; cell < it.complex->cellCount(); ++cell )
		{
			open += openEdges( trianglesOfCell( *it.complex, cell ) ) > 0;
		}
		for ( const auto& t : it.complex->faceTriangle )
		{
			for ( const std::uint32_t p : t )
			{
				highest = std::max( highest, ( it.at( p ) + it.lattice().massCentre ).norm() );
				lowest = std::min( lowest, ( it.at( p ) + it.lattice().massCentre ).norm() );
			}
		}
		EXPECT_GT( open, 0 ); // those at the hole
		EXPECT_LT( open, int( it.complex->cellCount() / 4 ) );
		EXPECT_LT( highest, 1.0 + 1e-6 );
		EXPECT_LT( lowest, 0.2 ); // faces fill the inside
		DrawnCracks surface( it.complex );
		surface.breakFaces( facesBetween( *it.complex, shatter( it.lattice(), 8, 1 ) ) );
		expectValid( surface );
	}
}

/// Triangles without common vertices: no cut of the surface closes, and each face is drawn from its corners.
TEST( CrackModes, SoupFallsBackOnMarchingSquares )
{
	Mesh soup = unwelded( makeSphere( 1.0, 24, 32 ) );
	for ( std::size_t t = 0; t < soup.triangleCount(); ++t )
	{
		for ( std::size_t k = 0; k < 9; ++k ) // each shrinks a little towards its first corner
		{
			soup.positions[9 * t + k] += 0.03f * ( soup.positions[9 * t + k % 3] - soup.positions[9 * t + k] );
		}
	}
	const CrackCase it( soup, 0.2, drawnAs( CrackFaces::Exact ) );
	const double exact = areaOf( *CrackCase( makeSphere( 1.0, 24, 32 ), 0.2, drawnAs( CrackFaces::Exact ) ).complex );
	EXPECT_GT( it.complex->report.fallbacks, 100 );
	EXPECT_NEAR( areaOf( *it.complex ) / exact, 1.0, 0.05 );
	DrawnCracks surface( it.complex );
	surface.breakFaces( facesBetween( *it.complex, shatter( it.lattice(), 8, 1 ) ) );
	expectValid( surface );
	expectNoSeams( surface );
}

/// Number of corners of the outer surface whose normals differ from those of the sphere, and number of all of them.
std::pair<int, int> wronglyShaded( CrackCase& it, const DrawnCracks& surface, const SkinBinding& binding )
{
	std::vector<float> positions( 3 * surface.vertexCount() ), normals( 3 * surface.vertexCount() );
	const SkinTriangles triangles{ surface.triangles()[0].data(), int( surface.triangles().size() ) };
	const Eigen::Matrix3f turn = Eigen::AngleAxisf( 1.1f, Vec3( 1, 2, 3 ).normalized() ).toRotationMatrix();
	it.affine( turn );
	skin( binding, it.nodes, SkinPose{ .rotations = it.rotations.data() }, triangles, it.scratch, positions.data(), normals.data() );
	std::pair<int, int> wrong{ 0, 0 };
	for ( std::size_t t = 0; t < surface.triangles().size(); ++t )
	{
		for ( const std::uint32_t v : surface.triangles()[t] )
		{
			const Vec3 normal = Eigen::Map<const Vec3>( &normals[3 * v] ), place = Eigen::Map<const Vec3>( &positions[3 * v] );
			EXPECT_NEAR( normal.norm(), 1.0f, 1e-5f );
			EXPECT_LT( ( place - turn * binding.restPosition[v] ).norm(), 1e-5f );
			if ( surface.sources()[t] != CellComplex::kNone )
			{
				++wrong.second;
				wrong.first += ( normal - turn * binding.restPosition[v].normalized() ).norm() > 0.03f; // it is a sphere of flat triangles
			}
		}
	}
	return wrong;
}

/// A broken sphere at rest is shaded like the whole one, at every vertex of its outer surface, however few triangles are left there.
TEST( CrackModes, CutsDoNotShowOnTheOuterSurface )
{
	CrackCase it( makeSphere( 1.0, 24, 32 ), 0.2, noisy() );
	DrawnCracks surface( it.complex );
	surface.breakFaces( facesBetween( *it.complex, shatter( it.lattice(), 8, 1 ) ) );
	const auto [wrong, all] = wronglyShaded( it, surface, surface.binding() );
	EXPECT_LT( wrong, all / 5000 ); // slivers, whose normals are rounding
	SkinBinding unshifted = surface.binding();
	unshifted.normalShift.clear();
	EXPECT_GT( wronglyShaded( it, surface, unshifted ).first, all / 20 );
}

/// Shifts may end anywhere: vertices beyond the last one have a shift of zero.
TEST( CrackModes, NormalShiftsMayEndEarly )
{
	CrackCase it( makeSphere( 1.0, 24, 32 ), 0.2, noisy() );
	DrawnCracks surface( it.complex );
	surface.breakFaces( facesBetween( *it.complex, shatter( it.lattice(), 8, 1 ) ) );
	const SkinTriangles triangles{ surface.triangles()[0].data(), int( surface.triangles().size() ) };
	it.affine( Eigen::AngleAxisf( 1.1f, Vec3( 1, 2, 3 ).normalized() ).toRotationMatrix() );
	const auto normalsOf = [&]( const SkinBinding& binding ) {
		std::vector<float> positions( 3 * surface.vertexCount() ), normals( 3 * surface.vertexCount() );
		skin( binding, it.nodes, SkinPose{ .rotations = it.rotations.data() }, triangles, it.scratch, positions.data(), normals.data() );
		return normals;
	};
	const std::vector<Vec3>& shifts = surface.binding().normalShift;
	const auto isShift = []( const Vec3& shift ) { return !shift.isZero( 0.0f ); };
	const std::size_t half = std::size_t( shifts.rend() - std::find_if( shifts.rbegin(), shifts.rend(), isShift ) ) / 2;
	ASSERT_GT( half, 4u );
	for ( std::size_t count = half; count < half + 4; ++count )
	{
		SkinBinding cutShort = surface.binding(), filledUp = cutShort;
		cutShort.normalShift.resize( count );
		std::fill( filledUp.normalShift.begin() + std::ptrdiff_t( count ), filledUp.normalShift.end(), Vec3( Vec3::Zero() ) );
		const std::vector<float> all = normalsOf( surface.binding() ); // its shifts lie about where none are asked for next
		const std::vector<float> some = normalsOf( cutShort );
		EXPECT_EQ( some, normalsOf( filledUp ) );
		EXPECT_NE( some, all );
	}
}

TEST( CrackModes, WrongSettingsAreRefusedWithASentence )
{
	const CrackCase it( makeBox( { 0, 0, 0 }, { 1, 1, 1 } ), 0.25, noisy() );
	const auto refused = [&]( const CrackSettings& settings ) {
		const auto made = CellComplex::build( it.mesh.view(), it.lattice(), it.binding, LatticeSettings{}, settings );
		return !made.ok() && !made.status.sentence.empty() && made.value == nullptr;
	};
	CrackSettings wild;
	wild.noiseAmplitude = 0.5f;
	EXPECT_TRUE( refused( wild ) );
	wild.noiseAmplitude = std::nanf( "" );
	EXPECT_TRUE( refused( wild ) );
	wild = CrackSettings{};
	wild.noiseWavelength = 0.5f;
	EXPECT_TRUE( refused( wild ) );
	wild = CrackSettings{};
	wild.subdivision = 0;
	EXPECT_TRUE( refused( wild ) );
	for ( const float tolerance : { -0.01f, 0.6f, std::nanf( "" ) } )
	{
		wild = CrackSettings{};
		wild.bendTolerance = tolerance;
		EXPECT_TRUE( refused( wild ) );
	}
}

TEST( GradientNoise, StaysWithinItsBoundsAndIsTheSameEverywhere )
{
	const NoiseWarp warp( 0.35, 1.0, 3 );
	double most = 0.0;
	Vec3d mean = Vec3d::Zero();
	int count = 0;
	for ( int k = 0; k < 20000; ++k )
	{
		const Vec3d p( 0.137 * ( k % 31 ), 0.211 * ( k / 31 % 29 ), 0.173 * ( k / 899 ) - 2.0 );
		const Vec3d n = warp.noise( p );
		most = std::max( most, n.cwiseAbs().maxCoeff() );
		mean += n;
		++count;
		EXPECT_EQ( n, warp.noise( p ) );
		EXPECT_LT( ( n - warp.noise( p + Vec3d( 1e-6, 0, 0 ) ) ).norm(), 1e-5 ); // smooth
	}
	EXPECT_LE( most, 1.0 );
	EXPECT_GT( most, 0.5 );
	EXPECT_LT( ( mean / count ).norm(), 0.05 );
}

TEST( GradientNoise, BackwardUndoesForward )
{
	for ( const double wavelength : { 1.0, 1.6, 4.0 } )
	{
		const NoiseWarp warp( double( kMostNoise ), wavelength, 9 );
		for ( int k = 0; k < 2000; ++k )
		{
			const Vec3d p( 0.31 * ( k % 13 ), 0.27 * ( k / 13 % 11 ), 0.23 * ( k / 143 ) );
			ASSERT_LT( ( warp.backward( warp.forward( p ) ) - p ).norm(), 1e-9 ) << wavelength;
		}
	}
}

} // namespace
} // namespace pliant
