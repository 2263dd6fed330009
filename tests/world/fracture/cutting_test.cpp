// Cutting and healing in a world, and the handling of small pieces.

#include "support/test_world.h"
#include "world/test_world.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>

namespace pliant {
namespace {

using test::at;
using test::block;
using test::stiff;
using test::TestWorld;

const btVector3 kAlong( 1, 0, 0 ), kOrigin( 0, 0, 0 );

struct CutTotals
{
	double mass = 0.0;
	btVector3 momentum = kOrigin, spin = kOrigin; ///< about the world's origin
	int cells = 0;
};

CutTotals cutTotals( SoftBodyWorld& world )
{
	CutTotals sum;
	for ( int i = 0; i < world.softBodyCount(); ++i )
	{
		const SoftBody& body = *world.softBody( i );
		const btVector3 p = body.linearVelocity() * body.mass();
		sum.mass += double( body.mass() );
		sum.cells += body.cellCount();
		sum.momentum += p;
		sum.spin += body.angularMomentum() + body.massCentre().cross( p );
	}
	return sum;
}

Adaptivity levels( int coarse )
{
	Adaptivity adaptivity;
	adaptivity.coarseLevels = coarse;
	return adaptivity;
}

Fracture smallOnes( SmallPieces policy, int cells )
{
	Fracture fracture; // rule Never: cut by calls only
	fracture.smallPieces = policy;
	fracture.smallCells = cells;
	fracture.fadeTime = 0.25f;
	return fracture;
}

// The piece of a body that ignored the floor stayed on it.
TEST( Cutting, PiecesIgnoreWhatTheirBodyIgnores )
{
	for ( const bool floorIgnores : { false, true } )
	{
		TestWorld t;
		btRigidBody* const floor = t.addFloor();
		SoftBody* const bar = t.addSoft( block( 8, 4, 4, 0.1f ), at( 0, btScalar( 0.4 ), 0 ), stiff( 2e5f ) );
		floorIgnores ? floor->setIgnoreCollisionCheck( bar, true ) : bar->setIgnoreCollisionCheck( floor, true );
		EXPECT_GT( bar->cutPlane( kOrigin, kAlong ), 0 );
		t.run( 60 );
		ASSERT_EQ( t.world.fragmentCount(), 1 );
		SoftBody* const piece = t.world.softBody( 0 ) == bar ? t.world.softBody( 1 ) : t.world.softBody( 0 );
		EXPECT_LT( piece->massCentre().y(), -2 );
		EXPECT_FALSE( piece->checkCollideWith( floor ) && floor->checkCollideWith( piece ) );
		t.world.removeSoftBody( piece ); // gives it to the test
		const std::unique_ptr<SoftBody> holder( piece );
		EXPECT_EQ( floor->getNumObjectsWithoutCollision(), floorIgnores ? 1 : 0 );
	}
}

// Uniform and with levels, tumbling, in one substep: the cutTotals of the halves equal those of the whole.
TEST( Cutting, ABarBecomesTwoBodiesAndKeepsItsTotals )
{
	for ( const int coarse : { 0, 2 } )
	{
		TestWorld test;
		test.world.setGravity( kOrigin );
		SoftBody* soft = test.addSoft( block( 12, 4, 4, 0.1f ), at( 0, 1, 0 ), stiff( 1e5f ), levels( coarse ) );
		EXPECT_TRUE( soft->setVelocities( btVector3( 1, 2, 3 ), btVector3( 0, 2, 1 ) ).ok() );
		test.run( 5 );
		const CutTotals before = cutTotals( test.world );
		const int cut = soft->cutPlane( soft->massCentre(), soft->bestFitTransform().getBasis() * kAlong );
		EXPECT_EQ( cut, 100 );                                                                              // ( 3 * 4 - 2 )^2
		EXPECT_EQ( soft->cutPlane( soft->massCentre(), soft->bestFitTransform().getBasis() * kAlong ), 0 ); // already cut
		EXPECT_EQ( test.world.softBodyCount(), 1 );                                                         // not separated yet
		test.run( 1 );
		ASSERT_EQ( test.world.softBodyCount(), 2 );
		ASSERT_EQ( test.world.fractureEvents().size(), 1u );
		EXPECT_EQ( test.world.fractureEvents()[0].links, 100 );
		EXPECT_NEAR( test.world.fractureEvents()[0].area, 0.16, 1e-6 );
		const CutTotals after = cutTotals( test.world );
		std::printf( "%d levels: momentum off by %.1e, spin by %.1e\n", coarse,
			double( ( after.momentum - before.momentum ).length() / before.momentum.length() ),
			double( ( after.spin - before.spin ).length() / before.spin.length() ) );
		EXPECT_EQ( after.cells, 192 );
		EXPECT_NEAR( after.mass / before.mass, 1.0, 1e-6 );
		EXPECT_LT( ( after.momentum - before.momentum ).length(), 1e-6 * before.momentum.length() );
		EXPECT_LT( ( after.spin - before.spin ).length(), 1e-5 * before.spin.length() );
		EXPECT_EQ( test.world.softBody( 0 )->cellCount(), 96 );
		EXPECT_EQ( test.world.softBody( 1 )->cellCount(), 96 );
		EXPECT_EQ( test.world.softBody( 1 )->fadeFraction(), 1.0f );
		test.run( 30 );
		EXPECT_EQ( test.world.softBodyCount(), 2 );
	}
}

TEST( Cutting, ASleepingBodyWakesAndComesApart )
{
	TestWorld test;
	test.addFloor();
	SoftBody* soft = test.addSoft( block( 8, 4, 4, 0.1f ), at( 0, btScalar( 0.25 ), 0 ), stiff( 2e5f ) );
	for ( int frame = 0; frame < 600 && soft->isActive(); ++frame )
	{
		test.run( 1 );
	}
	ASSERT_FALSE( soft->isActive() );
	EXPECT_EQ( soft->cutPlane( btVector3( 50, 0, 0 ), kAlong ), 0 );
	EXPECT_FALSE( soft->isActive() ); // nothing was cut
	EXPECT_EQ( soft->cutPlane( kOrigin, kAlong ), 100 );
	EXPECT_TRUE( soft->isActive() );
	test.run( 1 );
	EXPECT_EQ( test.world.softBodyCount(), 2 );
	test.run( 60 );
	EXPECT_GT( test::lowestNode( *soft ), 0 );
}

TEST( Cutting, ABallAndABladeCutOutTheEnclosedCells )
{
	TestWorld test;
	test.world.setGravity( kOrigin );
	SoftBody* soft = test.addSoft( block( 9, 9, 9, 0.1f ), at( 0, 1, 0 ) );
	EXPECT_GT( soft->cutSphere( btVector3( 0, 1, 0 ), btScalar( 0.16 ) ), 0 );
	test.run( 1 );
	ASSERT_EQ( test.world.softBodyCount(), 2 );
	EXPECT_EQ( test.world.softBody( 1 )->cellCount(), 19 ); // the middle cell, its 6 face and its 12 edge neighbours
	// A blade from above in ten strokes while the body hangs still.
	int cut = 0;
	for ( int k = 0; k < 10; ++k )
	{
		const btScalar y0 = btScalar( 1.6 ) - btScalar( 0.12 ) * k, y1 = y0 - btScalar( 0.12 ), x = btScalar( 0.3 );
		cut += soft->cutSweep( btVector3( x, y0, -1 ), btVector3( x, y0, 1 ), btVector3( x, y1, -1 ), btVector3( x, y1, 1 ) );
		test.run( 1 );
		EXPECT_EQ( test.world.softBodyCount(), k < 8 ? 2 : 3 ) << k;
	}
	EXPECT_EQ( cut, 25 * 25 );
}

TEST( Cutting, IsTheSameOnAnyNumberOfThreads )
{
	std::vector<float> states[3];
	const int threads[3] = { 1, 2, 5 };
	for ( int run = 0; run < 3; ++run )
	{
		TestWorld test;
		test.world.setThreadCount( threads[run] );
		test.addFloor();
		for ( int k = 0; k < 3; ++k )
		{
			SoftBody* soft = test.addSoft(
				block( 8, 8, 8, 0.05f ), at( btScalar( 0.1 * k ), btScalar( 0.4 + 0.6 * k ), 0 ), stiff( 1e5f ), levels( k ) );
			ASSERT_TRUE( soft->setFracture( smallOnes( k == 1 ? SmallPieces::Rigid : SmallPieces::Fade, 40 ) ).ok() );
		}
		for ( int frame = 0; frame < 40; ++frame )
		{
			for ( int i = 0; frame % 8 == 4 && i < test.world.softBodyCount(); ++i )
			{
				SoftBody* body = test.world.softBody( i );
				body->cutPlane( body->massCentre(), btVector3( 1, btScalar( 0.1 * frame ), btScalar( i - 1 ) ) );
			}
			test.run( 1 );
		}
		EXPECT_GE( test.world.softBodyCount(), 12 );
		for ( int i = 0; i < test.world.softBodyCount(); ++i )
		{
			const SoftBody* body = test.world.softBody( i );
			for ( int node = 0; node < body->nodeCount(); ++node )
			{
				const btVector3 p = body->nodePosition( node ), v = body->nodeVelocity( node );
				states[run].insert(
					states[run].end(), { float( p.x() ), float( p.y() ), float( p.z() ), float( v.x() ), float( v.y() ), float( v.z() ) } );
			}
		}
	}
	for ( int run = 1; run < 3; ++run )
	{
		ASSERT_EQ( states[run].size(), states[0].size() );
		EXPECT_EQ( std::memcmp( states[run].data(), states[0].data(), states[0].size() * sizeof( float ) ), 0 );
	}
}

TEST( Cutting, ASlitHealsCompletely )
{
	for ( const int coarse : { 0, 1 } )
	{
		TestWorld test;
		test.world.setGravity( kOrigin );
		const auto shape = block( 12, 4, 4, 0.1f );
		SoftBody* soft = test.addSoft( shape, at( 0, 1, 0 ), stiff( 1e5f ), levels( coarse ) );
		EXPECT_EQ( soft->heal(), 0 );
		const btVector3 corner( 0, btScalar( 1.2 ), 0 );
		const int cut = soft->cutPlane( corner, kAlong, btScalar( 0.25 ) );
		ASSERT_GT( cut, 10 );
		test.run( 2 );
		EXPECT_EQ( test.world.softBodyCount(), 1 );
		EXPECT_EQ( soft->heal( btScalar( 0.5 ) ), 0 ); // they are further apart than that
		EXPECT_EQ( soft->heal(), cut );
		EXPECT_EQ( soft->heal(), 0 );
		test.run( 2 );
		EXPECT_TRUE( test.world.fractureEvents().empty() );
		// As whole as before: a plane cuts as many links as in the intact body.
		EXPECT_EQ( soft->heal(), 0 );
		EXPECT_EQ( soft->cutPlane( btVector3( 0, 1, 0 ), kAlong ), 100 );
		test.run( 1 );
		EXPECT_EQ( test.world.softBodyCount(), 2 );
		EXPECT_EQ( soft->heal(), 0 ); // separated pieces do not heal
	}
}

TEST( SmallPiecesPolicy, RemovedOnesAreNotMadeAndAreAccountedFor )
{
	for ( const int coarse : { 0, 1 } )
	{
		TestWorld test;
		test.world.setGravity( kOrigin );
		SoftBody* soft = test.addSoft( block( 12, 4, 4, 0.1f ), at( 0, 1, 0 ), stiff( 1e5f ), levels( coarse ) );
		ASSERT_TRUE( soft->setFracture( smallOnes( SmallPieces::Remove, 32 ) ).ok() );
		EXPECT_EQ( soft->fracture().smallCells, 32 );
		const double before = double( soft->mass() );
		// 2 layers are removed, 3 layers are too many to be small.
		EXPECT_GT( soft->cutPlane( btVector3( btScalar( -0.4 ), 0, 0 ), kAlong ), 0 );
		EXPECT_GT( soft->cutPlane( btVector3( btScalar( 0.3 ), 0, 0 ), kAlong ), 0 );
		test.run( 1 );
		ASSERT_EQ( test.world.fractureEvents().size(), 1u );
		const FractureEvent& event = test.world.fractureEvents()[0];
		EXPECT_EQ( event.removedPieces, 1 );
		EXPECT_NEAR( event.removedMass, 32 * before / 192, 1e-6 * before );
		EXPECT_EQ( event.fragments.size(), 1u );
		EXPECT_EQ( test.world.stepReport().removedPieces, 1 );
		const CutTotals after = cutTotals( test.world );
		EXPECT_EQ( after.cells, 160 );
		EXPECT_NEAR( ( after.mass + event.removedMass ) / before, 1.0, 1e-6 );
		// The body itself remains, however small it is.
		soft->cutPlane( btVector3( btScalar( -0.2 ), 0, 0 ), kAlong );
		soft->cutPlane( btVector3( 0, 0, 0 ), kAlong );
		soft->cutPlane( btVector3( btScalar( 0.1 ), 0, 0 ), kAlong );
		test.run( 1 );
		EXPECT_EQ( soft->cellCount(), 32 );
		EXPECT_EQ( test.world.stepReport().removedPieces, 3 );
		test.run( 1 );
		EXPECT_EQ( test.world.stepReport().removedPieces, 0 );
	}
}

TEST( SmallPiecesPolicy, RigidOnesAreOneClusterAndKeepMomentum )
{
	for ( const int coarse : { 0, 2 } )
	{
		TestWorld test;
		test.world.setGravity( kOrigin );
		SoftBody* soft = test.addSoft( block( 12, 4, 4, 0.1f ), at( 0, 1, 0 ), stiff( 1e5f ), levels( coarse ) );
		Fracture settings = smallOnes( SmallPieces::Rigid, 50 );
		settings.rule = BreakRule::Distance;
		settings.breakStrain = 5.0f;
		ASSERT_TRUE( soft->setFracture( settings ).ok() );
		EXPECT_TRUE( soft->setVelocities( btVector3( 1, 2, 3 ), btVector3( 2, 2, 1 ) ).ok() );
		test.run( 5 );
		const CutTotals before = cutTotals( test.world );
		const btTransform fit = soft->bestFitTransform();
		EXPECT_GT( soft->cutPlane( fit * btVector3( btScalar( -0.3 ), 0, 0 ), fit.getBasis() * kAlong ), 0 );
		test.run( 1 );
		ASSERT_EQ( test.world.softBodyCount(), 2 );
		SoftBody* small = test.world.softBody( 1 );
		EXPECT_EQ( small->cellCount(), 48 );
		EXPECT_EQ( small->nodeCount(), 48 );
		EXPECT_EQ( small->material().method, Method::SingleCluster );
		EXPECT_EQ( small->material().clusterMode, ClusterMode::Rigid );
		EXPECT_EQ( small->fracture().rule, BreakRule::Never );
		EXPECT_EQ( soft->material().method, Method::Lattice );
		EXPECT_EQ( soft->fracture().rule, BreakRule::Distance );
		const CutTotals after = cutTotals( test.world );
		EXPECT_NEAR( after.mass / before.mass, 1.0, 1e-6 );
		EXPECT_LT( ( after.momentum - before.momentum ).length(), 2e-6 * before.momentum.length() );
		EXPECT_LT( ( after.spin - before.spin ).length(), 2e-5 * before.spin.length() );
		// It is rigid and can be cut further, down to single cells; all of them keep rotating.
		test.run( 20 );
		EXPECT_NEAR( ( small->nodePosition( 0 ) - small->nodePosition( 47 ) ).length(), btScalar( 0.1 ) * btSqrt( btScalar( 22 ) ), 1e-3 );
		for ( int k = 0; k < 6 && small->cellCount() > 1; ++k )
		{
			const btTransform now = small->bestFitTransform();
			EXPECT_GT( small->cutPlane( small->massCentre(), now.getBasis() * btVector3( k % 3 == 0, k % 3 == 1, k % 3 == 2 ) ), 0 ) << k;
			test.run( 2 );
		}
		EXPECT_EQ( cutTotals( test.world ).cells, 192 );
		EXPECT_LE( small->cellCount(), 2 );
		for ( int i = 0; i < test.world.softBodyCount(); ++i )
		{
			EXPECT_TRUE( test.world.softBody( i )->isHealthy() );
		}
	}
}

TEST( SmallPiecesPolicy, FadingOnesGoWhenTheirTimeIsUp )
{
	TestWorld test;
	test.addFloor();
	SoftBody* soft = test.addSoft( block( 12, 4, 4, 0.1f ), at( 0, btScalar( 0.3 ), 0 ), stiff( 2e5f ) );
	ASSERT_TRUE( soft->setFracture( smallOnes( SmallPieces::Fade, 16 ) ).ok() );
	for ( const double x : { -0.5, 0.5 } )
	{
		EXPECT_GT( soft->cutPlane( btVector3( btScalar( x ), 0, 0 ), kAlong ), 0 );
	}
	test.run( 1 );
	ASSERT_EQ( test.world.softBodyCount(), 3 );
	ASSERT_EQ( test.world.fragmentCount(), 2 );
	SoftBody* mine = test.world.softBody( 1 );
	ASSERT_TRUE( test.world.releaseFragment( mine ) );
	const std::unique_ptr<SoftBody> holder( mine );
	EXPECT_EQ( soft->fadeFraction(), 1.0f );
	float last = 1.0f;
	int removed = 0, frames = 1; // the frame of the cut
	while ( test.world.softBodyCount() > 1 && frames < 100 )
	{
		const float fraction = mine->fadeFraction();
		EXPECT_TRUE( fraction <= last && fraction >= 0.0f );
		last = fraction;
		test.run( 1 );
		removed += test.world.stepReport().removedPieces;
		++frames;
	}
	EXPECT_NEAR( frames, 16, 2 ); // a quarter of a second
	EXPECT_EQ( removed, 2 );
	EXPECT_EQ( test.world.softBodyCount(), 1 );
	EXPECT_EQ( test.world.fragmentCount(), 0 ); // the world's piece is deleted
	EXPECT_EQ( mine->nodeCount(), 16 );         // the test's piece has only left the world
	EXPECT_EQ( mine->fadeFraction(), 0.0f );
	test.world.addSoftBody( mine ); // it stays if it is added again
	test.run( 5 );
	EXPECT_EQ( test.world.softBodyCount(), 2 );
	test.world.removeSoftBody( mine );
}

// After a slanted cut nodes merge, whose spheres reach over the cut. The parts were pushed apart at .08 to .23 m/s.
TEST( Cutting, PartsOfABodyOnLevelsStayTogether )
{
	for ( const Elasticity elasticity : { Elasticity::Explicit, Elasticity::Implicit } )
	{
		for ( const int levels : { 1, 2 } )
		{
			test::SoftWorld test;
			test.world.setGravity( btVector3( 0, 0, 0 ) );
			Material material;
			material.youngsModulus = 1e6f;
			material.elasticity = elasticity;
			Adaptivity adaptivity;
			adaptivity.coarseLevels = levels;
			SoftBody* const body = test.add(
				test::cubeTemplate( 0.8f, 8 ), btVector3( 0, 0, 0 ), material, btQuaternion::getIdentity(), adaptivity );
			test.step( 5 );
			ASSERT_GT( body->cutPlane( btVector3( 0, 0, 0 ), btVector3( btScalar( 0.3 ), 1, 0 ).normalized() ), 0 );
			test.step( 60 );
			ASSERT_EQ( test.world.softBodyCount(), 2 );
			EXPECT_LT( double( body->linearVelocity().length() ), 0.05 ) << levels << " levels";
		}
	}
}

} // namespace
} // namespace pliant
