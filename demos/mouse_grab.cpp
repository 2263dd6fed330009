// +-----------------------------------------------------------------------------------------------------------------+
// | A rigid body is held by a ball joint, a soft one by springs to the nodes around the point that was hit.           |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/mouse_grab.h"

#include <cmath>

namespace pliant_demos {

namespace {

constexpr btScalar kGrabReach = btScalar( 100 );    // m
constexpr btScalar kGrabCells = btScalar( 2.5 );    // radius of the held ball of nodes, in cells
constexpr btScalar kFrequency = btScalar( 12 );     // rad/s: determines how fast the body follows the mouse
constexpr btScalar kJointImpulse = btScalar( 0.5 ); // N s per kg
constexpr btScalar kJointTau = btScalar( 0.08 );

} // namespace

void MouseGrab::grab( const btVector3& from, const btVector3& direction )
{
	release();
	const btVector3 to = from + direction * kGrabReach;
	btCollisionWorld::ClosestRayResultCallback hit( from, to );
	m_world.rayTest( from, to, hit );
	if ( !hit.hasHit() )
	{
		return;
	}
	m_target = hit.m_hitPointWorld;
	m_distance = ( m_target - from ).length();
	auto* object = const_cast<btCollisionObject*>( hit.m_collisionObject ); // Bullet's callback returns it as const
	m_soft = pliant::SoftBody::upcast( object );
	m_rigid = m_soft == nullptr ? btRigidBody::upcast( object ) : nullptr;
	if ( m_soft != nullptr )
	{
		takeNode( m_target );
	}
	else if ( m_rigid != nullptr && m_rigid->getInvMass() > 0 )
	{
		m_rigid->activate( true );
		m_joint = std::make_unique<btPoint2PointConstraint>( *m_rigid, m_rigid->getWorldTransform().inverse() * m_target );
		m_joint->m_setting.m_impulseClamp = kJointImpulse / m_rigid->getInvMass();
		m_joint->m_setting.m_tau = kJointTau;
		m_world.addConstraint( m_joint.get(), true );
	}
}

void MouseGrab::takeNode( const btVector3& place )
{
	m_node = m_soft->nearestNode( place );
	m_heldAt = m_soft->nodePosition( m_node );
	m_versions = { m_soft->levelVersion(), m_soft->fractureVersion() };
}

void MouseGrab::move( const btVector3& from, const btVector3& direction )
{
	m_target = from + direction * m_distance;
	if ( m_joint != nullptr )
	{
		m_rigid->activate( true );
		m_joint->setPivotB( m_target );
	}
}

void MouseGrab::release()
{
	if ( m_joint != nullptr )
	{
		m_world.removeConstraint( m_joint.get() );
	}
	m_joint.reset();
	m_soft = nullptr;
	m_rigid = nullptr;
}

void MouseGrab::apply()
{
	if ( m_soft == nullptr )
	{
		return;
	}
	if ( m_versions != std::array<unsigned, 2>{ m_soft->levelVersion(), m_soft->fractureVersion() } )
	{
		takeNode( m_heldAt ); // the nodes have been renumbered
	}
	const btVector3 centre = m_soft->nodePosition( m_node );
	m_heldAt = centre;
	const btScalar radius = kGrabCells * btScalar( m_soft->bodyTemplate().cellSize() );
	btScalar held = 0;
	for ( int i = 0; i < m_soft->nodeCount(); ++i )
	{
		held += ( m_soft->nodePosition( i ) - centre ).length() < radius ? m_soft->nodeMass( i ) : 0;
	}
	// The held nodes pull the whole body, so the spring is computed for its mass: f = M (k^2 (target - x) - 2 k v), critically damped.
	const btScalar fraction = m_soft->mass() / held;
	for ( int i = 0; i < m_soft->nodeCount(); ++i )
	{
		if ( ( m_soft->nodePosition( i ) - centre ).length() < radius )
		{
			const btVector3 pull = ( m_target - centre ) * ( kFrequency * kFrequency ) - m_soft->linearVelocity() * ( 2 * kFrequency );
			static_cast<void>(
				m_soft->applyForce( pull * ( m_soft->nodeMass( i ) * fraction ), i ) ); // a force that is too large is refused, and omitted
		}
	}
}

btVector3 MouseGrab::heldPoint() const
{
	return m_soft != nullptr ? m_heldAt : m_joint != nullptr ? m_rigid->getWorldTransform() * m_joint->getPivotInA() : m_target;
}

} // namespace pliant_demos
