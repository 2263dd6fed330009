#include "world/misuse/misuse.h"

#include "world/bodies/soft_body_impl.h"
#include "world/levels/adaptive_bodies.h"

#include <pliant/game/skeleton.h>

namespace pliant::test {

namespace {

Material materialOf( BodyState state )
{
	Material material = state == BodyState::Implicit ? implicit( 1e5f ) : stiff( 1e5f );
	material.rigidStrain = state == BodyState::Rigid ? 0.05f : 0.0f;
	return material;
}

std::shared_ptr<const BodyTemplate> bareCube()
{
	static const float corners[24] = { 0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 0, 1, 1, 0, 1, 0, 1, 1, 1, 1, 1 };
	static const std::uint32_t indices[36] = {
		0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5 };
	MeshView mesh;
	mesh.positions = corners;
	mesh.vertexCount = 8;
	mesh.indices = indices;
	mesh.triangleCount = 12;
	LatticeSettings settings;
	settings.cellSize = 0.5f;
	settings.skinning = Skinning::None;
	return BodyTemplate::build( mesh, settings ).value;
}

void followOneBone( SoftBody& body )
{
	const std::size_t count = std::size_t( body.bodyTemplate().vertexCount() );
	const std::vector<float> weights( count, 1.0f );
	const std::vector<int> bones( count, 0 );
	EXPECT_TRUE( followBones( body, SkinWeights{ bones.data(), weights.data(), 1, int( count ), 1 } ).ok() );
}

} // namespace

Scene::Scene( BodyState state )
{
	floor = home.addFloor();
	box = home.addBox( 1, btVector3( 0.1f, 0.1f, 0.1f ), at( 1, btScalar( 0.1 ), 0 ) );
	farBox = elsewhere.addBox( 1, btVector3( 0.1f, 0.1f, 0.1f ), at( 1, 1, 0 ) );
	looseShape = std::make_unique<btBoxShape>( btVector3( 1, 1, 1 ) );
	loose = std::make_unique<btRigidBody>( btScalar( 1 ), nullptr, looseShape.get() );
	const std::shared_ptr<const BodyTemplate> cube = block( 4, 4, 4, 0.1f );
	other = home.addSoft( cube, at( -1, btScalar( 0.2 ), 0 ) );
	if ( state == BodyState::InNoWorld )
	{
		m_free = std::move( SoftBody::create( cube, at( 0, 3, 0 ) ).value );
		body = m_free.get();
	}
	else
	{
		TestWorld& world = state == BodyState::Elsewhere ? elsewhere : home;
		const btScalar height = state == BodyState::Rigid ? btScalar( 30 ) : btScalar( 0.2 );
		body = world.addSoft( cube, at( 0, height, 0 ), materialOf( state ), levels( state == BodyState::Levels ? 2 : 0 ) );
	}
	switch ( state )
	{
		case BodyState::Static: body->setCollisionFlags( btCollisionObject::CF_STATIC_OBJECT ); break;
		case BodyState::Kinematic: body->setCollisionFlags( btCollisionObject::CF_KINEMATIC_OBJECT ); break;
		case BodyState::Broken: EXPECT_GT( body->cutPlane( at( 0, btScalar( 0.2 ), 0 ).getOrigin(), btVector3( 1, 0, 0 ) ), 0 ); break;
		case BodyState::Held:
			EXPECT_TRUE( body->pinNode( 3 ).ok() );
			EXPECT_TRUE( body->pinNodeToBody( 60, box ).ok() );
			EXPECT_TRUE( body->driveNode( 5, body->nodePosition( 5 ) ).ok() );
			break;
		default: break;
	}
	frame = home.world.addFrame( *other, other->massCentre(), btScalar( 0.15 ) ).value;
	bare = std::move( SoftBody::create( bareCube(), at( 0, 0, 0 ) ).value );
	posed = std::move( SoftBody::create( cube, at( 0, 0, 0 ) ).value );
	drawn = std::move( SoftBody::create( cube, at( 0, 0, 0 ) ).value );
	followOneBone( *posed );
	EXPECT_TRUE( followTargets( *drawn ).ok() );
	for ( SoftBody* each : { body, other } )
	{
		each->setSurfaceTolerance( 0 );
		static_cast<void>( each->surface() ); // the drawn surface is a part of the state
	}
	attachment = home.world.attach( *other, 0, *floor ).value;
	EXPECT_TRUE( elsewhere.world.addForceField( field ).ok() );
	run( 5 );
	if ( state == BodyState::Asleep )
	{
		body->forceActivationState( ISLAND_SLEEPING );
	}
	if ( state == BodyState::Quarantined )
	{
		body->impl().body->nodes().v.set( 5, Vec3( std::numeric_limits<float>::quiet_NaN(), 0.0f, 0.0f ) );
		run( 1 );
		EXPECT_FALSE( body->isHealthy() );
	}
	EXPECT_EQ( body->isRigid(), state == BodyState::Rigid );
}

std::vector<std::byte> Scene::bytes( bool isForComparison ) const
{
	SaveSettings settings;
	settings.withTemplates = false;
	settings.forComparison = isForComparison;
	std::vector<std::byte> all, part;
	for ( const TestWorld* world : { &home, &elsewhere } )
	{
		EXPECT_TRUE( saveWorld( world->world, part, settings ).ok() );
		all.insert( all.end(), part.begin(), part.end() );
	}
	for ( const SoftBody* each : { m_free.get(), bare.get(), posed.get(), drawn.get() } )
	{
		part = each ? saveBody( *each, settings ).value : std::vector<std::byte>();
		all.insert( all.end(), part.begin(), part.end() );
	}
	return all;
}

void Scene::run( int steps )
{
	home.run( steps );
	elsewhere.run( steps );
}

btCollisionObject* Scene::proxy() const
{
	btDispatcher& dispatcher = const_cast<btCollisionDispatcher&>( home.parts.dispatcher );
	for ( int m = 0; m < dispatcher.getNumManifolds(); ++m )
	{
		const btPersistentManifold& manifold = *dispatcher.getManifoldByIndexInternal( m );
		for ( const btCollisionObject* side : { manifold.getBody0(), manifold.getBody1() } )
		{
			if ( SoftBody::upcast( side ) == other && side != other )
			{
				return const_cast<btCollisionObject*>( side );
			}
		}
	}
	return nullptr;
}

void expectNothingChanges( BodyState state, const Misuse* first, const Misuse* last )
{
	Scene scene( state ), twin( state );
	std::vector<std::byte> before = scene.bytes( false );
	for ( const Misuse* misuse = first; misuse != last; ++misuse )
	{
		const std::string call = misuse->call;
		SCOPED_TRACE( call + ", body " + std::to_string( int( state ) ) );
		const std::string word = misuse->word ? misuse->word : call.substr( call.rfind( ':' ) + 1 );
		int k = 0;
		for ( const Status& answer : misuse->make( scene ) )
		{
			EXPECT_EQ( answer.code, misuse->code ) << "misuse " << k << ": " << answer.sentence;
			EXPECT_EQ( answer.sentence.empty(), answer.ok() );
			EXPECT_TRUE( answer.ok() || answer.sentence.find( word ) != std::string::npos ) << "misuse " << k << ": " << answer.sentence;
			++k;
		}
		const std::vector<std::byte> after = scene.bytes( false );
		EXPECT_TRUE( before == after ) << "something has changed";
		before = after;
	}
	scene.run( 20 );
	twin.run( 20 );
	EXPECT_TRUE( scene.bytes( true ) == twin.bytes( true ) ) << "body " << int( state ) << " goes on otherwise";
	EXPECT_EQ( scene.body->isHealthy(), state != BodyState::Quarantined );
}

} // namespace pliant::test
