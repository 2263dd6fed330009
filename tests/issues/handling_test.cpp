// Operations on a single body: moving it by its pins, driving its nodes, removing and adding it, teleporting, drawing, cutting and breaking
// it. Each scene fails in some engines with soft bodies.

#include "support/mesh_of_boxes.h"
#include "world/test_world.h"

#include <cmath>

namespace pliant {
namespace {

using test::at;
using test::block;
using test::kFrame;
using test::TestWorld;

btVector3 vertex( const SurfaceView& view, int v )
{
	const float* const p = view.positions + 3 * v;
	return view.origin + btVector3( btScalar( p[0] ), btScalar( p[1] ), btScalar( p[2] ) );
}

std::vector<btVector3> nodesOf( const SoftBody& body )
{
	std::vector<btVector3> nodes;
	for ( int i = 0; i < body.nodeCount(); ++i )
	{
		nodes.push_back( body.nodePosition( i ) );
	}
	return nodes;
}

// A soft flag on a vehicle: the drawn surface of the held end must not lag behind its mast by a step, .17 m at 10 m/s.
TEST( Handling, TheSurfaceOfPinnedCellsFollowsTheirBox )
{
	for ( const Elasticity elasticity : { Elasticity::Explicit, Elasticity::Implicit } )
	{
		TestWorld t;
		btRigidBody* const box = t.addBox( 0, btVector3( btScalar( 0.3 ), btScalar( 0.1 ), btScalar( 0.3 ) ), at( 0, 1, 0 ) );
		box->setCollisionFlags( box->getCollisionFlags() | btCollisionObject::CF_KINEMATIC_OBJECT );
		box->setActivationState( DISABLE_DEACTIVATION );
		Material material = test::stiff( 1e5f );
		material.elasticity = elasticity;
		SoftBody* const bar = t.addSoft( block( 3, 10, 3, 0.1f ), at( 0, btScalar( 0.4 ), 0 ), material ); // from -.1 to .9 m
		ASSERT_TRUE( bar->setLinearVelocity( btVector3( 10, 0, 0 ) ).ok() );
		bar->setSurfaceTolerance( 0 ); // otherwise .01 cells, 1 mm
		for ( int i = 0; i < bar->nodeCount(); ++i )
		{
			if ( bar->nodePosition( i ).y() > btScalar( 0.6 ) )
			{
				ASSERT_TRUE( bar->pinNodeToBody( i, box ).ok() );
			}
		}
		for ( int k = 1; k <= 60; ++k )
		{
			box->setWorldTransform( at( 10 * kFrame * btScalar( k ), 1, 0 ) );
			t.run( 1 );
			const SurfaceView view = bar->surface();
			int held = 0;
			for ( int v = 0; v < view.vertexCount; ++v )
			{
				const btVector3 there = vertex( view, v ) - box->getWorldTransform().getOrigin();
				if ( there.y() > btScalar( -0.3 ) )
				{
					++held;
					ASSERT_NEAR( btFabs( there.x() ), 0.15, 1e-4 ) << "frame " << k;
					ASSERT_NEAR( there.y(), -0.1, 1e-4 ) << "frame " << k;
				}
			}
			ASSERT_EQ( held, 4 );
		}
	}
}

// A node driven at 20 Hz must stand still between two calls.
TEST( Handling, ANodeDrivenEveryThirdFrameStandsStillInBetween )
{
	for ( const Elasticity elasticity : { Elasticity::Explicit, Elasticity::Implicit } )
	{
		TestWorld t;
		Material material = test::stiff( 1e5f );
		material.elasticity = elasticity;
		SoftBody* const cube = t.addSoft( block( 4, 4, 4, 0.1f ), at( 0, 0, 0 ), material );
		const int node = cube->nearestNode( btVector3( 0, 1, 0 ) );
		btVector3 position = cube->nodePosition( node );
		for ( int k = 0; k < 60; ++k )
		{
			if ( k % 3 == 0 )
			{
				position += btVector3( btScalar( 0.05 ), 0, 0 );
				ASSERT_TRUE( cube->driveNode( node, position ).ok() );
			}
			t.run( 1 );
			ASSERT_LT( ( cube->nodePosition( node ) - position ).length(), 2e-6 ) << k;
			if ( k % 3 != 0 )
			{
				ASSERT_EQ( cube->nodeVelocity( node ).length(), 0 ) << k;
			}
		}
	}
}

// A body that is removed and added again, as in level streaming, keeps its shape and its pins.
TEST( Handling, ABodyRemovedAndAddedAgainIsUnchanged )
{
	TestWorld t;
	SoftBody* const bar = t.addSoft( block( 8, 2, 2, 0.1f ), at( 0, 1, 0 ), test::stiff( 1e5f ) );
	ASSERT_EQ( bar->pinNodesInside( btVector3( -1, 0, -1 ), btVector3( btScalar( -0.3 ), 2, 1 ) ), 4 );
	t.run( 20 ); // it bends and swings
	const std::vector<btVector3> before = nodesOf( *bar );
	const btVector3 velocity = bar->nodeVelocity( bar->nodeCount() - 1 );
	EXPECT_GT( velocity.length(), 0.01 );
	t.world.removeSoftBody( bar );
	t.run( 60 );
	t.world.addSoftBody( bar );
	const std::vector<btVector3> after = nodesOf( *bar );
	for ( std::size_t i = 0; i < before.size(); ++i )
	{
		ASSERT_EQ( ( before[i] - after[i] ).length(), 0 );
		ASSERT_EQ( bar->isPinned( int( i ) ), before[i].x() < btScalar( -0.29 ) );
	}
	EXPECT_EQ( ( bar->nodeVelocity( bar->nodeCount() - 1 ) - velocity ).length(), 0 );
	t.run( 60 );
	EXPECT_GT( bar->massCentre().y(), btScalar( 0.7 ) ) << "it hangs by its pins";
}

// Respawning: the surface drawn in the same frame is at the new position, and the next step does not move it again.
TEST( Handling, ATeleportMovesTheDrawnSurfaceOnceAndAtOnce )
{
	for ( const bool isAsleep : { false, true } )
	{
		TestWorld t;
		t.world.setGravity( btVector3( 0, 0, 0 ) );
		SoftBody* const cube = t.addSoft( block( 4, 4, 4, 0.1f ), at( 0, 0, 0 ) );
		t.run( isAsleep ? 300 : 2 );
		ASSERT_EQ( cube->isActive(), !isAsleep );
		const SurfaceView first = cube->surface();
		std::vector<btVector3> before;
		for ( int v = 0; v < first.vertexCount; ++v )
		{
			before.push_back( vertex( first, v ) );
		}
		const btTransform motion( btQuaternion( btVector3( 0, 0, 1 ), btScalar( 0.5 ) ), btVector3( 3, -2, 1 ) );
		ASSERT_TRUE( cube->teleport( motion ).ok() );
		for ( int k = 0; k < 3; ++k )
		{
			const SurfaceView now = cube->surface();
			for ( int v = 0; v < now.vertexCount; ++v )
			{
				ASSERT_LT( ( vertex( now, v ) - motion * before[std::size_t( v )] ).length(), 2e-6 ) << "after " << k << " steps";
			}
			t.run( 1 );
		}
	}
}

// Partial cuts, then partial cuts of all their pieces: cell indices of separated pieces differ from those of the last cut.
TEST( Handling, FiftyPartialCutsLoseNothing )
{
	TestWorld t;
	t.world.setGravity( btVector3( 0, 0, 0 ) );
	SoftBody* const whole = t.addSoft( block( 8, 8, 8, 0.1f ), at( 0, 0, 0 ) );
	const double mass = double( whole->mass() );
	std::uint32_t random = 1;
	const auto fraction = [&random] {
		random = random * 1664525u + 1013904223u;
		return btScalar( random >> 8 ) / btScalar( 1 << 24 ) - btScalar( 0.5 );
	};
	for ( int k = 0; k < 50; ++k )
	{
		for ( int b = t.world.softBodyCount(); b-- > 0; )
		{
			SoftBody* const piece = t.world.softBody( b );
			const btScalar x = fraction(), y = fraction(), z = fraction();
			const btVector3 normal = btVector3( x, y, z ).normalized();
			// A disc around a point at the piece's edge cuts half of it.
			const btScalar size = btScalar( 0.1 * std::cbrt( double( piece->cellCount() ) ) );
			piece->cutPlane( piece->massCentre() + normal.cross( btVector3( z, x, y ) ).normalized() * size / 2, normal, size / 2 );
		}
		t.run( 2 );
		double sum = 0;
		int cells = 0;
		for ( int b = 0; b < t.world.softBodyCount(); ++b )
		{
			const SoftBody& piece = *t.world.softBody( b );
			ASSERT_TRUE( piece.isHealthy() );
			sum += double( piece.mass() );
			cells += piece.cellCount();
		}
		ASSERT_EQ( cells, 512 ) << k;
		ASSERT_NEAR( sum, mass, 1e-5 * mass ) << k;
	}
	EXPECT_GT( t.world.softBodyCount(), 4 );
}

// One object of three cubes, ten times in a level: each must have its own bounds, .8 radii around its spheres.
TEST( Handling, BodiesOfThreeCubesHaveBoundsWhereTheyArePlaced )
{
	test::MeshOfBoxes mesh;
	for ( const btScalar x : { btScalar( -1 ), btScalar( 0 ), btScalar( 1 ) } )
	{
		mesh.add( btVector3( x, x * x, 0 ), btVector3( btScalar( 0.2 ), btScalar( 0.2 ), btScalar( 0.2 ) ) );
	}
	const std::shared_ptr<const BodyTemplate> made = mesh.build( 0.1f );
	TestWorld t;
	t.world.setGravity( btVector3( 0, 0, 0 ) );
	for ( int k = 0; k < 10; ++k )
	{
		t.addSoft( made, at( btScalar( 5 * k ), btScalar( k ), 0 ) );
	}
	t.run( 2 );
	for ( int k = 0; k < 10; ++k )
	{
		btVector3 low, high;
		SoftBody& body = *t.soft[std::size_t( k )];
		body.getCollisionShape()->getAabb( body.getWorldTransform(), low, high );
		const btVector3 position( btScalar( 5 * k ), btScalar( k ), 0 );
		EXPECT_LT( ( low - position - btVector3( btScalar( -1.2 ), btScalar( -0.2 ), btScalar( -0.2 ) ) ).length(), 0.08 );
		EXPECT_LT( ( high - position - btVector3( btScalar( 1.2 ), btScalar( 1.2 ), btScalar( 0.2 ) ) ).length(), 0.08 );
		EXPECT_LT( ( body.getBroadphaseHandle()->m_aabbMax - high ).length(), 0.1 );
		EXPECT_LT( ( body.getBroadphaseHandle()->m_aabbMin - low ).length(), 0.1 );
	}
}

// Culling by the body's box: the drawn surface must not protrude from it. The spheres of cells leave out the cells' corners, so the box is
// grown by ( sqrt 3 - 1 ) / 2 of an edge.
TEST( Handling, TheBodysBoxGrownByItsCellsCornersEnclosesItsSurface )
{
	constexpr btScalar kCell = btScalar( 0.1 ), kCorner = btScalar( 0.37 ) * kCell;
	for ( const Elasticity elasticity : { Elasticity::Explicit, Elasticity::Implicit } )
	{
		TestWorld t;
		t.addFloor();
		Material material = test::stiff( 5e4f );
		material.elasticity = elasticity;
		SoftBody* const cube = t.addSoft( block( 5, 5, 5, float( kCell ) ), at( 0, 1, 0 ), material );
		EXPECT_TRUE( cube->setVelocities( btVector3( 3, 0, 0 ), btVector3( 2, 3, 5 ) ).ok() );
		for ( int k = 0; k < 120; ++k )
		{
			t.run( 1 );
			btVector3 low, high;
			cube->getCollisionShape()->getAabb( cube->getWorldTransform(), low, high );
			const SurfaceView view = cube->surface();
			for ( int v = 0; v < view.vertexCount; ++v )
			{
				const btVector3 p = vertex( view, v );
				for ( int axis = 0; axis < 3; ++axis )
				{
					ASSERT_GT( p[axis], low[axis] - kCorner ) << "frame " << k;
					ASSERT_LT( p[axis], high[axis] + kCorner ) << "frame " << k;
				}
			}
		}
	}
}

/// A cube of 1 m about the origin whose faces have four vertices each.
std::shared_ptr<const BodyTemplate> cubeOfSixFaces()
{
	std::vector<float> positions;
	std::vector<std::uint32_t> indices;
	for ( int face = 0; face < 6; ++face )
	{
		const int axis = face / 2, u = ( axis + 1 ) % 3, v = ( axis + 2 ) % 3;
		const float side = face % 2 ? 0.5f : -0.5f;
		for ( int k = 0; k < 4; ++k )
		{
			float point[3];
			point[axis] = side;
			point[u] = k & 1 ? 0.5f : -0.5f;
			point[v] = k & 2 ? 0.5f : -0.5f;
			positions.insert( positions.end(), point, point + 3 );
		}
		const std::uint32_t a = 4 * std::uint32_t( face ), b = face % 2 ? a + 1 : a + 2, c = face % 2 ? a + 2 : a + 1;
		indices.insert( indices.end(), { a, b, c, b, a + 3, c } );
	}
	MeshView mesh;
	mesh.positions = positions.data();
	mesh.vertexCount = 24;
	mesh.indices = indices.data();
	mesh.triangleCount = 12;
	LatticeSettings settings;
	settings.cellSize = 0.125f;
	return BodyTemplate::build( mesh, settings ).value;
}

// A crate: at rest its faces must be flat and meet at the edges, where each has its own vertices.
TEST( Handling, ACrateAtRestHasFlatFacesThatMeet )
{
	TestWorld t;
	t.addFloor();
	SoftBody* const crate = t.addSoft( cubeOfSixFaces(), at( 0, btScalar( 0.5 ), 0 ), test::stiff( 1e6f ) );
	t.run( 300 );
	const SurfaceView view = crate->surface();
	ASSERT_EQ( view.vertexCount, 24 );
	for ( int k = 0; k < view.triangleCount; ++k )
	{
		const std::uint32_t* const corner = view.indices + 3 * k;
		const btVector3 a = vertex( view, int( corner[0] ) ), b = vertex( view, int( corner[1] ) ), c = vertex( view, int( corner[2] ) );
		const btVector3 normal = ( b - a ).cross( c - a ).normalized();
		const int face = k / 2;
		EXPECT_GT( ( face % 2 ? 1 : -1 ) * normal[face / 2], btCos( SIMD_RADS_PER_DEG ) ) << "triangle " << k;
	}
	for ( int i = 0; i < 24; ++i )
	{
		int meeting = 0;
		for ( int j = 0; j < 24; ++j )
		{
			meeting += ( vertex( view, i ) - vertex( view, j ) ).length() == 0;
		}
		EXPECT_EQ( meeting, 3 ) << i;
	}
}

// Known limitation: meshes have no normals, so a hard edge cannot be told from a seam of texture coordinates, and vertices at one position
// share a normal, 48 to 71 degrees off.
TEST( Handling, DISABLED_ACratesEdgesAreHard )
{
	const std::unique_ptr<SoftBody> crate = SoftBody::create( cubeOfSixFaces(), at( 0, 0, 0 ) ).value;
	const SurfaceView view = crate->surface();
	for ( int i = 0; i < view.vertexCount; ++i )
	{
		const int face = i / 4;
		EXPECT_GT( ( face % 2 ? 1 : -1 ) * view.normals[3 * i + face / 2], float( btCos( SIMD_RADS_PER_DEG ) ) ) << i;
	}
}

// A sign hangs by its upper edge at half of its strength: small breaks must not accumulate until it falls.
TEST( Handling, AtHalfItsStrengthNothingBreaksInAMinute )
{
	for ( const Elasticity elasticity : { Elasticity::Explicit, Elasticity::Implicit } )
	{
		for ( const BreakRule rule : { BreakRule::Distance, BreakRule::Plane } )
		{
			TestWorld t;
			t.world.setGravity( btVector3( 0, 0, 0 ) );
			Material material = test::stiff( 1e5f );
			material.elasticity = elasticity;
			SoftBody* const bar = t.addSoft( block( 3, 10, 3, 0.1f ), at( 0, 0, 0 ), material );
			ASSERT_EQ( bar->pinNodesInside( btVector3( -1, btScalar( 0.4 ), -1 ), btVector3( 1, 1, 1 ) ), 9 );
			Fracture fracture;
			fracture.rule = rule;
			fracture.breakStrain = 0.18f; // below the pins the stretch is 1 000 x 10 x .9 / 1e5 = .09
			ASSERT_TRUE( bar->setFracture( fracture ).ok() );
			bar->setActivationState( DISABLE_DEACTIVATION );
			const int links = bar->linkCount();
			for ( int k = 0; k < 3600; ++k )
			{
				EXPECT_TRUE(
					bar->setGravity( btVector3( 0, -btMin( btScalar( 10 ), btScalar( k ) / 18 ), 0 ) ).ok() ); // applied over three seconds
				t.run( 1 );
			}
			EXPECT_EQ( bar->linkCount(), links );
			EXPECT_LT( test::lowestNode( *bar ), btScalar( -0.48 ) ) << "it is stretched";
			EXPECT_TRUE( bar->setGravity( btVector3( 0, -40, 0 ) ).ok() );
			t.run( 60 );
			EXPECT_LT( bar->linkCount(), links ) << "at twice its strength it breaks";
		}
	}
}

// Panes break one after the other for a minute; their remains must not keep costing time.
TEST( Handling, BreakingPanesLeaveNoCostBehind )
{
	constexpr int kPanes = 20, kEvery = 15; // frames
	TestWorld t;
	t.addFloor();
	const std::shared_ptr<const BodyTemplate> pane = block( 8, 8, 1, 0.1f );
	int most = 0, broken = 0;
	for ( int k = 0; k < kPanes * kEvery + 240; ++k )
	{
		if ( k % kEvery == 0 && k < kPanes * kEvery )
		{
			const btScalar x = btScalar( k / kEvery % 8 - 4 );
			SoftBody* const body = t.addSoft( pane, at( x, btScalar( 0.4 ), 0 ), test::stiff( 1e6f ) );
			Fracture fracture;
			fracture.rule = BreakRule::Plane;
			fracture.breakStrain = 0.005f;
			fracture.growthFraction = 0.3f;
			fracture.smallCells = 64;
			fracture.smallPieces = SmallPieces::Fade;
			fracture.fadeTime = 1.0f;
			ASSERT_TRUE( body->setFracture( fracture ).ok() );
			btRigidBody* const shot = t.addBox(
				5, btVector3( btScalar( 0.1 ), btScalar( 0.1 ), btScalar( 0.1 ) ), at( x, btScalar( 0.5 ), 1 ) );
			shot->setLinearVelocity( btVector3( 0, 0, -15 ) );
		}
		t.run( 1 );
		broken += t.world.stepReport().fragments;
		most = std::max( most, t.world.fragmentCount() );
	}
	EXPECT_GT( broken, 2 * kPanes );
	EXPECT_LT( most, broken ) << "faded pieces are removed while new ones appear";
	EXPECT_EQ( t.world.fragmentCount(), 0 );
	EXPECT_LE( t.world.softBodyCount(), kPanes );
}

} // namespace
} // namespace pliant
