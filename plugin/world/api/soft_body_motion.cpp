// Calls of the game on a body: velocities, forces, impulses, gravity, positions. Each is refused if a number is bad, and then changes
// nothing.

#include "lattice/attempt.h"
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
void checkAcceleration( const btVector3& acceleration, const char* call )
{
	rejectIf( !isFinite( acceleration ), call, kNotFinite );
	const bool isTooMuch = std::max( { btFabs( acceleration.x() ), btFabs( acceleration.y() ), btFabs( acceleration.z() ) } ) >
		kMostAcceleration;
	rejectIf( isTooMuch, call, "with what acts already it would bring a node to 1e5 m/s within a sixtieth of a second." );
}

/// `isNumber`: whether all numbers were finite that led to the velocity.
void checkVelocity( const Vec3& velocity, const char* call, bool isNumber )
{
	rejectIf( !( velocity.array().abs() <= kSpeedLimit ).all(), call, isNumber ? kTooFast : kNotFinite );
}

bool isFar( const btVector3& position )
{
	return std::max( { btFabs( position.x() ), btFabs( position.y() ), btFabs( position.z() ) } ) > kFarthestPosition;
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
	if ( isFar( transform.getOrigin() ) )
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
	meanSquareSpeed = body->measureMotion().squareSpeed / mass; // landings are found by it at the start of the next step
	mustDeform = mustDeform || ( rigidProxy && rigidProxy->isHeld() );
}

Status SoftBody::setLinearVelocity( const btVector3& velocity )
{
	return attempt( [&]() {
		insist( m_impl->checkTime( "setLinearVelocity" ) );
		const bool isSet = setVelocities( velocity, btVector3( 0, 0, 0 ) ).ok();
		rejectIf( !isSet, "setLinearVelocity", isFinite( velocity ) ? kTooFast : kNotFinite );
	} );
}

Status SoftBody::setVelocities( const btVector3& linear, const btVector3& angular )
{
	return attempt( [&]() {
		insist( m_impl->checkTime( "setVelocities" ) );
		NodeState& nodes = m_impl->body->nodes();
		const Vec3d centre = m_impl->body->sums().centre;
		const auto velocityOf = [&]( int node ) {
			const Vec3d arm = nodes.x.get( node ).cast<double>() - centre;
			return Vec3( ( toVec3d( linear ) + toVec3d( angular ).cross( arm ) ).cast<float>() );
		};
		for ( int i = 0; i < nodes.count; ++i )
		{
			checkVelocity( velocityOf( i ), "setVelocities", isFinite( linear ) && isFinite( angular ) );
		}
		for ( int i = 0; i < nodes.count; ++i )
		{
			nodes.v.set( i, velocityOf( i ) );
		}
		m_impl->followVelocities();
		activate( true );
	} );
}

Status SoftBody::applyCentralForce( const btVector3& force )
{
	return attempt( [&]() {
		insist( m_impl->checkTime( "applyCentralForce" ) );
		const btVector3 sum = m_impl->centralForce + force;
		checkAcceleration( sum / mass(), "applyCentralForce" );
		m_impl->centralForce = sum;
		activate( true );
	} );
}

Status SoftBody::applyForce( const btVector3& force, int node )
{
	return attempt( [&]() {
		insist( m_impl->checkTime( "applyForce" ) );
		rejectIf( !m_impl->hasNode( node ), "applyForce", kNoSuchNode );
		NodeState& nodes = m_impl->body->nodes();
		const bool isFirst = nodes.force.x.empty();
		const Vec3 sum = ( isFirst ? Vec3( Vec3::Zero() ) : nodes.force.get( node ) ) + toVec3( force );
		checkAcceleration( toBt( sum.cast<double>() / double( nodes.mass[node] ) ), "applyForce" );
		if ( isFirst )
		{
			nodes.force.resize( nodes.padded );
		}
		nodes.force.set( node, sum );
		m_impl->hasNodeForces = true;
		activate( true );
	} );
}

Status SoftBody::applyCentralImpulse( const btVector3& impulse )
{
	return attempt( [&]() {
		insist( m_impl->checkTime( "applyCentralImpulse" ) );
		NodeState& nodes = m_impl->body->nodes();
		const Vec3 change = toVec3( impulse / mass() );
		for ( int i = 0; i < nodes.count; ++i )
		{
			checkVelocity( nodes.v.get( i ) + nodes.freedom[i] * change, "applyCentralImpulse", isFinite( impulse ) );
		}
		for ( int i = 0; i < nodes.count; ++i )
		{
			nodes.v.set( i, nodes.v.get( i ) + nodes.freedom[i] * change );
		}
		m_impl->followVelocities();
		activate( true );
	} );
}

Status SoftBody::applyImpulse( const btVector3& impulse, int node )
{
	return attempt( [&]() {
		insist( m_impl->checkTime( "applyImpulse" ) );
		rejectIf( !m_impl->hasNode( node ), "applyImpulse", kNoSuchNode );
		NodeState& nodes = m_impl->body->nodes();
		const Vec3 velocity = nodes.v.get( node ) + ( nodes.freedom[node] / nodes.mass[node] ) * toVec3( impulse );
		checkVelocity( velocity, "applyImpulse", isFinite( impulse ) );
		m_impl->system ? m_impl->system->deformNow( *this ) : void();
		const Vec3d before = nodes.v.get( node ).cast<double>(), now = velocity.cast<double>();
		const double more = nodes.mass[node] * ( now.squaredNorm() - before.squaredNorm() );
		m_impl->elasticity.blow += nodes.mass[node] * ( now - before ).squaredNorm() / m_impl->mass;
		nodes.v.set( node, velocity );
		if ( m_impl->rigidProxy )
		{
			m_impl->followVelocities();
			m_impl->mustDeform = true;
		}
		else // without a pass over the body, as games push many nodes
		{
			m_impl->meanSquareSpeed = std::max( 0.0, m_impl->meanSquareSpeed + more / m_impl->mass );
		}
		activate( true );
	} );
}

Status SoftBody::setGravity( const btVector3& gravity )
{
	return attempt( [&]() {
		insist( m_impl->checkTime( "setGravity" ) );
		checkAcceleration( gravity, "setGravity" );
		m_impl->hasOwnGravity = true;
		m_impl->gravity = gravity;
		activate( true );
	} );
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
	return attempt( [&]() {
		insist( m_impl->checkTime( "teleport" ) );
		insist( checkTransform( by, "teleport" ) );
		rejectIf( isFar( by * massCentre() ), "teleport", "the body would be further out than 1e9 m." );
		m_impl->body->teleport( Placement{ rotationOf( by ), toVec3d( by.getOrigin() ) } );
		hasMoved();
	} );
}

Status SoftBody::reset( const btTransform& transform )
{
	return attempt( [&]() {
		insist( m_impl->checkTime( "reset" ) );
		insist( checkTransform( transform, "reset" ) );
		m_impl->body->place( placementOf( m_impl->body->lattice(), transform ) );
		if ( !m_impl->isHealthy )
		{
			forceActivationState( m_impl->stateBefore ); // quarantine had taken it out of the simulation
		}
		m_impl->isHealthy = true;
		m_impl->skin.fade.clear();
		activate( true ); // keeps a permanent activation state that the game has set
		hasMoved();
	} );
}

} // namespace pliant
