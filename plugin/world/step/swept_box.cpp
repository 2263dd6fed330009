#include "world/step/swept_box.h"

#include "world/bodies/soft_body_impl.h"
#include "world/constants.h"
#include "world/query/query_constants.h"
#include "world/step/object_motion.h"

#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

namespace pliant {

SweptBox SweptBox::of( const btRigidBody& body, btScalar step )
{
	const btVector3 velocity = body.getLinearVelocity() + step * body.getInvMass() * body.getTotalForce();
	return of( body, ObjectMotion{ body.getCenterOfMassPosition(), velocity, body.getAngularVelocity() }, step );
}

SweptBox SweptBox::of( const btCollisionObject& object, const ObjectMotion& motion, btScalar step )
{
	SweptBox box;
	object.getCollisionShape()->getAabb( object.getWorldTransform(), box.low, box.high );
	const btScalar turned = step * motion.angularVelocity.length() * ( box.high - box.low ).length() / 2;
	box.include( step * motion.velocity );
	box.grow( turned + gContactBreakingThreshold );
	return box;
}

SweptBox SweptBox::displacementsOf( const SoftBody& body, const btVector3& gravity, btScalar step )
{
	const auto [low, high] = body.impl().body->nodes().velocityBounds();
	SweptBox box{ step * toBt( low.cast<double>() ), step * toBt( high.cast<double>() ) };
	box.include( step * step * gravity );
	box.low.setMin( btVector3( 0, 0, 0 ) );
	box.high.setMax( btVector3( 0, 0, 0 ) );
	return box;
}

SweptBox SweptBox::restOf( const SoftBody& body )
{
	if ( body.impl().rigidProxy )
	{
		SweptBox box;
		body.getCollisionShape()->getAabb( body.getWorldTransform(), box.low, box.high );
		return box;
	}
	const SphereRows::Box& whole = body.impl().shape->rows().whole();
	const btVector3 at = body.getWorldTransform().getOrigin();
	return SweptBox{ at + whole.mins(), at + whole.maxs() };
}

SweptBox SweptBox::of( const SoftBody& body, const btVector3& gravity, btScalar step )
{
	SweptBox box = restOf( body );
	if ( body.isActive() )
	{
		const SweptBox displacements = displacementsOf( body, gravity, step );
		box.low += displacements.low;
		box.high += displacements.high;
	}
	return box;
}

SweptNodes::SweptNodes( const SoftBody& body, const btVector3& gravity, btScalar step ) :
	m_body( body ), m_displacements( SweptBox::displacementsOf( body, gravity, step ) ), m_box( SweptBox::restOf( body ) )
{
	m_box.low += m_displacements.low;
	m_box.high += m_displacements.high;
	m_box.grow( body.impl().shape->largestRadius() ); // a split node is replaced by nodes that fill its cube
}

bool SweptNodes::mayTouch( const SweptBox& other ) const
{
	if ( !m_box.overlaps( other ) )
	{
		return false;
	}
	const NodeShape& shape = *m_body.impl().shape;
	const btVector3 at = m_body.getWorldTransform().getOrigin();
	SweptBox reach{ other.low - at - m_displacements.high, other.high - at - m_displacements.low };
	reach.grow( shape.largestRadius() );
	bool isFound = m_body.impl().rigidProxy != nullptr;
	shape.rows().visitOverlaps( SphereRows::Box::of( reach.low, reach.high ), [&isFound]( int ) { isFound = true; } );
	return isFound;
}

SweptBox broadphaseBoxOf( const btCollisionObject& object, const btVector3& gravity, btScalar gameStep )
{
	SweptBox box;
	if ( const SoftBody* const soft = SoftBody::upcast( &object ) )
	{
		box = SweptBox::of( *soft, gravity, gameStep );
		if ( !soft->impl().rigidProxy )
		{
			box.grow( btScalar( kDrawnBeyondSpheres ) * soft->impl().shape->largestRadius() ); // as for the box of the drawn surface
		}
	}
	else if ( const btRigidBody* const rigid = btRigidBody::upcast( &object ) )
	{
		box = SweptBox::of( *rigid, gameStep );
	}
	else
	{
		box = SweptBox::of( object, motionOf( object ), gameStep );
	}
	box.grow( gContactBreakingThreshold + kSweepMargin * ( box.high - box.low ).length() );
	return box;
}

bool isInBroadphaseBox( const btCollisionObject& object )
{
	SweptBox now;
	object.getCollisionShape()->getAabb( object.getWorldTransform(), now.low, now.high );
	const btBroadphaseProxy& known = *object.getBroadphaseHandle();
	for ( int k = 0; k < 3; ++k )
	{
		if ( now.low[k] < known.m_aabbMin[k] || now.high[k] > known.m_aabbMax[k] )
		{
			return false;
		}
	}
	return true;
}

} // namespace pliant
