// Moves the origin of a world: adds the same to every coordinate that anything in it keeps.

#include "lattice/attempt.h"
#include "pliant/soft_body_host.h"
#include "world/bodies/placing.h"
#include "world/bodies/soft_body_impl.h"
#include "world/constants.h"
#include "world/step/world_step.h"

#include <BulletDynamics/ConstraintSolver/btConeTwistConstraint.h>
#include <BulletDynamics/ConstraintSolver/btGeneric6DofConstraint.h>
#include <BulletDynamics/ConstraintSolver/btGeneric6DofSpring2Constraint.h>
#include <BulletDynamics/ConstraintSolver/btHingeConstraint.h>
#include <BulletDynamics/ConstraintSolver/btPoint2PointConstraint.h>
#include <BulletDynamics/ConstraintSolver/btSliderConstraint.h>
#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyFixedConstraint.h>
#include <BulletDynamics/Featherstone/btMultiBodyPoint2Point.h>
#include <BulletDynamics/Featherstone/btMultiBodySliderConstraint.h>

#include <algorithm>

namespace pliant {

namespace {

btTransform moved( const btTransform& transform, const btVector3& by )
{
	return btTransform( transform.getBasis(), transform.getOrigin() + by );
}

void check( const btCollisionWorld& world, const btVector3& by )
{
	insist( checkVector( by, "shiftOrigin", "the displacement" ) );
	const btCollisionObjectArray& objects = world.getCollisionObjectArray();
	for ( int k = 0; k < objects.size(); ++k )
	{
		const btVector3 to = objects[k]->getWorldTransform().getOrigin() + by;
		rejectIf( std::max( { btFabs( to.x() ), btFabs( to.y() ), btFabs( to.z() ) } ) > kFarthestPosition, "shiftOrigin",
			"something would be further out than 1e9 m." );
		rejectIf( objects[k]->getInternalType() == btCollisionObject::CO_SOFT_BODY, "shiftOrigin",
			"a soft body of Bullet's own is in the world." );
	}
}

void shiftObject( btCollisionObject& object, const btVector3& by )
{
	object.setWorldTransform( moved( object.getWorldTransform(), by ) );
	object.setInterpolationWorldTransform( moved( object.getInterpolationWorldTransform(), by ) );
	btRigidBody* const body = btRigidBody::upcast( &object );
	if ( body && body->getMotionState() )
	{
		btTransform shown;
		body->getMotionState()->getWorldTransform( shown );
		body->getMotionState()->setWorldTransform( moved( shown, by ) );
	}
}

/// Both frames of a joint, of which those in Bullet's fixed body are in the world.
template <class Joint>
void shiftFrames( btTypedConstraint& joint, const btTransform& a, const btTransform& b, const btVector3& by )
{
	const btRigidBody* const fixed = &btTypedConstraint::getFixedBody();
	static_cast<Joint&>( joint ).setFrames(
		&joint.getRigidBodyA() == fixed ? moved( a, by ) : a, &joint.getRigidBodyB() == fixed ? moved( b, by ) : b );
}

template <class Joint>
void shiftSixDof( btTypedConstraint& joint, const btVector3& by )
{
	Joint& typed = static_cast<Joint&>( joint );
	shiftFrames<Joint>( joint, typed.getFrameOffsetA(), typed.getFrameOffsetB(), by );
}

void shiftJoint( btTypedConstraint& joint, const btVector3& by )
{
	const btRigidBody* const fixed = &btTypedConstraint::getFixedBody();
	if ( &joint.getRigidBodyA() != fixed && &joint.getRigidBodyB() != fixed )
	{
		return;
	}
	switch ( joint.getConstraintType() )
	{
		case POINT2POINT_CONSTRAINT_TYPE: {
			auto& ball = static_cast<btPoint2PointConstraint&>( joint );
			&joint.getRigidBodyA() == fixed ? ball.setPivotA( ball.getPivotInA() + by ) : ball.setPivotB( ball.getPivotInB() + by );
			break;
		}
		case HINGE_CONSTRAINT_TYPE: {
			auto& hinge = static_cast<btHingeConstraint&>( joint );
			shiftFrames<btHingeConstraint>( joint, hinge.getAFrame(), hinge.getBFrame(), by );
			break;
		}
		case CONETWIST_CONSTRAINT_TYPE: {
			auto& cone = static_cast<btConeTwistConstraint&>( joint );
			shiftFrames<btConeTwistConstraint>( joint, cone.getAFrame(), cone.getBFrame(), by );
			break;
		}
		case SLIDER_CONSTRAINT_TYPE: shiftSixDof<btSliderConstraint>( joint, by ); break;
		case D6_CONSTRAINT_TYPE:
		case D6_SPRING_CONSTRAINT_TYPE: shiftSixDof<btGeneric6DofConstraint>( joint, by ); break;
		case D6_SPRING_2_CONSTRAINT_TYPE:
		case FIXED_CONSTRAINT_TYPE: shiftSixDof<btGeneric6DofSpring2Constraint>( joint, by ); break;
		default: break; // gears have axes only; joints of the game's own are the game's
	}
}

/// Reads the second rigid body, for which Bullet has no accessor.
template <class Joint>
struct OpenJoint : Joint
{
	static const btRigidBody* secondOf( const Joint& joint ) { return joint.*( &OpenJoint::m_rigidBodyB ); }
};

template <class Joint>
void shiftPivot( btMultiBodyConstraint& joint, const btVector3& by )
{
	auto& typed = static_cast<Joint&>( joint );
	const btRigidBody* const second = OpenJoint<Joint>::secondOf( typed );
	if ( !joint.getMultiBodyB() && ( !second || second == &btTypedConstraint::getFixedBody() ) )
	{
		typed.setPivotInB( typed.getPivotInB() + by );
	}
}

void shiftMultiBody( btMultiBody& body, const btVector3& by )
{
	const btVector3 interpolated = body.getInterpolateBasePos();
	body.setBasePos( body.getBasePos() + by );
	body.setInterpolateBaseWorldTransform( btTransform( body.getInterpolateWorldToBaseRot().inverse(), interpolated + by ) );
	for ( int link = 0; link < body.getNumLinks(); ++link )
	{
		body.getLink( link ).m_cachedWorldTransform.getOrigin() += by;
	}
}

void shiftMultiBodyJoint( btMultiBodyConstraint& joint, const btVector3& by )
{
	switch ( joint.getConstraintType() )
	{
		case MULTIBODY_CONSTRAINT_POINT_TO_POINT: shiftPivot<btMultiBodyPoint2Point>( joint, by ); break;
		case MULTIBODY_CONSTRAINT_SLIDER: shiftPivot<btMultiBodySliderConstraint>( joint, by ); break;
		case MULTIBODY_CONSTRAINT_FIXED: shiftPivot<btMultiBodyFixedConstraint>( joint, by ); break;
		default: break;
	}
}

void shiftContacts( btDispatcher& dispatcher, const btVector3& by )
{
	for ( int m = 0; m < dispatcher.getNumManifolds(); ++m )
	{
		btPersistentManifold& manifold = *dispatcher.getManifoldByIndexInternal( m );
		for ( int k = 0; k < manifold.getNumContacts(); ++k )
		{
			manifold.getContactPoint( k ).m_positionWorldOnA += by;
			manifold.getContactPoint( k ).m_positionWorldOnB += by;
		}
	}
}

void shiftSoft( SoftBody& body, const btVector3& by )
{
	SoftBody::Impl& impl = body.impl();
	const Vec3d far = toVec3d( by );
	impl.body->shift( far );
	impl.rest.origin += far;
	for ( Vec3d& position : impl.heldBefore )
	{
		position += far;
	}
	for ( Pin& pin : impl.pins )
	{
		pin.point += pin.kind == PinKind::Driven ? by : btVector3( 0, 0, 0 );
	}
	for ( btVector3& origin : impl.skin.origin )
	{
		origin += by;
	}
	if ( impl.skin.blend )
	{
		impl.skin.blend->kept.shift( far );
	}
	if ( impl.follower )
	{
		impl.follower->shift( far );
	}
	for ( ContactProxy* proxy : impl.touched )
	{
		shiftObject( *proxy, by );
		proxy->written += by;
	}
	impl.rigidProxy ? impl.placeRigid( body ) : impl.placeShape( body );
}

} // namespace

void SoftBodySystem::shift( const btVector3& by )
{
	for ( SoftBody* body : m_bodies )
	{
		shiftSoft( *body, by );
	}
	for ( Frame& frame : frames.all() )
	{
		frame.at += toVec3d( by ); // its rigid body is shifted with the others
	}
}

Status WorldStep::shiftOrigin( const btVector3& by )
{
	return attempt( [&]() {
		btDiscreteDynamicsWorld& world = m_parts.world;
		rejectIf( bodies.isBusy(), "shiftOrigin", "a step is in progress." );
		check( world, by );
		bodies.shift( by );
		btCollisionObjectArray& objects = m_parts.objects;
		for ( int k = 0; k < objects.size(); ++k )
		{
			if ( !asSoftBody( objects[k] ) )
			{
				shiftObject( *objects[k], by );
			}
		}
		for ( int k = 0; k < m_parts.multiBodies.size(); ++k )
		{
			shiftMultiBody( *m_parts.multiBodies[k], by );
		}
		for ( int k = 0; k < m_parts.multiBodyJoints.size(); ++k )
		{
			shiftMultiBodyJoint( *m_parts.multiBodyJoints[k], by );
		}
		for ( int k = 0; k < m_parts.constraints.size(); ++k )
		{
			shiftJoint( *m_parts.constraints[k], by );
		}
		shiftContacts( *m_parts.dispatcher, by );
		for ( int k = 0; k < objects.size(); ++k )
		{
			world.updateSingleAabb( objects[k] );
		}
	} );
}

Status SoftBodyHost::shiftOrigin( const btVector3& by )
{
	return m_step->shiftOrigin( by );
}

const std::vector<ContactEvent>& SoftBodyHost::contactEvents() const
{
	return m_step->bodies.contactEvents.events();
}

Status SoftBodyHost::addForceField( ForceField& field )
{
	return attempt( [&]() {
		rejectIf( m_step->bodies.fields.areActing(), "addForceField", kInField );
		m_step->bodies.isPlain = false;
		rejectIf( !m_step->bodies.fields.add( field ), "addForceField", "the field is in a world already." );
	} );
}

bool SoftBodyHost::removeForceField( ForceField& field )
{
	return !m_step->bodies.fields.areActing() && m_step->bodies.fields.remove( field );
}

int SoftBodyHost::forceFieldCount() const
{
	return m_step->bodies.fields.count();
}

} // namespace pliant
