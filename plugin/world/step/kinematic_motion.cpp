#include "world/step/kinematic_motion.h"

#include <BulletCollision/CollisionShapes/btCollisionShape.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <algorithm>

namespace pliant {

namespace {

/// Whether a body has been moved, and not put somewhere else: it goes no further than it is wide.
bool isWay( const btRigidBody& body, const btTransform& start, const btTransform& end )
{
	btVector3 centre;
	btScalar radius = 0;
	body.getCollisionShape()->getBoundingSphere( centre, radius );
	return ( end * centre ).distance( start * centre ) <= 2 * radius;
}

} // namespace

void KinematicMotion::noteStarts( const btCollisionObjectArray& objects, int steps )
{
	m_ways.clear();
	m_steps = std::max( steps, 1 );
	m_step = 0;
	for ( int k = 0; k < objects.size(); ++k )
	{
		btCollisionObject& object = *objects[k];
		// Bullet leaves a sleeping one alone.
		btRigidBody* const body = object.isKinematicObject() && object.isActive() ? btRigidBody::upcast( &object ) : nullptr;
		if ( body )
		{
			m_ways.push_back( Way{ body, k, body->getInterpolationWorldTransform(), btTransform::getIdentity(), false } );
		}
	}
}

void KinematicMotion::beginStep( const btCollisionObjectArray& objects )
{
	std::erase_if( m_ways, [&objects]( const Way& way ) {
		return way.index >= objects.size() || objects[way.index] != way.body; // a callback has changed the list
	} );
	for ( Way& way : m_ways )
	{
		way.end = way.body->getWorldTransform();
		way.moves = way.body->isKinematicObject() && !( way.end == way.start ) && isWay( *way.body, way.start, way.end );
	}
	++m_step;
}

btTransform KinematicMotion::poseAt( const Way& way, btScalar fraction ) const
{
	const btScalar t = std::min( ( btScalar( m_step - 1 ) + fraction ) / btScalar( m_steps ), btScalar( 1 ) );
	btTransform pose( way.end.getBasis(), way.start.getOrigin().lerp( way.end.getOrigin(), t ) );
	if ( !( way.start.getBasis() == way.end.getBasis() ) )
	{
		pose.setRotation( way.start.getRotation().slerp( way.end.getRotation(), t ) );
	}
	return pose;
}

void KinematicMotion::place( btScalar fraction )
{
	for ( const Way& way : m_ways )
	{
		if ( way.moves )
		{
			way.body->setWorldTransform( m_step == m_steps && fraction >= 1 ? way.end : poseAt( way, fraction ) );
		}
	}
}

void KinematicMotion::finish()
{
	for ( Way& way : m_ways )
	{
		if ( way.moves )
		{
			way.body->setWorldTransform( way.end );
			way.moves = false;
		}
	}
}

bool KinematicMotion::boxOf( const btCollisionObject& object, btVector3& low, btVector3& high ) const
{
	const auto found = std::find_if( m_ways.begin(), m_ways.end(), [&object]( const Way& way ) { return way.body == &object; } );
	if ( found == m_ways.end() || !found->moves )
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
	const auto found = std::find_if( m_ways.begin(), m_ways.end(), [&object]( const Way& way ) { return way.body == &object; } );
	if ( found != m_ways.end() )
	{
		found->moves ? found->body->setWorldTransform( found->end ) : void(); // a callback takes it out in the middle of a step
		m_ways.erase( found );
	}
}

} // namespace pliant
