#include "world/shape/contact_proxy.h"

#include "world/bodies/soft_body_impl.h"

#include <BulletCollision/CollisionDispatch/btManifoldResult.h>

namespace pliant {

const char kSoftBodyMark = 0;
const char kContactProxyMark = 0;

ContactProxy::ContactProxy( ContactProxyPool& from ) :
	btRigidBody( btRigidBodyConstructionInfo( btScalar( 1 ), nullptr, nullptr, btVector3( 0, 0, 0 ) ) ), pool( &from )
{
	// Inertia and angular factor are zero: otherwise friction would spin the spheres instead of resisting the slide.
	setAngularFactor( btVector3( 0, 0, 0 ) );
	internalSetExtensionPointer( const_cast<char*>( &kContactProxyMark ) );
	setFlags( BT_DISABLE_WORLD_GRAVITY );
}

ContactProxy::~ContactProxy()
{
	if ( pool )
	{
		pool->forget( *this );
	}
}

bool hasContactCallback()
{
	return gContactAddedCallback || gContactProcessedCallback || gContactStartedCallback;
}

ContactProxyPool::~ContactProxyPool()
{
	for ( ContactProxy* body : m_all )
	{
		body->pool = nullptr;
		delete body;
	}
}

void ContactProxyPool::forget( const ContactProxy& body )
{
	std::erase( m_all, &body );
	std::erase( m_free, &body );
}

void ContactProxyPool::detach( SoftBody& owner )
{
	SoftBody::Impl& impl = owner.impl();
	for ( ContactProxy* proxy : impl.touched )
	{
		proxy->node = -1;
		proxy->owner = nullptr;
	}
	impl.touched.clear();
	impl.proxyOfNode.assign( impl.proxyOfNode.size(), nullptr );
}

void NodeSurface::follow( const SoftBody& owner, unsigned step )
{
	if ( m_version != 0 && m_step == step )
	{
		return;
	}
	m_step = step;
	const bool isDirected = owner.hasAnisotropicFriction( btCollisionObject::CF_ANISOTROPIC_FRICTION );
	const Values now{ isDirected ? owner.getAnisotropicFriction() : btVector3( 1, 1, 1 ), owner.getFriction(), owner.getRestitution(),
		owner.getRollingFriction(), owner.getSpinningFriction(), owner.getContactProcessingThreshold(), owner.getContactStiffness(),
		owner.getContactDamping(), ( owner.getCollisionFlags() & btCollisionObject::CF_HAS_CONTACT_STIFFNESS_DAMPING ) != 0,
		{ owner.getUserIndex(), owner.getUserIndex2(), owner.getUserIndex3() }, owner.getUserPointer() };
	if ( m_version == 0 || !( now == m_values ) )
	{
		m_values = now;
		++m_version;
	}
}

void NodeSurface::applyTo( ContactProxy& body ) const
{
	body.setFriction( m_values.friction );
	body.setRestitution( m_values.restitution );
	body.setRollingFriction( m_values.rolling );
	body.setSpinningFriction( m_values.spinning );
	body.setUserPointer( m_values.pointer );
	body.setUserIndex( m_values.index[0] );
	body.setUserIndex2( m_values.index[1] );
	body.setUserIndex3( m_values.index[2] );
	body.setContactProcessingThreshold( m_values.threshold );
	if ( m_values.isSpring )
	{
		body.setContactStiffnessAndDamping( m_values.stiffness, m_values.damping );
	}
	// Proxies pass from owner to owner, so that every property is set again.
	body.setAnisotropicFriction( m_values.slip );
	body.surface = m_version;
}

namespace {

/// The material's axes at a node, which anisotropic friction refers to.
btQuaternion axesAt( const SoftBody& owner, int node )
{
	const SoftBody::Impl& impl = owner.impl();
	const std::size_t count = std::size_t( impl.body->nodeCount() );
	if ( impl.nodeAxes.size() != 4 * count ) // asleep since creation
	{
		impl.nodeAxes.resize( 4 * count );
		impl.body->nodeRotations( impl.nodeAxes.data() );
	}
	const float* const q = impl.nodeAxes.data() + 4 * std::size_t( node );
	return btQuaternion( q[0], q[1], q[2], q[3] );
}

} // namespace

ContactProxy* ContactProxyPool::acquire( SoftBody& owner, int node )
{
	SoftBody::Impl& impl = owner.impl();
	ContactProxy*& slot = impl.proxyOfNode[node];
	if ( !slot )
	{
		if ( m_free.empty() )
		{
			m_all.push_back( new ContactProxy( *this ) );
			m_free.push_back( m_all.back() );
		}
		slot = m_free.back();
		m_free.pop_back();
		slot->owner = &owner;
		slot->node = node;
		slot->uses = 0;
		slot->clearForces();
		slot->stamp = m_phase - 1;
		slot->step = m_step - 1;
		slot->surface = 0;
		slot->setCollisionShape( impl.shape->sphereOfNode( node ) );
		slot->touchedIndex = int( impl.touched.size() );
		impl.touched.push_back( slot );
	}
	++slot->uses;
	refresh( *slot );
	return slot;
}

namespace {

void takeFromTouched( SoftBody::Impl& impl, ContactProxy& body )
{
	impl.touched[body.touchedIndex] = impl.touched.back();
	impl.touched[body.touchedIndex]->touchedIndex = body.touchedIndex;
	impl.touched.pop_back();
}

} // namespace

void ContactProxyPool::release( ContactProxy* body )
{
	if ( !body || --body->uses > 0 )
	{
		return;
	}
	if ( body->node >= 0 )
	{
		SoftBody::Impl& impl = body->owner->impl();
		impl.proxyOfNode[body->node] = nullptr;
		takeFromTouched( impl, *body );
	}
	body->owner = nullptr;
	body->setBroadphaseHandle( body->handle = nullptr );
	m_free.push_back( body );
}

void ContactProxyPool::renumber( SoftBody& owner, const std::vector<std::uint32_t>& nodeNow, int nodeCount )
{
	SoftBody::Impl& impl = owner.impl();
	++impl.numbering;
	impl.proxyOfNode.assign( std::size_t( nodeCount ), nullptr );
	for ( std::size_t k = impl.touched.size(); k-- > 0; )
	{
		ContactProxy& proxy = *impl.touched[k];
		const std::uint32_t now = nodeNow[std::size_t( proxy.node )];
		if ( now == kNoNode )
		{
			takeFromTouched( impl, proxy );
			proxy.node = -1;
			continue;
		}
		proxy.node = int( now );
		impl.proxyOfNode[now] = &proxy;
	}
}

void ContactProxyPool::refresh( ContactProxy& body )
{
	if ( body.stamp == m_phase )
	{
		return;
	}
	body.stamp = m_phase;
	SoftBody& owner = *body.owner;
	SoftBody::Impl& impl = owner.impl();
	const NodeState& nodes = impl.body->nodes();
	const btVector3 velocity = impl.velocity( body.node );
	const bool isFree = impl.isHealthy && nodes.freedom[body.node] != 0.0f && !owner.isStaticOrKinematicObject();
	const btScalar mass = isFree ? btScalar( nodes.mass[body.node] ) : btScalar( 0 );
	if ( mass != body.mass )
	{
		body.setMassProps( mass, btVector3( 0, 0, 0 ) );
		body.mass = mass;
	}
	// A held node moves others only while it moves itself: Bullet keeps everything awake that touches a kinematic body.
	int flags = owner.getCollisionFlags() & ~( btCollisionObject::CF_STATIC_OBJECT | btCollisionObject::CF_KINEMATIC_OBJECT );
	if ( mass == 0 )
	{
		flags |= velocity.isZero() ? btCollisionObject::CF_STATIC_OBJECT : btCollisionObject::CF_KINEMATIC_OBJECT;
	}
	body.setCollisionFlags( flags );

	const btVector3 position = impl.position( body.node );
	body.written = position;
	body.getWorldTransform().setOrigin( position );
	const bool isDirected = owner.hasAnisotropicFriction( btCollisionObject::CF_ANISOTROPIC_FRICTION );
	if ( isDirected )
	{
		body.getWorldTransform().setRotation( axesAt( owner, body.node ) );
	}
	else if ( body.isDirected )
	{
		body.getWorldTransform().getBasis().setIdentity();
	}
	body.isDirected = isDirected;
	const_cast<btVector3&>( body.getLinearVelocity() ) = velocity;
	if ( body.step != m_step ) // otherwise cache lines that are not read stay untouched; a callback of the game may have set them
	{
		body.step = m_step;
		impl.surface.follow( owner, m_step );
		if ( body.surface != impl.surface.version() || m_hadCallback || m_clearsForces )
		{
			impl.surface.applyTo( body );
			body.setInterpolationWorldTransform( body.getWorldTransform() );
			body.setInterpolationLinearVelocity( velocity );
		}
		if ( m_clearsForces )
		{
			body.clearForces();
		}
	}
	if ( body.handle != owner.getBroadphaseHandle() )
	{
		body.setBroadphaseHandle( body.handle = const_cast<btBroadphaseProxy*>( owner.getBroadphaseHandle() ) );
	}
	body.setIslandTag( owner.getIslandTag() );
	body.forceActivationState( owner.getActivationState() );
	body.wasAsleep = !owner.isActive();
}

} // namespace pliant
