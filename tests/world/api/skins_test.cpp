// The first request for a skin after a step computes, on all threads, the skins of all bodies that were drawn after the last step. Results
// must not depend on this: neither the bits, nor the counters, nor how long a view stays readable; and bodies that are not drawn are not
// computed.

#include "world/levels/adaptive_bodies.h"

#include <gtest/gtest.h>

#include <optional>
#include <vector>

namespace pliant::test {
namespace {

constexpr int kBodies = 7;

/// Bodies of several sizes in free fall, one of them with changing levels.
class Skins : public ::testing::Test
{
protected:
	void fill( int threads )
	{
		world.emplace();
		world->world.setThreadCount( threads );
		for ( int k = 0; k < kBodies; ++k )
		{
			const int edge = k == 3 ? 12 : 3 + k % 3;
			const btTransform where = at( btScalar( 2 * k ), 0, 0 );
			SoftBody* const body = world->addSoft(
				block( edge, edge, edge, 0.1f ), where, stiff( 2e4f ), k == 1 ? levels( 1 ) : Adaptivity{} );
			EXPECT_TRUE( body->setVelocities( btVector3( 0, 0, 0 ), btVector3( 1, btScalar( k ), 2 ) ).ok() );
		}
	}

	/// Steps, and requests the skins of these bodies after each step.
	void run( int frames, const std::vector<int>& lookedAt )
	{
		for ( int frame = 0; frame < frames; ++frame )
		{
			world->run( 1 );
			for ( const int k : lookedAt )
			{
				body( k ).surface();
			}
		}
	}

	const SoftBody& body( int k ) const { return *world->soft[std::size_t( k )]; }
	/// The frame counter of a body's skin, without requesting it.
	unsigned frameOf( int k ) const { return body( k ).impl().skin.frame; }

	std::optional<TestWorld> world;
};

std::vector<float> copyOf( const SurfaceView& view )
{
	std::vector<float> all( view.positions, view.positions + 3 * view.vertexCount );
	all.insert( all.end(), view.normals, view.normals + 3 * view.vertexCount );
	all.push_back( float( view.frame ) );
	all.push_back( float( view.origin.y() ) );
	return all;
}

TEST_F( Skins, AreTheSameForAnyNumberOfThreads )
{
	std::vector<std::vector<float>> seen;
	for ( const int threads : { 1, 2, 4 } )
	{
		fill( threads );
		seen.emplace_back();
		for ( int frame = 0; frame < 12; ++frame )
		{
			world->run( 1 );
			if ( frame == 5 )
			{
				changeLevels( *world->soft[1], coarseNodes( body( 1 ), anyNode ), {} );
			}
			for ( int k = 0; k < kBodies; ++k )
			{
				// In varying order, with gaps, and one of them twice.
				const std::vector<float> copy = copyOf( body( ( k * ( 1 + frame % 5 ) + 3 ) % kBodies ).surface() );
				seen.back().insert( seen.back().end(), copy.begin(), copy.end() );
			}
		}
	}
	EXPECT_EQ( seen[1], seen[0] );
	EXPECT_EQ( seen[2], seen[0] );
}

TEST_F( Skins, OfDrawnBodiesAreComputedWithTheFirst )
{
	fill( 2 );
	run( 3, { 0, 2, 3, 4 } );
	run( 1, { 4 } );
	for ( int k = 0; k < kBodies; ++k )
	{
		const bool isLookedAt = k == 0 || k == 2 || k == 3 || k == 4;
		EXPECT_EQ( frameOf( k ), isLookedAt ? 4u : 0u ) << "body " << k;
		EXPECT_EQ( body( k ).impl().skin.isStale, !isLookedAt ) << "body " << k;
	}
	// Only this one is requested, so after the next step the others are not computed.
	run( 1, { 4 } );
	EXPECT_EQ( frameOf( 4 ), 5u );
	EXPECT_EQ( frameOf( 0 ), 4u );
	EXPECT_EQ( frameOf( 3 ), 4u );
}

TEST_F( Skins, AreDrawnOneByOneWithoutThreads )
{
	fill( 1 );
	run( 2, { 0, 1 } );
	run( 1, { 0 } );
	EXPECT_EQ( frameOf( 0 ), 3u );
	EXPECT_EQ( frameOf( 1 ), 2u );
}

TEST_F( Skins, StayReadableUntilTheStepAfterNext )
{
	fill( 3 );
	for ( int frame = 0; frame < 3; ++frame )
	{
		world->run( 1 );
		std::vector<SurfaceView> views;
		std::vector<std::vector<float>> copies;
		for ( int k = 0; k < kBodies; ++k )
		{
			views.push_back( body( k ).surface() );
			copies.push_back( copyOf( views.back() ) );
		}
		world->run( 1 );
		body( 0 ).surface(); // computes all others too
		for ( int k = 0; k < kBodies; ++k )
		{
			EXPECT_EQ( copyOf( views[std::size_t( k )] ), copies[std::size_t( k )] ) << "body " << k;
		}
	}
}

TEST_F( Skins, OfABodyThatHasLeftAreItsOwn )
{
	fill( 2 );
	run( 2, { 0, 1, 2, 3, 4, 5, 6 } );
	world->run( 1 );
	world->world.removeSoftBody( world->soft[2].get() );
	body( 0 ).surface();
	EXPECT_EQ( frameOf( 2 ), 2u );
	EXPECT_EQ( body( 2 ).surface().frame, 3u );
	EXPECT_EQ( frameOf( 5 ), 3u );
}

/// Returns the largest distance between corresponding vertices of two bodies that move alike, m.
double apart( const SurfaceView& a, const SurfaceView& b )
{
	EXPECT_EQ( a.vertexCount, b.vertexCount );
	const Vec3 origin = toVec3( a.origin - b.origin );
	double most = 0.0;
	for ( int v = 0; v < a.vertexCount; ++v )
	{
		most = std::max( most,
			double( ( Eigen::Map<const Vec3>( a.positions + 3 * v ) - Eigen::Map<const Vec3>( b.positions + 3 * v ) + origin ).norm() ) );
	}
	return most;
}

/// Blocks that fall, hit the floor, rest and sleep; one has levels, one spins so fast that it breaks.
struct Falling
{
	static constexpr int kCount = 4;
	TestWorld test;

	explicit Falling( btScalar tolerance )
	{
		test.addFloor();
		for ( int k = 0; k < kCount; ++k )
		{
			const btTransform where(
				btQuaternion( btVector3( 1, 2, 0 ).normalized(), btScalar( 0.3 * k ) ), btVector3( btScalar( 2 * k ), 1, 0 ) );
			SoftBody* const body = test.addSoft( block( 4, 4, 6, 0.1f ), where, stiff( 3e4f ), k % 2 == 1 ? levels( 1 ) : Adaptivity{} );
			EXPECT_TRUE( body->setVelocities( btVector3( 0, 0, 0 ), btVector3( 0, btScalar( k == 3 ? 20 : 2 * k ), 1 ) ).ok() );
			body->setSurfaceTolerance( tolerance );
			if ( k == 3 )
			{
				Fracture fracture;
				fracture.rule = BreakRule::Distance;
				fracture.breakStrain = 0.03f;
				EXPECT_TRUE( body->setFracture( fracture ).ok() );
			}
		}
	}
};

// Compares with a copy that is skinned in full in every frame: rotated or reused skins are within the tolerance in flight, bent, broken, at
// rest and after a teleport, and cost less.
TEST( SurfaceTolerance, KeepsTheSurfaceNearTheOneSkinnedInFull )
{
	constexpr btScalar kTolerance = btScalar( 0.01 );
	Falling full( 0 ), turned( kTolerance );
	unsigned fullFrames = 0, turnedFrames = 0;
	for ( int frame = 0; frame < 240; ++frame )
	{
		full.test.run( 1 );
		turned.test.run( 1 );
		if ( frame == 200 )
		{
			const btTransform by( btQuaternion( btVector3( 0, 1, 0 ), btScalar( 0.4 ) ), btVector3( 0, btScalar( 0.5 ), 1 ) );
			EXPECT_TRUE( full.test.soft[1]->teleport( by ).ok() );
			EXPECT_TRUE( turned.test.soft[1]->teleport( by ).ok() );
		}
		ASSERT_EQ( full.test.world.softBodyCount(), turned.test.world.softBodyCount() );
		for ( int k = 0; k < full.test.world.softBodyCount(); ++k )
		{
			SoftBody &a = *full.test.world.softBody( k ), &b = *turned.test.world.softBody( k );
			EXPECT_EQ( b.surfaceTolerance(), kTolerance ) << "a piece inherits it";
			const SurfaceView wanted = a.surface(), shown = b.surface();
			EXPECT_LE( apart( shown, wanted ), double( kTolerance ) * 0.1 + 2e-6 ) << "frame " << frame << ", body " << k;
			fullFrames = frame == 239 ? fullFrames + wanted.frame : fullFrames;
			turnedFrames = frame == 239 ? turnedFrames + shown.frame : turnedFrames;
		}
	}
	EXPECT_GT( full.test.world.softBodyCount(), Falling::kCount ) << "nothing came off";
	EXPECT_LT( turnedFrames, fullFrames ) << "no skin was reused";
}

TEST( SurfaceTolerance, KeepsTheViewWhereNothingMoved )
{
	TestWorld test;
	test.world.setGravity( btVector3( 0, 0, 0 ) );
	SoftBody* const body = test.addSoft( block( 4, 4, 4, 0.1f ), at( 0, 0, 0 ) );
	body->setActivationState( DISABLE_DEACTIVATION );
	const SurfaceView before = body->surface();
	test.run( 5 );
	const SurfaceView after = body->surface();
	EXPECT_EQ( after.frame, before.frame );
	EXPECT_EQ( after.positions, before.positions );
	body->setSurfaceTolerance( 0 );
	test.run( 1 );
	EXPECT_EQ( body->surface().frame, before.frame + 1 );
	body->setSurfaceTolerance( btScalar( -1 ) );
	EXPECT_EQ( body->surfaceTolerance(), btScalar( 0 ) );
}

// Where many nodes carry few vertices, the rigidity test would cost more than skinning: a seventh of a step at 19 683 nodes.
TEST( SurfaceTolerance, IsNotTestedWhereManyNodesCarryFewVertices )
{
	TestWorld test;
	test.world.setGravity( btVector3( 0, 0, 0 ) );
	SoftBody* const body = test.addSoft( block( 11, 10, 10, 0.1f ), at( 0, 0, 0 ) );
	const SurfaceView before = body->surface();
	test.run( 1 );
	EXPECT_EQ( body->surface().frame, before.frame + 1 );
}

// Rotated skins are computed from the last full one, which is not overwritten while in use.
TEST( SurfaceTolerance, ViewsOfARotatedBodyStayReadableUntilTheStepAfterNext )
{
	TestWorld test;
	test.world.setGravity( btVector3( 0, 0, 0 ) );
	SoftBody* const body = test.addSoft( block( 4, 4, 4, 0.1f ), at( 0, 0, 0 ) );
	EXPECT_TRUE( body->setLinearVelocity( btVector3( 1, 0, 0 ) ).ok() );
	SurfaceView last = body->surface();
	std::vector<float> copy = copyOf( last );
	for ( int frame = 0; frame < 12; ++frame )
	{
		test.run( 1 );
		if ( frame == 7 )
		{
			body->setSurfaceTolerance( 0 );
		}
		const SurfaceView now = body->surface();
		EXPECT_EQ( copyOf( last ), copy ) << frame;
		EXPECT_NE( now.positions, last.positions ) << frame;
		EXPECT_NEAR( now.positions[0] + float( now.origin.x() ), copy[0] + float( last.origin.x() ) + 1.0f / 60.0f, 1e-5f );
		last = now;
		copy = copyOf( last );
	}
}

} // namespace
} // namespace pliant::test
