// Calls of the game on a body: velocities, forces, impulses, gravity, positions. Each is refused if a number is bad, and then changes
// nothing.

#include "matching/constants.h"
#include "world/bodies/placing.h"
#include "world/constants.h"
#include "world/step/soft_body_system.h"

#include <algorithm>

namespace pliant {

namespace {

const char* const kNoSuchNode = "there is no node of this number.";
const char* const kNotFinite = "a number is not finite.";
const char* const kTooFast = "a node would be faster than 1e5 m/s.";

/// The acceleration that takes a node to the limit of velocity within a frame, m/s^2.
constexpr btScalar kMostAcceleration = btScalar( kSpeedLimit ) / kNominalStep;

/// Forces and gravity.
Status checkAcceleration( const btVector3& acceleration, const char* call )
{
	if ( !isFinite( acceleration ) )
	{
		return refused( call, kNotFinite );
	}
	const bool isTooMuch = std::max( { btFabs( acceleration.x() ), btFabs( acceleration.y() ), btFabs( acceleration.z() ) } ) >
		kMostAcceleration;
	return isTooMuch ? refused( call, "with what acts already it would bring a node to 1e5 m/s within a sixtieth of a second." ) : Status{};
}

bool isTooFast( const Vec3& velocity )
{
	return !( velocity.array().abs() <= kSpeedLimit ).all(); // not a number counts
}

} // namespace

bool SoftBody::Impl::isInField() const
{
	return system && system->fields.areActing();
}

Status SoftBody::Impl::checkTime( const char* call ) const
{
	return isInField() ? refused( call, kInField ) : Status{};
}

Status checkVector( const btVector3& vector, const char* call, const char* what )
{
	return isFinite( vector ) ? Status{} : refused( call, std::string( what ) + " holds a number that is not finite." );
}

Status checkTransform( const btTransform& transform, const char* call )
{
	if ( !isFinite( transform ) )
	{
		return refused( call, "the transform holds a number that is not finite." );
	}
	const btVector3& to = transform.getOrigin();
	if ( std::max( { btFabs( to.x() ), btFabs( to.y() ), btFabs( to.z() ) } ) > kFarthestPosition )
	{
		return refused( call, "the transform leads further out than 1e9 m." );
	}
	const Eigen::Matrix3d basis = toMatrix3d( transform.getBasis() );
	const double off = ( basis.transpose() * basis - Eigen::Matrix3d::Identity() ).cwiseAbs().maxCoeff();
	if ( off > kMostScale || basis.determinant() < 0.0 )
	{
		return refused( call,
			"the transform scales, shears or mirrors; only rotations and translations can be taken. Scale the mesh before "
			"BodyTemplate::build." );
	}
	return {};
}

void SoftBody::Impl::followVelocities()
{
	body->followVelocities();
	mustDeform = mustDeform || ( rigidProxy && rigidProxy->isHeld() );
}

Status SoftBody::setLinearVelocity( const btVector3& velocity )
{
	if ( Status status = m_impl->checkTime( "setLinearVelocity" ); !status.ok() )
	{
		return status;
	}
	const Status status = setVelocities( velocity, btVector3( 0, 0, 0 ) );
	const char* const why = isFinite( velocity ) ? kTooFast : kNotFinite;
	return status.ok() ? Status{} : refused( "setLinearVelocity", why );
}

Status SoftBody::setVelocities( const btVector3& linear, const btVector3& angular )
{
	if ( Status status = m_impl->checkTime( "setVelocities" ); !status.ok() )
	{
		return status;
	}
	NodeState& nodes = m_impl->body->nodes();
	const Vec3d centre = m_impl->body->sums().centre;
	const auto velocityOf = [&]( int node ) {
		const Vec3d arm = nodes.x.get( node ).cast<double>() - centre;
		return Vec3( ( toVec3d( linear ) + toVec3d( angular ).cross( arm ) ).cast<float>() );
	};
	for ( int i = 0; i < nodes.count; ++i )
	{
		if ( isTooFast( velocityOf( i ) ) )
		{
			return isFinite( linear ) && isFinite( angular ) ? refused( "setVelocities", kTooFast )
															 : refused( "setVelocities", kNotFinite );
		}
	}
	for ( int i = 0; i < nodes.count; ++i )
	{
		nodes.v.set( i, velocityOf( i ) );
	}
	m_impl->followVelocities();
	activate( true );
	return {};
}

Status SoftBody::applyCentralForce( const btVector3& force )
{
	if ( Status status = m_impl->checkTime( "applyCentralForce" ); !status.ok() )
	{
		return status;
	}
	const btVector3 sum = m_impl->centralForce + force;
	Status status = checkAcceleration( sum / mass(), "applyCentralForce" );
	if ( status.ok() )
	{
		m_impl->centralForce = sum;
		activate( true );
	}
	return status;
}

Status SoftBody::applyForce( const btVector3& force, int node )
{
	if ( Status status = m_impl->checkTime( "applyForce" ); !status.ok() )
	{
		return status;
	}
	if ( !m_impl->hasNode( node ) )
	{
		return refused( "applyForce", kNoSuchNode );
	}
	NodeState& nodes = m_impl->body->nodes();
	const bool isFirst = nodes.force.x.empty();
	const Vec3 sum = ( isFirst ? Vec3( Vec3::Zero() ) : nodes.force.get( node ) ) + toVec3( force );
	Status status = checkAcceleration( toBt( sum.cast<double>() / double( nodes.mass[node] ) ), "applyForce" );
	if ( status.ok() )
	{
		if ( isFirst )
		{
			nodes.force.resize( nodes.padded );
		}
		nodes.force.set( node, sum );
		m_impl->hasNodeForces = true;
		activate( true );
	}
	return status;
}

Status SoftBody::applyCentralImpulse( const btVector3& impulse )
{
	if ( Status status = m_impl->checkTime( "applyCentralImpulse" ); !status.ok() )
	{
		return status;
	}
	NodeState& nodes = m_impl->body->nodes();
	const Vec3 change = toVec3( impulse / mass() );
	for ( int i = 0; i < nodes.count; ++i )
	{
		if ( isTooFast( nodes.v.get( i ) + nodes.freedom[i] * change ) )
		{
			return isFinite( impulse ) ? refused( "applyCentralImpulse", kTooFast ) : refused( "applyCentralImpulse", kNotFinite );
		}
	}
	for ( int i = 0; i < nodes.count; ++i )
	{
		nodes.v.set( i, nodes.v.get( i ) + nodes.freedom[i] * change );
	}
	m_impl->followVelocities();
	activate( true );
	return {};
}

Status SoftBody::applyImpulse( const btVector3& impulse, int node )
{
	if ( Status status = m_impl->checkTime( "applyImpulse" ); !status.ok() )
	{
		return status;
	}
	if ( !m_impl->hasNode( node ) )
	{
		return refused( "applyImpulse", kNoSuchNode );
	}
	NodeState& nodes = m_impl->body->nodes();
	const Vec3 velocity = nodes.v.get( node ) + ( nodes.freedom[node] / nodes.mass[node] ) * toVec3( impulse );
	if ( isTooFast( velocity ) )
	{
		return isFinite( impulse ) ? refused( "applyImpulse", kTooFast ) : refused( "applyImpulse", kNotFinite );
	}
	nodes.v.set( node, velocity );
	m_impl->body->followVelocities();
	m_impl->mustDeform = m_impl->mustDeform || m_impl->rigidProxy;
	activate( true );
	return {};
}

Status SoftBody::setGravity( const btVector3& gravity )
{
	if ( Status status = m_impl->checkTime( "setGravity" ); !status.ok() )
	{
		return status;
	}
	Status status = checkAcceleration( gravity, "setGravity" );
	if ( status.ok() )
	{
		m_impl->hasOwnGravity = true;
		m_impl->gravity = gravity;
		activate( true );
	}
	return status;
}

void SoftBody::clearGravity()
{
	if ( m_impl->isInField() )
	{
		return;
	}
	m_impl->hasOwnGravity = false;
	activate( true );
}

btVector3 SoftBody::gravity() const
{
	const btVector3 ofWorld = m_impl->system ? m_impl->system->world().getGravity() : btVector3( 0, 0, 0 );
	return m_impl->hasOwnGravity ? m_impl->gravity : ofWorld;
}

bool SoftBody::hasOwnGravity() const
{
	return m_impl->hasOwnGravity;
}

void SoftBody::Impl::wakeTouching( const SoftBody& owner ) const
{
	if ( system && !touched.empty() )
	{
		system->wakeTouching( owner );
	}
}

void SoftBody::hasMoved()
{
	++m_impl->placements;
	m_impl->wakeTouching( *this );
	m_impl->skin.jumped();
	m_impl->rigidProxy ? m_impl->placeRigid( *this ) : m_impl->placeShape( *this );
	if ( m_impl->system )
	{
		m_impl->system->refreshBox( *this );
	}
	activate( true );
}

Status SoftBody::teleport( const btTransform& by )
{
	if ( Status status = m_impl->checkTime( "teleport" ); !status.ok() )
	{
		return status;
	}
	if ( Status status = checkTransform( by, "teleport" ); !status.ok() )
	{
		return status;
	}
	const btVector3 to = by * massCentre();
	if ( std::max( { btFabs( to.x() ), btFabs( to.y() ), btFabs( to.z() ) } ) > kFarthestPosition )
	{
		return refused( "teleport", "the body would be further out than 1e9 m." );
	}
	m_impl->body->teleport( Placement{ rotationOf( by ), toVec3d( by.getOrigin() ) } );
	hasMoved();
	return {};
}

Status SoftBody::reset( const btTransform& transform )
{
	if ( Status status = m_impl->checkTime( "reset" ); !status.ok() )
	{
		return status;
	}
	if ( Status status = checkTransform( transform, "reset" ); !status.ok() )
	{
		return status;
	}
	m_impl->body->place( placementOf( m_impl->body->lattice(), transform ) );
	if ( !m_impl->isHealthy )
	{
		forceActivationState( m_impl->stateBefore ); // quarantine had taken it out of the simulation
	}
	m_impl->isHealthy = true;
	m_impl->skin.fade.clear();
	activate( true ); // keeps a permanent activation state that the game has set
	hasMoved();
	return {};
}

} // namespace pliant
