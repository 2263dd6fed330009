// Far from the world's origin a scene evolves as at the origin: 1 km out in a float world, 100 km in a double one.

#include "world/test_world.h"

#include "world/bodies/soft_body_impl.h"

#include <cstdio>

namespace pliant {
namespace {

using test::at;
using test::block;
using test::TestWorld;

// A power of two, so that Bullet's transforms of the floor and the slope are exact there.
constexpr btScalar kFar = sizeof( btScalar ) == 4 ? btScalar( 1024 ) : btScalar( 131072 );

/// Returns node positions relative to `centre` of two stacked cubes that have fallen on a tilted box, after two seconds.
std::vector<btVector3> scene( const btVector3& centre, bool onPlane )
{
	TestWorld t;
	if ( onPlane )
	{
		t.addPlane( centre.y() );
	}
	else
	{
		t.addBox(
			0, btVector3( 4, 1, 4 ), btTransform( btQuaternion( btVector3( 0, 0, 1 ), btScalar( 0.1 ) ), centre + btVector3( 0, -1, 0 ) ) );
	}
	const auto shape = block( 4, 4, 4, 0.1f );
	SoftBody* bodies[] = { t.addSoft( shape, btTransform( btQuaternion::getIdentity(), centre + btVector3( 0, btScalar( 0.25 ), 0 ) ) ),
		t.addSoft( shape, btTransform( btQuaternion::getIdentity(), centre + btVector3( 0, btScalar( 0.75 ), 0 ) ) ) };
	t.run( 120 );
	std::vector<btVector3> positions;
	for ( const SoftBody* body : bodies )
	{
		for ( int i = 0; i < body->nodeCount(); ++i )
		{
			// Relative to `centre`, because Bullet's precision does not hold more.
			positions.push_back( body->nodePosition( i ) - centre );
		}
	}
	return positions;
}

TEST( Far, TheSameSceneWithinAThousandthOfACell )
{
	for ( const bool onPlane : { false, true } )
	{
		const std::vector<btVector3> home = scene( btVector3( 0, 0, 0 ), onPlane );
		const std::vector<btVector3> away = scene( btVector3( kFar, kFar / 4, -kFar ), onPlane );
		btScalar worst = 0;
		for ( std::size_t k = 0; k < home.size(); ++k )
		{
			worst = btMax( worst, ( home[k] - away[k] ).length() );
		}
		std::printf( "%g m out: %.1e of a cell\n", double( kFar ), double( worst ) * 10 );
		EXPECT_LT( worst, btScalar( 1e-4 ) ) << ( onPlane ? "on a plane" : "on a box" );
		EXPECT_GT( home[0].y(), btScalar( -1 ) );
	}
}

// Triangles are divided to the size of a cell where a contact test needs them: of a body of 1e15 m, as wild forces leave it, that did not
// end.
TEST( Far, ContactTestsOfBodiesWithoutBoundsReturn )
{
	struct Result : btCollisionWorld::ContactResultCallback
	{
		btScalar addSingleResult(
			btManifoldPoint&, const btCollisionObjectWrapper*, int, int, const btCollisionObjectWrapper*, int, int ) override
		{
			return 0;
		}
	};
	TestWorld t;
	t.world.setGravity( btVector3( 0, 0, 0 ) );
	SoftBody* const soft = t.addSoft( block( 4, 4, 4, 0.1f ), at( 0, 0, 0 ) );
	NodeState& nodes = soft->impl().body->nodes();
	for ( int i = 0; i < nodes.count; ++i )
	{
		nodes.x.set( i, 1e15f * nodes.x.get( i ) );
		nodes.v.set( i, Vec3::Zero() );
	}
	btBoxShape box( btVector3( btScalar( 1e16 ), btScalar( 1e16 ), btScalar( 1e16 ) ) );
	btCollisionObject probe;
	probe.setCollisionShape( &box );
	probe.setWorldTransform( at( 0, 0, 0 ) );
	Result result;
	t.world.contactPairTest( soft, &probe, result );
	SUCCEED(); // a hang is the failure
}

} // namespace
} // namespace pliant
