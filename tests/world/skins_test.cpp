// The first question for a skin after a step draws, on all threads at once, those of all bodies that were looked at after the last one. What anybody
// sees may not depend on it: not the bits, not the counters, not how long a view may be read; and what nobody asks for is not drawn.

#include "adaptive_bodies.h"

#include <gtest/gtest.h>

#include <optional>
#include <vector>

namespace pliant::test {
namespace {

constexpr int kBodies = 7;

/// Bodies of several sizes in the air, one of them with levels that change.
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
			SoftBody* const body = world->addSoft( block( edge, edge, edge, 0.1f ), where, stiff( 2e4f ), k == 1 ? levels( 1 ) : Adaptivity{} );
			body->setVelocities( btVector3( 0, 0, 0 ), btVector3( 1, btScalar( k ), 2 ) );
		}
	}

	/// Steps, and looks at these bodies after each.
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
	/// Of a body that may not have been asked for.
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
				// In any order, not always all, and one of them twice.
				const std::vector<float> copy = copyOf( body( ( k * ( 1 + frame % 5 ) + 3 ) % kBodies ).surface() );
				seen.back().insert( seen.back().end(), copy.begin(), copy.end() );
			}
		}
	}
	EXPECT_EQ( seen[1], seen[0] );
	EXPECT_EQ( seen[2], seen[0] );
}

TEST_F( Skins, OfThoseLookedAtAreDrawnWithTheFirst )
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
	// Only the one was asked for: after the next step the others are left alone.
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
		body( 0 ).surface(); // draws all others, too
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

} // namespace
} // namespace pliant::test
