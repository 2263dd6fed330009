// The surface follows its nodes: exactly in rigid motion, closely otherwise, and always in one piece.

#include "surface/skin_case.h"

#include "pliant/task_runner.h"

#include <gtest/gtest.h>

#include <cmath>

namespace pliant {
namespace {

using test::SkinCase;

class Skin : public testing::TestWithParam<Skinning>
{};

INSTANTIATE_TEST_SUITE_P( Kinds, Skin, testing::Values( Skinning::NearbyNodes, Skinning::Trilinear ),
	[]( const auto& kind ) { return kind.param == Skinning::Trilinear ? "Trilinear" : "NearbyNodes"; } );

TEST_P( Skin, AtRestVertexIIsInputVertexI )
{
	SkinCase it( test::moved( test::makeBumpySphere( 1.0, 0.1, 30, 40 ), { 3, -2, 5 } ), 0.2, GetParam() );
	it.skinIt();
	EXPECT_LT( it.largestError( []( const Vec3& x ) { return x; } ), 2e-6 );
}

TEST_P( Skin, RigidMotionIsExact )
{
	SkinCase it( test::makeGlob( 1.0, 24 ), 0.2, GetParam() );
	const Eigen::Matrix3f turn = Eigen::AngleAxisf( 2.3f, Vec3( 1, -2, 0.5f ).normalized() ).toRotationMatrix();
	it.affine( turn, Vec3( 0.3f, 0.1f, -0.2f ) );
	it.skinIt();
	double box = 0.0;
	for ( int v = 0; v < it.vertexCount(); ++v )
	{
		box = std::max( box, 2.0 * double( it.rest( v ).cwiseAbs().maxCoeff() ) );
	}
	EXPECT_LT( it.largestError( [&]( const Vec3& x ) { return Vec3( turn * x + Vec3( 0.3f, 0.1f, -0.2f ) ); } ), 1e-6 * box );
}

TEST_P( Skin, ALinearDeformationIsMetWithinWhatHalfACellCanHide )
{
	// Inside, weights reproduce a linear field; the outermost half cell follows the nodes' rotations only and so lacks the stretch there:
	// at most |F - R| times the distance from a vertex to the centre of its nodes.
	const double d = 0.1;
	SkinCase it( test::makeBox( { -0.5, -0.5, -0.5 }, { 0.5, 0.5, 0.5 }, 12 ), d, GetParam() );
	Eigen::Matrix3f f;
	f << 1.15f, 0.1f, 0.0f, 0.0f, 0.95f, 0.05f, 0.0f, 0.0f, 1.05f;
	const Eigen::Matrix3f r = fitRotation( f, Eigen::Quaternionf::Identity() ).toRotationMatrix();
	it.affine( f );
	it.skinIt();
	const auto wanted = [&]( const Vec3& x ) { return Vec3( f * x ); };
	const double strain = ( f - r ).jacobiSvd().singularValues()[0];
	std::printf( "largest error %.3f cells at strain %.3f\n", it.largestError( wanted ) / d, strain );
	EXPECT_LT( it.largestError( wanted ), 0.75 * std::sqrt( 3.0 ) * strain * d );

	// In the middle of a face only the stretch across the face is missing: half a cell, and the inward reach of wider weights.
	for ( int v = 0; v < it.vertexCount(); ++v )
	{
		if ( ( it.rest( v ).cwiseAbs().array() < 0.3f ).count() == 2 )
		{
			EXPECT_LT( ( it.position( v ) - wanted( it.rest( v ) ) ).norm(), 0.75 * strain * d );
		}
	}
}

TEST_P( Skin, AFlowedRestShapeIsFollowedToTheLastHalfCell )
{
	SkinCase it( test::makeBox( { -0.5, -0.5, -0.5 }, { 0.5, 0.5, 0.5 }, 12 ), 0.1, GetParam() );
	const Eigen::Matrix3f turn = Eigen::AngleAxisf( 0.7f, Vec3( 1, 2, -1 ).normalized() ).toRotationMatrix();
	Eigen::Matrix3f stretch;
	stretch << 1.3f, 0.1f, 0.0f, 0.1f, 0.9f, 0.05f, 0.0f, 0.05f, 0.85f;
	const auto wanted = [&]( const Vec3& x ) { return Vec3( turn * stretch * x ); };
	it.deform( wanted, [&]( const Vec3& ) { return turn; } );
	it.skinIt();
	EXPECT_GT( it.largestError( wanted ), 0.01 ) << "rotations alone know nothing of it";

	std::vector<float> flow;
	for ( int i = 0; i < it.nodes.count; ++i )
	{
		flow.insert( flow.end(), stretch.data(), stretch.data() + 9 ); // symmetric
	}
	it.flow = flow.data();
	it.skinIt();
	EXPECT_LT( it.largestError( wanted ), 2e-6 );
}

TEST_P( Skin, BendingIsFollowedSmoothly )
{
	// A bar bent to a quarter circle: vertices lie on it within a small part of a cell, and the surface has no steps: every edge has the
	// right length, except in the last cell at each end, which lacks the stretch beyond it.
	const double length = 2.0, d = 0.1;
	SkinCase it( test::makeBox( { -1.0, -0.2, -0.2 }, { 1.0, 0.2, 0.2 }, 40 ), d, GetParam() );
	const float curvature = float( 1.5707963 / length );
	const auto bend = [&]( const Vec3& x ) {
		const float angle = curvature * x.x(), radius = 1.0f / curvature - x.y();
		return Vec3( radius * std::sin( angle ), 1.0f / curvature - radius * std::cos( angle ), x.z() );
	};
	const auto turn = [&]( const Vec3& x ) { return Eigen::AngleAxisf( curvature * x.x(), Vec3::UnitZ() ).toRotationMatrix(); };
	it.deform( bend, turn );
	it.skinIt();
	std::printf( "bent bar: largest error %.4f cells\n", it.largestError( bend ) / d );
	EXPECT_LT( it.largestError( bend ), 0.09 * d ); // strain 0.16 times half a cell, at the ends
	double worst = 0.0;
	for ( std::size_t t = 0; t < it.mesh.triangleCount(); ++t )
	{
		for ( int k = 0; k < 3; ++k )
		{
			const int a = int( it.mesh.indices[3 * t + std::size_t( k )] ),
					  b = int( it.mesh.indices[3 * t + std::size_t( ( k + 1 ) % 3 )] );
			if ( std::max( std::abs( it.rest( a ).x() ), std::abs( it.rest( b ).x() ) ) < 1.0 - d )
			{
				const double wanted = ( bend( it.rest( b ) ) - bend( it.rest( a ) ) ).norm();
				worst = std::max( worst, std::abs( ( it.position( b ) - it.position( a ) ).norm() / wanted - 1.0 ) );
			}
		}
	}
	std::printf( "edges of the surface: wrong by %.3f of their length at most\n", worst );
	EXPECT_LT( worst, 0.03 );
}

TEST_P( Skin, WeightsChangeHandsWithoutAJerk )
{
	// One node pushed out by a cell; a fine row of vertices over the face above it must rise and fall without steps.
	const double d = 0.1;
	SkinCase it( test::makeBox( { -0.4, -0.4, -0.4 }, { 0.4, 0.4, 0.4 }, 160 ), d, GetParam() );
	int top = 0;
	for ( int i = 0; i < it.nodes.count; ++i )
	{
		const Vec3 x = it.nodes.x0.get( i ) - Vec3( 0.05f, 0.05f, 0.35f ), best = it.nodes.x0.get( top ) - Vec3( 0.05f, 0.05f, 0.35f );
		top = x.squaredNorm() < best.squaredNorm() ? i : top;
	}
	it.nodes.x.z[top] += float( d );
	it.skinIt();
	double steepest = 0.0, highest = 0.0;
	for ( std::size_t t = 0; t < it.mesh.triangleCount(); ++t )
	{
		for ( int k = 0; k < 3; ++k )
		{
			const int a = int( it.mesh.indices[3 * t + std::size_t( k )] ),
					  b = int( it.mesh.indices[3 * t + std::size_t( ( k + 1 ) % 3 )] );
			const double rise = std::abs( ( it.position( b ).z() - it.rest( b ).z() ) - ( it.position( a ).z() - it.rest( a ).z() ) );
			steepest = std::max( steepest, rise / ( it.rest( b ) - it.rest( a ) ).norm() );
		}
	}
	for ( int v = 0; v < it.vertexCount(); ++v )
	{
		highest = std::max( highest, double( it.position( v ).z() - it.rest( v ).z() ) );
	}
	std::printf( "a node pushed out by a cell: bump %.2f cells high, steepest slope %.2f\n", highest / d, steepest );
	EXPECT_GT( highest, 0.2 * d );
	EXPECT_LT( steepest, 2.0 ); // a step between vertices d / 20 apart would be 20
}

TEST_P( Skin, AnUnweldedCubeStaysWhole )
{
	SkinCase it( test::unwelded( test::makeBox( { -0.5, -0.5, -0.5 }, { 0.5, 0.5, 0.5 }, 8 ) ), 0.11, GetParam() );
	test::Seeded random( 6 );
	for ( int i = 0; i < it.nodes.count; ++i )
	{
		it.nodes.x.set( i, it.nodes.x0.get( i ) + random.inBox( 0.1f ) ); // as irregular as possible
	}
	it.skinIt();
	int pairs = 0;
	for ( int a = 0; a < it.vertexCount(); ++a )
	{
		for ( int b = a + 1; b < it.vertexCount(); ++b )
		{
			if ( it.rest( a ) == it.rest( b ) )
			{
				ASSERT_EQ( it.position( a ), it.position( b ) );
				ASSERT_EQ( it.normal( a ), it.normal( b ) );
				++pairs;
			}
		}
	}
	EXPECT_GT( pairs, 1000 );
}

TEST_P( Skin, TheSameBitsOnAnyThreadCountAndInAnyOrderOfCalls )
{
	SkinCase it( test::makeBumpySphere( 1.0, 0.1, 60, 80 ), 0.15, GetParam() );
	test::Seeded random( 6 );
	for ( int i = 0; i < it.nodes.count; ++i )
	{
		it.nodes.x.set( i, it.nodes.x0.get( i ) + random.inBox( 0.05f ) );
	}
	it.skinIt();
	const std::vector<float> positions = it.positions, normals = it.normals;
	for ( int threads : { 1, 2, 5 } )
	{
		const std::unique_ptr<TaskRunner> runner = createThreadPool( threads );
		it.skinIt( runner.get() );
		EXPECT_EQ( it.positions, positions );
		EXPECT_EQ( it.normals, normals );
	}
	const SkinBinding again = bindSkin( it.mesh.view(), it.lattice(), it.built.weldedVertex, GetParam() );
	EXPECT_EQ( again.node, it.binding.node );
	EXPECT_EQ( again.weight, it.binding.weight );
}

TEST( Normals, OfASphereAreItsRadii )
{
	SkinCase it( test::makeSphere( 1.0, 60, 80 ), 0.2 );
	const Eigen::Matrix3f turn = Eigen::AngleAxisf( 1.1f, Vec3( 1, 2, 3 ).normalized() ).toRotationMatrix();
	it.affine( turn, Vec3( 1, 2, 3 ) );
	it.skinIt();
	for ( int v = 0; v < it.vertexCount(); ++v )
	{
		EXPECT_NEAR( it.normal( v ).norm(), 1.0f, 1e-5f );
		EXPECT_GT( it.normal( v ).dot( turn * it.rest( v ).normalized() ), 0.998f );
	}
}

TEST( Normals, FollowABentFaceAsDifferencesDo )
{
	SkinCase it( test::makeBox( { -1.0, -0.2, -0.2 }, { 1.0, 0.2, 0.2 }, 40 ), 0.1 );
	const auto bend = []( const Vec3& x ) { return Vec3( x.x(), x.y(), x.z() + 0.2f * x.x() * x.x() ); };
	const auto gradient = []( const Vec3& x ) {
		Eigen::Matrix3f g = Eigen::Matrix3f::Identity();
		g( 2, 0 ) = 0.4f * x.x();
		return g;
	};
	it.deform( bend, gradient );
	it.skinIt();
	int tested = 0;
	for ( int v = 0; v < it.vertexCount(); ++v )
	{
		const Vec3 x = it.rest( v );
		if ( x.z() > 0.199f && std::abs( x.x() ) < 0.8f && std::abs( x.y() ) < 0.1f )
		{
			const float e = 1e-2f;
			const Vec3 along = bend( x + e * Vec3::UnitX() ) - bend( x - e * Vec3::UnitX() );
			const Vec3 across = bend( x + e * Vec3::UnitY() ) - bend( x - e * Vec3::UnitY() );
			EXPECT_GT( it.normal( v ).dot( along.cross( across ).normalized() ), 0.995f );
			++tested;
		}
	}
	EXPECT_GT( tested, 100 );
}

TEST( Normals, OfAVertexWithoutAreaTurnAlong )
{
	test::Mesh mesh = test::makeSphere( 1.0, 20, 30 );
	const std::uint32_t lonely = mesh.addVertex( 0.0, 1.0, 0.0 );
	SkinCase it( mesh, 0.25 );
	it.skinIt();
	const Vec3 before = it.normal( int( lonely ) );
	EXPECT_NEAR( before.norm(), 1.0f, 1e-6f );
	const Eigen::Matrix3f turn = Eigen::AngleAxisf( 0.9f, Vec3( 3, 2, 1 ).normalized() ).toRotationMatrix();
	it.affine( turn );
	it.skinIt();
	EXPECT_LT( ( it.normal( int( lonely ) ) - turn * before ).norm(), 1e-5f );

	// All nodes at one position: no triangle has an area, yet every normal is a unit vector.
	it.affine( Eigen::Matrix3f::Zero() );
	for ( int i = 0; i < it.nodes.count; ++i )
	{
		Eigen::Map<Eigen::Vector4f>( it.rotations.data() + 4 * i ) = Eigen::Vector4f( 0, 0, 0, 1 );
	}
	it.skinIt();
	for ( int v = 0; v < it.vertexCount(); ++v )
	{
		EXPECT_NEAR( it.normal( v ).norm(), 1.0f, 1e-4f );
	}
}

} // namespace
} // namespace pliant
