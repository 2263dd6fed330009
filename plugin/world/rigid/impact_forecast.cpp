// What bodies in their rigid state meet: impacts that will deform them, which are found a step ahead, so that the body meets them
// deformable; and neighbours that their hulls overlap.

#include "body/rigid_state.h"
#include "world/bodies/soft_body_impl.h"
#include "world/constants.h"
#include "world/step/soft_body_system.h"

#include <BulletCollision/BroadphaseCollision/btBroadphaseInterface.h>
#include <LinearMath/btAabbUtil2.h>

#include <algorithm>

namespace pliant {

namespace {

struct Motion
{
	btVector3 centre, velocity, angularVelocity;

	btVector3 at( const btVector3& point ) const { return velocity + angularVelocity.cross( point - centre ); }
};

Motion motionOf( const btCollisionObject& object )
{
	const btVector3 zero( 0, 0, 0 );
	if ( const SoftBody* const soft = SoftBody::upcast( &object ) )
	{
		const RigidState* const state = soft->impl().body->rigidState();
		if ( !soft->isActive() )
		{
			return Motion{ object.getWorldTransform().getOrigin(), zero, zero };
		}
		return state ? Motion{ toBt( state->motion.centre ), toBt( state->motion.velocity ), toBt( state->motion.angularVelocity ) }
					 : Motion{ soft->massCentre(), soft->linearVelocity(), soft->angularVelocity() };
	}
	const btRigidBody* const rigid = btRigidBody::upcast( &object );
	const bool moves = rigid && !rigid->isStaticObject() && rigid->isActive();
	return moves ? Motion{ rigid->getCenterOfMassPosition(), rigid->getLinearVelocity(), rigid->getAngularVelocity() }
				 : Motion{ object.getWorldTransform().getOrigin(), zero, zero };
}

/// The largest velocity that an object's rotation gives to one of its points, m/s.
btScalar fastestTurn( const btCollisionObject& object, const Motion& motion )
{
	btVector3 centre;
	btScalar radius;
	object.getCollisionShape()->getBoundingSphere( centre, radius );
	return motion.angularVelocity.length() * ( radius + centre.length() );
}

/// An upper bound of the velocity of any point of the object, m/s.
btScalar fastest( const btCollisionObject& object, const Motion& motion )
{
	return motion.velocity.length() + fastestTurn( object, motion );
}

/// Whether the boxes of two objects come within `reach`, m, of each other.
bool comeNear( const btCollisionObject& a, const btCollisionObject& b, btScalar reach )
{
	btVector3 lowA, highA, lowB, highB;
	a.getCollisionShape()->getAabb( a.getWorldTransform(), lowA, highA );
	b.getCollisionShape()->getAabb( b.getWorldTransform(), lowB, highB );
	const btVector3 around( reach, reach, reach );
	return TestAabbAgainstAabb2( lowA - around, highA + around, lowB, highB );
}

btScalar massOf( const btCollisionObject& object )
{
	const SoftBody* const soft = SoftBody::upcast( &object );
	const btRigidBody* const rigid = btRigidBody::upcast( &object );
	const bool isFixed = object.isStaticOrKinematicObject() || ( !soft && ( !rigid || rigid->getInvMass() == 0 ) );
	return isFixed ? btScalar( SIMD_INFINITY ) : soft ? soft->mass() : 1 / rigid->getInvMass();
}

/// Finds whether two objects collide within a step at a point at which their approach is faster than a limit.
struct FastContact : btCollisionWorld::ContactResultCallback
{
	Motion first, second;
	btScalar step, limit;
	bool isFound = false;

	FastContact( const Motion& ofFirst, const Motion& ofSecond, btScalar h, btScalar fastestAllowed ) :
		first( ofFirst ), second( ofSecond ), step( h ), limit( fastestAllowed )
	{}
	btScalar addSingleResult(
		btManifoldPoint& point, const btCollisionObjectWrapper*, int, int, const btCollisionObjectWrapper*, int, int ) override
	{
		const btScalar approach = -( first.at( point.getPositionWorldOnA() ) - second.at( point.getPositionWorldOnB() ) )
									   .dot( point.m_normalWorldOnB );
		isFound = isFound || ( approach > limit && point.getDistance() <= approach * step );
		return 0;
	}
};

struct DeepestContact : btCollisionWorld::ContactResultCallback
{
	btScalar depth = 0; ///< m

	btScalar addSingleResult(
		btManifoldPoint& point, const btCollisionObjectWrapper*, int, int, const btCollisionObjectWrapper*, int, int ) override
	{
		depth = btMax( depth, -point.getDistance() );
		return 0;
	}
};

/// Tests a body's hulls against another object; of a deformable body against its spheres: what is drawn of it, as cracks are, must not
/// decide on the motion.
void testContact( btCollisionWorld& world, SoftBody& body, btCollisionObject& other, btCollisionWorld::ContactResultCallback& contact )
{
	const SoftBody* const soft = asSoftBody( &other );
	if ( !soft || soft->impl().rigidProxy )
	{
		world.contactPairTest( &body, &other, contact );
		return;
	}
	btCollisionObject spheres;
	soft->impl().shape->freshen( nullptr );
	spheres.setCollisionShape( soft->impl().shape.get() );
	spheres.setWorldTransform( other.getWorldTransform() );
	world.contactPairTest( &body, &spheres, contact );
}

struct Overlaps : btBroadphaseAabbCallback
{
	std::vector<btCollisionObject*> found;
	bool process( const btBroadphaseProxy* proxy ) override
	{
		found.push_back( static_cast<btCollisionObject*>( proxy->m_clientObject ) );
		return true;
	}
};

/// A light object's velocity counts less: nothing lighter than a cell strains the body.
btScalar largestApproach( const SoftBody& body, const btCollisionObject& other )
{
	const Body& core = *body.impl().body;
	const double speed = core.largestInvisibleVelocity();
	const double cell = core.rigidState()->mass / double( core.lattice().cellCount() ), mass = double( massOf( other ) );
	return btScalar( mass < SIMD_INFINITY ? speed * ( mass + cell ) / mass : speed );
}

} // namespace

bool SoftBodySystem::mayTouch( SoftBody& body, btCollisionObject& other )
{
	return body.hasContactResponse() && other.hasContactResponse() && m_dispatcher.needsCollision( &body, &other ) &&
		m_world.getPairCache()->needsBroadphaseCollision( body.getBroadphaseHandle(), other.getBroadphaseHandle() );
}

bool SoftBodySystem::overlapsNeighbours( SoftBody& body )
{
	btVector3 low, high;
	body.getCollisionShape()->getAabb( body.getWorldTransform(), low, high );
	Overlaps overlaps;
	m_world.getBroadphase()->aabbTest( low, high, overlaps );
	DeepestContact contact;
	for ( btCollisionObject* other : overlaps.found )
	{
		if ( other != &body && mayTouch( body, *other ) && comeNear( body, *other, 0 ) )
		{
			testContact( m_world, body, *other, contact );
		}
	}
	return contact.depth > kRigidOverlap * body.impl().shape->smallestRadius();
}

void SoftBodySystem::forecastImpact( SoftBody& body, btCollisionObject& other, btScalar h )
{
	if ( body.impl().mustDeform || !mayTouch( body, other ) )
	{
		return;
	}
	const Motion own = motionOf( body ), others = motionOf( other );
	const btScalar limit = largestApproach( body, other );
	const btScalar bound = ( own.velocity - others.velocity ).length() + fastestTurn( body, own ) + fastestTurn( other, others );
	if ( bound <= limit || !comeNear( body, other, bound * h ) )
	{
		return;
	}
	FastContact contact( own, others, h, limit );
	contact.m_closestDistanceThreshold = bound * h;
	testContact( m_world, body, other, contact );
	if ( contact.isFound )
	{
		body.impl().mustDeform = true;
	}
}

// From each fast object, to what it may meet: both may be in their rigid state.
void SoftBodySystem::forecastImpacts( btScalar h )
{
	double slowest = SIMD_INFINITY;
	for ( const SoftBody* body : m_bodies )
	{
		if ( body->impl().rigidProxy )
		{
			slowest = std::min( slowest, body->impl().body->largestInvisibleVelocity() );
		}
	}
	const btCollisionObjectArray& objects = m_world.getCollisionObjectArray();
	Overlaps overlaps;
	for ( int i = 0; i < objects.size(); ++i )
	{
		btCollisionObject& object = *objects[i];
		if ( !object.isActive() || object.isStaticObject() || !object.getBroadphaseHandle() )
		{
			continue;
		}
		const Motion motion = motionOf( object );
		const btScalar speed = fastest( object, motion );
		if ( double( speed ) <= 0.5 * slowest ) // the other object is no faster, or it is tested itself
		{
			continue;
		}
		btVector3 low, high;
		object.getCollisionShape()->getAabb( object.getWorldTransform(), low, high );
		const btVector3 reach( speed * h, speed * h, speed * h );
		overlaps.found.clear();
		m_world.getBroadphase()->aabbTest( low - reach, high + reach, overlaps );
		SoftBody* const soft = asSoftBody( &object );
		for ( btCollisionObject* other : overlaps.found )
		{
			SoftBody* const otherSoft = asSoftBody( other );
			if ( other != &object && soft && soft->impl().rigidProxy )
			{
				forecastImpact( *soft, *other, h );
			}
			if ( other != &object && otherSoft && otherSoft->impl().rigidProxy )
			{
				forecastImpact( *otherSoft, object, h );
			}
		}
	}
}

} // namespace pliant
