// Rigid bodies are moved.

#include "c/handles.h"
#include "c/numbers.h"
#include "pliant/c/rigid.h"

namespace pliant::c {

namespace {

void requireDynamic( const btRigidBody& body )
{
	rejectIf( body.isStaticOrKinematicObject(), PLIANT_BAD_ARGUMENT, "The rigid body is not dynamic: forces do not move it." );
}

void requireVelocities( const btVector3& linear, const btVector3& angular, const char* sentence )
{
	rejectIf( !isWithin( linear, kMostSpeed ) || !isWithin( angular, kMostSpeed ), PLIANT_BAD_ARGUMENT, sentence );
}

/// Rejects an impulse on a body that is not dynamic, and one that causes velocities beyond the limits. Returns the arm of its point.
btVector3 takeImpulse( const btRigidBody& body, const btVector3& push, const pliant_vec3& point )
{
	requireDynamic( body );
	rejectIf( !isWithin( point, kMostPosition ) || !isNumber( push ), PLIANT_BAD_ARGUMENT,
		"A number is not finite, or the point is not within 1e9 m." );
	const btVector3 arm = vectorOf( point ) - body.getCenterOfMassPosition();
	requireVelocities( body.getLinearVelocity() + push * body.getInvMass(),
		body.getAngularVelocity() + body.getInvInertiaTensorWorld() * arm.cross( push ),
		"The body would be faster than 1e5 m/s or rad/s along an axis." );
	return arm;
}

} // namespace

} // namespace pliant::c

using namespace pliant;
using namespace pliant::c;

pliant_result pliant_rigid_get_pose( const pliant_world* world, pliant_id rigid, pliant_pose* pose )
{
	return withRigid( world, rigid, [&]( btRigidBody& body ) { give( poseOf( body.getWorldTransform() ), pose ); } );
}

pliant_result pliant_rigid_set_pose( pliant_world* world, pliant_id rigid, const pliant_pose* pose )
{
	return withRigid( world, rigid, [&]( btRigidBody& body ) {
		const btTransform transform = readPose( pose );
		body.setWorldTransform( transform );
		if ( body.isKinematicObject() )
		{
			body.getMotionState() ? body.getMotionState()->setWorldTransform( transform ) : void();
			return;
		}
		// Bullet derives a kinematic body's velocity from the two transforms; all others are to be at rest between them.
		body.setInterpolationWorldTransform( transform );
		body.updateInertiaTensor();
		world->host->bulletWorld().updateSingleAabb( &body );
		body.activate();
	} );
}

pliant_result pliant_rigid_get_velocity( const pliant_world* world, pliant_id rigid, pliant_vec3* linear, pliant_vec3* angular )
{
	return withRigid( world, rigid, [&]( btRigidBody& body ) {
		offer( vectorOf( body.getLinearVelocity() ), linear );
		offer( vectorOf( body.getAngularVelocity() ), angular );
	} );
}

pliant_result pliant_rigid_set_velocity( pliant_world* world, pliant_id rigid, pliant_vec3 linear, pliant_vec3 angular )
{
	return withRigid( world, rigid, [&]( btRigidBody& body ) {
		requireDynamic( body );
		requireVelocities( vectorOf( linear ), vectorOf( angular ), "Velocities must be at most 1e5 along each axis." );
		body.setLinearVelocity( vectorOf( linear ) );
		body.setAngularVelocity( vectorOf( angular ) );
		body.activate();
	} );
}

pliant_result pliant_rigid_apply_impulse( pliant_world* world, pliant_id rigid, pliant_vec3 impulse, pliant_vec3 point )
{
	return withRigid( world, rigid, [&]( btRigidBody& body ) {
		const btVector3 arm = takeImpulse( body, vectorOf( impulse ), point );
		body.activate();
		body.applyImpulse( vectorOf( impulse ), arm );
	} );
}

pliant_result pliant_rigid_apply_force( pliant_world* world, pliant_id rigid, pliant_vec3 force, pliant_vec3 point )
{
	return withRigid( world, rigid, [&]( btRigidBody& body ) {
		const btVector3 arm = takeImpulse(
			body, vectorOf( pliant_vec3{ force.x * kForceTime, force.y * kForceTime, force.z * kForceTime } ), point );
		body.activate();
		body.applyForce( vectorOf( force ), arm );
	} );
}

pliant_result pliant_rigid_get_mass( const pliant_world* world, pliant_id rigid, double* mass )
{
	return withRigid(
		world, rigid, [&]( btRigidBody& body ) { give( body.getInvMass() > 0 ? 1 / double( body.getInvMass() ) : 0, mass ); } );
}
