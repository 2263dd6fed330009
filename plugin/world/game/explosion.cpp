// Explosions: the impulse of a shock wave on the surfaces that face it, of soft and of rigid bodies.

#include "lattice/attempt.h"
#include "pliant/soft_body_host.h"
#include "world/bodies/placing.h"
#include "world/bodies/soft_body_impl.h"
#include "world/game/constants.h"
#include "world/step/world_step.h"

#include <BulletCollision/CollisionShapes/btCompoundShape.h>
#include <BulletCollision/CollisionShapes/btConvexShape.h>

#include <cmath>

namespace pliant {

namespace {

void check( const Explosion& explosion )
{
	const bool isGood = isFinite( explosion.centre ) && std::isfinite( explosion.radius ) && explosion.radius > 0 &&
		std::isfinite( explosion.impulse ) && explosion.impulse >= 0 && explosion.falloff >= 0 && explosion.falloff <= kMostFalloff;
	rejectIf( !isGood, ResultCode::BadSettings, "explode: a setting is out of range." );
}

/// On a surface at a distance that faces the centre, N s/m^2.
double impulseAt( const Explosion& explosion, double distance )
{
	const double left = 1.0 - distance / double( explosion.radius );
	return left > 0.0 ? double( explosion.impulse ) * std::pow( left, double( explosion.falloff ) ) : 0.0;
}

/// Whether a static or kinematic object is between the centre and a point.
bool isSheltered( const btCollisionWorld& world, const Explosion& explosion, const btVector3& point )
{
	struct Walls : btCollisionWorld::ClosestRayResultCallback
	{
		using ClosestRayResultCallback::ClosestRayResultCallback;
		bool needsCollision( btBroadphaseProxy* proxy ) const override
		{
			const btCollisionObject* const object = static_cast<const btCollisionObject*>( proxy->m_clientObject );
			return object->isStaticOrKinematicObject() && object->hasContactResponse();
		}
	} walls( explosion.centre, point );
	if ( explosion.isSheltered )
	{
		world.rayTest( explosion.centre, point, walls );
	}
	return walls.hasHit();
}

/// Area of a shape's outline seen along a direction of unit length, m^2. Of shapes that are not convex, that of their box.
double outlineOf( const btCollisionShape& shape, const btTransform& at, const btVector3& direction )
{
	double sum = 0.0;
	if ( shape.isCompound() )
	{
		const btCompoundShape& compound = static_cast<const btCompoundShape&>( shape );
		for ( int k = 0; k < compound.getNumChildShapes(); ++k )
		{
			sum += outlineOf( *compound.getChildShape( k ), at * compound.getChildTransform( k ), direction );
		}
		return sum;
	}
	btVector3 across, up;
	btPlaneSpace1( direction, across, up );
	if ( !shape.isConvex() )
	{
		btVector3 low, high;
		shape.getAabb( at, low, high );
		const btVector3 size = high - low, facing = direction.absolute();
		return double( facing.x() * size.y() * size.z() + facing.y() * size.x() * size.z() + facing.z() * size.x() * size.y() );
	}
	btScalar u[kOutlineDirections], v[kOutlineDirections];
	for ( int k = 0; k < kOutlineDirections; ++k )
	{
		const btScalar angle = SIMD_2_PI * btScalar( k ) / btScalar( kOutlineDirections );
		const btVector3 outwards = across * btCos( angle ) + up * btSin( angle );
		const btVector3 point = at.getBasis() *
			static_cast<const btConvexShape&>( shape ).localGetSupportingVertex( outwards * at.getBasis() );
		u[k] = point.dot( across );
		v[k] = point.dot( up );
	}
	for ( int k = 0; k < kOutlineDirections; ++k )
	{
		const int next = ( k + 1 ) % kOutlineDirections;
		sum += 0.5 * double( u[k] * v[next] - u[next] * v[k] );
	}
	return std::fabs( sum );
}

/// How far a shape reaches from its centre along a direction of unit length, m.
btScalar reachOf( const btCollisionShape& shape, const btTransform& at, const btVector3& direction )
{
	if ( shape.isConvex() )
	{
		return direction.dot(
			at.getBasis() * static_cast<const btConvexShape&>( shape ).localGetSupportingVertex( direction * at.getBasis() ) );
	}
	btVector3 low, high;
	shape.getAabb( at, low, high );
	return direction.absolute().dot( high - low ) / 2;
}

/// The changes of the nodes' velocities, m/s; empty where it does not reach the body.
std::vector<Vec3> pushOf( SoftBody& body, const btCollisionWorld& world, const Explosion& explosion )
{
	SoftBody::Impl& impl = body.impl();
	const NodeState& nodes = impl.body->nodes();
	if ( !impl.forces )
	{
		impl.forces = std::make_unique<SurfaceForces>();
	}
	SurfaceForces& forces = *impl.forces;
	forces.boundary.update( *impl.body, impl.fractureVersion );
	forces.nodeForce.assign( std::size_t( nodes.count ), Vec3d::Zero() );
	const double scale = std::pow( forces.boundary.cells().displaced, 2.0 / 3.0 );
	bool isHit = false;
	for ( int p = 0; p < forces.boundary.count(); ++p )
	{
		const Vec3d at = nodes.origin + forces.boundary.position( p ), away = at - toVec3d( explosion.centre );
		const double distance = away.norm(), impulse = impulseAt( explosion, distance );
		const double facing = distance > 0.0 ? -forces.boundary.area( p ).dot( away ) / distance : 0.0;
		if ( impulse > 0.0 && facing > 0.0 && !isSheltered( world, explosion, toBt( at ) ) )
		{
			isHit = true;
			forces.boundary.forNodes( *impl.body, p, [&]( int node, double fraction ) {
				forces.nodeForce[std::size_t( node )] += fraction * scale * facing * impulse / distance * away;
			} );
		}
	}
	std::vector<Vec3> push( isHit ? std::size_t( nodes.count ) : 0 );
	for ( std::size_t i = 0; i < push.size(); ++i )
	{
		push[i] = nodes.freedom[i] * ( forces.nodeForce[i] / double( nodes.mass[i] ) ).cast<float>();
	}
	return push;
}

struct Push
{
	btCollisionObject* object;
	std::vector<Vec3> nodes; ///< of a soft body, m/s
	btVector3 impulse;       ///< on a rigid one, N s
};

Push pushOf( btRigidBody& body, const btCollisionWorld& world, const Explosion& explosion )
{
	const btVector3 away = body.getCenterOfMassPosition() - explosion.centre;
	const btScalar distance = away.length();
	Push push{ &body, {}, btVector3( 0, 0, 0 ) };
	if ( distance > 0 && !isSheltered( world, explosion, body.getCenterOfMassPosition() ) )
	{
		const btVector3 direction = away / distance;
		const btTransform& at = body.getWorldTransform();
		const btScalar front = btMax( btScalar( 0 ), distance - reachOf( *body.getCollisionShape(), at, -direction ) );
		push.impulse = direction *
			btScalar( impulseAt( explosion, double( front ) ) * outlineOf( *body.getCollisionShape(), at, direction ) );
	}
	return push;
}

bool isTooFast( const Push& push )
{
	if ( const SoftBody* const soft = asSoftBody( push.object ) )
	{
		for ( std::size_t i = 0; i < push.nodes.size(); ++i )
		{
			const Vec3 velocity = soft->impl().body->nodes().v.get( int( i ) ) + push.nodes[i];
			if ( !( velocity.array().abs() <= kSpeedLimit ).all() )
			{
				return true;
			}
		}
	}
	const btRigidBody* const rigid = btRigidBody::upcast( push.object );
	const btVector3 velocity = rigid ? rigid->getLinearVelocity() + push.impulse * rigid->getInvMass() : btVector3( 0, 0, 0 );
	return !isFinite( velocity ) || velocity.absolute()[velocity.absolute().maxAxis()] > btScalar( kSpeedLimit );
}

void apply( const Push& push )
{
	if ( SoftBody* const soft = asSoftBody( push.object ) )
	{
		SoftBody::Impl& impl = soft->impl();
		impl.system->deformNow( *soft );
		NodeState& nodes = impl.body->nodes();
		for ( int i = 0; i < nodes.count; ++i )
		{
			const Vec3& change = push.nodes[std::size_t( i )];
			impl.elasticity.blow += double( nodes.mass[i] * change.squaredNorm() ) / impl.mass;
			nodes.v.set( i, nodes.v.get( i ) + change );
		}
		impl.followVelocities();
		soft->activate( true );
		return;
	}
	btRigidBody::upcast( push.object )->applyCentralImpulse( push.impulse );
	push.object->activate( true );
}

} // namespace

Result<int> SoftBodyHost::explode( const Explosion& explosion )
{
	return attempt( [&]() {
		rejectIf( m_step->bodies.isBusy(), "explode", "a step is in progress." );
		check( explosion );
		std::vector<Push> pushes;
		btCollisionObjectArray& objects = m_step->world().getCollisionObjectArray();
		for ( int k = 0; k < objects.size(); ++k )
		{
			SoftBody* const soft = asSoftBody( objects[k] );
			btRigidBody* const rigid = btRigidBody::upcast( objects[k] );
			if ( objects[k]->isStaticOrKinematicObject() || ( soft && !soft->isHealthy() ) || ( !soft && !rigid ) )
			{
				continue;
			}
			Push push = soft ? Push{ soft, pushOf( *soft, m_step->world(), explosion ), btVector3( 0, 0, 0 ) }
							 : pushOf( *rigid, m_step->world(), explosion );
			rejectIf( isTooFast( push ), "explode", "a node or a rigid body would be faster than 1e5 m/s." );
			if ( !push.nodes.empty() || !push.impulse.isZero() )
			{
				pushes.push_back( std::move( push ) );
			}
		}
		for ( const Push& push : pushes )
		{
			apply( push );
		}
		return Result<int>::success( int( pushes.size() ) );
	} );
}

} // namespace pliant
