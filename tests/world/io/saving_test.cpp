// Saving templates, bodies and worlds as a game does, and misuse of it.

#include "support/snapshots.h"
#include "world/test_world.h"

#include <LinearMath/btSerializer.h>

#include <map>

namespace pliant::test {
namespace {

const std::shared_ptr<const BodyTemplate>& cube()
{
	static const std::shared_ptr<const BodyTemplate> made = block( 4, 4, 4, 0.1f );
	return made;
}

std::size_t sizeOf( const Result<std::vector<std::byte>>& saved )
{
	EXPECT_TRUE( saved.ok() ) << saved.status.sentence;
	return saved.value.size();
}

void expectRefused( const Status& status, const char* words )
{
	EXPECT_EQ( status.code, ResultCode::BadSnapshot ) << toString( status.code );
	EXPECT_NE( status.sentence.find( words ), std::string::npos ) << status.sentence;
}

TEST( Saving, LoadedTemplateMakesTheSameBodiesAndSkins )
{
	const auto saved = saveTemplate( *cube() );
	ASSERT_GT( sizeOf( saved ), 0u );
	const auto loaded = loadTemplate( foreign( saved.value ) );
	ASSERT_TRUE( loaded.ok() ) << loaded.status.sentence;
	EXPECT_EQ( loaded.value->cellCount(), cube()->cellCount() );
	EXPECT_EQ( loaded.value->report().cells, cube()->report().cells );
	EXPECT_EQ( loaded.value->fingerprint(), cube()->fingerprint() );
	EXPECT_EQ( saveTemplate( *loaded.value ).value, saved.value );

	std::vector<float> drawn[2];
	for ( int k = 0; k < 2; ++k )
	{
		TestWorld world;
		world.addFloor();
		SoftBody* const body = world.addSoft( k == 0 ? cube() : loaded.value, at( 0, 0.3f, 0 ) );
		static_cast<void>( body->cutPlane( btVector3( 0, 0.3f, 0 ), btVector3( 1, 1, 0 ), btScalar( 0.15 ) ) );
		world.run( 20 );
		const SurfaceView view = body->surface();
		drawn[k].assign( view.positions, view.positions + 3 * std::size_t( view.vertexCount ) );
	}
	EXPECT_EQ( drawn[0], drawn[1] );
}

TEST( Saving, LoadedBodyGoesOnLikeTheSavedOne )
{
	TestWorld worlds[2];
	SoftBody* const body = worlds[0].addSoft( cube(), at( 0, 3, 0 ), stiff( 3e4f ) );
	static_cast<void>( body->setVelocities( btVector3( 1, 0, 0 ), btVector3( 3, 2, 1 ) ) );
	static_cast<void>( body->applyImpulse( btVector3( 30, 0, 10 ), 0 ) );
	worlds[0].run( 4 );
	static_cast<void>( body->pinNode( 5 ) );
	const auto saved = saveBody( *body );
	ASSERT_GT( sizeOf( saved ), 0u );
	SoftBodyResult loaded = loadBody( foreign( saved.value ) );
	ASSERT_TRUE( loaded.ok() ) << loaded.status.sentence;
	worlds[1].world.addSoftBody( loaded.value.get() );
	worlds[0].run( 20 );
	worlds[1].run( 20 );
	EXPECT_TRUE( loaded.value->isPinned( 5 ) );
	for ( int i = 0; i < body->nodeCount(); ++i )
	{
		EXPECT_EQ( body->nodePosition( i ), loaded.value->nodePosition( i ) );
		EXPECT_EQ( body->nodeVelocity( i ), loaded.value->nodeVelocity( i ) );
	}
}

TEST( Saving, InterpolationIsKept )
{
	TestWorld t;
	SoftBody* const body = t.addSoft( cube(), at( 0, 3, 0 ), stiff( 3e4f ) );
	body->setInterpolation( true );
	t.run( 2 );
	const SoftBodyResult loaded = loadBody( saveBody( *body ).value );
	ASSERT_TRUE( loaded.ok() ) << loaded.status.sentence;
	EXPECT_TRUE( loaded.value->interpolation() );
	std::vector<std::byte> bytes;
	ASSERT_TRUE( saveWorld( t.world, bytes ).ok() );
	body->setInterpolation( false );
	ASSERT_TRUE( restoreWorld( t.world, bytes ).ok() );
	EXPECT_TRUE( body->interpolation() );
}

// Bullet's own sweeps of fast bodies are made before the next step updates any surface.
TEST( Saving, QueriesMeetARestoredBodyAtOnce )
{
	TestWorld world, other;
	SoftBody* const body = world.addSoft( cube(), at( 0, 3, 0 ), stiff( 3e4f ) );
	other.addSoft( cube(), at( 0, 3, 0 ), stiff( 3e4f ) );
	world.run( 5 );
	const auto heightIn = []( const TestWorld& of ) {
		const btVector3 from( 0, 9, 0 ), to( 0, -9, 0 );
		btCollisionWorld::ClosestRayResultCallback ray( from, to );
		of.world.rayTest( from, to, ray );
		return ray.m_hitPointWorld.y();
	};
	const Bytes saved = savedWorld( world.world );
	const btScalar then = heightIn( world );
	EXPECT_NEAR( then, body->massCentre().y() + btScalar( 0.2 ), 0.01 );
	for ( const bool isForeign : { false, true } )
	{
		world.run( 20 );
		EXPECT_LT( heightIn( world ), then - btScalar( 0.1 ) );
		ASSERT_TRUE( restoreWorld( world.world, isForeign ? foreign( saved ) : saved ).ok() );
		EXPECT_EQ( heightIn( world ), then );
	}
	EXPECT_GT( heightIn( other ), then );
	ASSERT_TRUE( restoreWorld( other.world, saved ).ok() );
	EXPECT_EQ( heightIn( other ), then );
}

TEST( Saving, BodyWithoutItsTemplateNeedsItListed )
{
	TestWorld world;
	SaveSettings settings;
	settings.withTemplates = false;
	const SoftBody* const body = world.addSoft( cube(), at( 0, 3, 0 ) );
	const auto saved = saveBody( *body, settings );
	EXPECT_LT( sizeOf( saved ), sizeOf( saveBody( *body ) ) );
	expectRefused( loadBody( saved.value ).status, "listed" );
	LoadSettings listed;
	listed.templates = { nullptr, block( 2, 2, 2, 0.1f ), cube() };
	const SoftBodyResult loaded = loadBody( saved.value, listed );
	ASSERT_TRUE( loaded.ok() ) << loaded.status.sentence;
	EXPECT_EQ( &loaded.value->bodyTemplate(), cube().get() );
}

// Bodies of equal templates had one of them in common: the others were deleted and built again.
TEST( Saving, BodiesOfEqualTemplatesStayTheSameBodies )
{
	TestWorld world;
	SoftBody* const bodies[2] = {
		world.addSoft( block( 3, 3, 3, 0.1f ), at( 0, 1, 0 ) ), world.addSoft( block( 3, 3, 3, 0.1f ), at( 1, 1, 0 ) ) };
	const BodyTemplate* const made[2] = { &bodies[0]->bodyTemplate(), &bodies[1]->bodyTemplate() };
	ASSERT_NE( made[0], made[1] );
	const Bytes saved = savedWorld( world.world, true ), before = stateOf( world.world );
	world.run( 3 );
	for ( const bool isForeign : { false, true } )
	{
		const auto restored = restoreWorld( world.world, isForeign ? foreign( saved ) : saved );
		ASSERT_TRUE( restored.ok() ) << restored.status.sentence;
		EXPECT_TRUE( restored.value.created.empty() && restored.value.removed.empty() );
		EXPECT_TRUE( areEqual( stateOf( world.world ), before ) );
		for ( int k = 0; k < 2; ++k )
		{
			EXPECT_EQ( &bodies[k]->bodyTemplate(), made[k] );
		}
	}
}

TEST( Saving, FramesThatTheWorldLacksAreRefused )
{
	TestWorld world;
	SoftBody* const body = world.addSoft( cube(), at( 0, 1, 0 ) );
	const auto frame = world.world.addFrame( *body, btVector3( 0, 1.2f, 0 ), 0.15f );
	ASSERT_TRUE( frame.ok() ) << frame.status.sentence;
	const Bytes saved = savedWorld( world.world );
	ASSERT_TRUE( world.world.removeFrame( frame.value ) );
	world.add( 1, new btSphereShape( 0.15f ), at( 0, 3, 0 ) ); // at the same index
	const Bytes before = stateOf( world.world );
	expectRefused( restoreWorld( world.world, saved ).status, "frame" );
	EXPECT_TRUE( areEqual( stateOf( world.world ), before ) );
}

/// A cube on the floor, which cutInTwo() cuts.
void cubeOnFloor( TestWorld& world )
{
	world.addFloor();
	world.addSoft( cube(), at( 0, 0.3f, 0 ), stiff( 3e4f ) );
	world.run( 5 );
}

void cutInTwo( TestWorld& world )
{
	EXPECT_GT( world.soft[0]->cutPlane( world.soft[0]->massCentre(), btVector3( 1, 0.3f, 0 ) ), 0 );
	world.run( 30 );
	EXPECT_GT( world.world.softBodyCount(), 1 );
}

TEST( Saving, GoingBackBeforeABreakKeepsTheBodyAndEndsItsFragments )
{
	TestWorld world;
	cubeOnFloor( world );
	SoftBody* const body = world.soft[0].get();
	static int thing = 0;
	body->setUserPointer( &thing );
	const Bytes saved = savedWorld( world.world );
	const unsigned version = body->fractureVersion();
	static_cast<void>( body->surface() );
	cutInTwo( world );
	const unsigned broken = body->surface().topologyVersion;
	const auto restored = restoreWorld( world.world, saved );
	ASSERT_TRUE( restored.ok() ) << restored.status.sentence;
	EXPECT_EQ( world.world.softBodyCount(), 1 );
	EXPECT_EQ( world.world.softBody( 0 ), body );
	EXPECT_EQ( world.world.fragmentCount(), 0 );
	EXPECT_EQ( body->getUserPointer(), &thing );
	EXPECT_EQ( body->cellCount(), cube()->cellCount() );
	EXPECT_TRUE( restored.value.created.empty() && restored.value.removed.empty() );
	EXPECT_GT( body->surface().topologyVersion, broken ) << "a renderer that has not seen the body since takes the old triangles";
	EXPECT_GT( body->fractureVersion(), version );
	EXPECT_EQ( body->surface().triangleCount, cube()->triangleCount() );
}

// Contacts of a deformable body with one in its rigid state refer to nodes of the deformable one, in any order of insertion.
TEST( Saving, BodiesInTheirRigidStateComeBack )
{
	for ( const bool isRigidFirst : { false, true } )
	{
		TestWorld world;
		world.addFloor();
		Material rigid = test::implicit( 1e7f );
		rigid.rigidStrain = 0.01f;
		const auto addRigid = [&] { return world.addSoft( block( 2, 2, 2, 0.1f ), at( 0, 0.105f, 0 ), rigid ); };
		SoftBody* const first = isRigidFirst ? addRigid() : nullptr;
		SoftBody* const soft = world.addSoft( block( 4, 4, 4, 0.1f ), at( 0, 0.41f, 0 ), test::implicit( 1e5f ) );
		SoftBody* const body = first ? first : addRigid();
		world.run( 40 );
		ASSERT_TRUE( body->isRigid() && !soft->isRigid() );
		const Bytes saved = savedWorld( world.world );
		const btVector3 before = body->massCentre();
		world.run( 20 );
		ASSERT_TRUE( body->setLinearVelocity( btVector3( 3, 0, 0 ) ).ok() );
		world.run( 20 );
		const auto restored = restoreWorld( world.world, saved );
		ASSERT_TRUE( restored.ok() ) << restored.status.sentence;
		EXPECT_TRUE( body->isRigid() );
		EXPECT_EQ( body->massCentre(), before );
		world.run( 20 );
		EXPECT_LT( body->massCentre().distance( before ), 0.01 );
	}
}

TEST( Saving, GoingForwardAgainCreatesTheFragments )
{
	TestWorld world;
	cubeOnFloor( world );
	const Bytes before = savedWorld( world.world );
	cutInTwo( world );
	const Bytes after = savedWorld( world.world ), there = stateOf( world.world );
	const int count = world.world.softBodyCount();
	ASSERT_TRUE( restoreWorld( world.world, before ).ok() );
	const auto restored = restoreWorld( world.world, after );
	ASSERT_TRUE( restored.ok() ) << restored.status.sentence;
	EXPECT_EQ( int( restored.value.created.size() ), count - 1 );
	EXPECT_EQ( world.world.fragmentCount(), count - 1 );
	EXPECT_TRUE( areEqual( stateOf( world.world ), there ) );
	for ( SoftBody* const created : restored.value.created )
	{
		EXPECT_GT( created->surface().triangleCount, 0 );
		EXPECT_TRUE( world.world.releaseFragment( created ) );
		delete created;
	}
}

TEST( Saving, BodiesOfTheGameThatAreNewerLeaveTheWorld )
{
	TestWorld world;
	world.addSoft( cube(), at( 0, 3, 0 ) );
	const Bytes saved = savedWorld( world.world );
	SoftBody* const newer = world.addSoft( cube(), at( 2, 3, 0 ) );
	const auto restored = restoreWorld( world.world, saved );
	ASSERT_TRUE( restored.ok() ) << restored.status.sentence;
	ASSERT_EQ( restored.value.removed.size(), 1u );
	EXPECT_EQ( restored.value.removed[0], newer );
	EXPECT_EQ( world.world.softBodyCount(), 1 );
}

TEST( Saving, RigidBodiesComeBackUnlessTheGameDoesIt )
{
	for ( const bool isOurs : { true, false } )
	{
		TestWorld world;
		world.addSoft( cube(), at( 0, 3, 0 ) );
		btRigidBody* const box = world.addBox( 1, btVector3( 0.1f, 0.1f, 0.1f ), at( 2, 3, 0 ) );
		world.run( 5 );
		const btVector3 where = box->getWorldTransform().getOrigin(), speed = box->getLinearVelocity();
		const Bytes saved = savedWorld( world.world );
		world.run( 10 );
		const btVector3 later = box->getWorldTransform().getOrigin();
		LoadSettings settings;
		settings.withRigidBodies = isOurs;
		ASSERT_TRUE( restoreWorld( world.world, saved, settings ).ok() );
		EXPECT_EQ( box->getWorldTransform().getOrigin(), isOurs ? where : later );
		EXPECT_EQ( box->getLinearVelocity() == speed, isOurs );
	}
}

// A game that removes objects and adds them again identifies them by its own numbers.
TEST( Saving, ObjectsAreFoundByTheGamesIds )
{
	TestWorld world;
	static std::map<const btCollisionObject*, std::int64_t> ids;
	static std::map<std::int64_t, btCollisionObject*> objects;
	for ( int k = 0; k < 3; ++k )
	{
		btRigidBody* const box = world.addBox( 1, btVector3( 0.1f, 0.1f, 0.1f ), at( btScalar( k ), 1, 0 ) );
		ids[box] = 100 + k;
		objects[100 + k] = box;
	}
	world.addSoft( cube(), at( 0, 3, 0 ) );
	SaveSettings save;
	save.idOf = []( const btCollisionObject& object, void* ) { return ids[&object]; };
	LoadSettings load;
	load.objectOf = []( std::int64_t id, void* ) { return objects[id]; };
	Bytes saved;
	ASSERT_TRUE( saveWorld( world.world, saved, save ).ok() );
	world.world.removeRigidBody( world.rigid[0].get() );
	expectRefused( restoreWorld( world.world, saved, load ).status, "lacks an object" );
	world.world.addRigidBody( world.rigid[0].get() );
	world.run( 3 );
	ASSERT_TRUE( restoreWorld( world.world, saved, load ).ok() );
	for ( int k = 0; k < 3; ++k )
	{
		EXPECT_EQ( world.rigid[std::size_t( k )]->getWorldTransform().getOrigin().x(), btScalar( k ) );
	}
	save.idOf = []( const btCollisionObject&, void* ) { return std::int64_t( 1 ); };
	EXPECT_EQ( saveWorld( world.world, saved, save ).code, ResultCode::BadArgument );
	load.objectOf = []( std::int64_t, void* ) { return objects[100]; };
	EXPECT_FALSE( restoreWorld( world.world, saved, load ).ok() );
}

TEST( Saving, WorldWithOtherObjectsIsRefused )
{
	TestWorld world;
	world.addBox( 1, btVector3( 0.1f, 0.1f, 0.1f ), at( 0, 1, 0 ) );
	world.addSoft( cube(), at( 0, 3, 0 ) );
	const Bytes saved = savedWorld( world.world );
	world.add( 1, new btSphereShape( 1 ), at( 5, 1, 0 ) );
	expectRefused( restoreWorld( world.world, saved ).status, "did not have" );
	TestWorld other;
	expectRefused( restoreWorld( other.world, saved ).status, "listed" );
	other.add( 1, new btSphereShape( 1 ), at( 5, 1, 0 ) );
	other.addSoft( cube(), at( 0, 3, 0 ) );
	expectRefused( restoreWorld( other.world, saved ).status, "another kind" );
}

TEST( Saving, ForeignDataIsRefused )
{
	TestWorld world;
	world.addSoft( cube(), at( 0, 3, 0 ) );
	const Bytes saved = savedWorld( world.world );
	expectRefused( restoreWorld( world.world, BytesView() ).status, "too short" );
	expectRefused( restoreWorld( world.world, Bytes( 200, std::byte( 7 ) ) ).status, "no snapshot" );
	expectRefused( restoreWorld( world.world, BytesView( saved.data(), saved.size() - 1 ) ).status, "cut off" );
	Bytes damaged = saved;
	damaged[saved.size() / 2] ^= std::byte( 4 );
	expectRefused( restoreWorld( world.world, damaged ).status, "damaged" );
	Bytes newer = saved;
	newer[8] = std::byte( 200 ); // Header::format
	expectRefused( restoreWorld( world.world, newer ).status, "newer version" );
	Bytes precise = saved;
	precise[14] ^= std::byte( 12 ); // Header::scalarBytes, under the checksum
	expectRefused( restoreWorld( world.world, precise ).status, "damaged" );
	expectRefused( restoreWorld( world.world, saveTemplate( *cube() ).value ).status, "another kind" );
	expectRefused( loadTemplate( saved ).status, "another kind" );
	expectRefused( loadBody( saved ).status, "another kind" );
	EXPECT_TRUE( areEqual( savedWorld( world.world ), saved ) );
}

TEST( Saving, BulletFileHoldsASnapshotToo )
{
	TestWorld world;
	cubeOnFloor( world );
	cutInTwo( world );
	const Bytes saved = savedWorld( world.world, true );
	btDefaultSerializer serializer;
	ASSERT_TRUE( saveBulletFile( world.world, serializer ).ok() );
	const auto* const first = reinterpret_cast<const std::byte*>( serializer.getBufferPointer() );
	const BytesView file( first, std::size_t( serializer.getCurrentBufferSize() ) );
	const Result<BytesView> found = snapshotInBulletFile( file );
	ASSERT_TRUE( found.ok() ) << found.status.sentence;
	ASSERT_EQ( Bytes( found.value.data, found.value.data + found.value.size ), saved );
	world.run( 10 );
	ASSERT_TRUE( restoreWorld( world.world, found.value ).ok() );

	btDefaultSerializer plain;
	world.world.serialize( &plain );
	const auto* const bytes = reinterpret_cast<const std::byte*>( plain.getBufferPointer() );
	expectRefused( snapshotInBulletFile( BytesView( bytes, std::size_t( plain.getCurrentBufferSize() ) ) ).status, "no soft bodies" );
	expectRefused( snapshotInBulletFile( BytesView( bytes, 5 ) ).status, "no .bullet file" );
	for ( std::size_t size = 12; size < file.size; size += 97 )
	{
		static_cast<void>( snapshotInBulletFile( BytesView( file.data, size ) ) ); // of any length
	}
}

} // namespace
} // namespace pliant::test
