#include "world/search/contact_points.h"

#include "world/bodies/soft_body_impl.h"
#include "world/search/node_search.h"
#include "world/shape/contact_proxy.h"
#include "world/touch/touched_part.h"

#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionDispatch/btManifoldResult.h>

namespace pliant {

namespace {

/// Combines the properties of the two surfaces by Bullet's (and the game's) rules.
void combineSurfaces( const btCollisionObject* body0, const btCollisionObject* body1, btManifoldPoint& point )
{
	point.m_combinedFriction = gCalculateCombinedFrictionCallback( body0, body1 );
	point.m_combinedRestitution = gCalculateCombinedRestitutionCallback( body0, body1 );
	point.m_combinedRollingFriction = gCalculateCombinedRollingFrictionCallback( body0, body1 );
	point.m_combinedSpinningFriction = gCalculateCombinedSpinningFrictionCallback( body0, body1 );
	const int flags = body0->getCollisionFlags() | body1->getCollisionFlags();
	if ( flags & btCollisionObject::CF_HAS_CONTACT_STIFFNESS_DAMPING )
	{
		point.m_combinedContactDamping1 = gCalculateCombinedContactDampingCallback( body0, body1 );
		point.m_combinedContactStiffness1 = gCalculateCombinedContactStiffnessCallback( body0, body1 );
		point.m_contactPointFlags |= BT_CONTACT_FLAG_CONTACT_STIFFNESS_DAMPING;
	}
	if ( flags & btCollisionObject::CF_HAS_FRICTION_ANCHOR )
	{
		point.m_contactPointFlags |= BT_CONTACT_FLAG_FRICTION_ANCHOR;
	}
	btPlaneSpace1( point.m_normalWorldOnB, point.m_lateralFrictionDir1, point.m_lateralFrictionDir2 );
}

/// A point in the body's own axes. Most proxies have the world's axes; reading their basis would touch another cache line.
btVector3 toLocal( const btCollisionObject& body, const btVector3& at )
{
	const bool isStraight = ownerOfContactProxy( &body ) && !static_cast<const ContactProxy&>( body ).isDirected;
	return isStraight ? at - body.getWorldTransform().getOrigin() : body.getWorldTransform().invXform( at );
}

} // namespace

void fillPoint(
	const btPersistentManifold& manifold, const ContactProxy& node, const NodeHit& hit, bool nodeIsFirst, btManifoldPoint& point )
{
	const btScalar radius = node.radius(), distance = btScalar( hit.touch.distance );
	const btVector3 outward = toBt( hit.touch.normal );
	const bool isPatch = hit.touch.reach >= 0.0;
	const btVector3 own = isPatch ? toBt( hit.touch.ownPoint( double( radius ) ) ) : btVector3( outward * -radius );
	const btVector3 other = isPatch ? toBt( hit.touch.otherPoint( double( radius ) ) ) : btVector3( outward * -distance );
	( nodeIsFirst ? point.m_positionWorldOnA : point.m_positionWorldOnB ) = node.written + own;
	( nodeIsFirst ? point.m_positionWorldOnB : point.m_positionWorldOnA ) = node.written + other;
	point.m_localPointA = toLocal( *manifold.getBody0(), point.m_positionWorldOnA );
	point.m_localPointB = toLocal( *manifold.getBody1(), point.m_positionWorldOnB );
	point.m_normalWorldOnB = nodeIsFirst ? outward : -outward;
	point.m_distance1 = distance - radius;
	point.m_partId0 = nodeIsFirst ? -1 : hit.part;
	point.m_index0 = nodeIsFirst ? node.node : hit.index;
	point.m_partId1 = nodeIsFirst ? hit.part : -1;
	point.m_index1 = nodeIsFirst ? hit.index : node.node;
	point.m_contactPointFlags = 0;
	point.m_contactMotion1 = point.m_contactMotion2 = 0;
	point.m_contactCFM = point.m_contactERP = point.m_frictionCFM = 0;
	combineSurfaces( manifold.getBody0(), manifold.getBody1(), point );
}

void renewPoint( btPersistentManifold& manifold, const ContactProxy& node, const NodeHit& hit, bool nodeIsFirst, int at )
{
	btManifoldPoint& point = manifold.getContactPoint( at );
	// Restitution acts once per touch: a node under load that bounced in every substep would gain energy.
	const bool hasBounced = point.m_appliedImpulse > 0;
	if ( ( manifold.getBody0()->getCollisionFlags() | manifold.getBody1()->getCollisionFlags() ) &
		btCollisionObject::CF_HAS_FRICTION_ANCHOR )
	{
		btManifoldPoint anchored; // Bullet decides whether the anchor stays
		fillPoint( manifold, node, hit, nodeIsFirst, anchored );
		anchored.m_combinedRestitution = hasBounced ? btScalar( 0 ) : anchored.m_combinedRestitution;
		manifold.replaceContactPoint( anchored, at );
	}
	else
	{
		fillPoint( manifold, node, hit, nodeIsFirst, point );
		point.m_combinedRestitution = hasBounced ? btScalar( 0 ) : point.m_combinedRestitution;
	}
	++point.m_lifeTime;
}

void notifyAdded( const btPersistentManifold& manifold, btManifoldPoint& point, int leaf )
{
	const btCollisionObject* const body[2] = { manifold.getBody0(), manifold.getBody1() };
	const int flags = body[0]->getCollisionFlags() | body[1]->getCollisionFlags();
	if ( gContactAddedCallback && ( flags & btCollisionObject::CF_CUSTOM_MATERIAL_CALLBACK ) != 0 )
	{
		const TouchedPart part0( *body[0], leaf, point.m_partId0, point.m_index0, point.m_positionWorldOnA );
		const TouchedPart part1( *body[1], leaf, point.m_partId1, point.m_index1, point.m_positionWorldOnB );
		const btCollisionObjectWrapper wrap0( nullptr, part0.shape(), body[0], part0.transform(), point.m_partId0, point.m_index0 );
		const btCollisionObjectWrapper wrap1( nullptr, part1.shape(), body[1], part1.transform(), point.m_partId1, point.m_index1 );
		gContactAddedCallback( point, &wrap0, point.m_partId0, point.m_index0, &wrap1, point.m_partId1, point.m_index1 );
	}
}

int findPoint( const btPersistentManifold& manifold, const NodeHit& hit, int hitCount, bool nodeIsFirst )
{
	const int count = manifold.getNumContacts();
	if ( count == 1 && hitCount == 1 )
	{
		return 0;
	}
	for ( int k = 0; k < count; ++k )
	{
		const btManifoldPoint& point = manifold.getContactPoint( k );
		if ( ( nodeIsFirst ? point.m_index1 : point.m_index0 ) == hit.index &&
			( nodeIsFirst ? point.m_partId1 : point.m_partId0 ) == hit.part )
		{
			return k;
		}
	}
	return -1;
}

} // namespace pliant
