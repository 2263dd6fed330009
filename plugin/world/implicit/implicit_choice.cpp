#include "world/implicit/implicit_choice.h"

#include "world/bodies/soft_body_impl.h"
#include "world/constants.h"

#include <BulletCollision/BroadphaseCollision/btDispatcher.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>
#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorld.h>

#include <algorithm>
#include <cmath>

namespace pliant {

namespace {

bool asks( const SoftBody& body )
{
	return body.material().elasticity == Elasticity::Automatic && body.impl().body->canStepImplicitly();
}

/// The mass that a contact's other side brings, kg; 0 for what is fixed.
double massOf( const btCollisionObject& object )
{
	if ( object.isStaticOrKinematicObject() )
	{
		return 0.0;
	}
	if ( const SoftBody* owner = ownerOfContactProxy( &object ) )
	{
		return owner->impl().mass;
	}
	const btRigidBody* const rigid = btRigidBody::upcast( &object );
	return rigid && rigid->getInvMass() > 0 ? 1.0 / double( rigid->getInvMass() ) : 0.0;
}

btVector3 gravityOf( const SoftBody& body, const btDiscreteDynamicsWorld& world )
{
	return body.impl().hasOwnGravity ? body.impl().gravity : world.getGravity();
}

/// What lies on the body, and what its nodes carry of things that can move.
void addContact( btPersistentManifold& manifold, int side, const btDiscreteDynamicsWorld& world )
{
	const btCollisionObject* const objects[2] = { manifold.getBody0(), manifold.getBody1() };
	SoftBody* const owner = ownerOfContactProxy( objects[side] );
	if ( !owner || !owner->impl().elasticity.feelsLoads || manifold.getNumContacts() == 0 )
	{
		return;
	}
	const double other = massOf( *objects[1 - side] );
	if ( other == 0.0 )
	{
		return;
	}
	const ContactProxy& node = *static_cast<const ContactProxy*>( objects[side] );
	ElasticityState& state = owner->impl().elasticity;
	double impulse = 0.0;
	bool liesOnIt = false;
	const btVector3 gravity = gravityOf( *owner, world );
	for ( int k = 0; k < manifold.getNumContacts(); ++k )
	{
		const btManifoldPoint& point = manifold.getContactPoint( k );
		impulse += double( point.m_appliedImpulse );
		liesOnIt = liesOnIt || ( point.m_distance1 <= 0 && ( side == 0 ? gravity : -gravity ).dot( point.m_normalWorldOnB ) > 0 );
	}
	state.heaviest = liesOnIt ? std::max( state.heaviest, other ) : state.heaviest;
	if ( impulse > 0.0 && node.node >= 0 )
	{
		state.impulse += impulse;
		state.nodeMass += double( owner->impl().body->nodes().mass[node.node] );
	}
}

} // namespace

/// Of those that take the implicit step for their loads alone: where there are none, no contact is looked at.
void ImplicitChoice::measureLoads( btDiscreteDynamicsWorld& world )
{
	for ( SoftBody* body : m_asked )
	{
		ElasticityState& state = body->impl().elasticity;
		state.heaviest = state.impulse = state.nodeMass = 0.0;
	}
	const auto feels = []( const SoftBody* body ) { return body->impl().elasticity.feelsLoads && body->impl().lastSubstep > 0.0; };
	const bool looks = std::any_of( m_asked.begin(), m_asked.end(), feels );
	btDispatcher& dispatcher = *world.getDispatcher();
	for ( int m = 0; looks && m < dispatcher.getNumManifolds(); ++m )
	{
		btPersistentManifold& manifold = *dispatcher.getManifoldByIndexInternal( m );
		addContact( manifold, 0, world );
		addContact( manifold, 1, world );
	}
}

/// More than the explicit step can do with the substeps it has; regions that are cut short answer harder (link_moments.h).
bool ImplicitChoice::isTooStiff( const SoftBody& body, btScalar gameStep, int substeps ) const
{
	const SoftBody::Impl& impl = body.impl();
	Material material = body.material();
	material.elasticity = Elasticity::Explicit;
	const StiffnessPlan plan = planStiffness( material, impl.bodyTemplate->cellSize(), float( gameStep ), substeps );
	const double fraction = impl.body->largestRegionFraction() * ( 1.0 + 3.0 * double( material.volumeKeeping ) );
	return !plan.reachable || double( plan.alpha ) * fraction > kLargestVolumeAlpha;
}

// One round over the contacts between a thing of mass M and n nodes of mass m brings its speed and theirs nearer by n m / M, so that I
// rounds need n m I > M. n: what lies there at most, a face of N^(2/3) nodes; or, of what is piled up, what the touched nodes carry.
bool ImplicitChoice::isTooHeavilyLoaded( SoftBody& body, const btDiscreteDynamicsWorld& world, btScalar gameStep ) const
{
	const SoftBody::Impl& impl = body.impl();
	ElasticityState& state = body.impl().elasticity;
	const double weight = state.nodeMass * double( gravityOf( body, world ).length() );
	const double load = weight > 0.0 && impl.lastSubstep > 0.0 ? state.impulse / impl.lastSubstep / weight
															   : 0.0; // impulses are the last substep's
	state.load += ( load - state.load ) * std::min( 1.0, double( gameStep ) / kLoadTime );
	const double count = double( impl.body->nodeCount() );
	const double face = impl.mass / count * std::pow( count, 2.0 / 3.0 );
	const double bears = ( state.isImplicit ? kLeaveFraction : 1.0 ) * double( world.getSolverInfo().m_numIterations );
	return state.heaviest > bears * face || state.load > bears;
}

void ImplicitChoice::choose( const std::vector<SoftBody*>& bodies, btDiscreteDynamicsWorld& world, btScalar gameStep, int substeps )
{
	m_asked.clear();
	for ( SoftBody* body : bodies )
	{
		if ( body->isActive() && body->isHealthy() && asks( *body ) )
		{
			m_asked.push_back( body );
		}
	}
	if ( m_asked.empty() )
	{
		return;
	}
	for ( SoftBody* body : m_asked )
	{
		body->impl().elasticity.feelsLoads = !isTooStiff( *body, gameStep, substeps );
	}
	measureLoads( world );
	for ( SoftBody* body : m_asked )
	{
		ElasticityState& state = body->impl().elasticity;
		state.needs = !state.feelsLoads || isTooHeavilyLoaded( *body, world, gameStep );
		state.calm = state.needs ? 0.0 : state.calm + double( gameStep );
	}
	std::vector<int> islands; // that need it
	for ( const SoftBody* body : m_asked )
	{
		const ElasticityState& state = body->impl().elasticity;
		if ( ( state.needs || ( state.isImplicit && state.calm < kCalmTime ) ) && body->getIslandTag() >= 0 )
		{
			islands.push_back( body->getIslandTag() );
		}
	}
	for ( SoftBody* body : m_asked )
	{
		ElasticityState& state = body->impl().elasticity;
		const bool isInOne = std::find( islands.begin(), islands.end(), body->getIslandTag() ) != islands.end();
		state.isImplicit = isInOne || state.needs || ( state.isImplicit && state.calm < kCalmTime );
	}
}

} // namespace pliant
