// The contacts with which a body becomes rigid.

#include "world/test_world.h"

namespace pliant {
namespace {

using test::at;
using test::TestWorld;

/// A cube of a metre that has become rigid on a plane, which is older than the cube or younger.
SoftBody* restOnPlane( TestWorld& t, int cells, bool isPlaneFirst )
{
	isPlaneFirst ? void( t.addPlane() ) : void();
	Material material;
	material.density = 500.0f;
	material.youngsModulus = 1e8f;
	material.rigidStrain = 0.01f;
	SoftBody* const cube = t.addSoft( test::block( cells, cells, cells, 1.0f / float( cells ) ), at( 0, btScalar( 0.5 ), 0 ), material );
	isPlaneFirst ? void() : void( t.addPlane() );
	t.run( 90 );
	EXPECT_TRUE( cube->isRigid() );
	return cube;
}

// Bullet's algorithm for planes may name the two bodies of a manifold in the other order than the pair. One of four contacts then had its
// normal turned round, pulled at the plane, and held the cube: an impulse of 5 m/s left it 2.2 m/s and 4.3 rad/s.
TEST( FirstContacts, PushABodyOffThePlaneThatItRestsOn )
{
	for ( const bool isPlaneFirst : { true, false } )
	{
		for ( const int cells : { 3, 5 } )
		{
			TestWorld t;
			SoftBody* const cube = restOnPlane( t, cells, isPlaneFirst );
			btDispatcher& dispatcher = *t.world.getDispatcher();
			for ( int m = 0; m < dispatcher.getNumManifolds(); ++m )
			{
				const btPersistentManifold& manifold = *dispatcher.getManifoldByIndexInternal( m );
				const bool isFirst = SoftBody::upcast( manifold.getBody0() ) != nullptr;
				for ( int k = 0; k < manifold.getNumContacts(); ++k )
				{
					EXPECT_GT( manifold.getContactPoint( k ).m_normalWorldOnB.y() * ( isFirst ? 1 : -1 ), btScalar( 0.9 ) )
						<< "contact " << k << " of " << cells << " cells";
				}
			}
			ASSERT_TRUE( cube->applyCentralImpulse( btVector3( 0, 5 * cube->mass(), 0 ) ).ok() );
			t.run( 1 );
			EXPECT_NEAR( cube->linearVelocity().y(), 5 - 10 * test::kFrame, 0.05 ) << cells << " cells";
			EXPECT_LT( cube->angularVelocity().length(), btScalar( 0.1 ) );
		}
	}
}

} // namespace
} // namespace pliant
