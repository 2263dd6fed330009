// Bodies whose cells form several disconnected parts: debris, leaves, the boxes of a level's model in one mesh. They are as stable in the
// implicit step as in the explicit one, because each part is handled like a whole body.

#include "support/explicit_material.h"
#include "support/mesh_of_boxes.h"
#include "support/test_world.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace {

using namespace pliant;
using namespace pliant::test;

Material materialOf( Elasticity elasticity, float youngsModulus )
{
	Material material = test::explicitMaterial();
	material.elasticity = elasticity;
	material.youngsModulus = youngsModulus;
	return material;
}

struct Fall
{
	double fastest = 0.0; ///< of any node, m/s
	int products = 0;
	bool isHealthy = true;
};

/// Dropped from 1.5 m, rotated by half a radian, for two and a half seconds.
Fall drop( const std::shared_ptr<const BodyTemplate>& made, Elasticity elasticity, float youngsModulus )
{
	SoftWorld t;
	t.addFloor();
	const SoftBody* const body = t.add(
		made, btVector3( 0, 1.5f, 0 ), materialOf( elasticity, youngsModulus ), btQuaternion( btVector3( 1, 0, 0 ), btScalar( 0.5 ) ) );
	Fall fall;
	for ( int frame = 0; frame < 150; ++frame )
	{
		t.step( 1 );
		fall.products = std::max( fall.products, t.world.stepReport().implicitProducts );
		for ( int i = 0; i < body->nodeCount(); ++i )
		{
			fall.fastest = std::max( fall.fastest, double( body->nodeVelocity( i ).length() ) );
		}
	}
	fall.isHealthy = body->isHealthy();
	return fall;
}

// One mesh of 64 small boxes spread through a metre, at about 800 cells. Relative to the centre of the whole, 150 cells away, the rounding
// error of a part's motion times a stiffness of a thousand would make the body fly apart.
TEST( LooseParts, SpreadThroughAMetreDoNotFlyApart )
{
	for ( const btScalar edge : { btScalar( 0.01 ), btScalar( 0.1 ) } )
	{
		const auto made = spreadCubes( 64, edge, 1 );
		ASSERT_NE( made, nullptr );
		const Fall explicitFall = drop( made, Elasticity::Explicit, 1e5f ), implicitFall = drop( made, Elasticity::Implicit, 1e5f );
		EXPECT_TRUE( explicitFall.isHealthy && implicitFall.isHealthy ) << edge;
		EXPECT_LE( implicitFall.fastest, 1.05 * explicitFall.fastest ) << edge;
		EXPECT_LT( implicitFall.products, 150 ) << edge;
	}
}

struct Loose
{
	int count;
	Cells cells;
};

// Loose cubes, rods, plates and single cells, two to a thousand of them.
TEST( LooseParts, OfAnyNumberAndShapeFallAsTheyDoExplicitly )
{
	for ( const Loose& loose : { Loose{ 2, { 2, 2, 2 } }, Loose{ 27, { 2, 2, 2 } }, Loose{ 40, { 6, 1, 1 } }, Loose{ 20, { 4, 4, 1 } },
			  Loose{ 1000, { 1, 1, 1 } } } )
	{
		const auto made = looseBoxes( loose.count, loose.cells, 0.1f );
		ASSERT_NE( made, nullptr );
		ASSERT_EQ( made->report().components, loose.count );
		const Fall explicitFall = drop( made, Elasticity::Explicit, 1e5f );
		for ( const float youngsModulus : { 1e5f, 1e7f } )
		{
			const Fall implicitFall = drop( made, Elasticity::Implicit, youngsModulus );
			EXPECT_TRUE( implicitFall.isHealthy && explicitFall.isHealthy ) << loose.count;
			EXPECT_LE( implicitFall.fastest, 1.05 * explicitFall.fastest ) << loose.count << " of " << loose.cells.x << " cells";
		}
	}
}

/// Totals over all moving bodies, and sums of absolute values as the scale of errors.
struct Motion
{
	btVector3 momentum = btVector3( 0, 0, 0 ), spin = btVector3( 0, 0, 0 );
	double moved = 0.0, spun = 0.0, energy = 0.0;
};

Motion motionOf( const SoftWorld& t )
{
	Motion sum;
	for ( const auto& body : t.soft )
	{
		for ( int i = 0; i < body->nodeCount(); ++i )
		{
			const btVector3 p = body->nodeMass( i ) * body->nodeVelocity( i ), at = body->nodePosition( i );
			sum.momentum += p;
			sum.spin += at.cross( p );
			sum.moved += double( p.length() );
			sum.spun += double( at.length() * p.length() );
			sum.energy += 0.5 * double( p.dot( body->nodeVelocity( i ) ) );
		}
	}
	return sum;
}

TEST( LooseParts, KeepMomentumInFlightAndWhereTheyCollide )
{
	for ( const Loose& loose : { Loose{ 2, { 2, 2, 2 } }, Loose{ 27, { 2, 2, 2 } }, Loose{ 20, { 6, 1, 1 } }, Loose{ 100, { 1, 1, 1 } } } )
	{
		const auto made = looseBoxes( loose.count, loose.cells, 0.1f );
		ASSERT_NE( made, nullptr );
		for ( const bool collides : { false, true } )
		{
			SoftWorld t;
			t.world.setGravity( btVector3( 0, 0, 0 ) );
			SoftBody* const one = t.add( made, btVector3( 0, 0, 0 ), materialOf( Elasticity::Implicit, 1e6f ),
				btQuaternion( btVector3( 1, 0, 0 ), btScalar( 0.5 ) ) );
			EXPECT_TRUE( one->setVelocities( btVector3( 1, btScalar( 0.3 ), 0 ), btVector3( 1, 2, btScalar( 0.5 ) ) ).ok() );
			if ( collides )
			{
				btVector3 low, high;
				one->getCollisionShape()->getAabb( btTransform::getIdentity(), low, high );
				SoftBody* const other = t.add( made, btVector3( btScalar( 1.2 ) * ( high.x() - low.x() ), btScalar( 0.03 ), 0 ),
					materialOf( Elasticity::Implicit, 1e6f ) );
				EXPECT_TRUE( other->setVelocities( btVector3( -3, 0, 0 ), btVector3( 0, 0, 1 ) ).ok() );
			}
			const Motion before = motionOf( t );
			int contacts = 0;
			for ( int frame = 0; frame < 60; ++frame )
			{
				t.step( 1 );
				contacts = std::max( contacts, t.world.stepReport().softContacts );
			}
			const Motion after = motionOf( t );
			EXPECT_EQ( contacts > 0, collides ) << loose.count;
			EXPECT_LE( double( ( after.momentum - before.momentum ).length() ), 1e-5 * before.moved ) << loose.count;
			EXPECT_LE( double( ( after.spin - before.spin ).length() ), 1e-5 * before.spun ) << loose.count;
			EXPECT_LE( after.energy, 1.0001 * before.energy ) << loose.count;
		}
	}
}

// Debris of 200 fragments on ice, one of which still slides at 0.3 m/s. The mean over the body is 0.02 m/s, which counts as rest for a
// connected body.
TEST( LooseParts, DoNotFreezeTheOneThatStillSlides )
{
	for ( const Elasticity elasticity : { Elasticity::Explicit, Elasticity::Implicit } )
	{
		MeshOfBoxes mesh;
		for ( int k = 0; k < 200; ++k )
		{
			mesh.add( btVector3( btScalar( k % 20 ) * btScalar( 0.2 ), 0, btScalar( k / 20 ) * btScalar( 0.2 ) ),
				btVector3( 1, 1, 1 ) * btScalar( 0.05 ) );
		}
		SoftWorld t;
		t.addFloor();
		SoftBody* const body = t.add( mesh.build( 0.1f ), btVector3( 0, btScalar( 0.05 ), 0 ), materialOf( elasticity, 1e5f ) );
		ASSERT_EQ( body->nodeCount(), 200 );
		body->setFriction( 0 );
		int last = 0;
		for ( int i = 0; i < body->nodeCount(); ++i )
		{
			last = body->nodePosition( i ).x() + body->nodePosition( i ).z() >
					body->nodePosition( last ).x() + body->nodePosition( last ).z()
				? i
				: last;
		}
		EXPECT_TRUE( body->applyImpulse( btVector3( btScalar( 0.3 ), 0, 0 ) * body->nodeMass( last ), last ).ok() );
		const btScalar from = body->nodePosition( last ).x();
		t.step( 180 );
		EXPECT_NEAR( body->nodePosition( last ).x() - from, 0.9, 0.03 );
	}
}

} // namespace
