// The demos' own shapes are closed and oriented outward, and their volumes agree with geometry.

#include "demos/shapes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <utility>

using pliant_glue::ModelMesh;

namespace {

/// Every edge belongs to exactly two triangles, which traverse it in opposite directions.
bool isClosed( const ModelMesh& mesh )
{
	std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
	for ( std::size_t t = 0; t < mesh.indices.size(); t += 3 )
	{
		for ( std::size_t k = 0; k < 3; ++k )
		{
			++edges[{ mesh.indices[t + k], mesh.indices[t + ( k + 1 ) % 3] }];
		}
	}
	for ( const auto& [edge, count] : edges )
	{
		if ( count != 1 || edges.find( { edge.second, edge.first } ) == edges.end() )
		{
			return false;
		}
	}
	return !edges.empty();
}

double shapeVolume( const ModelMesh& mesh )
{
	double sum = 0;
	for ( std::size_t t = 0; t < mesh.indices.size(); t += 3 )
	{
		const float* a = &mesh.positions[3 * mesh.indices[t]];
		const float* b = &mesh.positions[3 * mesh.indices[t + 1]];
		const float* c = &mesh.positions[3 * mesh.indices[t + 2]];
		sum += double( a[0] ) * ( double( b[1] ) * c[2] - double( b[2] ) * c[1] ) +
			double( a[1] ) * ( double( b[2] ) * c[0] - double( b[0] ) * c[2] ) +
			double( a[2] ) * ( double( b[0] ) * c[1] - double( b[1] ) * c[0] );
	}
	return sum / 6;
}

constexpr double kPi = 3.14159265358979;

TEST( Shapes, CubeEnclosesItsVolume )
{
	for ( const int cuts : { 1, 2, 7 } )
	{
		const ModelMesh cube = pliant_demos::makeCube( 0.5f, cuts );
		EXPECT_TRUE( isClosed( cube ) );
		EXPECT_EQ( cube.triangleCount(), std::size_t( 12 * cuts * cuts ) );
		EXPECT_NEAR( shapeVolume( cube ), 0.125, 1e-6 );
	}
}

TEST( Shapes, SphereAndTorusApproachTheirVolume )
{
	const ModelMesh sphere = pliant_demos::makeSphere( 1.0f, 4 );
	EXPECT_TRUE( isClosed( sphere ) );
	EXPECT_NEAR( shapeVolume( sphere ), kPi / 6, 0.003 );
	const ModelMesh torus = pliant_demos::makeTorus( 0.4f, 0.1f, 96, 48 );
	EXPECT_TRUE( isClosed( torus ) );
	EXPECT_NEAR( shapeVolume( torus ), 2 * kPi * kPi * 0.4 * 0.01, 0.001 );
}

TEST( Shapes, OneMetaballIsABall )
{
	// exp( -|x|^2 / r^2 ) = level at |x| = r sqrt( -ln level )
	const ModelMesh ball = pliant_demos::makeMetaballs( { { { 0.1f, -0.2f, 0.3f }, { 0.5f, 0.5f, 0.5f } } }, 0.5f, 0.03f );
	EXPECT_TRUE( isClosed( ball ) );
	const double radius = 0.5 * std::sqrt( std::log( 2.0 ) );
	EXPECT_NEAR( shapeVolume( ball ), 4.0 / 3.0 * kPi * radius * radius * radius, 0.003 );
}

TEST( Shapes, StandInsAreClosedAndFitted )
{
	for ( ModelMesh mesh : { pliant_demos::makeGlob(), pliant_demos::makeBunnyLike() } )
	{
		EXPECT_TRUE( isClosed( mesh ) ) << mesh.name;
		EXPECT_GT( shapeVolume( mesh ), 0.05 ) << mesh.name;
		pliant_demos::fitHeight( mesh, 0.7f );
		float low = 1e9f, high = -1e9f;
		for ( std::size_t i = 1; i < mesh.positions.size(); i += 3 )
		{
			low = std::min( low, mesh.positions[i] );
			high = std::max( high, mesh.positions[i] );
		}
		EXPECT_NEAR( low, -0.35f, 1e-5f ) << mesh.name;
		EXPECT_NEAR( high, 0.35f, 1e-5f ) << mesh.name;
	}
}

} // namespace
