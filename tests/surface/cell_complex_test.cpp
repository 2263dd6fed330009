// A body divided along its cells: every cell closed, nothing lost, nothing duplicated.

#include "surface/complex_checks.h"

#include <gtest/gtest.h>

#include <cmath>

namespace pliant {
namespace {

using namespace test;

struct Solid
{
	const char* name;
	std::function<Mesh()> make;
	double cellSize;
	friend void PrintTo( const Solid& solid, std::ostream* out ) { *out << solid.name; }
};

CrackSettings flat()
{
	CrackSettings settings;
	settings.noiseAmplitude = 0.0f;
	settings.subdivision = 1;
	return settings;
}

std::vector<Solid> solids()
{
	return {
		{ "BoxOnTheGrid",
			[] {
				return makeBox( { 0, 0, 0 }, { 1, 1, 1 } );
			},
			0.25 },
		{ "BoxOffTheGrid",
			[] {
				return rotated( makeBox( { 0, 0, 0 }, { 1, 0.8, 0.6 } ), 0.7 );
			},
			0.173 },
		{ "BoxWithVerticesOnPlanes",
			[] {
				return makeBox( { 0, 0, 0 }, { 1, 1, 1 }, 8 );
			},
			0.25 },
		{ "Sphere", [] { return makeSphere( 1.0, 16, 24 ); }, 0.3 },
		{ "SphereOfBigCells", [] { return makeSphere( 1.0, 24, 32 ); }, 1.3 },
		{ "Torus", [] { return rotated( makeTorus( 1.0, 0.4, 24, 16 ), 0.4 ); }, 0.21 },
		{ "BumpySphere", [] { return makeBumpySphere( 1.0, 0.2, 30, 40 ); }, 0.22 },
		{ "Glob", [] { return makeGlob( 1.0, 24 ); }, 0.2 },
		{ "HollowSphere", [] { return joined( makeSphere( 1.0, 16, 24 ), flipped( makeSphere( 0.6, 12, 20 ) ) ); }, 0.27 },
		{ "TwoShells",
			[] {
				return joined( makeSphere( 1.0, 16, 24 ), moved( makeSphere( 0.7, 12, 20 ), { 1.75, 0.1, 0.2 } ) );
			},
			0.23 },
		{ "ThinPlate",
			[] {
				return rotated( makeBox( { 0, 0, 0 }, { 2, 1.5, 0.03 }, 3 ), 0.3 );
			},
			0.2 },
		{ "Unwelded", [] { return unwelded( makeTorus( 1.0, 0.3, 16, 12 ) ); }, 0.25 },
		{ "Fork",
			[] {
				return joined( makeBox( { 0, 0, 0 }, { 2, 0.2, 0.2 } ), makeBox( { 0, 0.25, 0 }, { 2, 0.45, 0.2 } ) );
			},
			0.3 },
	};
}

class Complex : public testing::TestWithParam<std::tuple<Solid, float>>
{
protected:
	CrackSettings settings() const
	{
		CrackSettings made = flat();
		made.noiseAmplitude = std::get<1>( GetParam() );
		made.subdivision = made.noiseAmplitude > 0.0f ? 2 : 1;
		return made;
	}
	CrackCase make() const { return CrackCase( std::get<0>( GetParam() ).make(), std::get<0>( GetParam() ).cellSize, settings() ); }
};

TEST_P( Complex, EveryCellIsClosed )
{
	const CrackCase it = make();
	ASSERT_TRUE( it.complex );
	const Status status = validate( *it.complex );
	EXPECT_TRUE( status.ok() ) << status.sentence;
	EXPECT_EQ( it.complex->report.fallbacks, 0 );
	for ( std::uint32_t cell = 0; cell < it.complex->cellCount(); ++cell )
	{
		ASSERT_EQ( openEdges( trianglesOfCell( *it.complex, cell ) ), 0 ) << "cell " << cell;
	}
}

TEST_P( Complex, VolumesOfTheCellsSumToTheMeshs )
{
	const CrackCase it = make();
	double sum = 0.0, least = 1e9;
	for ( std::uint32_t cell = 0; cell < it.complex->cellCount(); ++cell )
	{
		double volume = 0.0;
		for ( const TrianglePoints& t : trianglesOfCell( *it.complex, cell ) )
		{
			volume += signedVolume( it.at( t[0] ), it.at( t[1] ), it.at( t[2] ) );
		}
		sum += volume;
		least = std::min( least, volume );
	}
	EXPECT_NEAR( sum / meshVolume( it.mesh ), 1.0, 1e-6 );
	EXPECT_GT( least, -1e-6 * sum );
}

/// Without noise a cell's volume agrees with the fill, for which the lattice counts samples.
TEST_P( Complex, CellsHoldWhatTheLatticeSaysTheyHold )
{
	const CrackCase it = make();
	const double whole = std::pow( it.lattice().cellSize, 3 );
	double squares = 0.0;
	for ( std::uint32_t cell = 0; cell < it.complex->cellCount(); ++cell )
	{
		double volume = 0.0;
		for ( const TrianglePoints& t : trianglesOfCell( *it.complex, cell ) )
		{
			volume += signedVolume( it.at( t[0] ), it.at( t[1] ), it.at( t[2] ) );
		}
		squares += std::pow( volume / whole - it.lattice().fill[cell], 2 );
	}
	const double error = std::sqrt( squares / it.complex->cellCount() );
	EXPECT_LT( error, std::get<1>( GetParam() ) > 0.0f ? 0.35 : 0.08 );
}

TEST_P( Complex, TheOuterSurfaceIsTheMesh )
{
	const CrackCase it = make();
	std::vector<double> area( it.mesh.triangleCount(), 0.0 );
	const auto doubleAreaOf = [&]( const Vec3d& a, const Vec3d& b, const Vec3d& c ) { return Vec3d( ( b - a ).cross( c - a ) ); };
	const auto meshAt = [&]( std::uint32_t i ) { return it.rest( int( i ) ).cast<double>().eval(); };
	for ( std::size_t t = 0; t < it.complex->triangle.size(); ++t )
	{
		const auto& v = it.complex->triangle[t];
		const std::uint32_t* source = &it.mesh.indices[3 * it.complex->triangleSource[t]];
		const Vec3d normal = doubleAreaOf( meshAt( source[0] ), meshAt( source[1] ), meshAt( source[2] ) ).normalized();
		area[it.complex->triangleSource[t]] += doubleAreaOf(
			it.at( it.complex->vertexPoint[v[0]] ), it.at( it.complex->vertexPoint[v[1]] ), it.at( it.complex->vertexPoint[v[2]] ) )
												   .dot( normal );
	}
	double worst = 0.0, total = 0.0;
	for ( std::size_t t = 0; t < area.size(); ++t )
	{
		const std::uint32_t* v = &it.mesh.indices[3 * t];
		const double whole = doubleAreaOf( meshAt( v[0] ), meshAt( v[1] ), meshAt( v[2] ) ).norm();
		worst = std::max( worst, std::abs( area[t] - whole ) );
		total += whole;
	}
	EXPECT_LT( worst, 1e-5 * total );
	// Added vertices lie at the position given by their origin, and input vertices are unchanged.
	for ( std::uint32_t v = 0; v < it.complex->vertexPoint.size(); ++v )
	{
		Vec3d place = Vec3d::Zero();
		if ( v < it.complex->inputVertices )
		{
			place = meshAt( v );
		}
		else
		{
			const CellComplex::Origin& origin = it.complex->addedOrigin[v - it.complex->inputVertices];
			for ( std::size_t k = 0; k < 3 && origin.vertex[k] != CellComplex::kNone; ++k )
			{
				place += double( origin.weight[k] ) * meshAt( origin.vertex[k] );
			}
		}
		ASSERT_LT( ( place - it.at( it.complex->vertexPoint[v] ) ).norm(), 5e-3 * it.lattice().cellSize ) << v;
	}
}

INSTANTIATE_TEST_SUITE_P( Solids, Complex, testing::Combine( testing::ValuesIn( solids() ), testing::Values( 0.0f, 0.3f ) ),
	[]( const auto& it ) { return std::string( std::get<0>( it.param ).name ) + ( std::get<1>( it.param ) > 0.0f ? "Noisy" : "Flat" ); } );

} // namespace
} // namespace pliant
