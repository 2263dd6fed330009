#include "world/step/kinematic_motion.h"

#include <BulletCollision/CollisionShapes/btCollisionShape.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <algorithm>

namespace pliant {

namespace {

/// Whether a body has been moved and not teleported: by no more than its width.
bool isContinuous( const btRigidBody& body, const btTransform& start, const btTransform& end )
{
	btVector3 centre;
	btScalar radius = 0;
	body.getCollisionShape()->getBoundingSphere( centre, radius );
	return ( end * centre ).distance( start * centre ) <= 2 * radius;
}

} // namespace

void KinematicMotion::noteStarts( const btCollisionObjectArray& objects, int steps )
{
	m_motions.clear();
	m_steps = std::max( steps, 1 );
	m_step = 0;
	for ( int k = 0; k < objects.size(); ++k )
	{
		btCollisionObject& object = *objects[k];
		// Bullet leaves a sleeping one alone.
		btRigidBody* const body = object.isKinematicObject() && object.isActive() ? btRigidBody::upcast( &object ) : nullptr;
		if ( body )
		{
			m_motions.push_back( Motion{ body, k, body->getInterpolationWorldTransform(), btTransform::getIdentity(), false } );
		}
	}
}

void KinematicMotion::beginStep( const btCollisionObjectArray& objects )
{
	std::erase_if( m_motions, [&objects]( const Motion& motion ) {
		return motion.index >= objects.size() || objects[motion.index] != motion.body; // a callback has changed the list
	} );
	for ( Motion& motion : m_motions )
	{
		motion.end = motion.body->getWorldTransform();
		motion.moves = motion.body->isKinematicObject() && !( motion.end == motion.start ) &&
			isContinuous( *motion.body, motion.start, motion.end );
	}
	++m_step;
}

btTransform KinematicMotion::poseAt( const Motion& motion, btScalar fraction ) const
{
	const btScalar t = std::min( ( btScalar( m_step - 1 ) + fraction ) / btScalar( m_steps ), btScalar( 1 ) );
	btTransform pose( motion.end.getBasis(), motion.start.getOrigin().lerp( motion.end.getOrigin(), t ) );
	if ( !( motion.start.getBasis() == motion.end.getBasis() ) )
	{
		pose.setRotation( motion.start.getRotation().slerp( motion.end.getRotation(), t ) );
	}
	return pose;
}

void KinematicMotion::place( btScalar fraction )
{
	for ( const Motion& motion : m_motions )
	{
		if ( motion.moves )
		{
			motion.body->setWorldTransform( m_step == m_steps && fraction >= 1 ? motion.end : poseAt( motion, fraction ) );
		}
	}
}

void KinematicMotion::finish()
{
	for ( Motion& motion : m_motions )
	{
		if ( motion.moves )
		{
			motion.body->setWorldTransform( motion.end );
			motion.moves = false;
		}
	}
}

bool KinematicMotion::boxOf( const btCollisionObject& object, btVector3& low, btVector3& high ) const
{
	const auto found = std::find_if(
		m_motions.begin(), m_motions.end(), [&object]( const Motion& motion ) { return motion.body == &object; } );
	if ( found == m_motions.end() || !found->moves )
	{
		return false;
	}
	btVector3 least, most;
	object.getCollisionShape()->getAabb( poseAt( *found, 0 ), low, high );
	object.getCollisionShape()->getAabb( found->end, least, most );
	low.setMin( least );
	high.setMax( most );
	const btVector3 margin( gContactBreakingThreshold, gContactBreakingThreshold, gContactBreakingThreshold ); // as Bullet's
	low -= margin;
	high += margin;
	return true;
}

void KinematicMotion::forget( const btCollisionObject& object )
{
	const auto found = std::find_if(
		m_motions.begin(), m_motions.end(), [&object]( const Motion& motion ) { return motion.body == &object; } );
	if ( found != m_motions.end() )
	{
		found->moves ? found->body->setWorldTransform( found->end ) : void(); // a callback takes it out in the middle of a step
		m_motions.erase( found );
	}
}

} // namespace pliant
