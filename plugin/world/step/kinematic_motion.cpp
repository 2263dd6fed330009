#include "world/step/kinematic_motion.h"
#include "world/bodies/soft_body_impl.h"

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

/// The same for a soft body.
bool isContinuous( const SoftBody& body, const std::vector<Vec3d>& start, const std::vector<Vec3d>& end )
{
	const SphereRows::Box& box = body.impl().shape->rows().whole();
	const double width = double( ( box.maxs() - box.mins() ).length() );
	Vec3d sum = Vec3d::Zero();
	for ( std::size_t i = 0; i < start.size(); ++i )
	{
		sum += end[i] - start[i];
	}
	return sum.norm() <= width * double( start.size() );
}

} // namespace

void KinematicMotion::noteStarts( const btCollisionObjectArray& objects, int steps )
{
	m_motions.clear();
	m_steps = std::max( steps, 1 );
	m_step = 0;
	m_softCount = 0;
	for ( int k = 0; k < objects.size(); ++k )
	{
		btCollisionObject& object = *objects[k];
		// Bullet leaves a sleeping one alone.
		btRigidBody* const body = object.isKinematicObject() && object.isActive() ? btRigidBody::upcast( &object ) : nullptr;
		if ( body )
		{
			m_motions.push_back( Motion{ body, k, body->getInterpolationWorldTransform(), btTransform::getIdentity(), false } );
		}
		SoftBody* const soft = object.isKinematicObject() ? asSoftBody( &object ) : nullptr;
		if ( soft && !soft->impl().heldBefore.empty() )
		{
			m_soft.resize( std::max( m_soft.size(), m_softCount + 1 ) );
			NodeMotion& motion = m_soft[m_softCount++];
			motion.body = soft;
			motion.index = k;
			motion.start.assign( soft->impl().heldBefore.begin(), soft->impl().heldBefore.end() );
			motion.moves = false;
		}
	}
}

void KinematicMotion::beginStep( const btCollisionObjectArray& objects, btScalar seconds )
{
	m_seconds = seconds;
	std::erase_if( m_motions, [&objects]( const Motion& motion ) {
		return motion.index >= objects.size() || objects[motion.index] != motion.body; // a callback has changed the list
	} );
	for ( Motion& motion : m_motions )
	{
		motion.end = motion.body->getWorldTransform();
		motion.moves = motion.body->isKinematicObject() && !( motion.end == motion.start ) &&
			isContinuous( *motion.body, motion.start, motion.end );
	}
	for ( NodeMotion& motion : soft() )
	{
		const bool isThere = motion.index < objects.size() && objects[motion.index] == motion.body && motion.body->isKinematicObject();
		const std::vector<Vec3d>* const now = isThere ? &motion.body->impl().heldBefore : nullptr;
		motion.moves = now && now->size() == motion.start.size() && *now != motion.start &&
			isContinuous( *motion.body, motion.start, *now );
		if ( motion.moves )
		{
			motion.end.assign( now->begin(), now->end() );
		}
	}
	++m_step;
}

btScalar KinematicMotion::fractionOfAll( btScalar fraction ) const
{
	return m_step == m_steps && fraction >= 1 ? btScalar( 1 )
											  : std::min( ( btScalar( m_step - 1 ) + fraction ) / btScalar( m_steps ), btScalar( 1 ) );
}

void KinematicMotion::place( NodeMotion& motion, double fraction ) const
{
	SoftBody::Impl& impl = motion.body->impl();
	NodeState& nodes = impl.body->nodes();
	const double time = double( m_seconds ) * double( m_steps );
	if ( motion.start.size() != std::size_t( nodes.count ) )
	{
		return; // a callback has changed its nodes
	}
	for ( int i = 0; i < nodes.count; ++i )
	{
		const Vec3d &start = motion.start[std::size_t( i )], &end = motion.end[std::size_t( i )];
		const Vec3d at = fraction >= 1.0 ? end : Vec3d( start + fraction * ( end - start ) );
		nodes.x.set( i, ( at - nodes.origin ).cast<float>() );
		nodes.v.set( i, ( ( end - start ) / time ).cast<float>() );
	}
	impl.placeShape( *motion.body );
	impl.skin.nodesMoved();
}

btTransform KinematicMotion::poseAt( const Motion& motion, btScalar fraction ) const
{
	const btScalar t = fractionOfAll( fraction );
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
	for ( NodeMotion& motion : soft() )
	{
		motion.moves ? place( motion, double( fractionOfAll( fraction ) ) ) : void();
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
	for ( NodeMotion& motion : soft() )
	{
		motion.moves ? place( motion, 1.0 ) : void();
		motion.moves = false;
	}
}

bool KinematicMotion::boxOf( const NodeMotion& motion, btVector3& low, btVector3& high ) const
{
	if ( !motion.moves )
	{
		return false;
	}
	Vec3d least = Vec3d::Zero(), most = Vec3d::Zero();
	for ( std::size_t i = 0; i < motion.start.size(); ++i )
	{
		least = least.cwiseMin( motion.start[i] - motion.end[i] );
		most = most.cwiseMax( motion.start[i] - motion.end[i] );
	}
	const btCollisionObject& object = *motion.body;
	object.getCollisionShape()->getAabb( object.getWorldTransform(), low, high );
	low += toBt( least );
	high += toBt( most );
	return true;
}

bool KinematicMotion::boxOf( const btCollisionObject& object, btVector3& low, btVector3& high ) const
{
	for ( const NodeMotion& motion : soft() )
	{
		if ( motion.body == &object )
		{
			return boxOf( motion, low, high );
		}
	}
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
	for ( NodeMotion& motion : soft() )
	{
		if ( motion.body == &object )
		{
			motion.moves ? place( motion, 1.0 ) : void();
			motion = std::move( m_soft[--m_softCount] );
			break;
		}
	}
	const auto found = std::find_if(
		m_motions.begin(), m_motions.end(), [&object]( const Motion& motion ) { return motion.body == &object; } );
	if ( found != m_motions.end() )
	{
		found->moves ? found->body->setWorldTransform( found->end ) : void(); // a callback takes it out in the middle of a step
		m_motions.erase( found );
	}
}

} // namespace pliant
