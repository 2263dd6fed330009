// Rays, swept balls and contact tests meet the drawn surface of a soft body: whole, bent, cracked, with levels, and without a mesh.

#include "support/memory_in_use.h"
#include "support/surface_queries.h"
#include "test_meshes.h"
#include "world/test_world.h"

#include "world/bodies/soft_body_impl.h"

#include <cstdio>

namespace pliant {
namespace {

using test::at;
using test::QueryTally;
using test::TestWorld;

constexpr float kCell = 0.1f;

std::shared_ptr<const BodyTemplate> made( const test::Mesh& mesh, Skinning skinning = Skinning::NearbyNodes )
{
	LatticeSettings settings;
	settings.cellSize = kCell;
	settings.skinning = skinning;
	return BodyTemplate::build( mesh.view(), settings ).value;
}

const btSphereShape kSmallBall( btScalar( 0.005 ) ), kLargeBall( btScalar( 0.2 ) );
const btBoxShape kSweptBox( btVector3( btScalar( 0.1 ), btScalar( 0.05 ), btScalar( 0.08 ) ) );

/// Rests on a narrow stand until it hangs down on both sides.
void bend( TestWorld& t )
{
	t.addBox( 0, btVector3( btScalar( 0.1 ), btScalar( 0.5 ), 1 ), at( 0, btScalar( -0.75 ), 0 ) );
	t.run( 40 );
}

void expectSame( const char* what, const QueryTally& tally )
{
	std::printf( "%-24s %5d of %5d hit, %d different, %.1e m, %.2f degrees, %d wrong nodes\n", what, tally.hits, tally.asked,
		tally.different, tally.worstDistance, tally.worstAngle, tally.wrongNodes );
	EXPECT_GT( tally.hits, tally.asked / 10 ) << what;
	EXPECT_EQ( tally.different, 0 ) << what;
	EXPECT_LT( tally.worstDistance, 0.1 * double( kCell ) ) << what;
	EXPECT_LT( tally.worstAngle, 5.0 ) << what;
	EXPECT_EQ( tally.wrongNodes, 0 ) << what;
}

void expectDrawn( const char* what, const TestWorld& t, const SoftBody& body )
{
	expectSame( what, test::castRays( t.world, body, 300, 1 ) );
	expectSame( what, test::sweepBalls( t.world, body, 60, 2 ) );
}

TEST( SurfaceQueries, MeetAWholeBody )
{
	TestWorld t;
	t.world.setGravity( btVector3( 0, 0, 0 ) );
	expectDrawn( "ball", t, *t.addSoft( made( test::makeSphere( 0.5, 24, 48 ) ), at( 0, 0, 0 ) ) );
	const btTransform turned( btQuaternion( btVector3( 1, 2, 3 ).normalized(), btScalar( 0.7 ) ), btVector3( 5, 0, 0 ) );
	expectDrawn( "turned box", t, *t.addSoft( made( test::makeBox( { -0.5, -0.3, -0.4 }, { 0.5, 0.3, 0.4 } ) ), turned ) );
}

// Also for a plate, whose large faces dominate the drawn normals at its corners.
TEST( SurfaceQueries, HaveTheNormalsOfFlatFaces )
{
	TestWorld t;
	t.world.setGravity( btVector3( 0, 0, 0 ) );
	const SoftBody* const plate = t.addSoft( made( test::makeBox( { -0.8, -0.2, -0.8 }, { 0.8, 0.2, 0.8 } ) ), at( 0, 0, 0 ) );
	btScalar least = 1;
	test::RandomPaths paths( *plate, 3 );
	for ( int k = 0; k < 200; ++k )
	{
		btVector3 from, to;
		paths.next( from, to );
		test::NodeRay ray( from, to, *plate );
		t.world.rayTest( from, to, ray );
		const btVector3 size = ray.m_hitNormalWorld.absolute();
		least = ray.hasHit() ? btMin( least, size[size.maxAxis()] ) : least;
	}
	EXPECT_GT( least, btScalar( 0.9999 ) );
}

// The normals of a ball point away from its centre, independently of its triangles.
TEST( SurfaceQueries, HaveTheNormalsOfASmoothSurface )
{
	TestWorld t;
	t.world.setGravity( btVector3( 0, 0, 0 ) );
	const SoftBody* const ball = t.addSoft( made( test::makeSphere( 0.5, 24, 48 ) ), at( 0, 0, 0 ) );
	double worstRay = 0.0, worstSweep = 0.0;
	test::RandomPaths paths( *ball, 3 );
	for ( int k = 0; k < 200; ++k )
	{
		btVector3 from, to;
		paths.next( from, to );
		test::NodeRay ray( from, to, *ball );
		t.world.rayTest( from, to, ray );
		const auto degreesOff = []( const btVector3& normal, const btVector3& point ) {
			return std::acos( std::min( 1.0, double( normal.dot( point.normalized() ) ) ) ) * 57.29578;
		};
		worstRay = ray.hasHit() ? std::max( worstRay, degreesOff( ray.m_hitNormalWorld, ray.m_hitPointWorld ) ) : worstRay;
		for ( const btConvexShape* const shape : std::initializer_list<const btConvexShape*>{ &kSmallBall, &kLargeBall, &kSweptBox } )
		{
			test::NodeSweep sweep( from, to, *ball );
			t.world.convexSweepTest( shape, at( from.x(), from.y(), from.z() ), at( to.x(), to.y(), to.z() ), sweep );
			worstSweep = sweep.hasHit() ? std::max( worstSweep, degreesOff( sweep.m_hitNormalWorld, sweep.m_hitPointWorld ) ) : worstSweep;
		}
	}
	std::printf( "normals off by %.2f degrees, of sweeps %.2f\n", worstRay, worstSweep );
	EXPECT_LT( worstRay, 5.0 );
	EXPECT_LT( worstSweep, 5.0 );
}

// Vertices are computed for a query only.
TEST( SurfaceQueries, CostNothingWhereNothingAsks )
{
	TestWorld t;
	t.addFloor();
	const test::Mesh mesh = test::makeSphere( 0.3, 12, 24 );
	const SoftBody* const soft = t.addSoft( made( mesh ), at( 0, btScalar( 0.4 ), 0 ) );
	t.addBox( 1, btVector3( btScalar( 0.1 ), btScalar( 0.1 ), btScalar( 0.1 ) ), at( 0, 1, 0 ) );
	t.run( 30 );
	const std::size_t before = test::memoryInUse();
	test::NodeRay ray( btVector3( 0, 2, 0 ), btVector3( 0, 0, 0 ), *soft );
	t.world.rayTest( ray.m_rayFromWorld, ray.m_rayToWorld, ray );
	EXPECT_TRUE( ray.hasHit() );
	if ( before > 0 )
	{
		EXPECT_GT( test::memoryInUse() - before, 3 * sizeof( float ) * mesh.vertexCount() );
	}
}

// A skin may be that of an earlier step (surfaceTolerance), or lie between two steps (setInterpolation). A query meets the present surface:
// otherwise a game's physics would depend on the times at which it draws.
TEST( SurfaceQueries, DoNotDependOnWhatHasBeenDrawn )
{
	const btVector3 from( 0, 2, 0 ), to( 0, -2, 0 );
	const auto fractions = [&]( bool isDrawn, bool isInterpolated ) {
		TestWorld t;
		t.world.setGravity( btVector3( 0, 0, 0 ) );
		SoftBody* const soft = t.addSoft( made( test::makeBox( { -0.5, -0.3, -0.4 }, { 0.5, 0.3, 0.4 } ) ), at( 0, 0, 0 ) );
		soft->setInterpolation( isInterpolated );
		EXPECT_TRUE( soft->setLinearVelocity( btVector3( 0, btScalar( 0.03 ), 0 ) ).ok() ); // 0.005 cells a step
		std::vector<btScalar> found;
		for ( int k = 0; k < 6; ++k )
		{
			t.run( 1 );
			t.world.setInterpolationFraction( btScalar( 0.5 ) );
			isDrawn ? static_cast<void>( soft->surface() ) : static_cast<void>( 0 );
			test::NodeRay ray( from, to, *soft );
			t.world.rayTest( from, to, ray );
			EXPECT_TRUE( ray.hasHit() );
			found.push_back( ray.m_closestHitFraction );
		}
		return found;
	};
	const std::vector<btScalar> expected = fractions( false, false );
	EXPECT_LT( expected.back(), expected.front() );
	EXPECT_EQ( fractions( true, false ), expected );
	EXPECT_EQ( fractions( true, true ), expected );
}

// Of several triangles that a box meets at the same time, the first one reported is independent of the body's shape at the first query.
TEST( SurfaceQueries, DoNotDependOnWhatWasAskedBefore )
{
	std::vector<btVector3> met[2];
	for ( const bool asksEarly : { false, true } )
	{
		TestWorld t;
		const SoftBody* const body = t.addSoft( made( test::makeBox( { -0.8, -0.2, -0.3 }, { 0.8, 0.2, 0.3 } ) ), at( 0, 0, 0 ) );
		if ( asksEarly )
		{
			test::castRays( t.world, *body, 1, 1 );
		}
		bend( t );
		for ( int k = 0; k < 200; ++k )
		{
			const btVector3 from( btScalar( -0.8 ) + btScalar( 0.008 ) * btScalar( k ), 1, 0 ), to = from - btVector3( 0, 2, 0 );
			btCollisionWorld::ClosestConvexResultCallback sweep( from, to );
			t.world.convexSweepTest( &kSweptBox, at( from.x(), from.y(), 0 ), at( to.x(), to.y(), 0 ), sweep );
			met[asksEarly].insert( met[asksEarly].end(), { sweep.m_hitPointWorld, sweep.m_hitNormalWorld } );
		}
	}
	EXPECT_EQ( met[0], met[1] );
}

TEST( SurfaceQueries, MeetABentBody )
{
	TestWorld t;
	const SoftBody* const soft = t.addSoft(
		made( test::makeBox( { -0.8, -0.2, -0.2 }, { 0.8, 0.2, 0.2 }, 8 ) ), at( 0, 0, 0 ), test::stiff( 3e4f ) );
	bend( t );
	expectDrawn( "bent", t, *soft );
}

TEST( SurfaceQueries, MeetTheSidesOfACrack )
{
	TestWorld t;
	SoftBody* const soft = t.addSoft(
		made( test::makeBox( { -0.8, -0.2, -0.2 }, { 0.8, 0.2, 0.2 }, 4 ) ), at( 0, 0, 0 ), test::stiff( 3e4f ) );
	EXPECT_GT( soft->cutPlane( btVector3( btScalar( 0.03 ), btScalar( 0.2 ), 0 ), btVector3( 1, 0, 0 ), btScalar( 0.25 ) ), 0 );
	bend( t );
	EXPECT_EQ( t.world.softBodyCount(), 1 );
	EXPECT_GT( soft->surface().triangleCount, 12 * 16 ) << "no crack is open";
	expectDrawn( "cracked", t, *soft );
}

TEST( SurfaceQueries, MeetABodyWithLevels )
{
	Adaptivity levels;
	levels.coarseLevels = 1;
	TestWorld t;
	const SoftBody* const soft = t.addSoft(
		made( test::makeBox( { -0.8, -0.2, -0.2 }, { 0.8, 0.2, 0.2 }, 8 ) ), at( 0, 0, 0 ), test::stiff( 3e4f ), levels );
	bend( t );
	expectDrawn( "levels", t, *soft );
}

// Without a drawn mesh queries meet the border of the cells.
TEST( SurfaceQueries, MeetTheCellsOfABodyWithoutASkin )
{
	for ( const int coarse : { 0, 1 } )
	{
		Adaptivity levels;
		levels.coarseLevels = coarse;
		TestWorld t;
		t.world.setGravity( btVector3( 0, 0, 0 ) );
		t.addSoft(
			made( test::makeBox( { -0.4, -0.2, -0.2 }, { 0.4, 0.2, 0.2 } ), Skinning::None ), at( 0, 0, 0 ), test::stiff( 1e5f ), levels );
		int missed = 0;
		double worst = 0.0;
		for ( int k = 0; k < 400; ++k )
		{
			const btVector3 to( btScalar( -0.39 + 0.00195 * k ), btScalar( -1 ), btScalar( 0.001 * ( k * 7 % 390 ) - 0.195 ) ),
				from( to.x(), 1, to.z() );
			btCollisionWorld::ClosestRayResultCallback ray( from, to );
			t.world.rayTest( from, to, ray );
			missed += ray.hasHit() ? 0 : 1;
			worst = std::max( worst, std::abs( double( ray.m_hitPointWorld.y() ) - 0.2 ) );
		}
		EXPECT_EQ( missed, 0 );
		EXPECT_LT( worst, 1e-4 );
	}
}

/// Result of a contact test: number of points, the deepest one, and its normal.
struct Contacts : btCollisionWorld::ContactResultCallback
{
	explicit Contacts( const SoftBody& of ) : soft( of ) {}
	btScalar addSingleResult( btManifoldPoint& point, const btCollisionObjectWrapper* wrap0, int, int index0,
		const btCollisionObjectWrapper*, int, int index1 ) override
	{
		const bool isFirst = SoftBody::upcast( wrap0->getCollisionObject() ) == &soft;
		EXPECT_GE( soft.nodeOfShapeIndex( isFirst ? index0 : index1 ), 0 );
		++count;
		if ( point.getDistance() < deepest )
		{
			deepest = point.getDistance();
			outwards = isFirst ? -point.m_normalWorldOnB : point.m_normalWorldOnB;
		}
		return 0;
	}
	const SoftBody& soft;
	int count = 0;
	btScalar deepest = SIMD_INFINITY;
	btVector3 outwards = btVector3( 0, 0, 0 );
};

// Balls of a fifth of a cell, which fit between the node spheres: at the surface, half in it, and wholly inside.
TEST( SurfaceQueries, ContactTestsSeeSmallThings )
{
	TestWorld t;
	const SoftBody* const soft = t.addSoft( made( test::makeBox( { -0.5, -0.5, -0.5 }, { 0.5, 0.5, 0.5 } ) ), at( 0, 0, 0 ) );
	btSphereShape ball( btScalar( 0.02 ) );
	btCollisionObject probe;
	probe.setCollisionShape( &ball );
	for ( const double y : { 0.515, 0.5, 0.49, 0.47, 0.4 } )
	{
		probe.setWorldTransform( at( btScalar( 0.1 ), btScalar( y ), btScalar( 0.1 ) ) ); // between four nodes
		Contacts one( *soft ), pair( *soft );
		t.world.contactTest( &probe, one );
		t.world.contactPairTest( const_cast<SoftBody*>( soft ), &probe, pair );
		for ( const Contacts& found : { one, pair } )
		{
			EXPECT_GT( found.count, 0 ) << y;
			EXPECT_NEAR( found.deepest, y - 0.52, 2e-3 ) << y;
			EXPECT_GT( found.outwards.y(), 0.99 ) << y;
		}
	}
	probe.setWorldTransform( at( btScalar( 0.1 ), btScalar( 0.56 ), btScalar( 0.1 ) ) );
	Contacts none( *soft );
	t.world.contactTest( &probe, none );
	EXPECT_EQ( none.count, 0 );
}

// Triangles of the sides touch a plate above the top face with an edge. Their contacts had the plate's width for a depth: a default cube on
// a floor of 20 m was 10.25 m deep, and a plate 1 cm above a cube 1.28 m.
TEST( SurfaceQueries, ContactTestsGiveTheDepthOfWhatIsWiderThanAFace )
{
	TestWorld t;
	const SoftBody* const soft = t.addSoft( made( test::makeBox( { -0.5, -0.5, -0.5 }, { 0.5, 0.5, 0.5 } ) ), at( 0, 0, 0 ) );
	btBoxShape plate( btVector3( 1, btScalar( 0.1 ), 1 ) );
	btCylinderShape disc( btVector3( 3, btScalar( 0.1 ), 3 ) );
	for ( btCollisionShape* const shape : { static_cast<btCollisionShape*>( &plate ), static_cast<btCollisionShape*>( &disc ) } )
	{
		btCollisionObject probe;
		probe.setCollisionShape( shape );
		for ( const double gap : { -0.02, -0.005, 0.005 } )
		{
			probe.setWorldTransform( at( btScalar( 0.1 ), btScalar( 0.6 + gap ), btScalar( 0.07 ) ) );
			Contacts found( *soft );
			t.world.contactPairTest( const_cast<SoftBody*>( soft ), &probe, found );
			EXPECT_GT( found.count, 0 ) << gap;
			EXPECT_NEAR( found.deepest, gap, 3e-3 ) << "shape " << shape->getShapeType();
			EXPECT_GT( found.outwards.y(), 0.99 ) << gap;
		}
	}
}

// A ball below the cube is behind the planes of its sides, whose lower edges it touches: its depth was the distance from those planes to
// its far side.
TEST( SurfaceQueries, ContactTestsGiveTheDepthOfABallAtAFaceOrAnEdge )
{
	TestWorld t;
	const SoftBody* const soft = t.addSoft( test::boxTemplate( { 0.4f, 0.4f, 0.4f }, 0.4f / 6 ), at( 0, 0, 0 ) );
	btSphereShape ball( btScalar( 0.3 ) );
	btCollisionObject probe;
	probe.setCollisionShape( &ball );
	for ( const auto& [where, depth] : { std::pair{ btVector3( 0, -0.4f, 0 ), 0.1 }, { btVector3( 0.05f, -0.4f, 0.03f ), 0.1 },
			  { btVector3( 0.35f, 0.35f, 0 ), 0.3 - 0.15 * std::sqrt( 2.0 ) } } )
	{
		probe.setWorldTransform( btTransform( btQuaternion::getIdentity(), where ) );
		Contacts found( *soft );
		t.world.contactPairTest( const_cast<SoftBody*>( soft ), &probe, found );
		EXPECT_GT( found.count, 0 );
		EXPECT_NEAR( found.deepest, -depth, 3e-3 );
	}
}

// A rod that pierces one triangle is touched from beside by it alone.
TEST( SurfaceQueries, ContactTestsSeeARodInTheMiddleOfAFace )
{
	TestWorld t;
	const SoftBody* const soft = t.addSoft( made( test::makeBox( { -0.5, -0.5, -0.5 }, { 0.5, 0.5, 0.5 } ) ), at( 0, 0, 0 ) );
	btBoxShape rod( btVector3( btScalar( 0.005 ), btScalar( 0.2 ), btScalar( 0.005 ) ) );
	btCollisionObject probe;
	probe.setCollisionShape( &rod );
	for ( int k = 0; k < 12; ++k )
	{
		const btVector3 axis( btCos( btScalar( k ) ), 0, btSin( btScalar( k ) ) );
		probe.setWorldTransform(
			btTransform( btQuaternion( axis, btScalar( 0.02 * k ) ), btVector3( btScalar( 0.13 ), btScalar( 0.65 ), btScalar( -0.21 ) ) ) );
		Contacts found( *soft );
		t.world.contactPairTest( const_cast<SoftBody*>( soft ), &probe, found );
		EXPECT_GT( found.count, 0 ) << "tilt " << k;
	}
}

// Against objects without a convex shape: a plane, a mesh, a compound, another soft body.
TEST( SurfaceQueries, ContactTestsKnowAllShapes )
{
	TestWorld t;
	SoftBody* const soft = t.addSoft( made( test::makeSphere( 0.5, 16, 32 ) ), at( 0, btScalar( 0.49 ), 0 ) );
	const auto deepest = [&]( btCollisionObject* other ) {
		Contacts found( *soft );
		t.world.contactPairTest( soft, other, found );
		EXPECT_GT( found.count, 0 );
		return double( found.deepest );
	};
	EXPECT_NEAR( deepest( t.addPlane() ), -0.01, 3e-3 );
	btTriangleMesh floor;
	floor.addTriangle( btVector3( -2, 0, -2 ), btVector3( -2, 0, 2 ), btVector3( 2, 0, 2 ) );
	floor.addTriangle( btVector3( -2, 0, -2 ), btVector3( 2, 0, 2 ), btVector3( 2, 0, -2 ) );
	btCollisionObject mesh;
	btBvhTriangleMeshShape shape( &floor, true );
	mesh.setCollisionShape( &shape );
	EXPECT_LT( deepest( &mesh ), 0.0 );
	btBoxShape box( btVector3( 1, btScalar( 0.1 ), 1 ) );
	btCompoundShape inner, outer;
	inner.addChildShape( at( 0, btScalar( -0.1 ), 0 ), &box );
	outer.addChildShape( at( 0, 0, 0 ), &inner );
	btCollisionObject compound;
	compound.setCollisionShape( &outer );
	EXPECT_NEAR( deepest( &compound ), -0.01, 3e-3 );
	SoftBody* const other = t.addSoft( made( test::makeBox( { -0.5, -0.5, -0.5 }, { 0.5, 0.5, 0.5 } ) ), at( 0, btScalar( -0.5 ), 0 ) );
	EXPECT_LT( deepest( other ), 0.005 );
	EXPECT_EQ( t.parts.dispatcher.getNumManifolds(), 0 ) << "a contact test leaves contacts behind";
}

} // namespace
} // namespace pliant
