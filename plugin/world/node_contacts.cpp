#include "world/node_contacts.h"

#include "world/constants.h"
#include "world/soft_body_impl.h"

#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionDispatch/btManifoldResult.h>
#include <BulletCollision/CollisionShapes/btBoxShape.h>
#include <BulletCollision/CollisionShapes/btConcaveShape.h>
#include <BulletCollision/CollisionShapes/btStaticPlaneShape.h>

#include <algorithm>
#include <new>

namespace pliant {

namespace {

/// The soft body itself only: a node's stand-in meeting a compound is Bullet's business.
SoftBody* softOf( const btCollisionObjectWrapper* wrapper )
{
	return asSoftBody( const_cast<btCollisionObject*>( wrapper->getCollisionObject() ) );
}

/// The nearest point of a shape to a sphere's centre, for the shapes that have it in closed form.
struct Nearest
{
	btVector3 normal;  ///< out of the shape, towards the sphere
	btScalar distance; ///< of the centre from the surface, negative inside
};

bool hasClosedForm( const btCollisionShape* shape )
{
	const int type = shape->getShapeType();
	return type == STATIC_PLANE_PROXYTYPE || type == SPHERE_SHAPE_PROXYTYPE || type == BOX_SHAPE_PROXYTYPE;
}

Nearest nearestOnBox( const btBoxShape& box, const btVector3& p )
{
	const btVector3 half = box.getHalfExtentsWithMargin();
	btVector3 inside = p;
	inside.setMin( half );
	inside.setMax( -half );
	const btVector3 out = p - inside;
	const btScalar length = out.length();
	if ( length > 0 )
	{
		return { out / length, length };
	}
	// Inside: out through the nearest face.
	int axis = 0;
	for ( int k = 1; k < 3; ++k )
	{
		axis = half[k] - btFabs( p[k] ) < half[axis] - btFabs( p[axis] ) ? k : axis;
	}
	btVector3 normal( 0, 0, 0 );
	normal[axis] = p[axis] < 0 ? btScalar( -1 ) : btScalar( 1 );
	return { normal, btFabs( p[axis] ) - half[axis] };
}

/// `offset`: the sphere's centre relative to the shape's own origin, world axes (taken before rounding to world coordinates).
Nearest nearestOn( const btCollisionShape* shape, const btMatrix3x3& basis, const btVector3& offset )
{
	const btVector3 p = basis.transpose() * offset;
	switch ( shape->getShapeType() )
	{
		case STATIC_PLANE_PROXYTYPE:
		{
			const auto& plane = *static_cast<const btStaticPlaneShape*>( shape );
			return { basis * plane.getPlaneNormal(), plane.getPlaneNormal().dot( p ) - plane.getPlaneConstant() };
		}
		case SPHERE_SHAPE_PROXYTYPE:
		{
			const btScalar length = p.length();
			const btVector3 normal = length > 0 ? offset / length : btVector3( 0, 1, 0 );
			return { normal, length - static_cast<const btSphereShape*>( shape )->getRadius() };
		}
		default:
		{
			const Nearest nearest = nearestOnBox( *static_cast<const btBoxShape*>( shape ), p );
			return { basis * nearest.normal, nearest.distance };
		}
	}
}

/// Marks the nodes whose boxes meet a triangle's box.
struct TriangleCandidates : btTriangleCallback
{
	TriangleCandidates( const NodeShape& s, const btTransform& t, std::vector<std::uint64_t>& to ) : shape( s ), meshToShape( t ), keys( to ) {}

	void processTriangle( btVector3* triangle, int, int ) override
	{
		btVector3 low = meshToShape * triangle[0], high = low;
		for ( int k = 1; k < 3; ++k )
		{
			const btVector3 corner = meshToShape * triangle[k];
			low.setMin( corner );
			high.setMax( corner );
		}
		shape.visitOverlaps( low, high, [&]( int child ) { keys.push_back( std::uint64_t( shape.nodeOfChild( child ) ) ); } );
	}

	const NodeShape& shape;
	btTransform meshToShape;
	std::vector<std::uint64_t>& keys;
};

} // namespace

PairContacts::~PairContacts()
{
	for ( NodeContact& contact : m_contacts )
	{
		drop( contact );
	}
}

void PairContacts::drop( NodeContact& contact )
{
	// Manifolds before the bodies they name.
	if ( contact.manifold )
	{
		m_dispatcher.releaseManifold( contact.manifold );
	}
	if ( contact.algorithm )
	{
		contact.algorithm->~btCollisionAlgorithm();
		m_dispatcher.freeCollisionAlgorithm( contact.algorithm );
	}
	m_pool.release( contact.first );
	m_pool.release( contact.second );
	contact = NodeContact{};
}

void PairContacts::collectManifolds( btManifoldArray& manifolds ) const
{
	for ( const NodeContact& contact : m_contacts )
	{
		if ( contact.manifold )
		{
			manifolds.push_back( contact.manifold );
		}
		if ( contact.algorithm )
		{
			contact.algorithm->getAllContactManifolds( manifolds );
		}
	}
}

void PairContacts::process(
	const btCollisionObjectWrapper* body0, const btCollisionObjectWrapper* body1, const btDispatcherInfo& info, btManifoldResult& result )
{
	SoftBody* const soft0 = softOf( body0 );
	SoftBody* const soft1 = softOf( body1 );
	if ( soft0 && soft1 )
	{
		processSoft( *soft0, *soft1, info, result );
	}
	else if ( soft0 )
	{
		processRigid( *soft0, Side{ body0, true }, body1, info, result );
	}
	else if ( soft1 )
	{
		processRigid( *soft1, Side{ body1, false }, body0, info, result );
	}
}

void PairContacts::findCandidates( SoftBody& soft, const btCollisionObjectWrapper* other, btScalar step )
{
	const SoftBody::Impl& impl = soft.impl();
	const NodeShape& shape = *impl.shape;
	const NodeState& nodes = impl.body->nodes();
	const btCollisionShape* otherShape = other->getCollisionShape();
	const btTransform& at = other->getWorldTransform();
	if ( otherShape->getShapeType() == STATIC_PLANE_PROXYTYPE )
	{
		// A plane's box is everywhere: the test is the distance itself, as far as the node can come in this step.
		const btVector3 origin = impl.worldOrigin() - at.getOrigin();
		for ( int i = 0; i < nodes.count; ++i )
		{
			const Nearest nearest = nearestOn( otherShape, at.getBasis(), origin + btVector3( nodes.x.x[i], nodes.x.y[i], nodes.x.z[i] ) );
			const btScalar approach = btMax( btScalar( 0 ), -nearest.normal.dot( impl.velocity( i ) ) * step );
			if ( nearest.distance <= shape.sphereOfNode( i )->getRadius() * ( 1 + kContactSlop ) + approach )
			{
				m_candidates.push_back( std::uint64_t( i ) );
			}
		}
		return;
	}

	btTransform inShape = at;
	inShape.setOrigin( at.getOrigin() - impl.worldOrigin() );
	if ( otherShape->isConcave() )
	{
		const btTransform shapeInMesh = inShape.inverse();
		btVector3 low, high, centre = btScalar( 0.5 ) * ( shape.tree().m_root->volume.Mins() + shape.tree().m_root->volume.Maxs() );
		const btVector3 half = btScalar( 0.5 ) * ( shape.tree().m_root->volume.Maxs() - shape.tree().m_root->volume.Mins() );
		const btVector3 reach = shapeInMesh.getBasis().absolute() * half;
		centre = shapeInMesh * centre;
		low = centre - reach;
		high = centre + reach;
		TriangleCandidates marks( shape, inShape, m_candidates );
		static_cast<const btConcaveShape*>( otherShape )->processAllTriangles( &marks, low, high );
	}
	else
	{
		btVector3 low, high;
		otherShape->getAabb( inShape, low, high );
		shape.visitOverlaps( low, high, [&]( int child ) { m_candidates.push_back( std::uint64_t( shape.nodeOfChild( child ) ) ); } );
	}
	std::sort( m_candidates.begin(), m_candidates.end() );
	m_candidates.erase( std::unique( m_candidates.begin(), m_candidates.end() ), m_candidates.end() );
}

// Keeps the contacts whose key is a candidate still, drops the others, opens new ones, all in the order of the keys.
void PairContacts::matchEntries()
{
	m_next.clear();
	std::size_t old = 0;
	for ( const std::uint64_t key : m_candidates )
	{
		for ( ; old < m_contacts.size() && m_contacts[old].key < key; ++old )
		{
			drop( m_contacts[old] );
		}
		if ( old < m_contacts.size() && m_contacts[old].key == key )
		{
			m_next.push_back( m_contacts[old++] );
			continue;
		}
		NodeContact fresh;
		fresh.key = key;
		m_next.push_back( fresh );
	}
	for ( ; old < m_contacts.size(); ++old )
	{
		drop( m_contacts[old] );
	}
	m_contacts.swap( m_next );
}

void PairContacts::processRigid( SoftBody& soft, const Side& softSide, const btCollisionObjectWrapper* other, const btDispatcherInfo& info,
	btManifoldResult& result )
{
	m_candidates.clear();
	findCandidates( soft, other, info.m_timeStep );
	matchEntries();
	const bool closed = hasClosedForm( other->getCollisionShape() );
	for ( NodeContact& contact : m_contacts )
	{
		if ( !contact.first )
		{
			contact.first = m_pool.acquire( soft, int( contact.key ) );
		}
		m_pool.refresh( *contact.first );
		if ( closed )
		{
			closedForm( contact, other, softSide.isFirst, info.m_timeStep, result );
		}
		else
		{
			stockForm( contact, other, softSide.isFirst, info, result );
		}
	}
}

namespace {

/// A manifold of ours with its one point brought up to date; `depth` is the signed distance of the two surfaces.
struct ContactPoint
{
	btVector3 normalOnSecond;
	btVector3 pointOnSecond;
	btScalar depth;
};

void updateManifold( btPersistentManifold* manifold, const ContactPoint& point, btScalar reach, btManifoldResult& result )
{
	manifold->setContactBreakingThreshold( reach );
	result.setPersistentManifold( manifold );
	if ( manifold->getNumContacts() > 0 )
	{
		// The node's sphere touches in one point: a slid point is moved, not joined by a second one.
		btManifoldPoint& kept = manifold->getContactPoint( 0 );
		const btVector3 onFirst = point.pointOnSecond + point.normalOnSecond * point.depth;
		if ( point.depth > reach )
		{
			manifold->clearManifold();
			return;
		}
		kept.m_localPointA = manifold->getBody0()->getWorldTransform().invXform( onFirst );
		kept.m_localPointB = manifold->getBody1()->getWorldTransform().invXform( point.pointOnSecond );
		kept.m_positionWorldOnA = onFirst;
		kept.m_positionWorldOnB = point.pointOnSecond;
		kept.m_normalWorldOnB = point.normalOnSecond;
		kept.m_distance1 = point.depth;
		++kept.m_lifeTime;
		kept.m_combinedFriction = btManifoldResult::calculateCombinedFriction( manifold->getBody0(), manifold->getBody1() );
		kept.m_combinedRestitution = btManifoldResult::calculateCombinedRestitution( manifold->getBody0(), manifold->getBody1() );
		return;
	}
	result.addContactPoint( point.normalOnSecond, point.pointOnSecond, point.depth );
}

} // namespace

void PairContacts::closedForm(
	NodeContact& contact, const btCollisionObjectWrapper* other, bool softIsFirst, btScalar step, btManifoldResult& result )
{
	const SoftBody::Impl& impl = contact.first->owner->impl();
	const NodeState& nodes = impl.body->nodes();
	const int i = contact.first->node;
	const btTransform& at = other->getWorldTransform();
	const btVector3 offset = ( impl.worldOrigin() - at.getOrigin() ) + btVector3( nodes.x.x[i], nodes.x.y[i], nodes.x.z[i] );
	const Nearest nearest = nearestOn( other->getCollisionShape(), at.getBasis(), offset );
	const btScalar radius = static_cast<const btSphereShape*>( contact.first->getCollisionShape() )->getRadius();
	const btScalar depth = nearest.distance - radius;

	// Far enough ahead that nothing passes in this step: Bullet's solver lets a gap close within the step, and no further.
	btVector3 relative = contact.first->getLinearVelocity();
	if ( const btRigidBody* rigid = btRigidBody::upcast( other->getCollisionObject() ) )
	{
		relative -= rigid->getVelocityInLocalPoint( contact.first->written - rigid->getCenterOfMassPosition() );
	}
	const btScalar reach = radius * kContactSlop + btMax( btScalar( 0 ), -nearest.normal.dot( relative ) * step );
	if ( !contact.manifold )
	{
		if ( depth > reach )
		{
			return;
		}
		contact.manifold = m_dispatcher.getNewManifold( softIsFirst ? contact.first : const_cast<btCollisionObject*>( other->getCollisionObject() ),
			softIsFirst ? const_cast<btCollisionObject*>( other->getCollisionObject() ) : contact.first );
	}

	const btCollisionObjectWrapper node( nullptr, contact.first->getCollisionShape(), contact.first, contact.first->getWorldTransform(), -1, i );
	const btVector3 onOther = contact.first->written - nearest.normal * nearest.distance;
	const btVector3 onNode = contact.first->written - nearest.normal * radius;
	const btCollisionObjectWrapper* const saved0 = result.getBody0Wrap();
	const btCollisionObjectWrapper* const saved1 = result.getBody1Wrap();
	if ( softIsFirst )
	{
		result.setBody0Wrap( &node );
		result.setShapeIdentifiersA( -1, i );
		updateManifold( contact.manifold, ContactPoint{ nearest.normal, onOther, depth }, reach, result );
	}
	else
	{
		result.setBody1Wrap( &node );
		result.setShapeIdentifiersB( -1, i );
		updateManifold( contact.manifold, ContactPoint{ -nearest.normal, onNode, depth }, reach, result );
	}
	result.setBody0Wrap( saved0 );
	result.setBody1Wrap( saved1 );
}

void PairContacts::stockForm( NodeContact& contact, const btCollisionObjectWrapper* other, bool softIsFirst, const btDispatcherInfo& info,
	btManifoldResult& result )
{
	const btCollisionObjectWrapper node(
		nullptr, contact.first->getCollisionShape(), contact.first, contact.first->getWorldTransform(), -1, contact.first->node );
	const btCollisionObjectWrapper* const first = softIsFirst ? &node : other;
	const btCollisionObjectWrapper* const second = softIsFirst ? other : &node;
	if ( !contact.algorithm )
	{
		// No manifold is handed over: an algorithm that does not own its manifold never refreshes it.
		contact.algorithm = m_dispatcher.findAlgorithm( first, second, nullptr, BT_CONTACT_POINT_ALGORITHMS );
	}
	const btCollisionObjectWrapper* const saved0 = result.getBody0Wrap();
	const btCollisionObjectWrapper* const saved1 = result.getBody1Wrap();
	result.setBody0Wrap( first );
	result.setBody1Wrap( second );
	softIsFirst ? result.setShapeIdentifiersA( -1, contact.first->node ) : result.setShapeIdentifiersB( -1, contact.first->node );
	contact.algorithm->processCollision( first, second, info, &result );
	result.setBody0Wrap( saved0 );
	result.setBody1Wrap( saved1 );
}

void PairContacts::findSoftCandidates( SoftBody& a, SoftBody& b )
{
	const NodeShape& shapeA = *a.impl().shape;
	const NodeShape& shapeB = *b.impl().shape;
	const btVector3 shift = b.impl().worldOrigin() - a.impl().worldOrigin(); // from b's coordinates to a's
	btVector3 low = shapeB.tree().m_root->volume.Mins() + shift, high = shapeB.tree().m_root->volume.Maxs() + shift;
	shapeA.visitOverlaps( low, high, [&]( int childA ) {
		const btTransform& at = shapeA.getChildTransform( childA );
		const btScalar r = shapeA.radius( childA ) * ( 1 + kContactSlop );
		const btVector3 around( r, r, r );
		const btVector3 p = at.getOrigin() - shift;
		shapeB.visitOverlaps( p - around, p + around, [&]( int childB ) {
			m_candidates.push_back( std::uint64_t( shapeA.nodeOfChild( childA ) ) << 32 | std::uint64_t( shapeB.nodeOfChild( childB ) ) );
		} );
	} );
	std::sort( m_candidates.begin(), m_candidates.end() );
}

void PairContacts::processSoft( SoftBody& a, SoftBody& b, const btDispatcherInfo& info, btManifoldResult& result )
{
	m_candidates.clear();
	findSoftCandidates( a, b );
	matchEntries();
	for ( NodeContact& contact : m_contacts )
	{
		if ( !contact.first )
		{
			contact.first = m_pool.acquire( a, int( contact.key >> 32 ) );
			contact.second = m_pool.acquire( b, int( contact.key & 0xffffffffu ) );
		}
		m_pool.refresh( *contact.first );
		m_pool.refresh( *contact.second );
		softSoft( contact, info.m_timeStep, result );
	}
}

void PairContacts::softSoft( NodeContact& contact, btScalar step, btManifoldResult& result )
{
	const auto radiusOf = []( const NodeBody& body ) { return static_cast<const btSphereShape*>( body.getCollisionShape() )->getRadius(); };
	const btVector3 between = contact.first->written - contact.second->written;
	const btScalar length = between.length();
	const btVector3 normal = length > 0 ? between / length : btVector3( 0, 1, 0 );
	const btScalar depth = length - radiusOf( *contact.first ) - radiusOf( *contact.second );
	const btScalar approach = -normal.dot( contact.first->getLinearVelocity() - contact.second->getLinearVelocity() ) * step;
	const btScalar reach = radiusOf( *contact.first ) * kContactSlop + btMax( btScalar( 0 ), approach );
	if ( !contact.manifold )
	{
		if ( depth > reach )
		{
			return;
		}
		contact.manifold = m_dispatcher.getNewManifold( contact.first, contact.second );
	}
	const btCollisionObjectWrapper first(
		nullptr, contact.first->getCollisionShape(), contact.first, contact.first->getWorldTransform(), -1, contact.first->node );
	const btCollisionObjectWrapper second(
		nullptr, contact.second->getCollisionShape(), contact.second, contact.second->getWorldTransform(), -1, contact.second->node );
	const btCollisionObjectWrapper* const saved0 = result.getBody0Wrap();
	const btCollisionObjectWrapper* const saved1 = result.getBody1Wrap();
	result.setBody0Wrap( &first );
	result.setBody1Wrap( &second );
	result.setShapeIdentifiersA( -1, contact.first->node );
	result.setShapeIdentifiersB( -1, contact.second->node );
	updateManifold( contact.manifold, ContactPoint{ normal, contact.second->written + normal * radiusOf( *contact.second ), depth }, reach, result );
	result.setBody0Wrap( saved0 );
	result.setBody1Wrap( saved1 );
}

NodeAlgorithm::NodeAlgorithm( const btCollisionAlgorithmConstructionInfo& info, NodeBodyPool& pool ) :
	btCollisionAlgorithm( info ), m_contacts( new PairContacts( *info.m_dispatcher1, pool ) )
{
}

NodeAlgorithm::~NodeAlgorithm()
{
	delete m_contacts;
}

void NodeAlgorithm::processCollision( const btCollisionObjectWrapper* body0, const btCollisionObjectWrapper* body1,
	const btDispatcherInfo& info, btManifoldResult* result )
{
	m_contacts->process( body0, body1, info, *result );
}

btCollisionAlgorithm* NodeCreateFunc::CreateCollisionAlgorithm(
	btCollisionAlgorithmConstructionInfo& info, const btCollisionObjectWrapper* body0, const btCollisionObjectWrapper* body1 )
{
	if ( !softOf( body0 ) && !softOf( body1 ) )
	{
		return m_before->CreateCollisionAlgorithm( info, body0, body1 );
	}
	void* const room = info.m_dispatcher1->allocateCollisionAlgorithm( sizeof( NodeAlgorithm ) );
	return new ( room ) NodeAlgorithm( info, m_pool );
}

} // namespace pliant
