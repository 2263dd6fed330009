// Bodies that sleep on a soft body wake when it is removed or moved, by whatever call.

#include "world/test_world.h"

#include <functional>

namespace pliant {
namespace {

using test::at;
using test::block;
using test::TestWorld;

constexpr btScalar kHalf = btScalar( 0.2 ); // of the cube, m

struct Scene
{
	TestWorld world;
	btRigidBody* floor = nullptr;
	SoftBody* cube = nullptr;
	btRigidBody* box = nullptr;
	SoftBody* top = nullptr; ///< a soft body on the same cube

	explicit Scene( Elasticity elasticity )
	{
		floor = world.addFloor();
		Material material = test::stiff( 2e5f );
		material.elasticity = elasticity;
		cube = world.addSoft( block( 8, 4, 4, 0.1f ), at( 0, kHalf, 0 ), material );
		box = world.addBox( 2, btVector3( btScalar( 0.1 ), btScalar( 0.1 ), btScalar( 0.1 ) ), at( btScalar( -0.2 ), btScalar( 0.5 ), 0 ) );
		top = world.addSoft( block( 2, 2, 2, 0.1f ), at( btScalar( 0.2 ), btScalar( 0.51 ), 0 ), material );
		for ( int k = 0; k < 900 && ( cube->isActive() || box->isActive() || top->isActive() ); ++k )
		{
			world.run( 1 );
		}
		EXPECT_FALSE( cube->isActive() || box->isActive() || top->isActive() ) << "all sleep at first";
	}
};

// A barrel sleeps on a mattress. When the mattress is removed, moved or softened, or the floor under both is removed, the barrel must fall.
TEST( Sleepers, WakeWhenTheSoftBodyUnderThemGoes )
{
	struct Case
	{
		const char* what;
		std::function<void( Scene& )> goes;
		btScalar fall; ///< m within half a second, at least
	};
	const Case cases[] = {
		{ "teleported", []( Scene& s ) { EXPECT_TRUE( s.cube->teleport( at( 0, 0, 5 ) ).ok() ); }, btScalar( 0.3 ) },
		{ "teleported a little aside", []( Scene& s ) { EXPECT_TRUE( s.cube->teleport( at( 0, 0, btScalar( 0.33 ) ) ).ok() ); },
			btScalar( 0.3 ) },
		{ "reset elsewhere", []( Scene& s ) { EXPECT_TRUE( s.cube->reset( at( 0, kHalf, 5 ) ).ok() ); }, btScalar( 0.3 ) },
		{ "softened",
			[]( Scene& s ) {
				Material material = s.cube->material();
				material.youngsModulus = 2e3f;
				EXPECT_TRUE( s.cube->setMaterial( material ).ok() );
			},
			btScalar( 0.01 ) },
		{ "removed", []( Scene& s ) { s.world.world.removeSoftBody( s.cube ); }, btScalar( 0.3 ) },
		{ "removed as any object", []( Scene& s ) { s.world.world.removeCollisionObject( s.cube ); }, btScalar( 0.3 ) },
		{ "given a speed", []( Scene& s ) { EXPECT_TRUE( s.cube->setLinearVelocity( btVector3( 0, 0, 8 ) ).ok() ); }, btScalar( 0.01 ) },
		{ "without its floor", []( Scene& s ) { s.world.world.removeRigidBody( s.floor ); }, btScalar( 0.8 ) },
		{ "with its floor turned off",
			[]( Scene& s ) {
				s.floor->setIgnoreCollisionCheck( s.cube, true );
				s.cube->activate( true );
			},
			btScalar( 0.3 ) },
	};
	for ( const Elasticity elasticity : { Elasticity::Explicit, Elasticity::Implicit } )
	{
		for ( const Case& each : cases )
		{
			Scene scene( elasticity );
			const btScalar box = scene.box->getWorldTransform().getOrigin().y(), top = scene.top->massCentre().y();
			each.goes( scene );
			scene.world.run( 30 );
			EXPECT_GT( box - scene.box->getWorldTransform().getOrigin().y(), each.fall ) << each.what << ", rigid";
			EXPECT_GT( top - scene.top->massCentre().y(), each.fall ) << each.what << ", soft";
		}
	}
}

} // namespace
} // namespace pliant
