// Gas in hollow bodies, and explosions: the law of each, and its misuse.

#include "world/game/hollow_box.h"
#include "world/game/space.h"

#include <pliant/game/forces.h>

#include <BulletCollision/CollisionDispatch/btGhostObject.h>

#include <cmath>
#include <cstdio>
#include <limits>

namespace pliant::test {

namespace {

const btScalar kNaN = std::numeric_limits<btScalar>::quiet_NaN();

class BlastsOn : public ::testing::TestWithParam<Elasticity>
{};

} // namespace

INSTANTIATE_TEST_SUITE_P( Steps, BlastsOn, ::testing::Values( Elasticity::Explicit, Elasticity::Implicit ),
	[]( const auto& given ) { return given.param == Elasticity::Explicit ? "Explicit" : "Implicit"; } );

// --- gas --------------------------------------------------------------------------------------------------------------------

TEST_P( BlastsOn, GasInflatesAHollowBodyWithoutMovingIt )
{
	Space t;
	SoftBody* ball = t.addSoft( hollowBox( 1, 0.125f ), at( 1, 2, 3 ), of( GetParam(), 1000, 1e6f ) );
	ASSERT_TRUE( ball->setGas( Gas{ GasLaw::Constant, btScalar( 2e4 ), 0 } ).ok() );
	const btScalar before = ball->gasVolume();
	EXPECT_NEAR( before, 0.42, 0.02 );
	t.run( 120 );
	EXPECT_GT( ball->gasVolume(), 1.01 * before );
	EXPECT_LT( ball->linearVelocity().length(), 1e-4 );
	EXPECT_LT( ball->angularVelocity().length(), 1e-3 );
	EXPECT_EQ( ball->gasPressure(), btScalar( 2e4 ) );
}

TEST_P( BlastsOn, AnIdealGasKeepsPressureTimesVolume )
{
	Space t;
	SoftBody* ball = t.addSoft( hollowBox( 1, 0.125f ), at( 0, 0, 0 ), of( GetParam(), 100, 1e6f ) );
	ASSERT_TRUE( ball->setGas( Gas{ GasLaw::Ideal, btScalar( 5e4 ), btScalar( 1e5 ) } ).ok() );
	const double amount = 1.5e5 * double( ball->gasVolume() );
	t.run( 240 );
	EXPECT_TRUE( ball->isHealthy() );
	EXPECT_LT( ball->gasPressure(), btScalar( 5e4 ) ) << "the body has grown";
	EXPECT_NEAR( ( double( ball->gasPressure() ) + 1e5 ) * double( ball->gasVolume() ), amount, 0.01 * amount );
}

TEST( Gas, IsGoneWhenTheBodyIsPierced )
{
	Space t;
	SoftBody* ball = t.addSoft( hollowBox( 1, 0.125f ), at( 0, 0, 0 ), of( Elasticity::Explicit, 1000, 1e6f ) );
	ASSERT_TRUE( ball->setGas( Gas{ GasLaw::Constant, btScalar( 1e3 ), 0 } ).ok() );
	t.run( 2 );
	EXPECT_GT( ball->gasVolume(), 0 );
	EXPECT_GT( ball->cutSphere( btVector3( 0.5f, 0, 0 ), btScalar( 0.2 ) ), 0 );
	t.run( 2 );
	EXPECT_EQ( ball->gasVolume(), 0 );
	EXPECT_EQ( ball->gasPressure(), 0 );
}

TEST( Gas, IsRefusedWhereItCannotBe )
{
	Space t;
	SoftBody* solid = t.addSoft( block( 3, 3, 3, 0.1f ), at( 0, 0, 0 ) );
	EXPECT_EQ( solid->setGas( Gas{ GasLaw::Constant, 1, 0 } ).code, ResultCode::BadArgument );
	EXPECT_EQ( solid->gas().law, GasLaw::None );
	SoftBody* hollow = t.addSoft( hollowBox( 1, 0.125f ), at( 5, 0, 0 ) );
	EXPECT_EQ( hollow->setGas( Gas{ GasLaw::Constant, kNaN, 0 } ).code, ResultCode::BadSettings );
	EXPECT_EQ( hollow->setGas( Gas{ GasLaw::Ideal, -2, 1 } ).code, ResultCode::BadSettings );
	EXPECT_EQ( hollow->setGas( Gas{ GasLaw::Ideal, 1, -1 } ).code, ResultCode::BadSettings );
	EXPECT_EQ( hollow->gas().law, GasLaw::None );
	EXPECT_EQ( hollow->gasVolume( 7 ), 0 );
	ASSERT_TRUE( hollow->setGas( Gas{ GasLaw::Constant, 1, 0 } ).ok() );
	EXPECT_EQ( hollow->gas().law, GasLaw::Constant );
	ASSERT_TRUE( hollow->setGas( Gas{} ).ok() );
	EXPECT_EQ( hollow->gasVolume(), 0 );
}

// --- explosions -------------------------------------------------------------------------------------------------------------

TEST_P( BlastsOn, AnExplosionPushesACubeAsItsRigidTwin )
{
	for ( const btScalar falloff : { btScalar( 0 ), btScalar( 1 ), btScalar( 2 ) } )
	{
		Space t;
		SoftBody* soft = t.addSoft( block( 5, 5, 5, 0.2f ), at( 4, 0, 0 ), of( GetParam(), 100 ) );
		btRigidBody* rigid = t.addBox( 100, btVector3( 0.5f, 0.5f, 0.5f ), at( 0, 4, 0 ) );
		const Result<int> pushed = t.world.explode( Explosion{ btVector3( 0, 0, 0 ), 10, 300, falloff, false } );
		ASSERT_TRUE( pushed.ok() ) << pushed.status.sentence;
		EXPECT_EQ( pushed.value, 2 );
		t.run( 1 );
		EXPECT_GT( rigid->getLinearVelocity().y(), 1 );
		EXPECT_NEAR( soft->linearVelocity().x() / rigid->getLinearVelocity().y(), 1, 0.1 ) << falloff; // half a cell at its edges
		EXPECT_NEAR( soft->linearVelocity().y(), 0, 1e-3 );
	}
}

TEST( Explosions, ReachAsFarAsTheirRadiusAndNotBehindWalls )
{
	Space t;
	SoftBody* far = t.addSoft( block( 3, 3, 3, 0.1f ), at( 8, 0, 0 ) );
	SoftBody* hidden = t.addSoft( block( 3, 3, 3, 0.1f ), at( 0, 4, 0 ) );
	btRigidBody* rigid = t.addBox( 1, btVector3( 0.1f, 0.1f, 0.1f ), at( 0.5f, 4, 0 ) );
	t.addBox( 0, btVector3( 2, 0.1f, 2 ), at( 0, 2, 0 ) );
	Explosion explosion{ btVector3( 0, 0, 0 ), 5, 100, 1, true };
	EXPECT_EQ( t.world.explode( explosion ).value, 0 );
	EXPECT_EQ( hidden->linearVelocity().length(), 0 );
	explosion.isSheltered = false;
	EXPECT_EQ( t.world.explode( explosion ).value, 2 );
	EXPECT_GT( hidden->linearVelocity().y(), 0.05 );
	EXPECT_GT( rigid->getLinearVelocity().y(), 0.1 );
	EXPECT_EQ( far->linearVelocity().length(), 0 );
}

TEST( Explosions, WakeWhatTheyPushAndLeaveHeldNodes )
{
	Space t;
	t.world.setGravity( btVector3( 0, -10, 0 ) );
	t.addFloor();
	SoftBody* cube = t.addSoft( block( 3, 3, 3, 0.1f ), at( 0, 0.15f, 0 ) );
	t.run( 300 );
	ASSERT_FALSE( cube->isActive() );
	EXPECT_EQ( t.world.explode( Explosion{ btVector3( -1, 0.5f, 0 ), 5, 100, 1, false } ).value, 1 );
	EXPECT_TRUE( cube->isActive() );
	EXPECT_GT( cube->linearVelocity().x(), 0.1 );
	ASSERT_TRUE( cube->pinNode( 0 ).ok() );
	EXPECT_EQ( t.world.explode( Explosion{ btVector3( -1, 0.5f, 0 ), 5, 100, 1, false } ).value, 1 );
	EXPECT_EQ( cube->nodeVelocity( 0 ).length(), 0 );
	cube->setCollisionFlags( cube->getCollisionFlags() | btCollisionObject::CF_KINEMATIC_OBJECT );
	EXPECT_EQ( t.world.explode( Explosion{ btVector3( -1, 0.5f, 0 ), 5, 100, 1, false } ).value, 0 );
}

/// Links that break within half a second after a blow on a free cube of 4e6 Pa that breaks at a strain of .03.
template <class Blow>
int linksBrokenBy( Elasticity elasticity, float rigidStrain, const Blow& blow )
{
	Space t;
	Material material = of( elasticity, 1000, 4e6f );
	material.rigidStrain = rigidStrain;
	SoftBody* const cube = t.addSoft( block( 8, 8, 8, 0.125f ), at( 0, 0, 0 ), material );
	Fracture brittle;
	brittle.rule = BreakRule::Plane;
	brittle.breakStrain = 0.03f;
	EXPECT_TRUE( cube->setFracture( brittle ).ok() );
	t.run( 30 );
	EXPECT_EQ( cube->isRigid(), rigidStrain > 0.0f );
	blow( t, *cube );
	int links = 0;
	for ( int frame = 0; frame < 30; ++frame )
	{
		t.run( 1 );
		for ( const FractureEvent& event : t.world.fractureEvents() )
		{
			links += event.links;
		}
	}
	return links;
}

// A step of a sixtieth damped the blast away before the implicit cube could break, and a body in its rigid state took it as a whole.
TEST( Explosions, BreakBodiesInBothStepsAndInTheirRigidState )
{
	const auto explode = []( Space& t, SoftBody& ) {
		EXPECT_EQ( t.world.explode( Explosion{ btVector3( -1, 0, 0 ), 10, 20000, 1, false } ).value, 1 );
	};
	const int links = linksBrokenBy( Elasticity::Explicit, 0, explode );
	EXPECT_GT( links, 100 );
	for ( const Elasticity elasticity : { Elasticity::Explicit, Elasticity::Implicit } )
	{
		for ( const float rigidStrain : { 0.0f, 0.01f } )
		{
			const int broken = linksBrokenBy( elasticity, rigidStrain, explode );
			std::printf( "elasticity %d, rigid strain %g: %d links\n", int( elasticity ), double( rigidStrain ), broken );
			EXPECT_GT( broken, links / 4 );
		}
	}
}

TEST( Explosions, ImpulsesOnNodesDeformABodyInItsRigidState )
{
	Space t;
	Material material = of( Elasticity::Explicit, 1000, 4e6f );
	material.rigidStrain = 0.01f;
	SoftBody* const cube = t.addSoft( block( 4, 4, 4, 0.25f ), at( 0, 0, 0 ), material );
	t.run( 30 );
	ASSERT_TRUE( cube->isRigid() );
	ASSERT_TRUE( cube->applyImpulse( btVector3( 100, 0, 0 ), 0 ).ok() );
	EXPECT_FALSE( cube->isRigid() );
	EXPECT_NEAR( double( cube->nodeVelocity( 0 ).x() ), 100.0 / double( cube->nodeMass( 0 ) ), 1e-3 );
	EXPECT_EQ( cube->nodeVelocity( 1 ).x(), btScalar( 0 ) );
}

TEST( Explosions, BadSettingsAndWhatIsTooFastAreRefused )
{
	Space t;
	SoftBody* cube = t.addSoft( block( 3, 3, 3, 0.1f ), at( 1, 0, 0 ) );
	const Explosion good{ btVector3( 0, 0, 0 ), 5, 100, 1, false };
	for ( int k = 0; k < 6; ++k )
	{
		Explosion bad = good;
		( k == 0 ? bad.centre[1] : k == 1 ? bad.radius : k == 2 ? bad.impulse : bad.falloff ) = kNaN;
		bad.radius = k == 3 ? btScalar( 0 ) : bad.radius;
		bad.impulse = k == 4 ? btScalar( -1 ) : bad.impulse;
		bad.falloff = k == 3 || k == 4 ? btScalar( 1 ) : k == 5 ? btScalar( 11 ) : bad.falloff;
		EXPECT_EQ( t.world.explode( bad ).status.code, ResultCode::BadSettings ) << k;
	}
	Explosion huge = good;
	huge.impulse = btScalar( 1e12 );
	EXPECT_EQ( t.world.explode( huge ).status.code, ResultCode::BadArgument );
	EXPECT_EQ( cube->linearVelocity().length(), 0 );
}

} // namespace pliant::test
