// Calls at the wrong time, and functions of the game that return nonsense.

#include "world/bodies/soft_body_impl.h"
#include "world/misuse/misuse.h"

#include <pliant/game/queries.h>
#include <pliant/game/skeleton.h>
#include <pliant/render/render_mesh.h>
#include <pliant/render/vertex_attributes.h>

#include <functional>
#include <utility>

namespace pliant::test {
namespace {

/// The action of a contact callback, once a step of the world.
std::function<void()> inContact;

bool onProcessed( btManifoldPoint&, void*, void* )
{
	if ( inContact )
	{
		std::exchange( inContact, nullptr )();
	}
	return false;
}

class MisuseInStep : public testing::Test
{
protected:
	MisuseInStep() { gContactProcessedCallback = onProcessed; }
	~MisuseInStep() override
	{
		gContactProcessedCallback = nullptr;
		inContact = nullptr;
	}

	/// The bytes of a scene after a second, during which a contact callback has made a call.
	static std::vector<std::byte> after( const std::function<void( Scene& )>& call )
	{
		Scene scene( BodyState::Resting );
		bool isCalled = false;
		inContact = [&] {
			isCalled = true;
			call( scene );
		};
		scene.run( 30 );
		EXPECT_TRUE( isCalled );
		EXPECT_TRUE( scene.body->isHealthy() );
		return scene.bytes( true );
	}
};

void expectRefused( const Status& status, const char* call )
{
	EXPECT_EQ( status.code, kBad );
	EXPECT_NE( status.sentence.find( call ), std::string::npos ) << status.sentence;
}

TEST_F( MisuseInStep, WhatIsNotForAStepIsRefusedThenAndChangesNothing )
{
	const std::vector<std::byte> undisturbed = after( []( Scene& ) {} );
	Scene saved( BodyState::Resting );
	std::vector<std::byte> bytes;
	ASSERT_TRUE( saveWorld( saved.home.world, bytes ).ok() );
	const std::unique_ptr<TaskRunner> pool = createThreadPool( 2 );
	const std::function<void( Scene& )> calls[] = {
		[]( Scene& s ) { expectRefused( s.home.world.explode( Explosion{} ).status, "explode" ); },
		[]( Scene& s ) { expectRefused( s.home.world.shiftOrigin( btVector3( 16, 0, 0 ) ), "shiftOrigin" ); },
		[]( Scene& s ) { EXPECT_FALSE( s.home.world.removeFrame( s.frame ) ); },
		[]( Scene& s ) { EXPECT_EQ( s.home.world.stepSimulation( kFrame, 0 ), 0 ); },
		[]( Scene& s ) {
			s.home.world.setThreadCount( 2 );
			EXPECT_EQ( s.home.world.threadCount(), 1 );
		},
		[&]( Scene& s ) {
			s.home.world.setTaskRunner( pool.get() );
			EXPECT_EQ( s.home.world.threadCount(), 1 );
		},
		[]( Scene& s ) {
			std::vector<std::byte> none;
			expectRefused( saveWorld( s.home.world, none ), "saveWorld" );
			EXPECT_TRUE( none.empty() );
		},
		[&]( Scene& s ) { expectRefused( restoreWorld( s.home.world, bytes ).status, "restoreWorld" ); },
		[]( Scene& s ) { // queries, which return the state in the middle of a step
			static_cast<void>( SurfaceQuery( *s.body ).nearest( btVector3( 0, 0, 0 ) ) );
			static_cast<void>( s.body->gasVolume() );
		},
	};
	int index = 0;
	for ( const std::function<void( Scene& )>& call : calls )
	{
		EXPECT_TRUE( after( call ) == undisturbed ) << "call " << index;
		++index;
	}
}

// Calls that are allowed in a contact callback take effect there, in the middle of a step, on the body whose contacts are being found.
const std::function<void( Scene& )> kCallsInContact[] = {
	[]( Scene& s ) { EXPECT_TRUE( s.body->teleport( at( 0, 1, 0 ) ).ok() ); },
	[]( Scene& s ) { EXPECT_TRUE( s.body->reset( at( 0, 1, 0 ) ).ok() ); },
	[]( Scene& s ) { EXPECT_TRUE( s.body->setScale( btScalar( 1.1 ) ).ok() ); },
	[]( Scene& s ) { EXPECT_TRUE( s.body->setMaterial( stiff( 5e4f ) ).ok() ); },
	[]( Scene& s ) { EXPECT_TRUE( s.body->setMaterial( implicit( 5e5f ) ).ok() ); },
	[]( Scene& s ) { EXPECT_TRUE( s.body->setMaterial( implicit( 5e5f, 2 ) ).ok() ); },
	[]( Scene& s ) {
		EXPECT_TRUE( s.body->pinNode( 0 ).ok() );
		s.body->releaseNode( 0 );
	},
	[]( Scene& s ) { s.body->setCollisionFlags( btCollisionObject::CF_STATIC_OBJECT ); },
	[]( Scene& s ) { s.body->setCollisionFlags( btCollisionObject::CF_NO_CONTACT_RESPONSE ); },
	[]( Scene& s ) { s.body->forceActivationState( DISABLE_SIMULATION ); },
	[]( Scene& s ) { EXPECT_TRUE( s.body->setFracture( changed( Fracture{}, &Fracture::rule, BreakRule::Plane ) ).ok() ); },
	[]( Scene& s ) { EXPECT_GT( s.body->cutPlane( s.body->massCentre(), btVector3( 1, 0, 0 ) ), 0 ); },
	[]( Scene& s ) { EXPECT_EQ( s.body->heal(), 0 ); },
	[]( Scene& s ) { EXPECT_TRUE( s.body->prepareCracks().ok() ); },
	[]( Scene& s ) { EXPECT_TRUE( s.body->setVelocities( btVector3( 0, 1, 0 ), btVector3( 0, 1, 0 ) ).ok() ); },
	[]( Scene& s ) { EXPECT_TRUE( s.body->applyImpulse( btVector3( 0, 1, 0 ), 0 ).ok() ); },
	[]( Scene& s ) { EXPECT_TRUE( s.body->applyForce( btVector3( 0, 1, 0 ), 0 ).ok() ); },
	[]( Scene& s ) { EXPECT_TRUE( s.body->pinNode( 0 ).ok() ); },
	[]( Scene& s ) { EXPECT_TRUE( s.body->pinNodeToBody( 0, s.box ).ok() ); },
	[]( Scene& s ) { EXPECT_TRUE( s.body->driveNode( 0, s.body->nodePosition( 0 ) + btVector3( 0, btScalar( 0.01 ), 0 ) ).ok() ); },
	[]( Scene& s ) { EXPECT_TRUE( s.body->setSelfCollision( true ).ok() ); },
	[]( Scene& s ) { s.body->setContactEvents( true ); },
	[]( Scene& s ) { EXPECT_TRUE( followTargets( *s.body ).ok() ); },
	[]( Scene& s ) { EXPECT_TRUE( s.home.world.attach( *s.body, 0, *s.box ).ok() ); },
	[]( Scene& s ) { EXPECT_TRUE( s.home.world.attach( *s.body, *s.other, btVector3( btScalar( -0.5 ), btScalar( 0.2 ), 0 ) ).ok() ); },
	[]( Scene& s ) { EXPECT_TRUE( s.home.world.weld( *s.body, *s.other, 1 ).ok() ); },
	[]( Scene& s ) { EXPECT_TRUE( s.home.world.detach( s.attachment ) ); },
	[]( Scene& s ) { EXPECT_TRUE( s.home.world.addFrame( *s.body, s.body->massCentre(), 1 ).ok() ); },
	[]( Scene& s ) { s.home.world.setSoftSubsteps( 7 ); },
	[]( Scene& s ) { s.home.world.removeSoftBody( s.body ); },
	[]( Scene& s ) { s.home.world.removeSoftBody( s.other ); },
	[]( Scene& s ) { s.home.addSoft( s.body->impl().bodyTemplate, at( 0, 1, 0 ) ); },
	[]( Scene& s ) { s.home.world.removeRigidBody( s.box ); },
	[]( Scene& s ) { s.home.soft.erase( s.home.soft.begin() ); }, // deletes the other body
	[]( Scene& s ) { static_cast<void>( s.body->surface() ); },
	[]( Scene& s ) { static_cast<void>( saveBody( *s.body ) ); },
};

TEST_F( MisuseInStep, OtherCallsDoTheirWork )
{
	for ( const BodyState state : { BodyState::Resting, BodyState::Implicit } )
	{
		int index = 0;
		for ( const std::function<void( Scene& )>& call : kCallsInContact )
		{
			SCOPED_TRACE( "call " + std::to_string( index ) + ", body " + std::to_string( int( state ) ) );
			Scene scene( state );
			inContact = [&] { call( scene ); };
			scene.run( 30 );
			EXPECT_TRUE( scene.body->isHealthy() );
			EXPECT_TRUE( std::isfinite( scene.box->getWorldTransform().getOrigin().length() ) );
			EXPECT_LT( scene.body->linearVelocity().length(), 8 );
			++index;
		}
	}
}

TEST_F( MisuseInStep, BetweenStepsTheSameCallsWork )
{
	Scene scene( BodyState::Resting );
	std::vector<std::byte> bytes;
	EXPECT_TRUE( scene.home.world.explode( Explosion{ btVector3( 0, 5, 0 ) } ).ok() );
	EXPECT_TRUE( scene.home.world.shiftOrigin( btVector3( 16, 0, 0 ) ).ok() );
	EXPECT_TRUE( saveWorld( scene.home.world, bytes ).ok() );
	EXPECT_TRUE( restoreWorld( scene.home.world, bytes ).ok() );
	EXPECT_TRUE( scene.home.world.removeFrame( scene.frame ) );
	scene.home.world.setThreadCount( 2 );
	EXPECT_EQ( scene.home.world.threadCount(), 2 );
	scene.run( 30 );
	EXPECT_TRUE( scene.body->isHealthy() );
}

/// A field that returns numbers that are not finite.
class Nonsense : public ForceField
{
public:
	Nonsense() : ForceField( kAcceleration ) {}
	btVector3 acceleration( const btVector3& ) const override { return btVector3( kNan, 0, 0 ); }
	bool actsOn( const btCollisionObject& object ) const override { return &object == only; }

	const btCollisionObject* only = nullptr;
};

TEST( MisuseOfFields, ANumberThatIsNoneHarmsNobodyElse )
{
	Scene scene( BodyState::Resting );
	Nonsense field;
	ASSERT_TRUE( scene.home.world.addForceField( field ).ok() );
	field.only = scene.box;
	scene.run( 10 );
	EXPECT_TRUE( std::isfinite( scene.box->getWorldTransform().getOrigin().length() ) );
	field.only = scene.body;
	field.wake();
	scene.run( 10 );
	EXPECT_FALSE( scene.body->isHealthy() );
	EXPECT_TRUE( scene.other->isHealthy() );
	EXPECT_TRUE( std::isfinite( scene.body->massCentre().length() ) );
}

/// A runner that reports zero threads.
class NoThreads : public TaskRunner
{
public:
	void run( int count, Task task, void* context ) override
	{
		for ( int i = 0; i < count; ++i )
		{
			task( context, i );
		}
	}
	int threadCount() const override { return -3; }
};

TEST( MisuseOfThreads, ARunnerWithoutThreadsIsOneOfOneThread )
{
	Scene scene( BodyState::Resting ), twin( BodyState::Resting );
	NoThreads runner;
	scene.home.world.setTaskRunner( &runner );
	EXPECT_EQ( scene.home.world.threadCount(), 1 );
	scene.run( 20 );
	twin.run( 20 );
	EXPECT_TRUE( scene.bytes( true ) == twin.bytes( true ) );
	scene.home.world.setTaskRunner( nullptr );
}

// A radius that covers everything is valid, but Bullet supports no sphere of a million kilometres.
TEST( MisuseOfFrames, AHugeRadiusIsThatOfTheBody )
{
	Scene scene( BodyState::Resting );
	btRigidBody* const frame = scene.home.world.addFrame( *scene.body, scene.body->massCentre(), btScalar( 1e30 ) ).value;
	ASSERT_NE( frame, nullptr );
	scene.run( 10 );
	EXPECT_NE( frame->getActivationState(), DISABLE_SIMULATION );
	EXPECT_NEAR( frame->getMass(), scene.body->mass(), 1 );
	scene.home.world.removeSoftBody( scene.body ); // it becomes an ordinary rigid body
	scene.run( 10 );
	EXPECT_TRUE( std::isfinite( frame->getWorldTransform().getOrigin().length() ) );
	EXPECT_LT( frame->getInvInertiaDiagLocal().length(), 1e6 );
	EXPECT_GT( frame->getInvInertiaDiagLocal().length(), 0 );
}

// A skin is for one body; with another body it must not read beyond the data of the first.
TEST( MisuseOfSkins, AnotherBodyIsDrawnAsItIs )
{
	TestWorld t;
	const auto shape = block( 4, 4, 4, 0.1f );
	SoftBody* const whole = t.addSoft( shape, at( 0, 3, 0 ) );
	SoftBody* const halved = t.addSoft( shape, at( 3, 3, 0 ) );
	SoftBody* const cornered = t.addSoft( shape, at( 6, 3, 0 ) );
	ASSERT_GT( halved->cutPlane( halved->massCentre(), btVector3( 1, 0, 0 ) ), 0 );
	ASSERT_GT( cornered->cutPlane( cornered->massCentre() + btVector3( btScalar( 0.1 ), 0, 0 ), btVector3( 1, 0, 0 ) ), 0 );
	t.run( 2 );
	ASSERT_NE( halved->nodeCount(), cornered->nodeCount() );
	ASSERT_EQ( halved->fractureVersion(), cornered->fractureVersion() );

	const float corners[9] = { -0.2f, 0, 0, 0.2f, 0, 0, 0, 0.2f, 0 };
	const std::uint32_t face[3] = { 0, 1, 2 };
	MeshView mesh;
	mesh.positions = corners;
	mesh.vertexCount = 3;
	mesh.indices = face;
	mesh.triangleCount = 1;
	const auto bound = RenderMesh::bind( shape, mesh ).value;
	const auto shared = std::move( RenderSkin::create( bound ).value );
	for ( const SoftBody* body : { cornered, halved, whole, halved, cornered } )
	{
		const auto own = std::move( RenderSkin::create( bound ).value );
		const auto there = trianglesOf( shared->surface( *body ) ), expected = trianglesOf( own->surface( *body ) );
		EXPECT_EQ( there, expected );
		EXPECT_EQ( shared->vertexSources( *body ).vertexCount, own->vertexSources( *body ).vertexCount );
		EXPECT_EQ( shared->gpuSurface( *body ).influences.count, own->gpuSurface( *body ).influences.count );
	}
}

// A body that is restored to before its first crack, and breaks elsewhere, has as many cracks as before, but different ones.
TEST( MisuseOfSkins, ARestoredBodyThatBreaksElsewhereIsDrawnAnew )
{
	TestWorld t;
	SoftBody* const body = t.addSoft( block( 4, 4, 4, 0.1f ), at( 0, 3, 0 ) );
	std::vector<std::byte> before;
	ASSERT_TRUE( saveWorld( t.world, before ).ok() );
	const auto skin = std::move( RenderSkin::create( RenderMesh::bind( body->impl().bodyTemplate,
														 [] {
															 static const float corners[9] = { -0.2f, 0, 0, 0.2f, 0, 0, 0, 0.2f, 0 };
															 static const std::uint32_t face[3] = { 0, 1, 2 };
															 MeshView mesh;
															 mesh.positions = corners;
															 mesh.vertexCount = 3;
															 mesh.indices = face;
															 mesh.triangleCount = 1;
															 return mesh;
														 }() )
														 .value )
									 .value );
	int cells[2] = { 0, 0 };
	unsigned versions[2] = { 0, 0 };
	for ( int k = 0; k < 2; ++k )
	{
		ASSERT_TRUE( restoreWorld( t.world, before ).ok() );
		ASSERT_GT( body->cutPlane( body->massCentre() + btVector3( btScalar( 0.1 ) * btScalar( k ), 0, 0 ), btVector3( 1, 0, 0 ) ), 0 );
		t.run( 2 );
		cells[k] = body->cellCount();
		const GpuSurfaceView own = body->gpuSurface(), drawn = skin->gpuSurface( *body );
		versions[k] = own.topologyVersion;
		EXPECT_EQ( own.topologyVersion, body->surface().topologyVersion );
		EXPECT_EQ( drawn.topologyVersion, own.topologyVersion );
		EXPECT_EQ( own.vertices.count, body->surface().vertexCount );
		for ( const GpuSurfaceView& view : { own, drawn } )
		{
			for ( int i = 0; i < view.influences.count; ++i )
			{
				ASSERT_LT( view.influences.data[i].cell, std::uint32_t( view.nodeCount ) );
			}
		}
		EXPECT_EQ( vertexSources( *body ).vertexCount, body->surface().vertexCount );
		EXPECT_EQ( vertexSources( *body ).topologyVersion, own.topologyVersion );
	}
	EXPECT_NE( cells[0], cells[1] );
	EXPECT_NE( versions[0], versions[1] );
}

} // namespace
} // namespace pliant::test
