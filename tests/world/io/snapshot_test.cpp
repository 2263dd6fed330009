// A restored world continues like the one that was saved, to the bit: in the same world after further steps, and in another one that was
// made in the same manner.

#include "support/mesh_of_boxes.h"
#include "support/snapshots.h"
#include "world/test_world.h"

#include <pliant/game/skeleton.h>

#include <BulletCollision/CollisionDispatch/btGhostObject.h>

#include <memory>
#include <ostream>
#include <vector>

namespace pliant::test {
namespace {

struct SnapshotScene
{
	const char* name;
	void ( *build )( TestWorld& );
	int before, after; ///< steps before it is saved, and after
	int pieces = 0;    ///< smallest number of its pieces at the end
};

void PrintTo( const SnapshotScene& scene, std::ostream* out )
{
	*out << scene.name;
}

const std::shared_ptr<const BodyTemplate>& bar()
{
	static const std::shared_ptr<const BodyTemplate> made = block( 10, 5, 5, 0.05f );
	return made;
}

/// A bar falls on the floor next to two stacked boxes; a ball falls on it.
SoftBody* barAndBoxes( TestWorld& world, Material material, const Adaptivity& adaptivity = {} )
{
	world.addFloor();
	world.addBox( 1, btVector3( 0.1f, 0.1f, 0.1f ), at( 0.8f, 0.1f, 0 ) );
	world.addBox( 1, btVector3( 0.1f, 0.1f, 0.1f ), at( 0.81f, 0.32f, 0.02f ) );
	world.add( 2, new btSphereShape( 0.1f ), at( 0.05f, 0.75f, 0 ) );
	material.density = 300.0f;
	const btTransform tilted( btQuaternion( btVector3( 0.3f, 0.1f, 1 ).normalized(), 0.4f ), btVector3( 0, 0.4f, 0 ) );
	SoftBody* const body = world.addSoft( bar(), tilted, material, adaptivity );
	static_cast<void>( body->setLinearVelocity( btVector3( 0, -9, 0 ) ) );
	return body;
}

void breakable( SoftBody& body, float strain = 0.1f, BreakRule rule = BreakRule::Plane, SmallPieces small = SmallPieces::Keep )
{
	Fracture fracture;
	fracture.rule = rule;
	fracture.breakStrain = strain;
	fracture.smallCells = small == SmallPieces::Keep ? 0 : 12;
	fracture.smallPieces = small;
	fracture.fadeTime = 0.2f;
	EXPECT_TRUE( body.setFracture( fracture ).ok() );
}

Material soft( Elasticity elasticity = Elasticity::Explicit )
{
	Material material = stiff( 3e4f );
	material.elasticity = elasticity;
	material.beta = 0.2f;
	return material;
}

Adaptivity levels()
{
	Adaptivity adaptivity;
	adaptivity.coarseLevels = 2;
	adaptivity.refineStrain = 0.1f;
	adaptivity.refinesOnContact = true;
	return adaptivity;
}

/// A body hangs from a post, another from the first, and a third is pinned to a box that rotates.
void hangingBodies( TestWorld& world )
{
	btRigidBody* const post = world.addBox( 0, btVector3( 0.1f, 0.1f, 0.1f ), at( 0, 2, 0 ) );
	SoftBody* const upper = world.addSoft( bar(), at( 0, 1.6f, 0 ), soft() );
	SoftBody* const lower = world.addSoft( bar(), at( 0.1f, 1.2f, 0 ), soft( Elasticity::Implicit ) );
	EXPECT_TRUE( world.world.attach( *upper, btVector3( 0, 1.7f, 0 ), *post ).ok() );
	EXPECT_TRUE( world.world.attach( *upper, *lower, btVector3( 0.1f, 1.4f, 0 ) ).ok() );
	btRigidBody* const box = world.addBox( 3, btVector3( 0.2f, 0.2f, 0.2f ), at( 2, 2, 0 ) );
	box->setAngularVelocity( btVector3( 0, 3, 1 ) );
	SoftBody* const third = world.addSoft( bar(), at( 2, 1.5f, 0 ), soft() );
	EXPECT_TRUE( third->pinNodeToBody( third->nearestNode( btVector3( 2, 1.6f, 0 ) ), box ).ok() );
}

/// Two halves of a bar that collide with one another where they were cut.
void cutBar( TestWorld& world )
{
	SoftBody* const body = barAndBoxes( world, soft() );
	EXPECT_TRUE( body->setSelfCollision( true ).ok() );
	EXPECT_GT( body->cutPlane( btVector3( 0, 0.4f, 0 ), btVector3( 1, 0.2f, 0 ), btScalar( 0.12 ) ), 0 );
}

void cutOnLevels( TestWorld& world )
{
	SoftBody* const body = barAndBoxes( world, soft( Elasticity::Implicit ), levels() );
	EXPECT_GT( body->cutPlane( body->massCentre(), btVector3( 1, 0.2f, 0 ) ), 0 );
}

void restingBodies( TestWorld& world )
{
	world.addFloor();
	world.addSoft( bar(), at( 0, 0.125f, 0 ), soft() );
	world.addBox( 1, btVector3( 0.1f, 0.1f, 0.1f ), at( 0.8f, 0.1f, 0 ) );
	world.addBox( 1, btVector3( 0.1f, 0.1f, 0.1f ), at( 0.81f, 0.3f, 0.02f ) );
}

void heap( TestWorld& world )
{
	world.addFloor();
	for ( int k = 0; k < 6; ++k )
	{
		Material material = soft( k % 3 == 0 ? Elasticity::Automatic : k % 3 == 1 ? Elasticity::Implicit : Elasticity::Explicit );
		material.method = k == 5 ? Method::SingleCluster : Method::Lattice;
		material.farLevels = k == 2 ? 1 : 0;
		world.addSoft( bar(), at( 0.1f * float( k % 2 ), 0.3f + 0.35f * float( k ), 0.05f * float( k % 3 ) ), material );
	}
}

/// An L of two boxes, whose rigid state has two hulls.
const std::shared_ptr<const BodyTemplate>& angle()
{
	static const std::shared_ptr<const BodyTemplate> made = [] {
		MeshOfBoxes mesh;
		mesh.add( btVector3( 0, 0.1f, 0 ), btVector3( 0.3f, 0.1f, 0.1f ) );
		mesh.add( btVector3( -0.2f, 0.35f, 0 ), btVector3( 0.1f, 0.15f, 0.1f ) );
		return mesh.build( 0.05f );
	}();
	return made;
}

/// Stiff bodies and rigid crosses in a heap: which children of two compounds have contacts depends on the history.
void compounds( TestWorld& world )
{
	world.addFloor();
	static btBoxShape beam( btVector3( 0.3f, 0.05f, 0.05f ) );
	for ( int k = 0; k < 5; ++k )
	{
		Material material = stiff( 1e7f );
		material.elasticity = k % 2 == 0 ? Elasticity::Explicit : Elasticity::Implicit;
		material.rigidStrain = 0.01f;
		const btQuaternion turn( btVector3( 1, float( k ), 2 ).normalized(), 0.6f * float( k ) );
		SoftBody* const body = world.addSoft(
			angle(), btTransform( turn, btVector3( 0.1f * float( k ), 0.4f + 0.5f * float( k ), 0 ) ), material );
		k == 4 ? breakable( *body, 0.005f ) : void();
		auto* const cross = new btCompoundShape; // the world's
		cross->addChildShape( btTransform::getIdentity(), &beam );
		cross->addChildShape( btTransform( btQuaternion( btVector3( 0, 0, 1 ), SIMD_HALF_PI ) ), &beam );
		world.add( 1, cross, at( 0.2f * float( k ) - 0.3f, 0.6f + 0.5f * float( k ), 0.1f ) );
	}
}

/// A soft door on a hinge, which a ball pushes, and a body that follows a pose.
void doorAndPose( TestWorld& world )
{
	world.addFloor();
	btRigidBody* const post = world.addBox( 0, btVector3( 0.05f, 0.5f, 0.05f ), at( -0.4f, 0.8f, 0 ) );
	SoftBody* const door = world.addSoft( bar(), at( 0, 0.8f, 0 ), soft( Elasticity::Implicit ) );
	const auto frame = world.world.addFrame( *door, btVector3( -0.25f, 0.8f, 0 ), 0.12f );
	ASSERT_TRUE( frame.ok() ) << frame.status.sentence;
	const btTransform hinge = at( -0.3f, 0.8f, 0 );
	static std::vector<std::unique_ptr<btTypedConstraint>> joints; // outlives the worlds
	joints.push_back( std::make_unique<btHingeConstraint>(
		*post, *frame.value, post->getWorldTransform().inverse() * hinge, frame.value->getWorldTransform().inverse() * hinge ) );
	world.world.addConstraint( joints.back().get() );
	world.add( 3, new btSphereShape( 0.1f ), at( 0.1f, 0.8f, 0.4f ) )->setLinearVelocity( btVector3( 0, 1, -5 ) );
	SoftBody* const follower = world.addSoft( bar(), at( 0, 1.6f, 0 ), soft() );
	EXPECT_TRUE( followTargets( *follower ).ok() );
	std::vector<btVector3> targets;
	for ( int node = 0; node < follower->nodeCount(); ++node )
	{
		targets.push_back( follower->nodePosition( node ) + btVector3( 0.3f, 0.1f, 0 ) );
	}
	EXPECT_TRUE( setTargets( *follower, targets.data(), int( targets.size() ) ).ok() );
	EXPECT_TRUE( setPoseBlend( *follower, btScalar( 0.7 ) ).ok() );
}

/// A ghost that moves along x and looks for contacts in its own pairs, as Bullet's character does after each step.
class Prober : public btActionInterface
{
public:
	explicit Prober( TestWorld& world )
	{
		world.world.getPairCache()->setInternalGhostPairCallback( &m_pairs );
		m_ghost.setCollisionShape( &m_capsule );
		m_ghost.setCollisionFlags( btCollisionObject::CF_CHARACTER_OBJECT );
		m_ghost.setWorldTransform( at( -0.7f, 0.35f, 0.02f ) );
		world.world.addCollisionObject(
			&m_ghost, btBroadphaseProxy::CharacterFilter, btBroadphaseProxy::StaticFilter | btBroadphaseProxy::DefaultFilter );
		world.world.addAction( this );
	}
	void updateAction( btCollisionWorld* world, btScalar ) override
	{
		world->getDispatcher()->dispatchAllCollisionPairs(
			m_ghost.getOverlappingPairCache(), world->getDispatchInfo(), world->getDispatcher() );
		m_ghost.setWorldTransform( at( 0.01f, 0, 0 ) * m_ghost.getWorldTransform() );
	}
	void debugDraw( btIDebugDraw* ) override {}

private:
	btGhostPairCallback m_pairs;
	btCapsuleShape m_capsule = btCapsuleShape( 0.2f, 0.3f );
	btPairCachingGhostObject m_ghost;
};

void charactersGhost( TestWorld& world )
{
	restingBodies( world );
	world.addSoft( bar(), at( 0, 0.38f, 0.05f ), soft( Elasticity::Implicit ) );
	static std::vector<std::unique_ptr<Prober>> probers; // outlives the worlds
	probers.push_back( std::make_unique<Prober>( world ) );
}

class SnapshotOf : public testing::TestWithParam<SnapshotScene>
{};

TEST_P( SnapshotOf, ScenesStepsOnAsTheScene )
{
	const SnapshotScene& scene = GetParam();
	TestWorld world;
	scene.build( world );
	world.run( scene.before );
	const Bytes saved = savedWorld( world.world ), whole = savedWorld( world.world, true ), then = stateOf( world.world );
	const int bodies = world.world.softBodyCount();
	world.run( scene.after );
	const Bytes wanted = stateOf( world.world );
	EXPECT_GE( world.world.fragmentCount(), scene.pieces );

	for ( const bool isForeign : { false, true } )
	{
		const auto restored = restoreWorld( world.world, isForeign ? foreign( saved ) : saved );
		ASSERT_TRUE( restored.ok() ) << restored.status.sentence;
		EXPECT_EQ( world.world.softBodyCount(), bodies );
		EXPECT_TRUE( areEqual( stateOf( world.world ), then ) ) << "right after it was restored";
		world.run( scene.after );
		EXPECT_TRUE( areEqual( stateOf( world.world ), wanted ) ) << ( isForeign ? "anew" : "in place" );
	}

	TestWorld other;
	scene.build( other );
	const auto restored = restoreWorld( other.world, foreign( whole ) );
	ASSERT_TRUE( restored.ok() ) << restored.status.sentence;
	EXPECT_TRUE( areEqual( stateOf( other.world ), then ) ) << "right after it was restored";
	other.run( scene.after );
	EXPECT_TRUE( areEqual( stateOf( other.world ), wanted ) ) << "in another world";
}

const SnapshotScene kScenes[] = {
	{ "Falls", []( TestWorld& world ) { barAndBoxes( world, soft() ); }, 8, 40 },
	{ "FallsImplicitly", []( TestWorld& world ) { barAndBoxes( world, soft( Elasticity::Implicit ) ); }, 8, 40 },
	{ "Breaks", []( TestWorld& world ) { breakable( *barAndBoxes( world, soft() ) ); }, 5, 60, 5 },
	{ "HasBroken", []( TestWorld& world ) { breakable( *barAndBoxes( world, soft() ) ); }, 20, 60, 5 },
	{ "BreaksImplicitly", []( TestWorld& world ) { breakable( *barAndBoxes( world, soft( Elasticity::Implicit ) ), 0.03f ); }, 6, 60, 1 },
	{ "PiecesFade", []( TestWorld& world ) { breakable( *barAndBoxes( world, soft() ), 0.1f, BreakRule::Distance, SmallPieces::Fade ); }, 8,
		60, 2 },
	{ "OnLevels", []( TestWorld& world ) { barAndBoxes( world, soft(), levels() ); }, 9, 60 },
	{ "BreaksOnLevels", []( TestWorld& world ) { breakable( *barAndBoxes( world, soft(), levels() ) ); }, 9, 60, 5 },
	{ "HasBrokenOnLevels", []( TestWorld& world ) { breakable( *barAndBoxes( world, soft(), levels() ) ); }, 20, 60, 5 },
	{ "IsCutOnLevels", cutOnLevels, 12, 60, 1 },
	{ "Flows",
		[]( TestWorld& world ) {
			Material material = soft();
			material.yieldStrain = 0.03f;
			material.volumeKeeping = 0.3f;
			breakable( *barAndBoxes( world, material ), 0.2f );
		},
		8, 60, 2 },
	{ "IsCut", cutBar, 10, 60 },
	{ "Hangs", hangingBodies, 15, 40 },
	{ "Heap", heap, 40, 60 },
	{ "Sleeps", restingBodies, 240, 30 },
	{ "Compounds", compounds, 50, 30, 1 },
	{ "CompoundsAtRest", compounds, 200, 30, 1 },
	{ "Ghost", charactersGhost, 30, 60 },
	{ "DoorAndPose", doorAndPose, 12, 60 },
	{ "DoorAndPoseLater", doorAndPose, 90, 60 },
};

INSTANTIATE_TEST_SUITE_P( All, SnapshotOf, testing::ValuesIn( kScenes ),
	[]( const testing::TestParamInfo<SnapshotScene>& scene ) { return std::string( scene.param.name ); } );

} // namespace
} // namespace pliant::test
