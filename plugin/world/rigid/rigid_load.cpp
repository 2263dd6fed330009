#include "world/rigid/rigid_load.h"

#include "body/rigid_state.h"
#include "world/block/implicit_choice.h"
#include "world/bodies/soft_body_impl.h"
#include "world/rigid/rigid_constants.h"

#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>

#include <algorithm>
#include <cmath>

namespace pliant {

namespace {

/// Edges of the box with a body's mass and moments, ascending, m.
Vec3d edgesOf( const RigidState& state, double cell )
{
	Vec3d edges; // a^2 = 6 ( I_b + I_c - I_a ) / m, and a cell for the material around the nodes
	for ( int k = 0; k < 3; ++k )
	{
		const double square = 6.0 * ( state.moments.sum() - 2.0 * state.moments[k] ) / state.mass;
		edges[k] = std::sqrt( std::max( square, 0.0 ) + cell * cell );
	}
	std::sort( edges.data(), edges.data() + 3 );
	return edges;
}

/// Returns the load that strains a body by the visible limit e, N: E e V^( 2 / 3 ). A pinned body bends as a beam of length a, width b and
/// thickness c that is held at one end: E e b c^2 / ( 6 a ).
double largestLoad( const Body& body )
{
	const double limit = double( body.material().youngsModulus ) * body.largestInvisibleStrain();
	const RigidState& state = *body.rigidState();
	if ( state.isHeld )
	{
		const Vec3d edges = edgesOf( state, double( body.lattice().cellSize ) );
		return limit * edges[1] * edges[0] * edges[0] / ( 6.0 * edges[2] );
	}
	return limit * std::pow( state.mass / double( body.material().density ), 2.0 / 3.0 );
}

/// The same for a pinned body, whose pins carry its weight.
bool hasLoadOnHeldChanged( const SoftBody::Impl& impl, const Vec3d& acceleration )
{
	const RigidState& state = *impl.body->rigidState();
	const RigidLoad& load = impl.rigidLoad;
	const double most = largestLoad( *impl.body ), pulled = state.mass * ( acceleration - load.acceleration ).norm();
	const double pressed = load.first < 0.0 ? 0.0 : load.now - load.first;
	return pressed + pulled > most || ( state.isBent && pulled - pressed > std::max( most, ( 1.0 - kBentLoad ) * load.first ) );
}

} // namespace

double impulseOf( const btPersistentManifold& manifold )
{
	double impulse = 0.0;
	for ( int k = 0; k < manifold.getNumContacts(); ++k )
	{
		impulse += std::abs( double( manifold.getContactPoint( k ).m_appliedImpulse ) );
	}
	return impulse;
}

Vec3d accelerationOn( const SoftBody& body, const btVector3& gravity )
{
	const SoftBody::Impl& impl = body.impl();
	const Vec3Array& fields = impl.body->fieldForce();
	Vec3d force = toVec3d( impl.centralForce );
	for ( int i = 0; i < impl.body->nodeCount() && !fields.x.empty(); ++i )
	{
		force += fields.get( i ).cast<double>();
	}
	return toVec3d( gravity ) + force / impl.mass;
}

bool hasLoadChanged( const SoftBody& body, const btVector3& gravity )
{
	const SoftBody::Impl& impl = body.impl();
	const RigidState& state = *impl.body->rigidState();
	const RigidLoad& load = impl.rigidLoad;
	if ( state.isHeld )
	{
		return hasLoadOnHeldChanged( impl, accelerationOn( body, gravity ) );
	}
	const double weight = state.mass * double( gravity.length() ); // which loads a bent body too
	const bool wasLoaded = state.isBent && load.first > ( 1.0 + kLeastBentLoad ) * weight;
	const bool isUnloaded = wasLoaded && load.mean - weight < kBentLoad * ( load.first - weight );
	return isUnloaded || load.mean > std::max( kRigidLoad * load.first, largestLoad( *impl.body ) );
}

bool impactsPass( const SoftBody& body, double h )
{
	const bool isStiff = stepsImplicitly( body ) && body.material().yieldStrain == 0.0f && resolvedFraction( body, h ) == 0.0;
	return body.impl().pins.empty() && ( isStiff || body.impl().body->isInelastic() );
}

bool arePinsStill( const SoftBody& body )
{
	const SoftBody::Impl& impl = body.impl();
	return std::none_of( impl.pins.begin(), impl.pins.end(), [&impl]( const Pin& pin ) {
		if ( pin.kind != PinKind::FollowsBody )
		{
			return pin.hasTarget;
		}
		const btVector3 away = pin.body->getWorldTransform() * pin.point - impl.position( pin.node );
		return !pin.body->isStaticOrKinematicObject() || away.length2() > kStillPin * kStillPin;
	} );
}

// The velocity of a light object counts less: an object much lighter than a cell strains nothing. An object that meets a pinned body bends
// it until it has stopped. The beam of `largestLoad` then has the energy E e^2 V / 18, so that v = e c sqrt( M / 9 m ).
double largestApproach( const Body& body, double mass, bool passes )
{
	const double speed = body.largestInvisibleVelocity( !passes );
	const RigidState& state = *body.rigidState();
	const double cell = state.mass / double( body.lattice().cellCount() );
	const double free = mass < double( SIMD_INFINITY ) ? speed * ( mass + cell ) / mass : speed;
	if ( !state.isHeld )
	{
		return free;
	}
	const double bending = mass < double( SIMD_INFINITY ) ? speed * std::sqrt( state.mass / ( 9.0 * mass ) ) : 0.0;
	return std::min( free, bending );
}

} // namespace pliant
