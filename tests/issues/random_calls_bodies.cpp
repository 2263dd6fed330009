// The calls of the random sequences.

#include "issues/random_calls.h"
#include "issues/silent_drawer.h"

#include <LinearMath/btIDebugDraw.h>
#include <LinearMath/btSerializer.h>

#include <algorithm>
#include <limits>

namespace pliant::test {

namespace {

std::shared_ptr<const BodyTemplate> someTemplate( int which )
{
	static const std::vector<std::shared_ptr<const BodyTemplate>> all = {
		block( 1, 1, 1, 0.2f ), block( 2, 2, 2, 0.15f ), block( 3, 1, 2, 0.1f ), block( 4, 2, 2, 0.1f ) };
	return all[std::size_t( which )];
}

} // namespace

void RandomCalls::create()
{
	if ( m_soft.size() < 5 )
	{
		Adaptivity adaptivity;
		adaptivity.coarseLevels = oneIn( 3 ) ? 1 : 0;
		const btTransform at( btQuaternion::getIdentity(), btVector3( some( -1, 1 ), some( 0, 1 ), some( -1, 1 ) ) );
		SoftBodyResult made = SoftBody::create( someTemplate( below( 4 ) ), at, someMaterial(), adaptivity );
		if ( made )
		{
			m_soft.push_back( std::move( made.value ) );
			oneIn( 2 ) ? someWorld().addSoftBody( m_soft.back().get() ) : void();
		}
	}
	static_cast<void>( SoftBody::create( someTemplate( below( 4 ) ), someTransform(), someMaterial() ) );
}

void RandomCalls::add()
{
	SoftBody* const body = someSoft();
	if ( !body )
	{
		return;
	}
	const int group = oneIn( 3 ) ? below( 64 ) : 1, mask = oneIn( 3 ) ? below( 64 ) : -1;
	btCollisionWorld& plain = someWorld();
	switch ( below( 4 ) )
	{
		case 0: plain.addCollisionObject( body ); break;
		case 1: plain.addCollisionObject( body, group, mask ); break;
		case 2: someWorld().addCollisionObject( body ); break;
		default: someWorld().addSoftBody( body, group, mask );
	}
}

void RandomCalls::remove()
{
	SoftBody* const body = someSoft();
	if ( !body )
	{
		return;
	}
	SoftBodyWorld& world = someWorld();
	oneIn( 2 ) ? world.removeSoftBody( body ) : world.removeCollisionObject( body );
	takeIfLeft( body );
}

void RandomCalls::removeByManifold()
{
	SoftBodyWorld& world = someWorld();
	const int count = world.getDispatcher()->getNumManifolds();
	const btPersistentManifold* const manifold = count > 0 ? world.getDispatcher()->getManifoldByIndexInternal( below( count ) ) : nullptr;
	const bool isFirst = manifold && SoftBody::upcast( manifold->getBody0() );
	const btCollisionObject* const named = !manifold ? nullptr : isFirst ? manifold->getBody0() : manifold->getBody1();
	SoftBody* const soft = SoftBody::upcast( const_cast<btCollisionObject*>( named ) );
	btRigidBody* const proxy = named ? const_cast<btRigidBody*>( btRigidBody::upcast( named ) ) : nullptr;
	if ( soft && owns( soft ) && proxy )
	{
		world.removeRigidBody( proxy );
		oneIn( 2 ) ? world.addRigidBody( proxy ) : world.removeRigidBody( proxy );
		if ( oneIn( 3 ) && !soft->getBroadphaseHandle() )
		{
			delete proxy;
		}
	}
}

void RandomCalls::destroy()
{
	if ( !m_soft.empty() )
	{
		m_soft.erase( m_soft.begin() + below( int( m_soft.size() ) ) );
	}
}

void RandomCalls::destroyWorld()
{
	if ( m_worlds.size() < 2 )
	{
		return;
	}
	for ( Rigid& rigid : m_rigid )
	{
		if ( rigid.world == m_worlds.back().get() )
		{
			removeRigid( rigid.body.get() );
		}
	}
	m_worlds.pop_back();
}

void RandomCalls::forgetObjects()
{
	// Code that empties the object list, like Bullet's own reset, removes objects with a proxy from the broadphase; soft bodies detect this
	// themselves.
	SoftBodyWorld& world = someWorld();
	btCollisionObjectArray kept;
	for ( int k = 0; k < world.getNumCollisionObjects(); ++k )
	{
		btCollisionObject* const object = world.getCollisionObjectArray()[k];
		if ( !owns( SoftBody::upcast( object ) ) || oneIn( 2 ) )
		{
			object->setWorldArrayIndex( kept.size() );
			kept.push_back( object );
		}
	}
	world.getCollisionObjectArray().copyFromArray( kept );
}

void RandomCalls::oddStep()
{
	const btScalar times[] = {
		std::numeric_limits<btScalar>::quiet_NaN(), std::numeric_limits<btScalar>::infinity(), -1, 100, btScalar( 1e9 ), btScalar( 0.3 ) };
	const btScalar time = times[below( 6 )];
	for ( const auto& world : m_worlds )
	{
		if ( world->softBodyCount() > 0 )
		{
			world->stepSimulation( time, below( 2 ) * 3, oneIn( 3 ) ? times[below( 6 )] : kFrame );
		}
	}
}

void RandomCalls::flags()
{
	if ( SoftBody* const body = someSoft() )
	{
		using Object = btCollisionObject;
		const int all[] = { Object::CF_NO_CONTACT_RESPONSE, Object::CF_CUSTOM_MATERIAL_CALLBACK, Object::CF_DISABLE_VISUALIZE_OBJECT,
			Object::CF_HAS_FRICTION_ANCHOR, Object::CF_STATIC_OBJECT, Object::CF_KINEMATIC_OBJECT };
		body->setCollisionFlags( body->getCollisionFlags() ^ all[below( m_isPlain ? 4 : 6 )] );
		body->setFriction( some( 0, 2 ) );
		body->setRestitution( some( 0, 1 ) );
	}
}

void RandomCalls::ignore()
{
	SoftBody* const body = someSoft();
	btRigidBody* const rigid = someRigid();
	SoftBody* const other = someSoft();
	if ( body && rigid && other && body != other )
	{
		oneIn( 2 ) ? body->setIgnoreCollisionCheck( rigid, oneIn( 2 ) ) : rigid->setIgnoreCollisionCheck( body, oneIn( 2 ) );
		body->setIgnoreCollisionCheck( other, oneIn( 2 ) );
	}
}

void RandomCalls::pins()
{
	SoftBody* const body = someSoft();
	if ( !body )
	{
		return;
	}
	const int node = someNode( *body );
	switch ( below( 6 ) )
	{
		case 0: static_cast<void>( body->pinNode( node ) ); break;
		case 1: body->releaseNode( node ); break;
		case 2: static_cast<void>( body->driveNode( node, oneIn( 4 ) ? someVector( 1e6f ) : body->massCentre() + someVector( 1 ) ) ); break;
		case 3: body->pinNodesInside( body->massCentre() - someVector( 1 ), body->massCentre() + someVector( 1 ) ); break;
		default: static_cast<void>( body->pinNodeToBody( node, someRigid() ) );
	}
}

void RandomCalls::cuts()
{
	SoftBody* const body = someSoft();
	if ( !body || m_isPlain )
	{
		return;
	}
	const btVector3 centre = body->massCentre();
	const auto corner = [&] { return centre + someVector( 1 ); };
	switch ( below( 4 ) )
	{
		case 0: body->cutPlane( centre + someVector( btScalar( 0.1 ) ), someVector( 1 ), oneIn( 2 ) ? some( 0, 1 ) : SIMD_INFINITY ); break;
		case 1: body->cutSphere( centre + someVector( btScalar( 0.2 ) ), some( -1, 1 ) ); break;
		case 2: body->cutSweep( corner(), corner(), corner(), corner() ); break;
		default: body->heal( oneIn( 5 ) ? std::numeric_limits<btScalar>::quiet_NaN() : some( 0, 2 ) );
	}
}

void RandomCalls::breaking()
{
	SoftBody* const body = m_isPlain ? nullptr : someSoft();
	if ( !body )
	{
		return;
	}
	Fracture fracture;
	const BreakRule rules[] = { BreakRule::Never, BreakRule::Distance, BreakRule::Plane, BreakRule::Shards };
	const SmallPieces small[] = { SmallPieces::Keep, SmallPieces::Fade, SmallPieces::Remove };
	fracture.rule = rules[below( 4 )];
	fracture.crumbFraction = float( some( 0, 1 ) ) / 10;
	fracture.shardPattern = oneIn( 3 ) ? ShardPattern::Rings : ShardPattern::Scattered;
	fracture.breakStrain = float( some( -1, 1 ) ) / 4;
	fracture.smallPieces = small[below( 3 )];
	fracture.fadeTime = float( some( 0, 1 ) ) / 10;
	static_cast<void>( body->setFracture( fracture ) );
	oneIn( 4 ) ? void( body->prepareCracks() ) : void();
}

void RandomCalls::material()
{
	if ( SoftBody* const body = someSoft() )
	{
		static_cast<void>( body->setMaterial( someMaterial() ) );
	}
}

void RandomCalls::place()
{
	if ( SoftBody* const body = someSoft() )
	{
		const btTransform to = someTransform();
		const btTransform far( btQuaternion::getIdentity(), someVector( 1 ) - body->massCentre() );
		static_cast<void>( oneIn( 2 ) ? body->reset( to ) : body->teleport( oneIn( 2 ) ? to : far ) );
	}
}

void RandomCalls::push()
{
	SoftBody* const body = someSoft();
	if ( !body )
	{
		return;
	}
	const btScalar size = oneIn( 10 ) ? btScalar( 1e30 ) : btScalar( 5 );
	switch ( below( 8 ) )
	{
		case 0: static_cast<void>( body->setLinearVelocity( someVector( size ) ) ); break;
		case 1: static_cast<void>( body->setVelocities( someVector( size ), someVector( size ) ) ); break;
		case 2: static_cast<void>( body->applyCentralForce( someVector( size * 100 ) ) ); break;
		case 3: static_cast<void>( body->applyForce( someVector( size * 10 ), someNode( *body ) ) ); break;
		case 4: static_cast<void>( body->applyCentralImpulse( someVector( size ) ) ); break;
		case 5: static_cast<void>( body->applyImpulse( someVector( size / 10 ), someNode( *body ) ) ); break;
		case 6: static_cast<void>( body->setGravity( someVector( size ) ) ); break;
		default: body->clearGravity();
	}
}

void RandomCalls::rigid()
{
	if ( m_rigid.size() < 4 && oneIn( 2 ) )
	{
		const bool isFloor = m_rigid.empty() || oneIn( 4 );
		btRigidBody::btRigidBodyConstructionInfo info( isFloor ? btScalar( 0 ) : btScalar( 1 ), nullptr,
			isFloor ? &m_floorShape : &m_boxShape, btVector3( btScalar( 0.1 ), btScalar( 0.1 ), btScalar( 0.1 ) ) );
		info.m_startWorldTransform = isFloor ? at( 0, -1, 0 ) : at( some( -1, 1 ), some( 0, 2 ), some( -1, 1 ) );
		m_rigid.push_back( { std::make_unique<btRigidBody>( info ), nullptr } );
	}
	const std::size_t which = std::size_t( below( std::max( 1, int( m_rigid.size() ) ) ) );
	if ( which >= m_rigid.size() )
	{
		return;
	}
	Rigid& chosen = m_rigid[which];
	if ( !chosen.world )
	{
		chosen.world = &someWorld();
		chosen.world->addRigidBody( chosen.body.get() );
	}
	else if ( oneIn( 4 ) )
	{
		removeRigid( chosen.body.get() );
		oneIn( 2 ) ? void( m_rigid.erase( m_rigid.begin() + std::ptrdiff_t( which ) ) ) : void();
	}
}

void RandomCalls::features()
{
	if ( SoftBody* const body = someSoft() )
	{
		static_cast<void>( body->setSelfCollision( oneIn( 2 ) ) );
		body->setFinestLevel( below( 8 ) - 2 );
		body->requestRefinement( someVector( 1 ), someVector( 2 ) );
		body->setSurfaceTolerance( oneIn( 5 ) ? std::numeric_limits<btScalar>::quiet_NaN() : some( -1, 1 ) );
		EXPECT_GE( body->surface().vertexCount, 8 );
	}
}

void RandomCalls::activation()
{
	if ( SoftBody* const body = someSoft() )
	{
		const int state = 1 + below( m_isPlain ? 3 : 5 );
		oneIn( 2 ) ? body->setActivationState( state ) : body->forceActivationState( state );
		oneIn( 2 ) ? body->activate( oneIn( 2 ) ) : void();
	}
}

void RandomCalls::queries()
{
	SoftBodyWorld& world = someWorld();
	const btVector3 from( some( -1, 1 ), 3, some( -1, 1 ) ), to( some( -1, 1 ), -3, some( -1, 1 ) );
	btCollisionWorld::ClosestRayResultCallback ray( from, to );
	world.rayTest( from, to, ray );
	btCollisionWorld::ClosestConvexResultCallback sweep( from, to );
	btSphereShape ball( btScalar( 0.1 ) );
	world.convexSweepTest( &ball, btTransform( btQuaternion::getIdentity(), from ), btTransform( btQuaternion::getIdentity(), to ), sweep );
	struct Count : btCollisionWorld::ContactResultCallback
	{
		btScalar addSingleResult(
			btManifoldPoint&, const btCollisionObjectWrapper*, int, int, const btCollisionObjectWrapper*, int, int ) override
		{
			return 0;
		}
	} count;
	SoftBody* const body = someSoft();
	if ( body && body->getBroadphaseHandle() )
	{
		world.contactTest( body, count );
	}
	if ( body )
	{
		const int nearest = body->nearestNode( someVector( 2 ) );
		EXPECT_TRUE( nearest >= 0 && nearest < body->nodeCount() );
		EXPECT_GE( body->nodeOfShapeIndex( below( 10000 ) - 5 ), -1 );
		EXPECT_GE( body->nodeOfCell( below( 10000 ) - 5 ), -1 );
	}
}

void RandomCalls::output()
{
	SoftBodyWorld& world = someWorld();
	SilentDrawer drawer;
	world.setDebugDrawer( &drawer );
	world.debugDrawWorld();
	world.setDebugDrawer( nullptr );
	btDefaultSerializer serializer;
	serializer.setSerializationFlags( oneIn( 2 ) ? BT_SERIALIZE_CONTACT_MANIFOLDS : 0 );
	world.serialize( &serializer );
}

void RandomCalls::fragments()
{
	SoftBodyWorld& world = someWorld();
	SoftBody* const piece = world.softBody( below( world.softBodyCount() + 1 ) );
	if ( world.releaseFragment( piece ) )
	{
		m_soft.emplace_back( piece );
	}
}

bool RandomCalls::owns( const SoftBody* body ) const
{
	return std::any_of( m_soft.begin(), m_soft.end(), [body]( const std::unique_ptr<SoftBody>& own ) { return own.get() == body; } );
}

/// A fragment that has left its world is owned by the game.
void RandomCalls::takeIfLeft( SoftBody* body )
{
	if ( !owns( body ) && !body->getBroadphaseHandle() )
	{
		m_soft.emplace_back( body );
	}
}

void RandomCalls::settings()
{
	SoftBodyWorld& world = someWorld();
	if ( !m_isPlain )
	{
		world.setSoftSubsteps( below( 12 ) - 4 );
		world.setMaxSoftSubsteps( below( 12 ) - 4 );
	}
	world.setThreadCount( below( 4 ) - 1 );
	SoftBody* const body = someSoft();
	if ( body && body->getBroadphaseHandle() && world.getCollisionObjectArray().findLinearSearch( body ) < world.getNumCollisionObjects() )
	{
		world.refreshBroadphaseProxy( body );
		world.updateSingleAabb( body );
	}
	EXPECT_EQ( world.softBody( -1 ), nullptr );
	EXPECT_EQ( world.softBody( world.softBodyCount() ), nullptr );
	EXPECT_FALSE( world.releaseFragment( nullptr ) );
}

void RandomCalls::badNodes()
{
#ifdef NDEBUG // with assertions these abort the program
	if ( const SoftBody* const body = someSoft() )
	{
		for ( const int node : { -1, body->nodeCount(), std::numeric_limits<int>::max() } )
		{
			EXPECT_EQ( body->nodePosition( node ).length() + body->nodeVelocity( node ).length(), 0 );
			EXPECT_EQ( body->nodeMass( node ) + body->nodeRadius( node ), 0 );
			EXPECT_EQ( body->nodeLevel( node ), 0 );
		}
	}
#endif
}

} // namespace pliant::test
