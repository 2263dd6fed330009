#include "world/step/object_motion.h"

#include "body/rigid_state.h"
#include "world/bodies/soft_body_impl.h"

#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>

namespace pliant {

namespace {

/// The velocities that the base and the joints between it and the link give the link, from their motions as of the last game step.
ObjectMotion motionOfLink( const btMultiBodyLinkCollider& link )
{
	const btMultiBody& body = *link.m_multiBody;
	ObjectMotion motion{ body.getBasePos(), body.getBaseVel(), body.getBaseOmega() };
	const btVector3 centre = link.getWorldTransform().getOrigin();
	motion.velocity = motion.at( centre );
	motion.centre = centre;
	for ( int k = link.m_link; k >= 0; k = body.getParent( k ) )
	{
		// Velocities of the link's frame by its joint, in its own axes: omega = sum top q', v = sum bottom q'
		const btMultibodyLink& joint = body.getLink( k );
		const btScalar* const rates = body.getJointVelMultiDof( k );
		btVector3 omega( 0, 0, 0 ), v( 0, 0, 0 );
		for ( int axis = 0; axis < joint.m_dofCount; ++axis )
		{
			omega += rates[axis] * joint.getAxisTop( axis );
			v += rates[axis] * joint.getAxisBottom( axis );
		}
		const btTransform& frame = joint.m_cachedWorldTransform;
		const btVector3 turn = frame.getBasis() * omega;
		motion.angularVelocity += turn;
		motion.velocity += frame.getBasis() * v + turn.cross( centre - frame.getOrigin() );
	}
	return motion;
}

} // namespace

ObjectMotion motionOf( const btCollisionObject& object )
{
	const btVector3 zero( 0, 0, 0 );
	if ( const SoftBody* const soft = SoftBody::upcast( &object ) )
	{
		const RigidState* const state = soft->impl().body->rigidState();
		if ( !soft->isActive() )
		{
			return ObjectMotion{ object.getWorldTransform().getOrigin(), zero, zero };
		}
		return state ? ObjectMotion{ toBt( state->motion.centre ), toBt( state->motion.velocity ), toBt( state->motion.angularVelocity ) }
					 : ObjectMotion{ soft->massCentre(), soft->linearVelocity(), soft->angularVelocity() };
	}
	if ( const btMultiBodyLinkCollider* const link = btMultiBodyLinkCollider::upcast( &object ) )
	{
		return link->isActive() ? motionOfLink( *link ) : ObjectMotion{ object.getWorldTransform().getOrigin(), zero, zero };
	}
	const btRigidBody* const rigid = btRigidBody::upcast( &object );
	const bool moves = rigid && !rigid->isStaticObject() && rigid->isActive();
	return moves ? ObjectMotion{ rigid->getCenterOfMassPosition(), rigid->getLinearVelocity(), rigid->getAngularVelocity() }
				 : ObjectMotion{ object.getWorldTransform().getOrigin(), zero, zero };
}

btScalar fastestTurn( const btCollisionObject& object, const ObjectMotion& motion )
{
	btVector3 centre;
	btScalar radius;
	object.getCollisionShape()->getBoundingSphere( centre, radius );
	return motion.angularVelocity.length() * ( radius + centre.length() );
}

btScalar fastest( const btCollisionObject& object, const ObjectMotion& motion )
{
	return motion.velocity.length() + fastestTurn( object, motion );
}

btScalar massOf( const btCollisionObject& object )
{
	const SoftBody* const soft = SoftBody::upcast( &object );
	const btRigidBody* const rigid = btRigidBody::upcast( &object );
	const bool isHeld = soft && soft->impl().rigidProxy && soft->impl().rigidProxy->isHeld();
	const bool isFixed = isHeld || object.isStaticOrKinematicObject() || ( !soft && ( !rigid || rigid->getInvMass() == 0 ) );
	return isFixed ? btScalar( SIMD_INFINITY ) : soft ? soft->mass() : 1 / rigid->getInvMass();
}

} // namespace pliant
