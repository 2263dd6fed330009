// Bodies with levels of detail in a world: resting and carrying loads, and the update of references when nodes are split and merged.

#include "world/bodies/soft_body_impl.h"
#include "world/levels/adaptive_bodies.h"

#include <algorithm>
#include <random>

namespace pliant {
namespace {

using test::anyNode;
using test::at;
using test::block;
using test::changeLevels;
using test::coarseNodes;
using test::levels;
using test::stiff;
using test::TestWorld;

btScalar lowestPoint( const SoftBody& body )
{
	btScalar low = SIMD_INFINITY;
	for ( int i = 0; i < body.nodeCount(); ++i )
	{
		low = btMin( low, body.nodePosition( i ).y() - body.nodeRadius( i ) );
	}
	return low;
}

TEST( Adaptive, UniformBodiesHaveOneLevelAndRequestNoChanges )
{
	TestWorld test;
	SoftBody* soft = test.addSoft( block( 3, 3, 3, 0.2f ), at( 0, 1, 0 ) );
	soft->requestRefinement( btVector3( -9, -9, -9 ), btVector3( 9, 9, 9 ) );
	soft->setFinestLevel( 2 );
	test.run( 3 );
	EXPECT_EQ( soft->nodeCount(), 27 );
	EXPECT_EQ( soft->nodeLevel( 5 ), 0 );
	EXPECT_EQ( soft->nodeOfCell( 5 ), 5 );
	EXPECT_EQ( soft->nodeOfCell( 27 ), -1 );
	EXPECT_EQ( soft->levelVersion(), 0u );
	EXPECT_EQ( test.world.stepReport().nodesOnLevel[0], 27 );
	EXPECT_EQ( test.world.stepReport().levelChanges, 0 );
}

TEST( Adaptive, BlockRestsAndCarriesAtTheHeightOfTheUniformOne )
{
	// Blocks of full nodes, and of slabs, which fill only half of their nodes.
	for ( const int height : { 8, 2 } )
	{
		btScalar low[2], top[2];
		for ( const bool isAdaptive : { false, true } )
		{
			TestWorld test;
			test.addFloor();
			const btScalar half = btScalar( 0.05 ) * btScalar( height );
			SoftBody* soft = test.addSoft( block( 8, height, 8, 0.1f ), at( 0, half, 0 ), stiff( 4e5f ), levels( isAdaptive ? 2 : 0 ) );
			EXPECT_EQ( soft->nodeCount(), isAdaptive ? height == 8 ? 8 : 4 : 64 * height );
			const btVector3 halfSize( btScalar( 0.4 ), btScalar( 0.1 ), btScalar( 0.4 ) );
			btRigidBody* box = test.addBox( 5, halfSize, at( 0, 2 * half + btScalar( 0.1 ), 0 ) );
			test.run( 120 );
			low[isAdaptive] = lowestPoint( *soft );
			top[isAdaptive] = box->getWorldTransform().getOrigin().y() - btScalar( 0.1 );
		}
		EXPECT_NEAR( low[1], 0, 0.005 );
		EXPECT_NEAR( top[1], top[0], 0.02 );
	}
}

TEST( Adaptive, ContactRefinesLocallyAndMergesAfterwards )
{
	TestWorld test;
	btRigidBody* floor = test.addFloor();
	Adaptivity settings = levels( 2 );
	settings.refinesOnContact = true;
	SoftBody* soft = test.addSoft( block( 8, 16, 8, 0.1f ), at( 0, btScalar( 0.8 ), 0 ), stiff( 4e5f ), settings );
	const int before = soft->nodeCount();
	test.run( 60 );
	const StepReport& report = test.world.stepReport();
	EXPECT_EQ( report.nodesOnLevel[0] + report.nodesOnLevel[1] + report.nodesOnLevel[2], soft->nodeCount() );
	EXPECT_GE( report.nodesOnLevel[0], 64 );
	EXPECT_GE( report.nodesOnLevel[2], before / 2 );
	for ( int i = 0; i < soft->nodeCount(); ++i )
	{
		EXPECT_TRUE( soft->nodeLevel( i ) == 0 || soft->nodePosition( i ).y() > soft->nodeRadius( i ) * btScalar( 1.1 ) ) << i;
	}
	EXPECT_NEAR( lowestPoint( *soft ), 0, 0.01 );
	const unsigned version = soft->levelVersion();
	test.run( 60 );
	EXPECT_EQ( soft->levelVersion(), version ) << "levels change although the body rests";

	floor->setWorldTransform( at( 0, -20, 0 ) );
	test.world.updateSingleAabb( floor );
	soft->activate( true );
	test.run( 40 );
	EXPECT_EQ( soft->nodeCount(), before );
}

TEST( Adaptive, SmallThingsDoNotFallBetweenBigNodes )
{
	for ( const bool refines : { false, true } )
	{
		TestWorld test;
		test.addFloor();
		Adaptivity settings = levels( 2 );
		settings.refinesOnContact = refines;
		SoftBody* soft = test.addSoft( block( 8, 8, 8, 0.1f ), at( 0, btScalar( 0.4 ), 0 ), stiff( 4e5f ), settings );
		test.run( 10 );
		// Right above the channel between four big spheres down to the floor.
		btRigidBody* ball = test.add( 1, new btSphereShape( btScalar( 0.07 ) ), at( 0, 1, 0 ) );
		ball->setActivationState( DISABLE_DEACTIVATION );
		test.run( 120 );
		EXPECT_NEAR( ball->getWorldTransform().getOrigin().y() - btScalar( 0.07 ), 0.8, 0.01 );
		const unsigned version = soft->levelVersion();
		test.run( 60 );
		EXPECT_EQ( soft->levelVersion(), version );
		EXPECT_EQ( version > 0, refines );
	}
}

TEST( Adaptive, ContactsOfNodesThatStayKeepTheirImpulses )
{
	TestWorld test;
	test.addFloor();
	SoftBody* soft = test.addSoft( block( 8, 16, 8, 0.1f ), at( 0, btScalar( 0.8 ), 0 ), stiff( 4e5f ), levels( 2 ) );
	soft->setActivationState( DISABLE_DEACTIVATION );
	test.run( 90 );
	const auto oldest = [&test] {
		int age = 0;
		for ( int m = 0; m < test.parts.dispatcher.getNumManifolds(); ++m )
		{
			const btPersistentManifold* manifold = test.parts.dispatcher.getManifoldByIndexInternal( m );
			age = manifold->getNumContacts() > 0 ? btMax( age, manifold->getContactPoint( 0 ).getLifeTime() ) : age;
		}
		return age;
	};
	const int contacts = test.world.stepReport().softContacts, age = oldest();
	ASSERT_EQ( contacts, 4 );
	const btScalar restsAt = soft->massCentre().y();
	// The upper half splits, and a corner on the floor.
	const auto isHigh = []( const SoftBody& s, int i ) { return s.nodePosition( i ).y() > btScalar( 0.8 ) || i == 0; };
	changeLevels( *soft, coarseNodes( *soft, isHigh ), {} );
	EXPECT_TRUE( SoftBody::upcast( test.parts.dispatcher.getManifoldByIndexInternal( 0 )->getBody0() ) == soft ||
		SoftBody::upcast( test.parts.dispatcher.getManifoldByIndexInternal( 0 )->getBody1() ) == soft );
	test.run( 1 );
	EXPECT_GT( oldest(), age );
	EXPECT_EQ( test.world.stepReport().softContacts, contacts - 1 + 4 );
	for ( int m = 0; m < test.parts.dispatcher.getNumManifolds(); ++m )
	{
		const btPersistentManifold* manifold = test.parts.dispatcher.getManifoldByIndexInternal( m );
		const bool softIsFirst = SoftBody::upcast( manifold->getBody0() ) == soft;
		const btManifoldPoint& point = manifold->getContactPoint( 0 );
		const int node = softIsFirst ? point.m_index0 : point.m_index1;
		const btVector3 where = ( softIsFirst ? manifold->getBody0() : manifold->getBody1() )->getWorldTransform().getOrigin();
		EXPECT_LT( ( soft->nodePosition( node ) - where ).length(), 0.01 ) << node;
	}
	test.run( 60 );
	EXPECT_NEAR( soft->massCentre().y(), restsAt, 0.01 );
}

TEST( Adaptive, SpheresEqualThoseOfANewBodyWithTheSameLevels )
{
	TestWorld test;
	SoftBody* soft = test.addSoft( block( 10, 12, 8, 0.1f ), at( 0, 1, 0 ), stiff( 1e5f ), levels( 2 ) );
	std::mt19937 random( 5 );
	std::vector<std::vector<std::uint32_t>> splits;
	for ( int round = 0; round < 8; ++round )
	{
		if ( round % 4 == 3 )
		{
			changeLevels( *soft, {}, splits.back() );
			splits.pop_back();
		}
		else
		{
			std::vector<std::uint32_t> split = coarseNodes( *soft, anyNode );
			std::erase_if( split, [&random]( std::uint32_t ) { return random() % 2 == 0; } );
			changeLevels( *soft, split, {} );
			splits.push_back( split );
		}
		NodeShape& shape = *soft->impl().shape;
		shape.freshen();
		NodeShape fresh( *soft->impl().body );
		ASSERT_EQ( shape.getNumChildShapes(), fresh.getNumChildShapes() );
		std::vector<int> found( std::size_t( shape.getNumChildShapes() ), 0 );
		shape.rows().visitOverlaps(
			SphereRows::Box{ { -9, -9, -9 }, { 9, 9, 9 } }, [&]( int node ) { ++found[std::size_t( shape.childOfNode( node ) )]; } );
		EXPECT_EQ( found, std::vector<int>( found.size(), 1 ) );
		for ( int i = 0; i < soft->nodeCount(); ++i )
		{
			const int child = shape.childOfNode( i );
			ASSERT_EQ( child < 0, fresh.childOfNode( i ) < 0 );
			EXPECT_EQ( shape.sphereOfNode( i )->getRadius(), fresh.sphereOfNode( i )->getRadius() );
			if ( child >= 0 )
			{
				EXPECT_EQ( soft->nodeOfShapeIndex( child ), i );
				EXPECT_EQ( shape.getChildShape( child ), shape.sphereOfNode( i ) );
				const btVector3 sphere = soft->getWorldTransform() * shape.getChildTransform( child ).getOrigin();
				EXPECT_LT( ( sphere - soft->nodePosition( i ) ).length(), 1e-5 );
				for ( const btDbvtNode* node = shape.getChildList()[child].m_node; node->parent; node = node->parent )
				{
					EXPECT_TRUE( node->parent->volume.Contain( node->volume ) ); // children protrude from their parent's sphere
				}
			}
		}
	}
}

/// A post of four big nodes, the top one pinned, the bottom one attached to a rigid body.
struct HeldPost
{
	TestWorld test;
	btRigidBody* carrier = test.addBox( 0, btVector3( 1, 1, 1 ), at( 30, 0, 0 ) );
	SoftBody* soft = test.addSoft( block( 4, 16, 4, 0.1f ), at( 0, 2, 0 ), stiff( 1e5f ), levels( 2 ) );
	HeldPost()
	{
		EXPECT_EQ( soft->nodeCount(), 4 );
		EXPECT_TRUE( soft->pinNode( ends( true )[0] ).ok() );
		EXPECT_TRUE( soft->pinNodeToBody( ends( false )[0], carrier ).ok() );
	}
	std::vector<int> ends( bool isTop ) const
	{
		std::vector<int> nodes;
		for ( int i = 0; i < soft->nodeCount(); ++i )
		{
			if ( std::abs( soft->nodePosition( i ).y() - 2 - ( isTop ? 1 : -1 ) * btScalar( 0.6 ) ) < 0.2 )
			{
				nodes.push_back( i );
			}
		}
		return nodes;
	}
	void splitAll()
	{
		changeLevels( *soft, coarseNodes( *soft, anyNode ), {} );
		ASSERT_EQ( soft->nodeCount(), 32 );
	}
};

TEST( Adaptive, PinsFollowTheirNodes )
{
	HeldPost post;
	SoftBody* const soft = post.soft;
	post.splitAll();
	std::vector<btVector3> was;
	for ( const bool isTop : { true, false } )
	{
		EXPECT_EQ( post.ends( isTop ).size(), 8u );
		for ( const int node : post.ends( isTop ) )
		{
			EXPECT_TRUE( soft->isPinned( node ) );
			was.push_back( soft->nodePosition( node ) );
		}
	}
	post.test.run( 2 );
	std::size_t k = 0;
	for ( const bool isTop : { true, false } )
	{
		for ( const int node : post.ends( isTop ) )
		{
			EXPECT_LT( ( soft->nodePosition( node ) - was[k++] ).length(), 1e-5 );
		}
	}
}

// A node that was pinned as a whole is merged again when its children are no longer requested, with the same pin.
TEST( Adaptive, NodesPinnedAsOneAreMergedAgain )
{
	HeldPost post;
	SoftBody* const soft = post.soft;
	post.splitAll();
	post.test.run( 30 );
	ASSERT_EQ( soft->nodeCount(), 4 );
	const int held = post.ends( true )[0], carried = post.ends( false )[0];
	EXPECT_TRUE( soft->isPinned( held ) && soft->isPinned( carried ) );
	const btVector3 before = soft->nodePosition( carried ), top = soft->nodePosition( held );
	EXPECT_LT( ( before - btVector3( 0, btScalar( 1.4 ), 0 ) ).length(), 1e-5 );
	post.carrier->setWorldTransform( at( 30, btScalar( 0.1 ), 0 ) );
	post.test.run( 1 );
	EXPECT_LT( ( soft->nodePosition( carried ) - before - btVector3( 0, btScalar( 0.1 ), 0 ) ).length(), 1e-5 );
	EXPECT_EQ( soft->nodePosition( held ), top );
}

// But not if one of the children was released since, or pinned separately: a pin holds one node only.
TEST( Adaptive, NodesPinnedInPartsAreNotMerged )
{
	HeldPost post;
	SoftBody* const soft = post.soft;
	post.splitAll();
	soft->releaseNode( post.ends( true )[0] );
	post.test.run( 30 );
	EXPECT_EQ( soft->nodeCount(), 11 );
	for ( int i = 0; i < soft->nodeCount(); ++i )
	{
		EXPECT_TRUE( soft->nodeLevel( i ) == 2 || soft->isPinned( i ) || soft->pinNode( i ).ok() );
	}
	post.test.run( 30 );
	EXPECT_EQ( soft->nodeCount(), 11 );
	for ( int node = 0; node < soft->nodeCount(); soft->releaseNode( node++ ) )
	{}
	post.test.run( 30 );
	EXPECT_EQ( soft->nodeCount(), 4 );
	EXPECT_LT( soft->massCentre().y(), 1.9 ) << "released nodes fall";
}

TEST( Adaptive, ViewDistanceMergesAndSplitsAgain )
{
	TestWorld test;
	test.world.setGravity( btVector3( 0, 0, 0 ) );
	Adaptivity settings = levels( 2 );
	settings.isSurfaceFine = true;
	SoftBody* soft = test.addSoft( block( 12, 12, 12, 0.1f ), at( 0, 0, 0 ), stiff( 1e5f ), settings );
	soft->setActivationState( DISABLE_DEACTIVATION );
	const int near = soft->nodeCount();
	EXPECT_GT( near, 1000 );
	soft->setFinestLevel( 2 );
	test.run( 10 );
	EXPECT_EQ( soft->nodeCount(), 27 );
	soft->setFinestLevel( 0 );
	test.run( 30 );
	EXPECT_EQ( soft->nodeCount(), near );
	soft->requestRefinement( btVector3( -9, -9, -9 ), btVector3( 9, 9, 9 ) );
	test.run( 1 );
	EXPECT_GT( soft->nodeCount(), near );
}

/// Returns bit-exact positions of a heap of bodies that split and merge, after a second.
std::vector<float> heap( int threads )
{
	TestWorld test;
	test.world.setThreadCount( threads );
	test.addFloor();
	Adaptivity settings = levels( 2 );
	settings.refinesOnContact = true;
	settings.refineStrain = 0.1f;
	const auto shape = block( 8, 8, 8, 0.1f );
	for ( int k = 0; k < 3; ++k )
	{
		test.addSoft( shape, at( btScalar( 0.2 ) * btScalar( k ), btScalar( 0.6 ) + btScalar( k ), 0 ), stiff( 3e4f ), settings );
	}
	std::vector<float> state;
	int changes = 0;
	for ( int frame = 0; frame < 60; ++frame )
	{
		test.run( 1 );
		changes += test.world.stepReport().levelChanges;
		state.push_back( test.soft[1]->surface().positions[5] );
	}
	EXPECT_GT( changes, 10 );
	for ( const auto& body : test.soft )
	{
		const NodeState& nodes = body->impl().body->nodes();
		state.insert( state.end(), nodes.x.y.begin(), nodes.x.y.end() );
	}
	return state;
}

TEST( Adaptive, SameBitsOnAnyNumberOfThreads )
{
	const std::vector<float> one = heap( 1 );
	EXPECT_EQ( heap( 2 ), one );
	EXPECT_EQ( heap( 4 ), one );
}

TEST( Adaptive, QuarantineAndResetWorkOnAllLevels )
{
	TestWorld test;
	test.addFloor();
	Adaptivity settings = levels( 2 );
	settings.refinesOnContact = true;
	SoftBody* soft = test.addSoft( block( 8, 8, 8, 0.1f ), at( 0, btScalar( 0.5 ), 0 ), stiff( 1e5f ), settings );
	test.run( 20 );
	EXPECT_GT( soft->nodeCount(), 8 );
	soft->surface();
	soft->requestRefinement( btVector3( -9, -9, -9 ), btVector3( 9, 9, 9 ) );
	soft->impl().body->nodes().v.x[3] = NAN; // calls refuse it
	test.run( 10 );
	EXPECT_FALSE( soft->isHealthy() );
	for ( int i = 0; i < soft->nodeCount(); ++i )
	{
		ASSERT_TRUE( isFinite( soft->nodePosition( i ) ) );
	}
	EXPECT_TRUE( soft->reset( at( 0, 2, 0 ) ).ok() );
	EXPECT_TRUE( soft->isHealthy() );
	EXPECT_NEAR( soft->massCentre().y(), 2, 1e-5 );
	const SurfaceView skin = soft->surface();
	EXPECT_NEAR( skin.positions[1] + float( skin.origin.y() ), 1.6f, 1e-4f );
	test.run( 240 ); // it bounces for three seconds, as the uniform lattice does
	EXPECT_TRUE( soft->isHealthy() );
	EXPECT_NEAR( lowestPoint( *soft ), 0, 0.01 );
}

TEST( Adaptive, ImpactRaisesTheCountAndRestLowersIt )
{
	TestWorld test;
	test.addFloor();
	Adaptivity settings = levels( 2 );
	settings.refineStrain = 0.08f;
	Material material = stiff( 3e5f );
	material.damping = 20.0f;
	SoftBody* soft = test.addSoft( block( 8, 8, 8, 0.1f ), at( 0, btScalar( 2.5 ), 0 ), material, settings );
	int most = 0;
	for ( int frame = 0; frame < 180; ++frame )
	{
		test.run( 1 );
		most = std::max( most, soft->nodeCount() );
	}
	EXPECT_GT( most, 64 );
	EXPECT_LT( soft->nodeCount(), most / 4 );
}

} // namespace
} // namespace pliant
