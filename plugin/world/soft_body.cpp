#include "pliant/soft_body.h"

#include "world/constants.h"
#include "world/soft_body_impl.h"
#include "world/soft_body_system.h"

#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <algorithm>
#include <cmath>
#include <new>

namespace pliant {

namespace {

Eigen::Quaterniond rotationOf( const btTransform& t )
{
	const btQuaternion q = t.getRotation();
	return Eigen::Quaterniond( q.w(), q.x(), q.y(), q.z() ).normalized();
}

/// Where the lattice's mass centre goes when its mesh goes through `t`.
Placement placementOf( const Lattice& lattice, const btTransform& t )
{
	const Eigen::Quaterniond rotation = rotationOf( t );
	return Placement{ rotation, rotation * lattice.massCentre + toVec3d( t.getOrigin() ) };
}

} // namespace

void SoftBody::Impl::placeSpheres( btCollisionObject& object, const MotionSums& motion, TaskRunner* runner )
{
	const NodeState& nodes = body->nodes();
	mass = motion.mass;
	meanSquareSpeed = motion.squareSpeed / mass;
	const Vec3d centre = Vec3d( motion.moment ) / mass;
	const btTransform at( btQuaternion::getIdentity(), toBt( nodes.origin + centre ) );
	shapeShift = ( toVec3d( at.getOrigin() ) - nodes.origin ).cast<float>();
	shape->place( nodes, shapeShift, runner );
	object.setWorldTransform( at );
	object.setInterpolationWorldTransform( at );
}

void SoftBody::Impl::placeShape( btCollisionObject& object )
{
	placeSpheres( object, body->measureMotion() );
	shape->freshen();
}

void SoftBody::Impl::finish( SoftBody& owner )
{
	shape = std::make_unique<NodeShape>( *body );
	nodeBody.assign( std::size_t( body->nodeCount() ), nullptr );
	owner.m_internalType = CO_USER_TYPE;
	owner.m_collisionFlags &= ~CF_STATIC_OBJECT; // Bullet's objects are born static
	owner.internalSetExtensionPointer( const_cast<char*>( &kSoftBodyMark ) );
	owner.setCollisionShape( shape.get() );
	placeShape( owner );
}

SoftBody* asSoftBody( btCollisionObject* object )
{
	const bool isOurs = object && object->internalGetExtensionPointer() == &kSoftBodyMark;
	return isOurs ? static_cast<SoftBody*>( object ) : nullptr;
}

SoftBody::SoftBody() = default;

SoftBodyResult SoftBody::create( std::shared_ptr<const BodyTemplate> bodyTemplate, const btTransform& transform, const Material& material,
	const Adaptivity& adaptivity, const StiffnessField& stiffness )
{
	if ( !bodyTemplate )
	{
		return SoftBodyResult::failure( ResultCode::BadArgument, "SoftBody::create needs a template." );
	}
	if ( !isFinite( transform ) )
	{
		return SoftBodyResult::failure( ResultCode::BadArgument, "SoftBody::create: the transform holds a number that is not finite." );
	}
	try
	{
		Result<std::unique_ptr<Body>> made = Body::create(
			bodyTemplate->sharedLattice(), material, placementOf( bodyTemplate->lattice(), transform ), bodyTemplate->cache(), adaptivity, stiffness );
		if ( !made )
		{
			return SoftBodyResult{ std::move( made.status ), nullptr };
		}
		std::unique_ptr<SoftBody> soft( new SoftBody );
		soft->m_impl = std::make_unique<Impl>();
		Impl& impl = *soft->m_impl;
		impl.bodyTemplate = std::move( bodyTemplate );
		impl.body = std::move( made.value );
		impl.finish( *soft );
		return SoftBodyResult::success( std::move( soft ) );
	}
	catch ( const std::bad_alloc& )
	{
		return SoftBodyResult::failure( ResultCode::OutOfMemory, "Not enough memory for a soft body of this many cells." );
	}
}

SoftBody::~SoftBody()
{
	if ( m_impl && m_impl->system )
	{
		m_impl->system->forget( *this );
	}
}

SoftBody* SoftBody::upcast( btCollisionObject* object )
{
	SoftBody* const soft = asSoftBody( object );
	return soft ? soft : ownerOfNodeBody( object );
}

const SoftBody* SoftBody::upcast( const btCollisionObject* object )
{
	return upcast( const_cast<btCollisionObject*>( object ) );
}

int SoftBody::nodeCount() const
{
	return m_impl->body->nodeCount();
}

int SoftBody::nodeOfShapeIndex( int shapeIndex ) const
{
	const bool isChild = shapeIndex >= 0 && shapeIndex < m_impl->shape->getNumChildShapes();
	return isChild ? m_impl->shape->nodeOfChild( shapeIndex ) : -1;
}

btVector3 SoftBody::nodePosition( int node ) const
{
	return m_impl->position( node );
}

btVector3 SoftBody::nodeVelocity( int node ) const
{
	return m_impl->velocity( node );
}

btScalar SoftBody::nodeMass( int node ) const
{
	return m_impl->body->nodes().mass[node];
}

btScalar SoftBody::nodeRadius( int node ) const
{
	return m_impl->shape->sphereOfNode( node )->getRadius();
}

int SoftBody::nearestNode( const btVector3& worldPoint ) const
{
	const NodeState& nodes = m_impl->body->nodes();
	const btVector3 point = worldPoint - m_impl->worldOrigin();
	const bool hasLevels = m_impl->body->levels() != nullptr;
	int best = 0;
	btScalar bestDistance = SIMD_INFINITY;
	for ( int i = 0; i < nodes.count; ++i )
	{
		btScalar distance = ( btVector3( nodes.x.x[i], nodes.x.y[i], nodes.x.z[i] ) - point ).length2();
		if ( hasLevels )
		{
			distance = btSqrt( distance ) - nodeRadius( i ); // a big node is near from further away
		}
		if ( distance < bestDistance )
		{
			bestDistance = distance;
			best = i;
		}
	}
	return best;
}

btScalar SoftBody::mass() const
{
	return btScalar( m_impl->mass );
}

btVector3 SoftBody::massCentre() const
{
	return toBt( m_impl->body->nodes().origin + m_impl->body->sums().centre );
}

btVector3 SoftBody::linearVelocity() const
{
	const BodySums sums = m_impl->body->sums();
	return toBt( sums.momentum / sums.mass );
}

btVector3 SoftBody::angularMomentum() const
{
	return toBt( m_impl->body->sums().spin );
}

btTransform SoftBody::bestFitTransform() const
{
	const Placement fit = m_impl->body->bestFit();
	const Vec3d origin = fit.position - fit.rotation * m_impl->body->lattice().massCentre;
	const btQuaternion q(
		btScalar( fit.rotation.x() ), btScalar( fit.rotation.y() ), btScalar( fit.rotation.z() ), btScalar( fit.rotation.w() ) );
	return btTransform( q, toBt( origin ) );
}

void SoftBody::setLinearVelocity( const btVector3& velocity )
{
	setVelocities( velocity, btVector3( 0, 0, 0 ) );
}

void SoftBody::setVelocities( const btVector3& linear, const btVector3& angular )
{
	NodeState& nodes = m_impl->body->nodes();
	const Vec3d centre = m_impl->body->sums().centre;
	for ( int i = 0; i < nodes.count; ++i )
	{
		const Vec3d arm = nodes.x.get( i ).cast<double>() - centre;
		nodes.v.set( i, ( toVec3d( linear ) + toVec3d( angular ).cross( arm ) ).cast<float>() );
	}
	activate( true );
}

void SoftBody::applyCentralForce( const btVector3& force )
{
	m_impl->centralForce += force;
	activate( true );
}

void SoftBody::applyForce( const btVector3& force, int node )
{
	NodeState& nodes = m_impl->body->nodes();
	if ( nodes.force.x.empty() )
	{
		nodes.force.resize( nodes.padded );
	}
	nodes.force.set( node, nodes.force.get( node ) + toVec3( force ) );
	m_impl->hasNodeForces = true;
	activate( true );
}

void SoftBody::applyCentralImpulse( const btVector3& impulse )
{
	NodeState& nodes = m_impl->body->nodes();
	const Vec3 change = toVec3( impulse / mass() );
	for ( int i = 0; i < nodes.count; ++i )
	{
		nodes.v.set( i, nodes.v.get( i ) + nodes.freedom[i] * change );
	}
	activate( true );
}

void SoftBody::applyImpulse( const btVector3& impulse, int node )
{
	NodeState& nodes = m_impl->body->nodes();
	nodes.v.set( node, nodes.v.get( node ) + ( nodes.freedom[node] / nodes.mass[node] ) * toVec3( impulse ) );
	activate( true );
}

void SoftBody::setGravity( const btVector3& gravity )
{
	m_impl->hasOwnGravity = true;
	m_impl->gravity = gravity;
	activate( true );
}

void SoftBody::clearGravity()
{
	m_impl->hasOwnGravity = false;
	activate( true );
}

void SoftBody::hasMoved()
{
	++m_impl->placed;
	m_impl->skin.nodesMoved();
	m_impl->placeShape( *this );
	if ( m_impl->system )
	{
		m_impl->system->refreshBox( *this );
	}
	activate( true );
}

void SoftBody::teleport( const btTransform& by )
{
	if ( !isFinite( by ) )
	{
		return;
	}
	m_impl->body->teleport( Placement{ rotationOf( by ), toVec3d( by.getOrigin() ) } );
	hasMoved();
}

void SoftBody::reset( const btTransform& transform )
{
	if ( !isFinite( transform ) )
	{
		return;
	}
	m_impl->body->place( placementOf( m_impl->body->lattice(), transform ) );
	if ( !m_impl->isHealthy )
	{
		forceActivationState( m_impl->stateBefore ); // quarantine had taken it out of the simulation
	}
	m_impl->isHealthy = true;
	m_impl->skin.fade.clear();
	activate( true ); // leaves alone what the game has set for good
	hasMoved();
}

Status SoftBody::setMaterial( const Material& material )
{
	Status status = m_impl->body->setMaterial( material );
	if ( status.ok() )
	{
		m_impl->mass = m_impl->body->sums().mass;
		m_impl->skin.rigid.forget(); // other regions carry the skin otherwise
		activate( true );
	}
	return status;
}

bool SoftBody::stepsImplicitly() const
{
	return m_impl->isImplicit;
}

Status SoftBody::implicitStatus() const
{
	return m_impl->body->implicitStatus();
}

const Material& SoftBody::material() const
{
	return m_impl->body->material();
}

const StiffnessPlan& SoftBody::stiffnessPlan() const
{
	return m_impl->plan;
}

bool SoftBody::isHealthy() const
{
	return m_impl->isHealthy;
}

const BodyTemplate& SoftBody::bodyTemplate() const
{
	return *m_impl->bodyTemplate;
}

int SoftBody::cellCount() const
{
	return m_impl->body->lattice().cellCount();
}

int SoftBody::linkCount() const
{
	return m_impl->body->lattice().linkCount();
}

unsigned SoftBody::fractureVersion() const
{
	return m_impl->fractureVersion;
}

int SoftBody::nodeOfCell( int cell ) const
{
	const Body& body = *m_impl->body;
	const std::uint32_t own = cell < 0 ? kNoNode : body.ownCell( std::uint32_t( cell ) );
	return own == kNoNode ? -1 : body.nodeOfCell( own );
}

} // namespace pliant
