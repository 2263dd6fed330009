// Cracks with removed points: closed as with all of them, and nowhere farther off than the tolerance.

#include "surface/complex_checks.h"
#include "surface/crack_pieces.h"

#include "surface/crack_shapes/bent_chain.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace pliant {
namespace {

using namespace test;

double distanceToSegment( const Vec3d& p, const Vec3d& a, const Vec3d& b )
{
	const double fraction = ( b - a ).squaredNorm() > 0.0 ? std::clamp( ( p - a ).dot( b - a ) / ( b - a ).squaredNorm(), 0.0, 1.0 ) : 0.0;
	return ( p - a - fraction * ( b - a ) ).norm();
}

double distanceToTriangle( const Vec3d& p, const Vec3d& a, const Vec3d& b, const Vec3d& c )
{
	const Vec3d normal = ( b - a ).cross( c - a );
	const auto isLeft = [&]( const Vec3d& from, const Vec3d& to ) { return ( to - from ).cross( p - from ).dot( normal ) >= 0.0; };
	const double nearest = std::min( { distanceToSegment( p, a, b ), distanceToSegment( p, b, c ), distanceToSegment( p, c, a ) } );
	return normal.norm() > 0.0 && isLeft( a, b ) && isLeft( b, c ) && isLeft( c, a )
		? std::min( nearest, std::abs( normal.normalized().dot( p - a ) ) )
		: nearest;
}

TEST( BentChain, KeepsWhatStandsOffTheLineByTheTolerance )
{
	std::vector<Vec3d> chain;
	for ( int k = 0; k <= 40; ++k )
	{
		chain.emplace_back( 0.1 * k, std::sin( 0.4 * k ), 0.3 * std::cos( 0.23 * k ) );
	}
	for ( const double tolerance : { 0.01, 0.05, 0.3 } )
	{
		const std::vector<std::uint8_t> isKept = keepBent( chain, tolerance );
		std::vector<std::size_t> kept;
		for ( std::size_t k = 0; k < chain.size(); ++k )
		{
			if ( isKept[k] != 0 )
			{
				kept.push_back( k );
			}
		}
		ASSERT_EQ( kept.front(), 0u );
		ASSERT_EQ( kept.back(), 40u );
		EXPECT_LT( kept.size(), chain.size() );
		for ( std::size_t i = 1; i < kept.size(); ++i )
		{
			for ( std::size_t k = kept[i - 1]; k <= kept[i]; ++k )
			{
				EXPECT_LT( distanceToSegment( chain[k], chain[kept[i - 1]], chain[kept[i]] ), tolerance );
			}
		}
	}
}

TEST( BentChain, KeepsEveryPointAtNoTolerance )
{
	const std::vector<Vec3d> straight = { Vec3d( 0, 0, 0 ), Vec3d( 1, 0, 0 ), Vec3d( 2, 0, 0 ), Vec3d( 4, 0, 0 ) };
	const std::vector<std::uint8_t> all = keepBent( straight, 0.0 ), ends = keepBent( straight, 1e-9 );
	EXPECT_EQ( std::count( all.begin(), all.end(), 1 ), 4 );
	EXPECT_EQ( std::count( ends.begin(), ends.end(), 1 ), 2 );
}

struct Sample
{
	const char* name;
	std::function<Mesh()> make;
	double cellSize;
};

std::vector<Sample> samples()
{
	return {
		{ "box on the grid",
			[] {
				return makeBox( { 0, 0, 0 }, { 1, 1, 1 } );
			},
			0.2 },
		{ "box off the grid",
			[] {
				return rotated( makeBox( { 0, 0, 0 }, { 1, 0.8, 0.6 } ), 0.7 );
			},
			0.173 },
		{ "thin plate",
			[] {
				return rotated( makeBox( { 0, 0, 0 }, { 2, 1.5, 0.03 }, 3 ), 0.3 );
			},
			0.2 },
		{ "torus", [] { return rotated( makeTorus( 1.0, 0.4, 24, 16 ), 0.4 ); }, 0.21 },
	};
}

CrackCase caseOf( const Sample& sample, float tolerance, int subdivision, float noise = 0.3f )
{
	CrackSettings settings;
	settings.noiseAmplitude = noise;
	settings.subdivision = subdivision;
	settings.bendTolerance = tolerance;
	return CrackCase( sample.make(), sample.cellSize, settings );
}

/// Cells that draw a point, and those next to them: a crumb may go to another neighbour where borders differ.
std::set<std::uint32_t> cellsAround( const CellComplex& complex, std::uint32_t point )
{
	std::set<std::uint32_t> cells( complex.cellsOfPoint.begin( point ), complex.cellsOfPoint.end( point ) );
	for ( const std::uint32_t* cell = complex.cellsOfPoint.begin( point ); cell != complex.cellsOfPoint.end( point ); ++cell )
	{
		for ( const std::uint32_t* f = complex.facesOfCell.begin( *cell ); f != complex.facesOfCell.end( *cell ); ++f )
		{
			cells.insert( { complex.face[*f].cellA, complex.face[*f].cellB } );
		}
	}
	return cells;
}

/// Distance of a point from the surface that these cells draw, m.
double distanceToCells( const CrackCase& it, const std::set<std::uint32_t>& cells, const Vec3d& p )
{
	double nearest = 1e9;
	for ( const std::uint32_t cell : cells )
	{
		for ( const TrianglePoints& t : trianglesOfCell( *it.complex, cell ) )
		{
			nearest = std::min( nearest, distanceToTriangle( p, it.at( t[0] ), it.at( t[1] ), it.at( t[2] ) ) );
		}
	}
	return nearest;
}

TEST( BendTolerance, FewerPointsAreNowhereFartherOff )
{
	for ( const Sample& sample : samples() )
	{
		for ( const int subdivision : { 2, 4 } )
		{
			SCOPED_TRACE( testing::Message() << sample.name << ", subdivision " << subdivision );
			constexpr float kTolerance = 0.05f;
			const CrackCase all = caseOf( sample, 0.0f, subdivision ), few = caseOf( sample, kTolerance, subdivision );
			EXPECT_LT( few.complex->pointCount(), all.complex->pointCount() );
			double worst = 0.0;
			for ( std::uint32_t p = 0; p < all.complex->pointCount(); ++p )
			{
				worst = std::max( worst, distanceToCells( few, cellsAround( *all.complex, p ), all.at( p ) ) / sample.cellSize );
			}
			// The tolerance applies to the distance measured normal to the triangle in bent space; near the rim the distance is a little
			// larger.
			EXPECT_LT( worst, 1.25 * double( kTolerance ) );
		}
	}
}

/// Closed with any points removed, also with all of those that can be.
TEST( BendTolerance, EveryCellIsClosedAtAnyTolerance )
{
	for ( const Sample& sample : samples() )
	{
		for ( const float tolerance : { 0.0f, 0.02f, 0.1f, 0.5f } )
		{
			for ( const int subdivision : { 1, 2, 3, 8 } )
			{
				SCOPED_TRACE( testing::Message() << sample.name << ", tolerance " << tolerance << ", subdivision " << subdivision );
				const CrackCase it = caseOf( sample, tolerance, subdivision );
				const Status status = validate( *it.complex );
				EXPECT_TRUE( status.ok() ) << status.sentence;
				double volume = 0.0;
				int odd = 0; // edges at which four triangles meet
				for ( std::uint32_t cell = 0; cell < it.complex->cellCount(); ++cell )
				{
					const std::vector<TrianglePoints> drawn = trianglesOfCell( *it.complex, cell );
					EXPECT_EQ( openEdges( drawn ), 0 );
					odd += oddEdges( drawn );
					for ( const TrianglePoints& t : drawn )
					{
						volume += signedVolume( it.at( t[0] ), it.at( t[1] ), it.at( t[2] ) );
					}
				}
				EXPECT_NEAR( volume / meshVolume( it.mesh ), 1.0, 1e-6 );
				EXPECT_LE( odd, tolerance > 0.0f ? 2 : 8 );
			}
		}
	}
}

/// Without noise nothing bends: each whole face is two triangles, at any subdivision.
TEST( BendTolerance, FlatFacesAreAsCoarseAsTheyCanBe )
{
	const Sample box = samples().front();
	const CrackCase fine = caseOf( box, 0.05f, 4, 0.0f ), coarse = caseOf( box, 0.05f, 1, 0.0f ), all = caseOf( box, 0.0f, 4, 0.0f );
	EXPECT_EQ( fine.complex->faceTriangle.size(), coarse.complex->faceTriangle.size() );
	EXPECT_GT( all.complex->faceTriangle.size(), 8 * coarse.complex->faceTriangle.size() );
}

/// A block with the default noise, drawn with all faces broken.
TEST( BendTolerance, HalvesTheVerticesOfABlock )
{
	const Sample block{ "block", [] { return makeBox( { 0, 0, 0 }, { 1, 1, 1 } ); }, 1.0 / 6.0 };
	const CrackCase all = caseOf( block, 0.0f, 2 ), few = caseOf( block, CrackSettings{}.bendTolerance, 2 );
	EXPECT_LT( 10 * few.complex->faceTriangle.size(), 6 * all.complex->faceTriangle.size() );
	EXPECT_LT( 10 * few.complex->triangle.size(), 4 * all.complex->triangle.size() );
}

} // namespace
} // namespace pliant
