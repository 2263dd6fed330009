// Contacts of a body in its rigid state that are found at once: its first ones, and those that it has lost (lost_contacts.h). Until it
// became rigid it rested on all nodes that touched something. Bullet finds one contact of two hulls in a step, and the body would tip over
// it before the others are found. So it starts with the touches of its nodes. Pairs of two bodies in their rigid state, and those that have
// lost contacts, are detected several times instead, with the body rotated by small angles about axes across the normal, which adds the
// corners that nearly touch. btConvexConvexAlgorithm has the same option, but only for a whole world.

#include "world/bodies/soft_body_impl.h"
#include "world/detect/pair_contacts.h"
#include "world/rigid/lost_contacts.h"
#include "world/rigid/rigid_constants.h"
#include "world/search/node_search.h"
#include "world/step/soft_body_system.h"

#include <BulletCollision/BroadphaseCollision/btCollisionAlgorithm.h>
#include <BulletCollision/BroadphaseCollision/btOverlappingPairCache.h>
#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionDispatch/btManifoldResult.h>
#include <LinearMath/btTransformUtil.h>

#include <algorithm>

namespace pliant {

namespace {

btCollisionObject& objectOf( const btBroadphaseProxy* proxy )
{
	return *static_cast<btCollisionObject*>( proxy->m_clientObject );
}

/// Whether the object is a soft body whose nodes touch one by one.
bool isDeformable( btCollisionObject& object )
{
	const SoftBody* const soft = asSoftBody( &object );
	return soft && !soft->impl().rigidProxy;
}

void detectAgain( const btBroadphasePair& pair, const btDispatcherInfo& info )
{
	btCollisionObject &first = objectOf( pair.m_pProxy0 ), &second = objectOf( pair.m_pProxy1 );
	const btCollisionObjectWrapper one( nullptr, first.getCollisionShape(), &first, first.getWorldTransform(), -1, -1 );
	const btCollisionObjectWrapper other( nullptr, second.getCollisionShape(), &second, second.getWorldTransform(), -1, -1 );
	btManifoldResult result( &one, &other );
	pair.m_algorithm->processCollision( &one, &other, info, &result );
}

/// Adds the contacts of a pair that are found when `turned`, one of the two, is turned: about two axes across the normal, or about three if
/// compounds touch in several places.
void completeContacts( const btBroadphasePair& pair, btCollisionObject& turned, const btDispatcherInfo& info )
{
	btManifoldArray manifolds;
	pair.m_algorithm->getAllContactManifolds( manifolds );
	btVector3 axes[3] = { btVector3( 1, 0, 0 ), btVector3( 0, 1, 0 ), btVector3( 0, 0, 1 ) };
	btScalar threshold = SIMD_INFINITY; // m, the smallest
	int incomplete = 0;
	for ( int m = 0; m < manifolds.size(); ++m )
	{
		const btPersistentManifold& manifold = *manifolds[m];
		if ( manifold.getNumContacts() > 0 && manifold.getNumContacts() < MANIFOLD_CACHE_SIZE )
		{
			threshold = btMin( threshold, manifold.getContactBreakingThreshold() );
			if ( ++incomplete == 1 )
			{
				btPlaneSpace1( manifold.getContactPoint( 0 ).m_normalWorldOnB, axes[0], axes[1] );
				axes[2] = axes[0].cross( axes[1] );
			}
		}
	}
	if ( incomplete == 0 )
	{
		return;
	}
	const btTransform unturned = turned.getWorldTransform();
	const btScalar angle = kFirstContactTurn * threshold / turned.getCollisionShape()->getAngularMotionDisc();
	for ( int k = 0; k < ( incomplete == 1 ? 2 : 3 ); ++k )
	{
		for ( const btScalar side : { btScalar( 1 ), btScalar( -1 ) } )
		{
			turned.setWorldTransform( btTransform( btQuaternion( axes[k], side * angle ) * unturned.getRotation(), unturned.getOrigin() ) );
			detectAgain( pair, info );
		}
	}
	turned.setWorldTransform( unturned );
	refreshContacts( manifolds );
}

/// Adds the touches of a body's nodes to the contacts of its hulls, which fill its dents: a crate that stood in one would stand on the one
/// corner that is deepest in the hull, and turn about it.
void addNodeContacts( const btBroadphasePair& pair, SoftBody& soft, NodeSearch& search, const btDispatcherInfo& info )
{
	btManifoldArray manifolds;
	pair.m_algorithm->getAllContactManifolds( manifolds );
	int touching = 0;
	while ( touching < manifolds.size() && manifolds[touching]->getNumContacts() == 0 )
	{
		++touching;
	}
	if ( touching == manifolds.size() )
	{
		return;
	}
	btCollisionObject &first = objectOf( pair.m_pProxy0 ), &second = objectOf( pair.m_pProxy1 );
	const btCollisionObjectWrapper one( nullptr, first.getCollisionShape(), &first, first.getWorldTransform(), -1, -1 );
	const btCollisionObjectWrapper two( nullptr, second.getCollisionShape(), &second, second.getWorldTransform(), -1, -1 );
	btManifoldResult result( &one, &two );
	result.setPersistentManifold( manifolds[touching] );
	result.setShapeIdentifiersA( -1, -1 ); // which Bullet leaves as memory has them
	result.setShapeIdentifiersB( -1, -1 );
	SoftBody::Impl& impl = soft.impl();
	impl.placeNodes();
	// Bullet's algorithms may name the two bodies of a manifold in the other order than the pair.
	const bool isFirst = manifolds[touching]->getBody0() == &soft;
	for ( const NodeHit& hit : search.againstRigid( soft, &first == &soft ? two : one, double( info.m_timeStep ) ) )
	{
		const btScalar radius = impl.shape->sphereOfNode( hit.node() )->getRadius();
		const btVector3 centre = impl.position( hit.node() );
		const btVector3 own = centre + toBt( hit.touch.ownPoint( double( radius ) ) );
		const btVector3 others = centre + toBt( hit.touch.otherPoint( double( radius ) ) ), normal = toBt( hit.touch.normal );
		result.addContactPoint( isFirst ? normal : -normal, isFirst ? others : own, ( own - others ).dot( normal ) );
	}
}

/// Whether the object is a body in its rigid state that has been at rest within the last second or so.
bool isResting( btCollisionObject& object )
{
	const SoftBody* const soft = asSoftBody( &object );
	return soft && soft->impl().rigidProxy && soft->isActive() && soft->getDeactivationTime() > 0;
}

int contactsOf( const btBroadphasePair& pair, btManifoldArray& manifolds )
{
	int contacts = 0;
	manifolds.resizeNoInitialize( 0 );
	pair.m_algorithm->getAllContactManifolds( manifolds );
	for ( int m = 0; m < manifolds.size(); ++m )
	{
		contacts += manifolds[m]->getNumContacts();
	}
	return contacts;
}

/// Completes the contacts of a pair that had `before`, if it has lost some.
void completeLost( const btBroadphasePair& pair, int before, btManifoldArray& manifolds, const btDispatcherInfo& info )
{
	if ( contactsOf( pair, manifolds ) < before )
	{
		btCollisionObject& first = objectOf( pair.m_pProxy0 );
		completeContacts( pair, isResting( first ) ? first : objectOf( pair.m_pProxy1 ), info );
	}
}

} // namespace

void refreshPair( const btBroadphasePair& pair, btManifoldArray& manifolds, const btDispatcherInfo& info )
{
	const int before = contactsOf( pair, manifolds );
	refreshContacts( manifolds );
	if ( before > 0 && ( isResting( objectOf( pair.m_pProxy0 ) ) || isResting( objectOf( pair.m_pProxy1 ) ) ) )
	{
		completeLost( pair, before, manifolds, info );
	}
}

void LostContacts::note( const SoftBodySystem& bodies, btDiscreteDynamicsWorld& world )
{
	m_pairs.clear();
	if ( std::none_of( bodies.bodies().begin(), bodies.bodies().end(), []( SoftBody* body ) { return isResting( *body ); } ) )
	{
		return;
	}
	btBroadphasePairArray& pairs = world.getPairCache()->getOverlappingPairArray();
	for ( int p = 0; p < pairs.size(); ++p )
	{
		btCollisionObject &first = objectOf( pairs[p].m_pProxy0 ), &second = objectOf( pairs[p].m_pProxy1 );
		if ( pairs[p].m_algorithm && ( isResting( first ) || isResting( second ) ) && !isDeformable( first ) && !isDeformable( second ) )
		{
			m_pairs.push_back(
				Pair{ pairs[p].m_pProxy0->m_uniqueId, pairs[p].m_pProxy1->m_uniqueId, contactsOf( pairs[p], m_manifolds ) } );
		}
	}
	std::sort( m_pairs.begin(), m_pairs.end(), []( const Pair& a, const Pair& b ) { return a.isBefore( b ); } );
}

void LostContacts::complete( btDiscreteDynamicsWorld& world )
{
	if ( m_pairs.empty() )
	{
		return;
	}
	btBroadphasePairArray& pairs = world.getPairCache()->getOverlappingPairArray();
	for ( int p = 0; p < pairs.size(); ++p )
	{
		const Pair now{ pairs[p].m_pProxy0->m_uniqueId, pairs[p].m_pProxy1->m_uniqueId, 0 };
		const auto before = std::lower_bound(
			m_pairs.begin(), m_pairs.end(), now, []( const Pair& a, const Pair& b ) { return a.isBefore( b ); } );
		if ( before == m_pairs.end() || now.isBefore( *before ) || !pairs[p].m_algorithm )
		{
			continue;
		}
		completeLost( pairs[p], before->contacts, m_manifolds, world.getDispatchInfo() );
	}
}

void SoftBodySystem::completeFirstContacts()
{
	const auto isNew = [this]( btCollisionObject& object ) {
		const SoftBody* const soft = asSoftBody( &object );
		return soft && soft->impl().rigidProxy && soft->impl().rigidWait > 0 && isInPass( object );
	};
	if ( std::none_of( m_bodies.begin(), m_bodies.end(), [&isNew]( SoftBody* body ) { return isNew( *body ); } ) )
	{
		return;
	}
	const btDispatcherInfo& info = m_world.getDispatchInfo();
	btBroadphasePairArray& pairs = m_world.getPairCache()->getOverlappingPairArray();
	for ( int p = 0; p < pairs.size(); ++p )
	{
		btCollisionObject &first = objectOf( pairs[p].m_pProxy0 ), &second = objectOf( pairs[p].m_pProxy1 );
		btCollisionObject* const turned = isNew( first ) ? &first : isNew( second ) ? &second : nullptr;
		btCollisionObject& other = turned == &first ? second : first;
		if ( !turned || !pairs[p].m_algorithm || isDeformable( other ) )
		{
			continue;
		}
		if ( asSoftBody( &other ) )
		{
			completeContacts( pairs[p], *turned, info );
		}
		else
		{
			addNodeContacts( pairs[p], *asSoftBody( turned ), pairScratch.search, info );
		}
	}
	for ( SoftBody* body : m_bodies )
	{
		body->impl().rigidWait = isNew( *body ) ? 0 : body->impl().rigidWait;
	}
}

} // namespace pliant
