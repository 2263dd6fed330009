// Drawing between two steps (SoftBody::setInterpolation): the drawn skin moves evenly if the game draws more often than it steps, as a
// rigid body's motion state does.

#include "lattice/test_meshes.h"
#include "support/renderer_buffers.h"
#include "world/levels/adaptive_bodies.h"

#include <pliant/render/gpu_surface.h>
#include <pliant/render/vertex_attributes.h>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace pliant::test {
namespace {

std::shared_ptr<const BodyTemplate> sphere( int cells )
{
	const Mesh mesh = makeBumpySphere( 0.5, 0.1, 16, 32 );
	LatticeSettings settings;
	settings.targetCells = cells;
	return BodyTemplate::build( mesh.view(), settings ).value;
}

Vec3d vertexOf( const SurfaceView& view, int v )
{
	return toVec3d( view.origin ) + Eigen::Map<const Vec3>( view.positions + 3 * v ).cast<double>();
}

std::vector<Vec3d> verticesOf( const SoftBody& body )
{
	const SurfaceView view = body.surface();
	std::vector<Vec3d> all;
	for ( int v = 0; v < view.vertexCount; ++v )
	{
		all.push_back( vertexOf( view, v ) );
	}
	return all;
}

double apart( const std::vector<Vec3d>& a, const std::vector<Vec3d>& b )
{
	EXPECT_EQ( a.size(), b.size() );
	double most = 0.0;
	for ( std::size_t k = 0; k < std::min( a.size(), b.size() ); ++k )
	{
		most = std::max( most, ( a[k] - b[k] ).norm() );
	}
	return most;
}

// At 144 pictures a second and 60 steps, compared with a rigid body of the same motion.
TEST( Interpolation, MovesASkinAsTheMotionStateOfItsRigidTwin )
{
	TestWorld test;
	test.world.setGravity( btVector3( 0, 0, 0 ) );
	const btVector3 velocity( 3, 1, 0 ), spin( 0, 0, 12 );
	SoftBody* const body = test.addSoft( block( 3, 3, 3, 0.1f ), at( 0, 0, 0 ), stiff( 1e6f ) );
	EXPECT_FALSE( body->interpolation() );
	body->setInterpolation( true );
	EXPECT_TRUE( body->interpolation() );
	EXPECT_TRUE( body->setVelocities( velocity, spin ).ok() );
	btRigidBody* const twin = test.addBox( 1, btVector3( btScalar( 0.15 ), btScalar( 0.15 ), btScalar( 0.15 ) ), at( 0, 5, 0 ) );
	btDefaultMotionState state( at( 0, 5, 0 ) );
	twin->setMotionState( &state );
	twin->setLinearVelocity( velocity );
	twin->setAngularVelocity( spin );
	twin->setDamping( 0, 0 );
	const Vec3d arm = verticesOf( *body ).front();
	double worstPlace = 0.0, worstTurn = 0.0, lagBefore = 0.0;
	for ( int picture = 1; picture <= 100; ++picture )
	{
		test.world.stepSimulation( btScalar( 1 ) / 144, 4 );
		const Vec3d twinAt = toVec3d( state.m_graphicsWorldTrans.getOrigin() - btVector3( 0, 5, 0 ) );
		const Vec3d twinArm = toVec3d( state.m_graphicsWorldTrans.getBasis() * toBt( arm ) );
		Vec3d middle = Vec3d::Zero();
		const std::vector<Vec3d> drawn = verticesOf( *body );
		for ( const Vec3d& vertex : drawn )
		{
			middle += vertex / double( drawn.size() );
		}
		const Vec3d drawnArm = drawn.front() - middle;
		// The rotation of the soft body lags behind slowly, by little from picture to picture.
		const double lag = std::atan2(
			twinArm.x() * drawnArm.y() - twinArm.y() * drawnArm.x(), twinArm.head<2>().dot( drawnArm.head<2>() ) );
		if ( picture > 3 ) // the motion state shows the time before the start until the first step
		{
			worstPlace = std::max( worstPlace, ( middle - twinAt ).norm() );
			worstTurn = std::max( worstTurn, std::abs( lag - lagBefore ) );
		}
		lagBefore = lag;
	}
	std::printf( "off the rigid twin: %.2g m, %.2g rad from picture to picture\n", worstPlace, worstTurn );
	EXPECT_LT( worstPlace, 1e-5 ); // a step is 50 mm
	EXPECT_LT( worstTurn, 8e-3 );  // a step is 0.2 rad
	twin->setMotionState( nullptr );
}

TEST( Interpolation, IsTheLastStepAtOneAndTheOneBeforeAtZero )
{
	TestWorld plain, blended;
	for ( TestWorld* test : { &plain, &blended } )
	{
		test->addFloor();
		SoftBody* const body = test->addSoft( sphere( 150 ), at( 0, btScalar( 0.8 ), 0 ), stiff( 2e4f ) );
		body->setInterpolation( test == &blended );
		body->setSurfaceTolerance( 0 );
		EXPECT_TRUE( body->setVelocities( btVector3( 1, -3, 0 ), btVector3( 2, 5, 0 ) ).ok() );
	}
	std::vector<Vec3d> before = verticesOf( *plain.soft[0] );
	for ( int frame = 0; frame < 20; ++frame )
	{
		plain.run( 1 );
		blended.run( 1 );
		EXPECT_EQ( blended.world.interpolationFraction(), 1 );
		const std::vector<Vec3d> now = verticesOf( *plain.soft[0] );
		const unsigned shown = blended.soft[0]->surface().frame;
		EXPECT_EQ( apart( verticesOf( *blended.soft[0] ), now ), 0.0 );
		blended.world.setInterpolationFraction( 0 );
		EXPECT_LT( apart( verticesOf( *blended.soft[0] ), before ), 1e-6 ) << frame;
		EXPECT_NE( blended.soft[0]->surface().frame, shown );
		blended.world.setInterpolationFraction( btScalar( 0.5 ) );
		const std::vector<Vec3d> middle = verticesOf( *blended.soft[0] );
		for ( std::size_t v = 0; v < middle.size(); ++v )
		{
			EXPECT_LT( ( middle[v] - 0.5 * ( before[v] + now[v] ) ).norm(), 1e-3 ); // an arc's height over its chord: r w^2 dt^2 / 8
		}
		before = now;
	}
}

// Before and after the step in which a body breaks, the drawn surface is the same at the seam of the two steps.
TEST( Interpolation, OfNewPiecesStartsAtTheBodyTheyWere )
{
	for ( const int coarse : { 0, 1 } )
	{
		TestWorld test;
		test.world.setGravity( btVector3( 0, 0, 0 ) );
		SoftBody* const body = test.addSoft( sphere( 300 ), at( 0, 0, 0 ), stiff( 1e5f ), coarse == 0 ? Adaptivity{} : levels( coarse ) );
		body->setInterpolation( true );
		EXPECT_TRUE( body->setVelocities( btVector3( 6, 0, 0 ), btVector3( 0, 4, 0 ) ).ok() );
		test.run( 2 );
		const std::vector<Vec3d> before = verticesOf( *body );
		const Vec3d centre = toVec3d( body->massCentre() );
		EXPECT_GT( body->cutPlane( body->massCentre(), btVector3( 1, 0, 0 ) ), 0 );
		test.run( 1 );
		ASSERT_EQ( test.world.softBodyCount(), 2 );
		double worst = 0.0, way = 0.0;
		for ( int k = 0; k < 2; ++k )
		{
			const SoftBody& piece = *test.world.softBody( k );
			EXPECT_TRUE( piece.interpolation() );
			const std::vector<Vec3d> now = verticesOf( piece );
			test.world.setInterpolationFraction( 0 );
			const std::vector<Vec3d> drawn = verticesOf( piece );
			test.world.setInterpolationFraction( 1 );
			const VertexSourceView sources = vertexSources( piece );
			ASSERT_EQ( sources.vertexCount, int( drawn.size() ) );
			ASSERT_NE( sources.sources, nullptr );
			for ( std::size_t v = 0; v < drawn.size(); ++v )
			{
				const VertexSource& source = sources.sources[v];
				// Next to the cut, vertices follow the cells of their own side after the break, and some are moved to the blade's path.
				const bool isInput = source.vertex[0] != VertexSource::kInside && source.weight[0] == 1.0f;
				if ( isInput && std::abs( ( before[source.vertex[0]] - centre ).x() ) > 0.2 )
				{
					worst = std::max( worst, ( drawn[v] - before[source.vertex[0]] ).norm() );
					way = std::max( way, ( now[v] - drawn[v] ).norm() );
				}
			}
		}
		std::printf( "levels %d: pieces start %.2g m off, and move by %.2g m\n", coarse, worst, way );
		EXPECT_GT( way, 0.09 );
		EXPECT_LT( worst, 0.01 * way );
	}
}

TEST( Interpolation, GoesOnAcrossChangesOfLevels )
{
	TestWorld test;
	test.world.setGravity( btVector3( 0, 0, 0 ) );
	SoftBody* const body = test.addSoft( sphere( 600 ), at( 0, 0, 0 ), stiff( 3e4f ), levels( 2 ) );
	body->setInterpolation( true );
	body->setSurfaceTolerance( 0 );
	EXPECT_TRUE( body->setVelocities( btVector3( 3, 0, 0 ), btVector3( 0, 6, 0 ) ).ok() );
	test.run( 3 );
	unsigned version = body->levelVersion();
	int changes = 0;
	for ( int frame = 0; frame < 20; ++frame )
	{
		const std::vector<Vec3d> before = verticesOf( *body );
		if ( frame == 4 )
		{
			body->requestRefinement( body->massCentre(), body->massCentre() + btVector3( 1, 1, 1 ) );
		}
		test.run( 1 );
		const std::vector<Vec3d> now = verticesOf( *body );
		changes += body->levelVersion() != version ? 1 : 0;
		version = body->levelVersion();
		test.world.setInterpolationFraction( 0 );
		EXPECT_LT( apart( verticesOf( *body ), before ), 0.02 * apart( now, before ) ) << "frame " << frame;
		test.world.setInterpolationFraction( 1 );
	}
	EXPECT_GT( changes, 0 );
}

TEST( Interpolation, DoesNotDrawTheWayOfATeleport )
{
	TestWorld test;
	SoftBody* const body = test.addSoft( block( 3, 3, 3, 0.1f ), at( 0, 0, 0 ) );
	body->setInterpolation( true );
	test.run( 2 );
	test.world.setInterpolationFraction( btScalar( 0.3 ) );
	EXPECT_TRUE( body->teleport( at( 10, 0, 0 ) ).ok() );
	EXPECT_GT( verticesOf( *body ).front().x(), 9.0 );
	EXPECT_TRUE( body->reset( at( -10, 0, 0 ) ).ok() );
	EXPECT_LT( verticesOf( *body ).front().x(), -9.0 );
	test.run( 1 );
	test.world.setInterpolationFraction( btScalar( 0.3 ) );
	EXPECT_LT( verticesOf( *body ).front().x(), -9.0 );
	body->forceActivationState( DISABLE_SIMULATION );
	test.run( 1 );
	EXPECT_EQ( body->impl().drawnFraction(), 1.0 ) << "it does not move";
}

TEST( Interpolation, TurnsNodeTransformsToo )
{
	TestWorld test;
	test.addFloor();
	SoftBody* const body = test.addSoft( sphere( 150 ), at( 0, btScalar( 0.8 ), 0 ), stiff( 2e4f ) );
	body->setInterpolation( true );
	EXPECT_TRUE( body->setVelocities( btVector3( 1, -3, 0 ), btVector3( 2, 5, 0 ) ).ok() );
	RendererBuffers drawn;
	for ( int frame = 0; frame < 20; ++frame )
	{
		test.run( 1 );
		const unsigned number = body->gpuSurface().frame;
		test.world.setInterpolationFraction( btScalar( 0.1 + 0.04 * frame ) );
		drawn.draw( body->gpuSurface() );
		EXPECT_NE( body->gpuSurface().frame, number );
		const SurfaceView wanted = body->surface();
		for ( int v = 0; v < wanted.vertexCount; ++v )
		{
			const Float3 at = { wanted.positions[3 * v], wanted.positions[3 * v + 1], wanted.positions[3 * v + 2] };
			ASSERT_LT( lengthOf( drawn.positions[std::size_t( v )] - at ), 1e-5f );
		}
	}
}

TEST( Interpolation, TakesAnyFraction )
{
	TestWorld test;
	EXPECT_EQ( test.world.interpolationFraction(), 1 );
	test.world.setInterpolationFraction( btScalar( 0.25 ) );
	EXPECT_EQ( test.world.interpolationFraction(), btScalar( 0.25 ) );
	test.world.setInterpolationFraction( -3 );
	EXPECT_EQ( test.world.interpolationFraction(), 0 );
	test.world.setInterpolationFraction( std::numeric_limits<btScalar>::quiet_NaN() );
	EXPECT_EQ( test.world.interpolationFraction(), 1 );
	test.world.setInterpolationFraction( 7 );
	EXPECT_EQ( test.world.interpolationFraction(), 1 );
	test.world.stepSimulation( btScalar( 1 ) / 90, 4 );
	EXPECT_NEAR( test.world.interpolationFraction(), 2.0 / 3.0, 1e-5 );
	test.world.setLatencyMotionStateInterpolation( false );
	test.world.stepSimulation( btScalar( 1 ) / 90, 4 );
	EXPECT_EQ( test.world.interpolationFraction(), 1 );
	SoftBodyResult alone = SoftBody::create( block( 2, 2, 2, 0.1f ), at( 0, 0, 0 ) );
	alone.value->setInterpolation( true );
	EXPECT_EQ( alone.value->surface().frame, 1u );
	EXPECT_FALSE( alone.value->impl().skin.blend->kept.isKept() );
	alone.value->setInterpolation( false );
	EXPECT_EQ( alone.value->impl().skin.blend, nullptr );
}

} // namespace
} // namespace pliant::test
