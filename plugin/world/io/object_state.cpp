#include "world/io/object_state.h"

#include "world/constants.h"
#include "world/step/pass_objects.h"

#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <algorithm>
#include <initializer_list>

namespace pliant {

namespace {

bool areWithin( btScalar limit, std::initializer_list<btVector3> vectors )
{
	return std::all_of( vectors.begin(), vectors.end(), [limit]( const btVector3& v ) {
		const btVector3 size = v.absolute();
		return size[size.maxAxis()] <= limit;
	} );
}

/// Whether a transform leads to a position where soft bodies can be, and hardly scales.
bool isPlace( const btTransform& transform )
{
	const btMatrix3x3& basis = transform.getBasis();
	return areWithin( kFarthestPosition, { transform.getOrigin() } ) && areWithin( kLargestStoredAxis, { basis[0], basis[1], basis[2] } );
}

} // namespace

void archive( Archive& archive, btVector3& vector )
{
	archive.raw( &vector, 3 * sizeof( btScalar ) );
	archive.requireFinite( vector.m_floats, 3 );
}

void archive( Archive& archive, btTransform& transform )
{
	btMatrix3x3& basis = transform.getBasis();
	archive( transform.getOrigin(), basis[0], basis[1], basis[2] );
}

ObjectState ObjectState::of( const btCollisionObject& object )
{
	ObjectState state;
	state.transform = object.getWorldTransform();
	state.interpolation = object.getInterpolationWorldTransform();
	state.interpolationLinear = object.getInterpolationLinearVelocity();
	state.interpolationAngular = object.getInterpolationAngularVelocity();
	state.activation = object.getActivationState();
	state.islandTag = object.getIslandTag();
	state.deactivationTime = object.getDeactivationTime();
	if ( const btRigidBody* const rigid = btRigidBody::upcast( &object ) )
	{
		state.linear = rigid->getLinearVelocity();
		state.angular = rigid->getAngularVelocity();
		state.force = rigid->getTotalForce();
		state.torque = rigid->getTotalTorque();
	}
	return state;
}

void ObjectState::applyTo( btCollisionObject& object ) const
{
	const int type = object.getInternalType();
	if ( type == btCollisionObject::CO_COLLISION_OBJECT || type == btCollisionObject::CO_GHOST_OBJECT )
	{
		object.setWorldTransform( transform );
		object.setInterpolationWorldTransform( interpolation );
		object.setInterpolationLinearVelocity( interpolationLinear );
		object.setInterpolationAngularVelocity( interpolationAngular );
	}
	if ( btRigidBody* const rigid = btRigidBody::upcast( &object ) )
	{
		rigid->setCenterOfMassTransform( transform ); // the inertia in world axes too
		rigid->setLinearVelocity( linear );
		rigid->setAngularVelocity( angular );
		rigid->clearForces();
		if ( !force.isZero() || !torque.isZero() )
		{
			addForces( *rigid, force, torque );
		}
		object.setInterpolationWorldTransform( interpolation );
		object.setInterpolationLinearVelocity( interpolationLinear );
		object.setInterpolationAngularVelocity( interpolationAngular );
	}
	object.forceActivationState( activation );
	object.setDeactivationTime( deactivationTime );
	applyTag( object );
}

void ObjectState::archive( Archive& archive )
{
	archive( transform, interpolation, linear, angular, interpolationLinear, interpolationAngular, force, torque, activation, islandTag,
		deactivationTime );
	archive.require( activation >= ACTIVE_TAG && activation <= DISABLE_SIMULATION + 1 && std::isfinite( deactivationTime ),
		"The activation state of an object is out of range." );
	archive.require( !archive.isReading() || archive.isTrusted() ||
			( isPlace( transform ) && isPlace( interpolation ) &&
				areWithin( kFastestStoredObject, { linear, angular, interpolationLinear, interpolationAngular } ) &&
				areWithin( kStrongestStored, { force, torque } ) ),
		"An object is too far out or too fast." );
}

ObjectSettings ObjectSettings::of( const btCollisionObject& object )
{
	ObjectSettings settings;
	settings.flags = object.getCollisionFlags();
	settings.userIndex[0] = object.getUserIndex();
	settings.userIndex[1] = object.getUserIndex2();
	settings.userIndex[2] = object.getUserIndex3();
	for ( const int mode : { btCollisionObject::CF_ANISOTROPIC_FRICTION, btCollisionObject::CF_ANISOTROPIC_ROLLING_FRICTION } )
	{
		settings.frictionMode |= object.hasAnisotropicFriction( mode ) ? mode : 0;
	}
	settings.anisotropicFriction = object.getAnisotropicFriction();
	settings.friction = object.getFriction();
	settings.restitution = object.getRestitution();
	settings.rolling = object.getRollingFriction();
	settings.spinning = object.getSpinningFriction();
	settings.stiffness = object.getContactStiffness();
	settings.damping = object.getContactDamping();
	settings.threshold = object.getContactProcessingThreshold();
	settings.hitFraction = object.getHitFraction();
	settings.ccdRadius = object.getCcdSweptSphereRadius();
	settings.ccdThreshold = object.getCcdMotionThreshold();
	return settings;
}

void ObjectSettings::applyTo( btCollisionObject& object ) const
{
	object.setUserIndex( userIndex[0] );
	object.setUserIndex2( userIndex[1] );
	object.setUserIndex3( userIndex[2] );
	object.setAnisotropicFriction( anisotropicFriction, frictionMode );
	object.setFriction( friction );
	object.setRestitution( restitution );
	object.setRollingFriction( rolling );
	object.setSpinningFriction( spinning );
	object.setContactStiffnessAndDamping( stiffness, damping );
	object.setContactProcessingThreshold( threshold );
	object.setHitFraction( hitFraction );
	object.setCcdSweptSphereRadius( ccdRadius );
	object.setCcdMotionThreshold( ccdThreshold );
	object.setCollisionFlags( flags ); // last: calls above set some
}

void ObjectSettings::archive( Archive& archive )
{
	archive( flags, frictionMode, userIndex, anisotropicFriction, friction, restitution, rolling, spinning, stiffness, damping, threshold,
		hitFraction, ccdRadius, ccdThreshold );
	for ( const btScalar value : { friction, restitution, rolling, spinning, hitFraction, ccdRadius, ccdThreshold } )
	{
		archive.requireFinite( &value, 1 );
	}
}

} // namespace pliant
