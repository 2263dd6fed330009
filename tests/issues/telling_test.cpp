// Information about soft bodies: contact callbacks, the debug drawer, files.

#include "world/test_world.h"

#include <BulletCollision/CollisionShapes/btTriangleShape.h>
#include <LinearMath/btIDebugDraw.h>
#include <LinearMath/btSerializer.h>

#include <cstring>
#include <map>

namespace pliant {
namespace {

using test::at;
using test::block;
using test::TestWorld;

constexpr btScalar kHalf = btScalar( 0.2 ); // of the cubes, m

// --- callbacks that remove ------------------------------------------------------------------------------------------------

struct Removal
{
	SoftBodyWorld* world = nullptr;
	std::vector<std::unique_ptr<SoftBody>>* owned = nullptr;
	btRigidBody* floor = nullptr;
	bool removesFloor = false, deletes = false;
	int left = 0; ///< calls until it removes
	int told = 0;
} g_removal;

void removeWhatTouches( const btCollisionObject* a, const btCollisionObject* b )
{
	++g_removal.told;
	if ( g_removal.left-- != 0 )
	{
		return;
	}
	if ( g_removal.removesFloor )
	{
		g_removal.world->removeRigidBody( g_removal.floor );
		return;
	}
	SoftBody* const soft = SoftBody::upcast( const_cast<btCollisionObject*>( SoftBody::upcast( a ) ? a : b ) );
	g_removal.world->removeSoftBody( soft );
	if ( g_removal.deletes )
	{
		std::erase_if( *g_removal.owned, [soft]( const std::unique_ptr<SoftBody>& body ) { return body.get() == soft; } );
	}
}

bool onAdded( btManifoldPoint&, const btCollisionObjectWrapper* a, int, int, const btCollisionObjectWrapper* b, int, int )
{
	removeWhatTouches( a->getCollisionObject(), b->getCollisionObject() );
	return false;
}
bool onProcessed( btManifoldPoint&, void* a, void* b )
{
	removeWhatTouches( static_cast<btCollisionObject*>( a ), static_cast<btCollisionObject*>( b ) );
	return false;
}
void onStarted( btPersistentManifold* const& manifold )
{
	removeWhatTouches( manifold->getBody0(), manifold->getBody1() );
}
void onEnded( btPersistentManifold* const& manifold )
{
	if ( SoftBody::upcast( manifold->getBody0() ) || SoftBody::upcast( manifold->getBody1() ) )
	{
		removeWhatTouches( manifold->getBody0(), manifold->getBody1() );
	}
}

void forgetCallbacks()
{
	gContactAddedCallback = nullptr;
	gContactProcessedCallback = nullptr;
	gContactStartedCallback = nullptr;
	gContactEndedCallback = nullptr;
}

// An object that disappears on contact is removed, and deleted, in the contact callback. The step must not use its memory afterwards.
TEST( Telling, TouchingBodiesMayBeRemovedAndDeletedInContactCallbacks )
{
	for ( int variant = 0; variant < 72; ++variant )
	{
		const int callback = variant % 4, which = variant / 4 % 3, late = variant / 12 % 3, isSelf = variant / 36;
		TestWorld t;
		g_removal = Removal{ &t.world, &t.soft, t.addFloor(), which == 2, which == 1, late * 7, 0 };
		t.world.removeRigidBody( t.rigid[0].get() );
		t.world.addRigidBody( t.rigid[0].get() );
		for ( int k = 0; k < 2; ++k )
		{
			SoftBody* body = t.addSoft( block( 3, 3, 3, 0.1f ), at( 0, btScalar( 0.16 ) + btScalar( 0.31 ) * btScalar( k ), 0 ),
				k == 0 ? test::stiff( 1e5f ) : test::implicit( 1e5f ) );
			body->setCollisionFlags( body->getCollisionFlags() | btCollisionObject::CF_CUSTOM_MATERIAL_CALLBACK );
			EXPECT_TRUE( body->setSelfCollision( isSelf != 0 ).ok() );
		}
		callback == 0       ? void( gContactAddedCallback = onAdded )
			: callback == 1 ? void( gContactProcessedCallback = onProcessed )
			: callback == 2 ? void( gContactStartedCallback = onStarted )
							: void();
		t.run( 5 );
		if ( callback == 3 ) // contacts end where a body is thrown off
		{
			gContactEndedCallback = onEnded;
			EXPECT_TRUE( t.soft[1]->setLinearVelocity( btVector3( 0, 10, 0 ) ).ok() );
		}
		t.run( 10 );
		forgetCallbacks();
		EXPECT_GT( g_removal.told, 0 ) << variant;
		if ( g_removal.left < 0 )
		{
			EXPECT_EQ( t.world.softBodyCount(), which == 2 ? 2 : 1 ) << variant;
		}
		t.run( 10 );
		if ( which == 2 && g_removal.left < 0 )
		{
			EXPECT_LT( t.soft[0]->massCentre().y(), btScalar( 0.14 ) ) << "the floor is gone " << variant;
		}
		for ( const auto& body : t.soft )
		{
			EXPECT_TRUE( body->isHealthy() );
		}
	}
}

// --- arguments of contact-added callbacks ---------------------------------------------------------------------------------

struct Shown
{
	int shapeType = -1, part = -2, index = -2;
	btVector3 corner[3];
	const btCollisionShape* shape = nullptr;
	btVector3 at = btVector3( 0, 0, 0 );
	int count = 0;
};
std::vector<Shown> g_shown;

bool noteShown( btManifoldPoint& point, const btCollisionObjectWrapper* a, int partA, int indexA, const btCollisionObjectWrapper* b,
	int partB, int indexB )
{
	const bool softIsFirst = SoftBody::upcast( a->getCollisionObject() ) != nullptr ||
		a->getCollisionShape()->getShapeType() == SPHERE_SHAPE_PROXYTYPE;
	const btCollisionObjectWrapper* const other = softIsFirst ? b : a;
	Shown shown;
	shown.shape = other->getCollisionShape();
	shown.shapeType = shown.shape->getShapeType();
	shown.part = softIsFirst ? partB : partA;
	shown.index = softIsFirst ? indexB : indexA;
	shown.at = other->getWorldTransform().invXform( softIsFirst ? point.m_positionWorldOnB : point.m_positionWorldOnA );
	if ( shown.shapeType == TRIANGLE_SHAPE_PROXYTYPE )
	{
		std::copy_n( static_cast<const btTriangleShape*>( shown.shape )->m_vertices1, 3, shown.corner );
	}
	g_shown.push_back( shown );
	return false;
}

// Code that smooths the inner edges of meshes casts the shape in the callback to a btTriangleShape, as Bullet's convention allows.
TEST( Telling, ContactAddedCallbacksAreShownTheTriangleThatIsTouched )
{
	TestWorld t;
	btTriangleMesh mesh;
	for ( int k = 0; k < 8; ++k )
	{
		const btScalar x = btScalar( k ) - 4;
		mesh.addTriangle( btVector3( x, 0, -3 ), btVector3( x, 0, 3 ), btVector3( x + 1, 0, -3 ) );
		mesh.addTriangle( btVector3( x + 1, 0, -3 ), btVector3( x, 0, 3 ), btVector3( x + 1, 0, 3 ) );
	}
	btRigidBody* ground = t.add( 0, new btBvhTriangleMeshShape( &mesh, true ),
		btTransform( btQuaternion( btVector3( 0, 1, 0 ), btScalar( 0.3 ) ), btVector3( 0, 0, 0 ) ) );
	ground->setCollisionFlags( ground->getCollisionFlags() | btCollisionObject::CF_CUSTOM_MATERIAL_CALLBACK );
	t.addSoft( block( 8, 2, 2, 0.1f ), at( btScalar( 0.1 ), btScalar( 0.1 ), 0 ) );
	g_shown.clear();
	gContactAddedCallback = noteShown;
	t.run( 20 );
	forgetCallbacks();
	ASSERT_GT( g_shown.size(), 100u );
	std::map<int, int> triangles;
	for ( const Shown& shown : g_shown )
	{
		ASSERT_EQ( shown.shapeType, int( TRIANGLE_SHAPE_PROXYTYPE ) );
		ASSERT_GE( shown.index, 0 );
		++triangles[shown.index];
		const btScalar column = btScalar( shown.index / 2 ) - 4;
		ASSERT_GE( btMin( btMin( shown.corner[0].x(), shown.corner[1].x() ), shown.corner[2].x() ), column );
		ASSERT_LE( btMax( btMax( shown.corner[0].x(), shown.corner[1].x() ), shown.corner[2].x() ), column + 1 );
	}
	EXPECT_GE( triangles.size(), 2u );
}

TEST( Telling, ContactAddedCallbacksAreShownTheChildThatIsTouched )
{
	TestWorld t;
	btBoxShape left( btVector3( 1, 1, 1 ) ), right( btVector3( btScalar( 0.99 ), 1, 1 ) );
	auto* inner = new btCompoundShape;
	inner->addChildShape( at( 1, 0, 0 ), &right );
	t.shapes.emplace_back( inner );
	auto* compound = new btCompoundShape;
	compound->addChildShape( at( -1, 0, 0 ), &left );
	compound->addChildShape( at( 0, 0, 0 ), inner );
	btRigidBody* ground = t.add( 0, compound, at( 0, -1, 0 ) );
	ground->setCollisionFlags( ground->getCollisionFlags() | btCollisionObject::CF_CUSTOM_MATERIAL_CALLBACK );
	t.addSoft( block( 4, 4, 4, 0.1f ), at( -1, kHalf, 0 ) );
	t.addSoft( block( 4, 4, 4, 0.1f ), at( 1, kHalf, 0 ) );
	g_shown.clear();
	gContactAddedCallback = noteShown;
	t.run( 5 );
	forgetCallbacks();
	int count[2] = { 0, 0 };
	for ( const Shown& shown : g_shown )
	{
		ASSERT_TRUE( shown.shape == &left || shown.shape == &right );
		++count[shown.shape == &left ? 0 : 1];
		ASSERT_NEAR( shown.at.y(), 1, 0.02 ) << "in the child's own coordinates";
		ASSERT_LT( btFabs( shown.at.x() ), btScalar( 0.3 ) );
	}
	EXPECT_GT( count[0], 10 );
	EXPECT_GT( count[1], 10 );
}

// --- drawing --------------------------------------------------------------------------------------------------------------

struct CountingDrawer : btIDebugDraw
{
	int mode = DBG_DrawWireframe, lines = 0;
	btVector3 low = btVector3( 1e9f, 1e9f, 1e9f ), high = -low;

	void drawLine( const btVector3& from, const btVector3& to, const btVector3& ) override
	{
		++lines;
		low.setMin( from );
		low.setMin( to );
		high.setMax( from );
		high.setMax( to );
	}
	void drawContactPoint( const btVector3&, const btVector3&, btScalar, int, const btVector3& ) override {}
	void reportErrorWarning( const char* ) override {}
	void draw3dText( const btVector3&, const char* ) override {}
	void setDebugMode( int to ) override { mode = to; }
	int getDebugMode() const override { return mode; }
};

// The debug view draws the surface, not every sphere: 30 494 lines for a cube of 216 nodes would halt it.
TEST( Telling, TheWireframeOfASoftBodyIsItsSurface )
{
	TestWorld t;
	SoftBody* cube = t.addSoft( block( 6, 6, 6, 0.1f ), at( 0, 2, 0 ) );
	CountingDrawer drawer;
	t.world.setDebugDrawer( &drawer );
	t.world.debugDrawWorld();
	EXPECT_EQ( drawer.lines, 12 * 5 + 6 * 2 * 5 * 4 ) << "links along edges, and on faces";
	EXPECT_NEAR( drawer.high.y() - drawer.low.y(), 0.5, 1e-4 ) << "from node to node";
	cube->setCollisionFlags( cube->getCollisionFlags() | btCollisionObject::CF_DISABLE_VISUALIZE_OBJECT );
	drawer.lines = 0;
	t.world.debugDrawWorld();
	EXPECT_EQ( drawer.lines, 0 );
	drawer.mode = btIDebugDraw::DBG_DrawConstraints;
	ASSERT_TRUE( cube->pinNode( 0 ).ok() );
	t.world.debugDrawWorld();
	EXPECT_EQ( drawer.lines, 3 );
	drawer.mode = btIDebugDraw::DBG_NoDebug;
	drawer.lines = 0;
	t.world.debugDrawWorld();
	EXPECT_EQ( drawer.lines, 0 );
	t.world.setDebugDrawer( nullptr );
}

// --- files ----------------------------------------------------------------------------------------------------------------

/// Counts the chunks of each kind that Bullet's serializer writes.
std::map<int, int> chunksOf( btDiscreteDynamicsWorld& world, int flags )
{
	btDefaultSerializer serializer;
	serializer.setSerializationFlags( flags );
	world.serialize( &serializer );
	std::map<int, int> count;
	for ( int k = 0; k < serializer.getNumChunks(); ++k )
	{
		++count[serializer.getChunk( k )->m_chunkCode];
	}
	EXPECT_GT( serializer.getCurrentBufferSize(), 0 );
	return count;
}

// A saved world must not contain the shapes and contacts of soft bodies, since their objects are not saved.
TEST( Telling, AFileHasAllButTheSoftBodies )
{
	for ( const int flags : { 0, int( BT_SERIALIZE_CONTACT_MANIFOLDS ) } )
	{
		TestWorld plain, t;
		for ( TestWorld* each : { &plain, &t } )
		{
			each->addFloor();
			each->addBox( 1, btVector3( kHalf, kHalf, kHalf ), at( 3, kHalf, 0 ) );
		}
		SoftBody* cube = t.addSoft( block( 4, 4, 4, 0.1f ), at( 0, kHalf, 0 ) );
		plain.run( 10 );
		t.run( 10 );
		EXPECT_EQ( chunksOf( t.world, flags ), chunksOf( plain.world, flags ) );
		EXPECT_EQ( t.world.getNumCollisionObjects(), 3 );
		EXPECT_EQ( t.world.getCollisionObjectArray()[2], cube );
		t.run( 10 );
		EXPECT_NEAR( cube->massCentre().y(), kHalf, 0.02 );
	}
}

} // namespace
} // namespace pliant
