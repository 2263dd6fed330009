// What bodies in their rigid state meet: impacts that will deform them, which are found a step ahead, so that the body meets them
// deformable.

#include "body/rigid_state.h"
#include "world/bodies/soft_body_impl.h"
#include "world/constants.h"
#include "world/rigid/rigid_load.h"
#include "world/step/soft_body_system.h"

#include <BulletCollision/BroadphaseCollision/btBroadphaseInterface.h>
#include <LinearMath/btAabbUtil2.h>

#include <algorithm>

namespace pliant {

struct ForecastMotion
{
	btVector3 centre, velocity, angularVelocity;

	btVector3 at( const btVector3& point ) const { return velocity + angularVelocity.cross( point - centre ); }
};

namespace {

ForecastMotion motionOf( const btCollisionObject& object )
{
	const btVector3 zero( 0, 0, 0 );
	if ( const SoftBody* const soft = SoftBody::upcast( &object ) )
	{
		const RigidState* const state = soft->impl().body->rigidState();
		if ( !soft->isActive() )
		{
			return ForecastMotion{ object.getWorldTransform().getOrigin(), zero, zero };
		}
		return state ? ForecastMotion{ toBt( state->motion.centre ), toBt( state->motion.velocity ), toBt( state->motion.angularVelocity ) }
					 : ForecastMotion{ soft->massCentre(), soft->linearVelocity(), soft->angularVelocity() };
	}
	const btRigidBody* const rigid = btRigidBody::upcast( &object );
	const bool moves = rigid && !rigid->isStaticObject() && rigid->isActive();
	return moves ? ForecastMotion{ rigid->getCenterOfMassPosition(), rigid->getLinearVelocity(), rigid->getAngularVelocity() }
				 : ForecastMotion{ object.getWorldTransform().getOrigin(), zero, zero };
}

/// The largest velocity that an object's rotation gives to one of its points, m/s.
btScalar fastestTurn( const btCollisionObject& object, const ForecastMotion& motion )
{
	btVector3 centre;
	btScalar radius;
	object.getCollisionShape()->getBoundingSphere( centre, radius );
	return motion.angularVelocity.length() * ( radius + centre.length() );
}

/// An upper bound of the velocity of any point of the object, m/s.
btScalar fastest( const btCollisionObject& object, const ForecastMotion& motion )
{
	return motion.velocity.length() + fastestTurn( object, motion );
}

/// Whether the boxes of two objects come within `reach`, m, of each other while the first moves by `displacement`.
bool comeNear( const btCollisionObject& a, const btCollisionObject& b, const btVector3& displacement, btScalar reach )
{
	btVector3 lowA, highA, lowB, highB;
	a.getCollisionShape()->getAabb( a.getWorldTransform(), lowA, highA );
	b.getCollisionShape()->getAabb( b.getWorldTransform(), lowB, highB );
	btVector3 back = displacement, ahead = displacement;
	back.setMin( btVector3( 0, 0, 0 ) );
	ahead.setMax( btVector3( 0, 0, 0 ) );
	const btVector3 around( reach, reach, reach );
	return TestAabbAgainstAabb2( lowA + back - around, highA + ahead + around, lowB, highB );
}

btScalar massOf( const btCollisionObject& object )
{
	const SoftBody* const soft = SoftBody::upcast( &object );
	const btRigidBody* const rigid = btRigidBody::upcast( &object );
	const bool isHeld = soft && soft->impl().rigidProxy && soft->impl().body->rigidState()->isHeld;
	const bool isFixed = isHeld || object.isStaticOrKinematicObject() || ( !soft && ( !rigid || rigid->getInvMass() == 0 ) );
	return isFixed ? btScalar( SIMD_INFINITY ) : soft ? soft->mass() : 1 / rigid->getInvMass();
}

/// Finds whether two objects collide within a step at a point at which their approach is faster than a limit.
struct FastContact : btCollisionWorld::ContactResultCallback
{
	ForecastMotion first, second;
	btScalar step, limit;
	bool isFound = false;

	FastContact( const ForecastMotion& ofFirst, const ForecastMotion& ofSecond, btScalar h, btScalar fastestAllowed ) :
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

} // namespace

bool SoftBodySystem::mayTouch( SoftBody& body, btCollisionObject& other )
{
	return body.hasContactResponse() && other.hasContactResponse() && m_dispatcher.needsCollision( &body, &other ) &&
		m_world.getPairCache()->needsBroadphaseCollision( body.getBroadphaseHandle(), other.getBroadphaseHandle() );
}

/// The motions of a world's objects, by their index in it: those of deformable bodies are sums over their nodes.
class ForecastMotions
{
public:
	explicit ForecastMotions( const btCollisionObjectArray& objects )
	{
		m_motions.reserve( std::size_t( objects.size() ) );
		for ( int i = 0; i < objects.size(); ++i )
		{
			m_motions.push_back( motionOf( *objects[i] ) );
		}
	}
	const ForecastMotion& of( const btCollisionObject& object ) const { return m_motions[std::size_t( object.getWorldArrayIndex() )]; }

private:
	std::vector<ForecastMotion> m_motions;
};

void SoftBodySystem::forecastImpact( SoftBody& body, btCollisionObject& other, const ForecastMotions& motions, btScalar h )
{
	if ( body.impl().mustDeform || !mayTouch( body, other ) )
	{
		return;
	}
	const ForecastMotion &own = motions.of( body ), &others = motions.of( other );
	const btScalar limit = btScalar( largestApproach( *body.impl().body, double( massOf( other ) ) ) );
	const btScalar turn = fastestTurn( body, own ) + fastestTurn( other, others );
	const btVector3 approach = own.velocity - others.velocity;
	const btScalar bound = approach.length() + turn;
	if ( bound <= limit || !comeNear( body, other, approach * h, turn * h ) )
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
			const Body& core = *body->impl().body;
			const double speed = core.largestInvisibleVelocity();
			slowest = std::min( slowest, core.rigidState()->isHeld ? std::min( speed, kHeldForecast ) : speed );
		}
	}
	const btCollisionObjectArray& objects = m_world.getCollisionObjectArray();
	const ForecastMotions motions( objects );
	Overlaps overlaps;
	for ( int i = 0; i < objects.size(); ++i )
	{
		btCollisionObject& object = *objects[i];
		if ( !object.isActive() || object.isStaticObject() || !object.getBroadphaseHandle() )
		{
			continue;
		}
		const ForecastMotion& motion = motions.of( object );
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
				forecastImpact( *soft, *other, motions, h );
			}
			if ( other != &object && otherSoft && otherSoft->impl().rigidProxy )
			{
				forecastImpact( *otherSoft, object, motions, h );
			}
		}
	}
}

} // namespace pliant
