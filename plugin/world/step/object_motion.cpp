#include "world/step/object_motion.h"

#include "body/rigid_state.h"
#include "world/bodies/soft_body_impl.h"

namespace pliant {

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
