// Rigid bodies are moved.

#include "c/handles.h"
#include "c/numbers.h"
#include "pliant/c/rigid.h"

namespace pliant::c {

namespace {

pliant_result checkDynamic( const btRigidBody& body )
{
	return body.isStaticOrKinematicObject() ? refuse( PLIANT_BAD_ARGUMENT, "The rigid body is not dynamic: forces do not move it." )
											: PLIANT_OK;
}

/// The velocities that an impulse causes are within the limits.
pliant_result checkImpulse( const btRigidBody& body, const pliant_vec3& impulse, const pliant_vec3& point )
{
	const btVector3 push = vectorOf( impulse );
	if ( !isWithin( point, kMostPosition ) || !isNumber( push ) )
	{
		return refuse( PLIANT_BAD_ARGUMENT, "A number is not finite, or the point is not within 1e9 m." );
	}
	const btVector3 arm = vectorOf( point ) - body.getCenterOfMassPosition();
	const btVector3 linear = body.getLinearVelocity() + push * body.getInvMass();
	const btVector3 angular = body.getAngularVelocity() + body.getInvInertiaTensorWorld() * arm.cross( push );
	if ( !isWithin( linear, kMostSpeed ) || !isWithin( angular, kMostSpeed ) )
	{
		return refuse( PLIANT_BAD_ARGUMENT, "The body would be faster than 1e5 m/s or rad/s along an axis." );
	}
	return PLIANT_OK;
}

} // namespace

} // namespace pliant::c

using namespace pliant;
using namespace pliant::c;

pliant_result pliant_rigid_get_pose( const pliant_world* world, pliant_id rigid, pliant_pose* pose )
{
	return withRigid( world, rigid, [&]( btRigidBody& body ) {
		if ( !pose )
		{
			return refuseNull();
		}
		*pose = poseOf( body.getWorldTransform() );
		return pliant_result( PLIANT_OK );
	} );
}

pliant_result pliant_rigid_set_pose( pliant_world* world, pliant_id rigid, const pliant_pose* pose )
{
	return withRigid( world, rigid, [&]( btRigidBody& body ) {
		btTransform transform;
		if ( const pliant_result code = readPose( pose, transform ); code != PLIANT_OK )
		{
			return code;
		}
		body.setWorldTransform( transform );
		if ( body.isKinematicObject() )
		{
			body.getMotionState() ? body.getMotionState()->setWorldTransform( transform ) : void();
			return pliant_result( PLIANT_OK );
		}
		// Bullet derives a kinematic body's velocity from the two transforms; all others are to be at rest between them.
		body.setInterpolationWorldTransform( transform );
		body.updateInertiaTensor();
		world->host->bulletWorld().updateSingleAabb( &body );
		body.activate();
		return pliant_result( PLIANT_OK );
	} );
}

pliant_result pliant_rigid_get_velocity( const pliant_world* world, pliant_id rigid, pliant_vec3* linear, pliant_vec3* angular )
{
	return withRigid( world, rigid, [&]( btRigidBody& body ) {
		linear ? void( *linear = vectorOf( body.getLinearVelocity() ) ) : void();
		angular ? void( *angular = vectorOf( body.getAngularVelocity() ) ) : void();
		return pliant_result( PLIANT_OK );
	} );
}

pliant_result pliant_rigid_set_velocity( pliant_world* world, pliant_id rigid, pliant_vec3 linear, pliant_vec3 angular )
{
	return withRigid( world, rigid, [&]( btRigidBody& body ) {
		if ( const pliant_result code = checkDynamic( body ); code != PLIANT_OK )
		{
			return code;
		}
		if ( !isWithin( linear, kMostSpeed ) || !isWithin( angular, kMostSpeed ) )
		{
			return refuse( PLIANT_BAD_ARGUMENT, "Velocities must be at most 1e5 along each axis." );
		}
		body.setLinearVelocity( vectorOf( linear ) );
		body.setAngularVelocity( vectorOf( angular ) );
		body.activate();
		return pliant_result( PLIANT_OK );
	} );
}

pliant_result pliant_rigid_apply_impulse( pliant_world* world, pliant_id rigid, pliant_vec3 impulse, pliant_vec3 point )
{
	return withRigid( world, rigid, [&]( btRigidBody& body ) {
		pliant_result code = checkDynamic( body );
		code = code == PLIANT_OK ? checkImpulse( body, impulse, point ) : code;
		if ( code == PLIANT_OK )
		{
			body.activate();
			body.applyImpulse( vectorOf( impulse ), vectorOf( point ) - body.getCenterOfMassPosition() );
		}
		return code;
	} );
}

pliant_result pliant_rigid_apply_force( pliant_world* world, pliant_id rigid, pliant_vec3 force, pliant_vec3 point )
{
	return withRigid( world, rigid, [&]( btRigidBody& body ) {
		const pliant_vec3 impulse = { force.x * kForceTime, force.y * kForceTime, force.z * kForceTime };
		pliant_result code = checkDynamic( body );
		code = code == PLIANT_OK ? checkImpulse( body, impulse, point ) : code;
		if ( code == PLIANT_OK )
		{
			body.activate();
			body.applyForce( vectorOf( force ), vectorOf( point ) - body.getCenterOfMassPosition() );
		}
		return code;
	} );
}

pliant_result pliant_rigid_get_mass( const pliant_world* world, pliant_id rigid, double* mass )
{
	return withRigid( world, rigid, [&]( btRigidBody& body ) {
		if ( !mass )
		{
			return refuseNull();
		}
		*mass = body.getInvMass() > 0 ? 1 / double( body.getInvMass() ) : 0;
		return pliant_result( PLIANT_OK );
	} );
}
