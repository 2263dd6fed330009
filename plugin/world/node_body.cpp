#include "world/node_body.h"

#include "world/soft_body_impl.h"

#include <algorithm>

namespace pliant {

const char kSoftBodyMark = 0;
const char kNodeBodyMark = 0;

NodeBody::NodeBody() : btRigidBody( btRigidBodyConstructionInfo( btScalar( 1 ), nullptr, nullptr, btVector3( 0, 0, 0 ) ) )
{
	// Inertia and angular factor are zero: friction would spin the spheres and stop resisting the slide.
	setAngularFactor( btVector3( 0, 0, 0 ) );
	internalSetExtensionPointer( const_cast<char*>( &kNodeBodyMark ) );
	setFlags( getFlags() | BT_DISABLE_WORLD_GRAVITY );
}

SoftBody* ownerOfNodeBody( const btCollisionObject* object )
{
	if ( !object || object->internalGetExtensionPointer() != &kNodeBodyMark )
	{
		return nullptr;
	}
	return static_cast<const NodeBody*>( object )->owner;
}

NodeBodyPool::~NodeBodyPool()
{
	for ( NodeBody* body : m_all )
	{
		delete body;
	}
}

NodeBody* NodeBodyPool::acquire( SoftBody& owner, int node )
{
	SoftBody::Impl& impl = owner.impl();
	NodeBody*& place = impl.nodeBody[node];
	if ( !place )
	{
		if ( m_free.empty() )
		{
			m_all.push_back( new NodeBody );
			m_free.push_back( m_all.back() );
		}
		place = m_free.back();
		m_free.pop_back();
		place->owner = &owner;
		place->node = node;
		place->uses = 0;
		place->stamp = m_phase - 1;
		place->setCollisionShape( impl.shape->sphereOfNode( node ) );
		impl.touched.push_back( place );
	}
	++place->uses;
	refresh( *place );
	return place;
}

void NodeBodyPool::release( NodeBody* body )
{
	if ( !body || --body->uses > 0 )
	{
		return;
	}
	SoftBody::Impl& impl = body->owner->impl();
	impl.nodeBody[body->node] = nullptr;
	impl.touched.erase( std::find( impl.touched.begin(), impl.touched.end(), body ) );
	body->owner = nullptr;
	body->setBroadphaseHandle( nullptr );
	m_free.push_back( body );
}

void NodeBodyPool::refresh( NodeBody& body )
{
	if ( body.stamp == m_phase )
	{
		return;
	}
	body.stamp = m_phase;
	SoftBody& owner = *body.owner;
	const SoftBody::Impl& impl = owner.impl();
	const NodeState& nodes = impl.body->nodes();
	const bool moves = nodes.freedom[body.node] != 0.0f && impl.isHealthy;
	body.setMassProps( moves ? btScalar( nodes.mass[body.node] ) : btScalar( 0 ), btVector3( 0, 0, 0 ) );
	int flags = owner.getCollisionFlags() & ~( btCollisionObject::CF_STATIC_OBJECT | btCollisionObject::CF_KINEMATIC_OBJECT );
	flags |= moves ? 0 : btCollisionObject::CF_KINEMATIC_OBJECT; // a pinned node pushes with its own velocity
	body.setCollisionFlags( flags );

	body.written = impl.position( body.node );
	const btTransform at( btQuaternion::getIdentity(), body.written );
	body.setWorldTransform( at );
	body.setInterpolationWorldTransform( at );
	body.setLinearVelocity( impl.velocity( body.node ) );
	body.setInterpolationLinearVelocity( impl.velocity( body.node ) );
	body.setFriction( owner.getFriction() );
	body.setRestitution( owner.getRestitution() );
	body.setRollingFriction( owner.getRollingFriction() );
	body.setSpinningFriction( owner.getSpinningFriction() );
	body.setUserPointer( owner.getUserPointer() );
	body.setUserIndex( owner.getUserIndex() );
	body.setUserIndex2( owner.getUserIndex2() );
	body.setBroadphaseHandle( owner.getBroadphaseHandle() );
	body.setIslandTag( owner.getIslandTag() );
	body.forceActivationState( owner.getActivationState() );
	body.wasAsleep = !owner.isActive();
	if ( !moves )
	{
		body.setGravity( btVector3( 0, 0, 0 ) );
	}
}

} // namespace pliant
