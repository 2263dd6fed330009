#include "world/block/implicit_choice.h"

#include "world/bodies/soft_body_impl.h"
#include "world/constants.h"
#include "world/step/object_motion.h"
#include "world/step_constants.h"

#include <BulletCollision/BroadphaseCollision/btDispatcher.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>
#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorld.h>

#include <algorithm>
#include <cmath>

namespace pliant {

namespace {

bool isAutomatic( const SoftBody& body )
{
	return body.material().elasticity == Elasticity::Automatic && body.impl().body->canStepImplicitly();
}

btVector3 gravityOf( const SoftBody& body, const btDiscreteDynamicsWorld& world )
{
	return body.impl().hasOwnGravity ? body.impl().gravity : world.getGravity();
}

/// Adds a manifold's loads to the body on `side`: the heaviest object that rests on it, and the impulses its nodes carry.
void addContact( btPersistentManifold& manifold, int side, const btDiscreteDynamicsWorld& world )
{
	const btCollisionObject* const objects[2] = { manifold.getBody0(), manifold.getBody1() };
	SoftBody* const owner = ownerOfContactProxy( objects[side] );
	if ( !owner || !owner->impl().elasticity.checksLoads || manifold.getNumContacts() == 0 )
	{
		return;
	}
	const double otherMass = double( massOf( *objects[1 - side] ) );
	if ( otherMass == SIMD_INFINITY )
	{
		return;
	}
	const ContactProxy& node = *static_cast<const ContactProxy*>( objects[side] );
	ElasticityState& state = owner->impl().elasticity;
	double impulse = 0.0;
	bool restsOnBody = false;
	const btVector3 gravity = gravityOf( *owner, world );
	for ( int k = 0; k < manifold.getNumContacts(); ++k )
	{
		const btManifoldPoint& point = manifold.getContactPoint( k );
		impulse += double( point.m_appliedImpulse );
		restsOnBody = restsOnBody || ( point.m_distance1 <= 0 && ( side == 0 ? gravity : -gravity ).dot( point.m_normalWorldOnB ) > 0 );
	}
	state.heaviestLoad = restsOnBody ? std::max( state.heaviestLoad, otherMass ) : state.heaviestLoad;
	if ( impulse > 0.0 && node.node >= 0 )
	{
		state.impulse += impulse;
		state.nodeMass += double( owner->impl().body->nodes().mass[node.node] );
	}
}

} // namespace

bool stepsImplicitly( const SoftBody& body )
{
	const Elasticity wanted = body.material().elasticity;
	return ( wanted == Elasticity::Implicit || ( wanted == Elasticity::Automatic && body.impl().elasticity.isImplicit ) ) &&
		body.impl().body->canStepImplicitly();
}

double soundVelocity( const SoftBody& body )
{
	return std::sqrt( double( body.material().youngsModulus ) / double( body.material().density ) );
}

double sizeOf( const SoftBody& body )
{
	return std::cbrt( body.impl().mass / double( body.material().density ) );
}

double travelOfSound( const SoftBody& body, double h )
{
	return h * soundVelocity( body ) / sizeOf( body );
}

double resolvedFraction( const SoftBody& body, double h )
{
	const double above = std::clamp( ( travelOfSound( body, h ) - kResolvedTravel ) / ( 1.0 - kResolvedTravel ), 0.0, 1.0 );
	return 1.0 - above * above * ( 3.0 - 2.0 * above ); // smooth at both ends
}

ImplicitStepPlan planImplicitStep( const SoftBody& body, double gameStep, int usual )
{
	const double travel = travelOfSound( body, gameStep );
	ImplicitStepPlan plan{ std::max( 1, int( std::ceil( gameStep / kLongestImplicitStep - 1e-3 ) ) ), body.material().numericalDamping };
	const bool isUndamped = plan.numericalDamping != 1.0f;
	const bool lands = body.impl().elasticity.landingTime > 0.0;
	const double rolling = body.impl().elasticity.rolling;
	if ( lands || rolling > 0.0 )
	{
		// Whether a link breaks depends on the largest strain within the impact.
		const bool isWhole = travel <= kResolvedTravel && body.fracture().rule == BreakRule::Never;
		plan.parts = std::max( plan.parts, isWhole ? 1 : usual );
		const double spacing = sizeOf( body ) / std::cbrt( double( body.nodeCount() ) ),
					 travelled = std::sqrt( body.impl().meanSquareSpeed ) * gameStep / spacing;
		const double rolled = std::min( travelled / kRolledSpacings, kMostRollingSubsteps * usual );
		plan.parts = std::max( plan.parts, int( std::ceil( rolling * rolled ) ) );
		// The strain of a rolling body is at rest in space and turns in its material, which numerical damping takes for a vibration.
		const double resolved = lands ? resolvedFraction( body, gameStep / plan.parts ) : 0.0;
		plan.numericalDamping *= float( ( 1.0 - resolved ) * ( 1.0 - rolling ) );
	}
	if ( isUndamped && travel <= kResolvedTravel * usual )
	{
		plan.parts = std::max( plan.parts, usual );
	}
	// The step is linear in displacements: a stiff body that is crushed between others, or that vibrates without numerical damping in
	// steps that do not resolve it, would gain energy from large changes of its shape.
	const bool isFree = body.impl().touched.empty();
	const bool mayVibrate = isFree && isUndamped && !lands && travel > kResolvedTravel * plan.parts;
	const bool mayBeCrushed = ( !isFree || isUndamped ) && travel > kStiffTravel;
	if ( mayVibrate || mayBeCrushed )
	{
		const double most = kMostStretch / gameStep;
		const double stretches = std::min( body.impl().body->stretchRate( most ) / most, double( kLargestSubsteps ) );
		plan.parts = mayBeCrushed ? std::max( plan.parts, int( std::ceil( stretches ) ) ) : plan.parts;
		plan.numericalDamping = stretches > 1.0 ? 1.0f : plan.numericalDamping;
	}
	// So would one that a blow has set vibrating in flight, if its shape changes as much within a substep. What breaks keeps its waves.
	if ( lands && isFree && !isUndamped && body.fracture().rule == BreakRule::Never )
	{
		const double most = kMostStretch * plan.parts / gameStep;
		plan.numericalDamping = body.impl().body->stretchRate( most ) > most ? 1.0f : plan.numericalDamping;
	}
	return plan;
}

double restitutionFraction( const SoftBody& body, double h )
{
	const double kept = body.impl().elasticity.landingTime > 0.0 ? 1.0 : 1.0 - double( body.material().numericalDamping );
	return kept == 0.0 ? 1.0 : 1.0 - kept * resolvedFraction( body, h );
}

// Contacts are visited only if some body could take the implicit step for its loads alone.
void ImplicitChoice::measureLoads( btDiscreteDynamicsWorld& world )
{
	for ( SoftBody* body : m_automatic )
	{
		ElasticityState& state = body->impl().elasticity;
		state.heaviestLoad = state.impulse = state.nodeMass = 0.0;
	}
	const auto checks = []( const SoftBody* body ) { return body->impl().elasticity.checksLoads && body->impl().lastSubstep > 0.0; };
	const bool checksAny = std::any_of( m_automatic.begin(), m_automatic.end(), checks );
	btDispatcher& dispatcher = *world.getDispatcher();
	for ( int m = 0; checksAny && m < dispatcher.getNumManifolds(); ++m )
	{
		btPersistentManifold& manifold = *dispatcher.getManifoldByIndexInternal( m );
		addContact( manifold, 0, world );
		addContact( manifold, 1, world );
	}
}

// True where the explicit step is not stable with the given substeps; truncated regions are stiffer (link_moments.h).
bool ImplicitChoice::isTooStiff( const SoftBody& body, btScalar gameStep, int substeps ) const
{
	const SoftBody::Impl& impl = body.impl();
	Material material = body.material();
	material.elasticity = Elasticity::Explicit;
	const StiffnessPlan plan = planStiffness( material, impl.bodyTemplate->cellSize(), float( gameStep ), substeps );
	const double fraction = impl.body->largestRegionFraction() * ( 1.0 + 3.0 * double( material.volumeKeeping ) );
	return !plan.reachable || double( plan.alpha ) * fraction > kLargestVolumeAlpha;
}

// One iteration over the contacts between an object of mass M and n nodes of mass m reduces their relative velocity by the fraction n m /
// M, so I iterations need n m I > M. n is at most the nodes of a face, N^(2/3). For piles the load carried by the touched nodes is used.
bool ImplicitChoice::isTooHeavilyLoaded( SoftBody& body, const btDiscreteDynamicsWorld& world, btScalar gameStep ) const
{
	const SoftBody::Impl& impl = body.impl();
	ElasticityState& state = body.impl().elasticity;
	const double weight = state.nodeMass * double( gravityOf( body, world ).length() );
	const double load = weight > 0.0 && impl.lastSubstep > 0.0 ? state.impulse / impl.lastSubstep / weight
															   : 0.0; // the impulses are those of the last substep
	state.load += ( load - state.load ) * std::min( 1.0, double( gameStep ) / kLoadTime );
	const double count = double( impl.body->nodeCount() );
	const double face = impl.mass / count * std::pow( count, 2.0 / 3.0 );
	const double capacity = ( state.isImplicit ? kLeaveFraction : 1.0 ) * double( world.getSolverInfo().m_numIterations );
	return state.heaviestLoad > capacity * face || state.load > capacity;
}

bool ImplicitChoice::mayLeaveGroup( const SoftBody& body )
{
	return isAutomatic( body ) && !body.impl().elasticity.isImplicit && body.fracture().rule == BreakRule::Never;
}

void ImplicitChoice::leaveGroup( SoftBody& body )
{
	ElasticityState& state = body.impl().elasticity;
	state.isImplicit = true;
	state.calmTime = 0.0;
}

void ImplicitChoice::choose( const std::vector<SoftBody*>& bodies, btDiscreteDynamicsWorld& world, btScalar gameStep, int substeps )
{
	m_automatic.clear();
	for ( SoftBody* body : bodies )
	{
		if ( body->isActive() && body->isHealthy() && isAutomatic( *body ) )
		{
			m_automatic.push_back( body );
		}
	}
	if ( m_automatic.empty() )
	{
		return;
	}
	for ( SoftBody* body : m_automatic )
	{
		body->impl().elasticity.checksLoads = !isTooStiff( *body, gameStep, substeps );
	}
	measureLoads( world );
	for ( SoftBody* body : m_automatic )
	{
		ElasticityState& state = body->impl().elasticity;
		state.needsImplicit = !state.checksLoads || isTooHeavilyLoaded( *body, world, gameStep );
		state.calmTime = state.needsImplicit ? 0.0 : state.calmTime + double( gameStep );
	}
	std::vector<int> islands; // in which a body needs the implicit step
	for ( const SoftBody* body : m_automatic )
	{
		const ElasticityState& state = body->impl().elasticity;
		if ( ( state.needsImplicit || ( state.isImplicit && state.calmTime < kCalmTime ) ) && body->getIslandTag() >= 0 )
		{
			islands.push_back( body->getIslandTag() );
		}
	}
	for ( SoftBody* body : m_automatic )
	{
		ElasticityState& state = body->impl().elasticity;
		const bool isInOne = std::find( islands.begin(), islands.end(), body->getIslandTag() ) != islands.end();
		state.isImplicit = isInOne || state.needsImplicit || ( state.isImplicit && state.calmTime < kCalmTime );
	}
}

// Bodies that break or flow at a strain keep their modulus, so that they do so under the load that it says; pinned ones, which may be
// slender and cannot fly off, so that they do not sag. The modulus that is left must not depend on the substeps of a landing.
void limitStiffness( const SoftBody& body, int substeps, StiffnessPlan& plan )
{
	const float most = ( body.adaptivity().coarseLevels > 0 ? kMostLevelAlpha : kMostImplicitAlpha ) / float( substeps * substeps );
	const bool mayLose = body.fracture().rule == BreakRule::Never && body.material().yieldStrain == 0.0f && body.impl().pins.empty();
	if ( plan.alpha > most && mayLose )
	{
		plan.reachedModulus *= most / plan.alpha;
		plan.alpha = most;
		plan.reachable = false;
	}
}

} // namespace pliant
