#include "pliant/soft_body.h"

#include "body/rigid_state.h"
#include "lattice/attempt.h"
#include "world/bodies/placing.h"
#include "world/bodies/soft_body_impl.h"
#include "world/step/soft_body_system.h"

#include <cassert>

namespace pliant {

void SoftBody::Impl::placeSpheres( btCollisionObject& object, const MotionSums& motion, TaskRunner* runner )
{
	const NodeState& nodes = body->nodes();
	mass = motion.mass;
	meanSquareSpeed = motion.squareSpeed / mass;
	const Vec3d centre = Vec3d( motion.moment ) / mass;
	const btTransform at( btQuaternion::getIdentity(), toBt( nodes.origin + centre ) );
	shapeShift = ( toVec3d( at.getOrigin() ) - nodes.origin ).cast<float>();
	shape->place( nodes, shapeShift, runner );
	++skin.moves;
	object.setWorldTransform( at );
	object.setInterpolationWorldTransform( at );
}

// In the rigid state the object's transform is that of the hulls.
void SoftBody::Impl::placeNodes()
{
	const NodeState& nodes = body->nodes();
	shapeShift = ( body->rigidState()->motion.centre - nodes.origin ).cast<float>();
	shape->place( nodes, shapeShift );
}

void SoftBody::Impl::placeShape( btCollisionObject& object )
{
	placeSpheres( object, body->measureMotion() );
}

void SoftBody::Impl::finish( SoftBody& owner )
{
	shape = std::make_unique<NodeShape>( *body );
	proxyOfNode.assign( std::size_t( body->nodeCount() ), nullptr );
	owner.m_internalType = kInternalType;
	owner.m_collisionFlags &= ~CF_STATIC_OBJECT; // Bullet's objects are static initially
	owner.internalSetExtensionPointer( const_cast<char*>( &kSoftBodyMark ) );
	queried = std::make_unique<BodyShape>( owner );
	owner.setCollisionShape( queried.get() );
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
	return withinMemory( "Not enough memory for a soft body of this many cells.", [&]() -> SoftBodyResult {
		rejectIf( !bodyTemplate, ResultCode::BadArgument, "SoftBody::create needs a template." );
		insist( checkTransform( transform, "SoftBody::create" ) );
		std::unique_ptr<Body> made = insist( Body::create( bodyTemplate->sharedLattice(), material,
			placementOf( bodyTemplate->lattice(), transform ), bodyTemplate->cache(), adaptivity, stiffness ) );
		std::unique_ptr<SoftBody> soft( new SoftBody );
		soft->m_impl = std::make_unique<Impl>();
		Impl& impl = *soft->m_impl;
		impl.bodyTemplate = std::move( bodyTemplate );
		impl.body = std::move( made );
		impl.finish( *soft );
		return SoftBodyResult::success( std::move( soft ) );
	} );
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
	if ( soft )
	{
		return soft;
	}
	SoftBody* const ofProxy = ownerOfContactProxy( object );
	return ofProxy ? ofProxy : ownerOfRigidProxy( object );
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
	const bool isChild = !m_impl->rigidProxy && shapeIndex >= 0 && shapeIndex < m_impl->shape->getNumChildShapes();
	return isChild ? m_impl->shape->nodeOfChild( shapeIndex ) : -1;
}

btVector3 SoftBody::nodePosition( int node ) const
{
	assert( m_impl->hasNode( node ) );
	return m_impl->hasNode( node ) ? m_impl->position( node ) : btVector3( 0, 0, 0 );
}

btVector3 SoftBody::nodeVelocity( int node ) const
{
	assert( m_impl->hasNode( node ) );
	return m_impl->hasNode( node ) ? m_impl->velocity( node ) : btVector3( 0, 0, 0 );
}

btScalar SoftBody::nodeMass( int node ) const
{
	assert( m_impl->hasNode( node ) );
	return m_impl->hasNode( node ) ? btScalar( m_impl->body->nodes().mass[node] ) : btScalar( 0 );
}

btScalar SoftBody::nodeRadius( int node ) const
{
	assert( m_impl->hasNode( node ) );
	return m_impl->hasNode( node ) ? m_impl->shape->sphereOfNode( node )->getRadius() : btScalar( 0 );
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

btVector3 SoftBody::angularVelocity() const
{
	return toBt( m_impl->body->angularVelocity() );
}

btTransform SoftBody::bestFitTransform() const
{
	const Placement fit = m_impl->body->bestFit();
	const Vec3d origin = fit.position - fit.rotation * m_impl->body->lattice().massCentre;
	const btQuaternion q(
		btScalar( fit.rotation.x() ), btScalar( fit.rotation.y() ), btScalar( fit.rotation.z() ), btScalar( fit.rotation.w() ) );
	return btTransform( q, toBt( origin ) );
}

Status SoftBody::setMaterial( const Material& material )
{
	if ( Status status = m_impl->checkTime( "setMaterial" ); !status.ok() )
	{
		return status;
	}
	Status status = m_impl->body->setMaterial( material );
	if ( status.ok() )
	{
		m_impl->mass = m_impl->body->sums().mass;
		m_impl->skin.rigid.forget(); // other regions carry the skin otherwise
		m_impl->mustDeform = true;
		m_impl->system ? m_impl->system->equationsChanged( *this ) : void();
		m_impl->wakeTouching( *this );
		activate( true );
	}
	return status;
}

bool SoftBody::isRigid() const
{
	return m_impl->rigidProxy != nullptr;
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
	return m_impl->fractureVersion + m_impl->versionShift;
}

int SoftBody::nodeOfCell( int cell ) const
{
	const Body& body = *m_impl->body;
	const std::uint32_t own = cell < 0 ? kNoNode : body.ownCell( std::uint32_t( cell ) );
	return own == kNoNode ? -1 : body.nodeOfCell( own );
}

int SoftBody::cellOfNode( int node ) const
{
	return m_impl->hasNode( node ) ? int( m_impl->body->firstCellOfNode( node ) ) : -1;
}

void SkinBuffers::interpolate( bool isOn )
{
	if ( isOn != ( blend != nullptr ) )
	{
		blend = isOn ? std::make_unique<StepBlend>() : nullptr;
		isStale = true;
	}
}

void SoftBody::setInterpolation( bool isOn )
{
	if ( !m_impl->isInField() )
	{
		m_impl->skin.interpolate( isOn );
	}
}

bool SoftBody::interpolation() const
{
	return m_impl->skin.blend != nullptr;
}

} // namespace pliant
