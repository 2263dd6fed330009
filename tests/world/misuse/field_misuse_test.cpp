// Calls from force fields, which run in the middle of loops over all bodies: reading works, changes are refused.

#include "world/bodies/soft_body_impl.h"
#include "world/misuse/misuse.h"

#include <pliant/game/skeleton.h>
#include <pliant/render/gpu_surface.h>

#include <functional>
#include <utility>

namespace pliant::test {
namespace {

/// Which of a field's functions makes the call.
enum class From : int
{
	Actor,
	Rigid,
	Soft,
	Volume,
	Surface
};

/// A field without forces that makes one call.
class CallingField : public ForceField
{
public:
	CallingField() : ForceField( kAcceleration | kSurfaceForce | kVolumeForce ) {}

	bool actsOn( const btCollisionObject& object ) const override
	{
		m_isRigid = btRigidBody::upcast( &object ) != nullptr;
		make( From::Actor );
		return true;
	}
	btVector3 acceleration( const btVector3& ) const override
	{
		make( m_isRigid ? From::Rigid : From::Soft );
		return btVector3( 0, 0, 0 );
	}
	btVector3 surfaceForce( const SurfacePoint& ) const override
	{
		make( From::Surface );
		return btVector3( 0, 0, 0 );
	}
	btVector3 volumeForce( const VolumePoint& ) const override
	{
		make( From::Volume );
		return btVector3( 0, 0, 0 );
	}

	From from = From::Soft;
	mutable std::function<void()> call;

private:
	void make( From where ) const
	{
		if ( where == from && call )
		{
			std::exchange( call, nullptr )();
		}
	}
	mutable bool m_isRigid = false;
};

void expectNoChange( const Status& status, const char* call )
{
	EXPECT_EQ( status.code, kBad ) << call;
	EXPECT_EQ( status.sentence.rfind( call, 0 ), 0u ) << status.sentence;
}

/// Calls that are refused with a status.
void callWhatRefuses( Scene& s, const std::vector<std::byte>& snapshot )
{
	SoftBody& body = *s.body;
	SoftBodyHost& world = s.home.world;
	const btVector3 up( 0, 1, 0 ), nothing( 0, 0, 0 );
	const btTransform bone = btTransform::getIdentity();
	const std::vector<btVector3> targets( 64, nothing );
	const std::vector<int> bones( std::size_t( body.bodyTemplate().vertexCount() ), 0 );
	const std::vector<float> weights( bones.size(), 1.0f );
	const std::pair<Status, const char*> refusals[] = {
		{ body.setLinearVelocity( up ), "setLinearVelocity" },
		{ body.setVelocities( up, up ), "setVelocities" },
		{ body.applyCentralForce( up ), "applyCentralForce" },
		{ body.applyForce( up, 0 ), "applyForce" },
		{ body.applyCentralImpulse( up ), "applyCentralImpulse" },
		{ body.applyImpulse( up, 0 ), "applyImpulse" },
		{ body.setGravity( up ), "setGravity" },
		{ body.setGas( Gas{} ), "setGas" },
		{ body.teleport( at( 0, 1, 0 ) ), "teleport" },
		{ body.reset( at( 0, 1, 0 ) ), "reset" },
		{ body.setScale( 2 ), "setScale" },
		{ body.setSelfCollision( true ), "setSelfCollision" },
		{ body.setMaterial( stiff( 1e4f ) ), "setMaterial" },
		{ body.setFracture( Fracture{} ), "setFracture" },
		{ body.prepareCracks(), "prepareCracks" },
		{ body.pinNode( 0 ), "pinNode" },
		{ body.pinNodeToBody( 0, s.box ), "pinNodeToBody" },
		{ body.driveNode( 0, body.nodePosition( 0 ) ), "driveNode" },
		{ followBones( body, SkinWeights{ bones.data(), weights.data(), 1, int( bones.size() ), 1 } ), "followBones" },
		{ followTargets( body ), "followTargets" },
		{ setPose( body, &bone, 1 ), "setPose" },
		{ setTargets( body, targets.data(), 64 ), "setTargets" },
		{ setPoseBlend( body, 1 ), "setPoseBlend" },
		{ world.attach( body, 0, *s.box ).status, "attach" },
		{ world.attach( body, *s.other, body.massCentre() ).status, "attach" },
		{ world.weld( body, *s.other, 10 ).status, "weld" },
		{ world.addFrame( body, body.massCentre(), 1 ).status, "addFrame" },
		{ world.addForceField( s.field ), "addForceField" },
		{ world.explode( Explosion{} ).status, "explode" },
		{ world.shiftOrigin( btVector3( 16, 0, 0 ) ), "shiftOrigin" },
		{ restoreWorld( world, snapshot ).status, "restoreWorld" },
	};
	for ( const auto& [status, call] : refusals )
	{
		expectNoChange( status, call );
	}
	std::vector<std::byte> none;
	expectNoChange( saveWorld( world, none ), "saveWorld" );
}

/// Calls that are ignored.
void callWhatDoesNothing( Scene& s, CallingField& field )
{
	SoftBody& body = *s.body;
	SoftBodyHost& world = s.home.world;
	const btVector3 up( 0, 1, 0 );
	EXPECT_EQ( body.cutPlane( body.massCentre(), up ), 0 );
	EXPECT_EQ( body.cutSphere( body.massCentre(), btScalar( 0.1 ) ), 0 );
	EXPECT_EQ( body.cutSweep( body.massCentre() - up, body.massCentre() + up, up * 10, up * -10 ), 0 );
	EXPECT_EQ( body.heal(), 0 );
	EXPECT_EQ( body.pinNodesInside( btVector3( -9, -9, -9 ), btVector3( 9, 99, 9 ) ), 0 );
	EXPECT_FALSE( world.detach( s.attachment ) );
	EXPECT_FALSE( world.removeFrame( s.frame ) );
	EXPECT_FALSE( world.removeForceField( field ) );
	EXPECT_EQ( world.forceFieldCount(), 1 );
	EXPECT_EQ( body.surface().vertexCount, 0 );
	EXPECT_EQ( body.gpuSurface().vertices.count, 0 );
	body.clearGravity();
	body.releaseNode( 0 );
	body.setContactEvents( true );
	body.setInterpolation( true );
	body.requestRefinement( btVector3( -9, -9, -9 ), btVector3( 9, 9, 9 ) );
	body.setFinestLevel( 1 );
	stopFollowing( body );
	world.addSoftBody( s.posed.get() );
	world.removeSoftBody( s.other );
	EXPECT_EQ( world.softBodyCount(), 2 );
	EXPECT_EQ( s.home.world.stepSimulation( kFrame, 0 ), 0 );
	field.wake();
}

TEST( MisuseInFields, CallsThatChangeTheWorldAreRefused )
{
	for ( const BodyState state : { BodyState::Resting, BodyState::Implicit, BodyState::Rigid, BodyState::Levels, BodyState::Held } )
	{
		for ( const From from : { From::Actor, From::Rigid, From::Soft, From::Volume, From::Surface } )
		{
			SCOPED_TRACE( "body " + std::to_string( int( state ) ) + ", from " + std::to_string( int( from ) ) );
			std::vector<std::byte> after[2];
			for ( int k = 0; k < 2; ++k )
			{
				Scene scene( state );
				CallingField field;
				field.from = from;
				ASSERT_TRUE( scene.home.world.addForceField( field ).ok() );
				scene.run( 5 );
				std::vector<std::byte> snapshot;
				ASSERT_TRUE( saveWorld( scene.home.world, snapshot ).ok() );
				bool isCalled = false;
				field.call = [&] {
					isCalled = true;
					if ( k == 1 )
					{
						callWhatRefuses( scene, snapshot );
						callWhatDoesNothing( scene, field );
					}
				};
				scene.run( 10 );
				EXPECT_TRUE( isCalled );
				after[k] = scene.bytes( true );
			}
			EXPECT_TRUE( after[0] == after[1] );
		}
	}
}

TEST( MisuseInFields, FieldsAreNeitherAddedNorRemovedFromActsOn )
{
	Scene scene( BodyState::Resting );
	CallingField field;
	Wind second;
	field.from = From::Actor;
	field.call = [&] { expectNoChange( scene.home.world.addForceField( second ), "addForceField" ); };
	ASSERT_TRUE( scene.home.world.addForceField( field ).ok() );
	EXPECT_EQ( scene.home.world.forceFieldCount(), 1 );
	EXPECT_TRUE( scene.home.world.addForceField( second ).ok() );
}

// A world of rigid bodies alone steps as Bullet's world does, except for its fields.
TEST( MisuseInFields, AWorldWithoutSoftBodiesRefusesTheSame )
{
	TestWorld t;
	btRigidBody* const ball = t.add( 1, new btSphereShape( 1 ), at( 0, 5, 0 ) );
	CallingField field;
	field.from = From::Rigid;
	ASSERT_TRUE( t.world.addForceField( field ).ok() );
	field.call = [&] {
		EXPECT_EQ( t.world.stepSimulation( kFrame, 0 ), 0 );
		EXPECT_FALSE( t.world.removeForceField( field ) );
		expectNoChange( t.world.shiftOrigin( btVector3( 16, 0, 0 ) ), "shiftOrigin" );
	};
	t.run( 60 );
	EXPECT_FALSE( field.call );
	EXPECT_NEAR( ball->getLinearVelocity().y(), -kGravity, 1e-3 );
	EXPECT_TRUE( t.world.removeForceField( field ) );
}

} // namespace
} // namespace pliant::test
