// Joints between rigid bodies and frames: one constraint of Bullet's for all kinds, whose six directions are locked, limited or free.

#include "c/handles.h"
#include "c/numbers.h"
#include "pliant/c/joints.h"
#include "world/step/world_step.h"

#include <LinearMath/btScalar.h>

namespace pliant::c {

namespace {

/// Of btGeneric6DofSpring2Constraint: three directions, and then three rotations.
enum Direction
{
	MoveX = 0,
	RotateX = 3,
	Directions = 6
};

pliant_joint_settings defaultJoint()
{
	pliant_joint_settings c{};
	c.kind = PLIANT_JOINT_POINT;
	c.pose = kOrigin;
	c.low = 1;
	c.high = -1;
	return c;
}

/// The direction in which a joint has limits and a motor; -1: in none.
int drivenDirection( int kind )
{
	return kind == PLIANT_JOINT_HINGE ? RotateX : kind == PLIANT_JOINT_SLIDER ? MoveX : -1;
}

bool isMotorGood( double velocity, double force )
{
	return isWithin( velocity, -kMostSpeed, kMostSpeed ) && isWithin( force, 0, kMostForce );
}

void check( const pliant_joint_settings& settings )
{
	const double reach = settings.kind == PLIANT_JOINT_HINGE ? double( SIMD_PI ) : kMostLength;
	const bool hasLimits = settings.low <= settings.high;
	const bool areLimitsGood = !std::isnan( settings.low ) && !std::isnan( settings.high ) &&
		( !hasLimits || ( isWithin( settings.low, -reach, reach ) && isWithin( settings.high, -reach, reach ) ) );
	const bool isGood = isWithin( settings.kind, PLIANT_JOINT_POINT, PLIANT_JOINT_FIXED ) && areLimitsGood &&
		isMotorGood( settings.motor_velocity, settings.motor_force ) && settings.breaking_impulse >= 0 &&
		std::isfinite( settings.breaking_impulse );
	rejectIf( !isGood, PLIANT_BAD_SETTINGS, "pliant_joint_settings: a value is out of range." );
}

void setMotor( Joint& joint, double velocity, double force )
{
	const int driven = drivenDirection( joint.kind );
	if ( driven >= 0 )
	{
		// Bullet takes the velocity as that of the first body against the second.
		joint.constraint->enableMotor( driven, force > 0 );
		joint.constraint->setTargetVelocity( driven, btScalar( -velocity ) );
		joint.constraint->setMaxMotorForce( driven, btScalar( force ) );
	}
	joint.motorVelocity = velocity;
	joint.motorForce = force;
}

std::unique_ptr<btGeneric6DofSpring2Constraint> constraintOf(
	btRigidBody& first, btRigidBody* second, const pliant_joint_settings& settings, const btTransform& pose )
{
	btRigidBody& other = second ? *second : btTypedConstraint::getFixedBody();
	auto made = std::make_unique<btGeneric6DofSpring2Constraint>(
		first, other, first.getWorldTransform().inverse() * pose, other.getWorldTransform().inverse() * pose );
	for ( int k = 0; k < Directions; ++k )
	{
		const bool isFree = settings.kind == PLIANT_JOINT_POINT && k >= RotateX;
		made->setLimit( k, isFree ? 1 : 0, isFree ? -1 : 0 );
		made->setParam( BT_CONSTRAINT_STOP_ERP, btScalar( kJointErrorReduction ), k );
	}
	const int driven = drivenDirection( settings.kind );
	if ( driven == RotateX )
	{
		made->setLimitReversed( driven, btScalar( settings.low ), btScalar( settings.high ) );
	}
	else if ( driven == MoveX )
	{
		made->setLimit( driven, btScalar( settings.low ), btScalar( settings.high ) );
	}
	if ( settings.breaking_impulse > 0 )
	{
		made->setBreakingImpulseThreshold( btScalar( settings.breaking_impulse ) );
	}
	return made;
}

void checkTime( const pliant_world& world )
{
	rejectIf( world.host->step().bodies.isBusy(), PLIANT_BAD_ARGUMENT, "Joints cannot be made or ended during a step." );
}

void wake( const Joint& joint )
{
	joint.constraint->getRigidBodyA().activate();
	joint.constraint->getRigidBodyB().activate();
}

/// Calls `work( Joint& )`.
template <class F>
pliant_result withJoint( const pliant_world* world, pliant_id joint, F&& work ) noexcept
{
	return call( [&]() {
		requirePointers( world );
		const auto found = world->joints.find( joint );
		rejectIf( found == world->joints.end(), PLIANT_NO_SUCH_OBJECT, "The world has no joint of this identity." );
		work( *found->second );
	} );
}

pliant_id create( pliant_world& world, btRigidBody& first, btRigidBody* second, const pliant_joint_settings* given )
{
	checkTime( world );
	pliant_joint_settings settings = defaultJoint();
	readSized( given, settings );
	check( settings );
	const btTransform pose = takePose( settings.pose );
	rejectIf( &first == second || ( first.isStaticOrKinematicObject() && ( !second || second->isStaticOrKinematicObject() ) ),
		PLIANT_BAD_ARGUMENT, "A joint needs two different bodies, at least one of them dynamic." );
	auto joint = std::make_unique<Joint>();
	joint->constraint = constraintOf( first, second, settings, pose );
	joint->first = &first;
	joint->second = second;
	joint->kind = settings.kind;
	setMotor( *joint, settings.motor_velocity, settings.motor_force );
	const pliant_id id = world.lastOther + 2;
	Joint& kept = *world.joints.emplace( id, std::move( joint ) ).first->second;
	world.host->bulletWorld().addConstraint( kept.constraint.get(), settings.bodies_collide == 0 );
	world.lastOther = id;
	wake( kept );
	return id;
}

} // namespace

void endJoints( pliant_world& world, const btCollisionObject* at )
{
	std::erase_if( world.joints, [&]( const auto& entry ) {
		const Joint& joint = *entry.second;
		const bool ends = !at || joint.first == at || joint.second == at;
		if ( ends )
		{
			world.host->bulletWorld().removeConstraint( joint.constraint.get() );
			wake( joint );
		}
		return ends;
	} );
}

} // namespace pliant::c

using namespace pliant;
using namespace pliant::c;

pliant_result pliant_joint_settings_init( pliant_joint_settings* settings, uint32_t size )
{
	return initSized( defaultJoint(), settings, size );
}

pliant_result pliant_joint_create(
	pliant_world* world, pliant_id first, pliant_id second, const pliant_joint_settings* settings, pliant_id* made )
{
	return withRigid( world, first, [&]( btRigidBody& one ) {
		requirePointers( made );
		btRigidBody* const two = second != 0 ? rigidBody( *world, second ) : nullptr;
		if ( second != 0 && !two )
		{
			rejectIdentity( world, second, "rigid body" );
		}
		*made = create( *world, one, two, settings );
	} );
}

pliant_result pliant_joint_destroy( pliant_world* world, pliant_id joint )
{
	return withJoint( world, joint, [&]( const Joint& found ) {
		checkTime( *world );
		wake( found );
		world->host->bulletWorld().removeConstraint( found.constraint.get() );
		world->joints.erase( joint );
	} );
}

pliant_result pliant_joint_set_motor( pliant_world* world, pliant_id joint, double velocity, double force )
{
	return withJoint( world, joint, [&]( Joint& found ) {
		rejectIf( drivenDirection( found.kind ) < 0 || !isMotorGood( velocity, force ), PLIANT_BAD_ARGUMENT,
			"Only hinges and sliders have motors, of at most 1e5 in velocity and 1e12 in force." );
		setMotor( found, velocity, force );
		wake( found );
	} );
}

pliant_result pliant_joint_get_state( const pliant_world* world, pliant_id joint, pliant_joint_state* state, uint32_t size )
{
	return withJoint( world, joint, [&]( Joint& found ) {
		pliant_joint_state now{};
		const int driven = drivenDirection( found.kind );
		found.constraint->calculateTransforms();
		now.is_broken = found.constraint->isEnabled() ? 0 : 1;
		now.first = world->idsOfOthers.at( found.first );
		now.second = found.second ? world->idsOfOthers.at( found.second ) : pliant_id( 0 );
		now.position = driven == RotateX ? -double( found.constraint->getAngle( 0 ) )
			: driven == MoveX            ? double( found.constraint->getRelativePivotPosition( 0 ) )
										 : 0.0;
		now.impulse = double( found.constraint->getAppliedImpulse() );
		now.motor_velocity = found.motorVelocity;
		now.motor_force = found.motorForce;
		writeSized( now, state, size );
	} );
}
