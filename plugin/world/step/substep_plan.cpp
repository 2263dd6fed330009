// How many substeps a game step takes, and which bodies and objects take them.

#include "world/bodies/soft_body_impl.h"
#include "world/constants.h"
#include "world/step/soft_body_system.h"
#include "world/step_constants.h"

#include <algorithm>
#include <cmath>

namespace pliant {

int SoftBodySystem::planSubsteps( btScalar gameStep, const BulletStages::Parts& parts )
{
	const bool canSplit = !parts.hasOwnSingleStep && !parts.hasOwnIslands;
	// The user's number of substeps is per 1/60 s; a longer step gets proportionally more, so that behaviour does not depend on the frame
	// rate.
	const int nominal = int( std::ceil( double( substeps ) * gameStep / kNominalStep - 1e-3 ) );
	const int usual = std::max( substeps, std::min( nominal, mostSubsteps( gameStep ) ) );
	m_choice.choose( m_bodies, m_world, gameStep, usual );
	noteLandings( gameStep, usual, canSplit );
	int count = listSubstepped( gameStep, usual );
	const SubstepGroup::Scene scene{
		m_world, m_bodies, parts.rigidBodies, parts.constraints, parts.multiBodies, parts.multiBodyJoints, attachments, frames, canSplit };
	group.beginStep();
	group.choose( scene, m_substepped, gameStep );
	if ( isGroupTooLarge( scene, count ) )
	{
		leaveLargeGroups( scene, gameStep, count );
		count = listSubstepped( gameStep, usual );
		group.choose( scene, m_substepped, gameStep );
	}
	group.endChoice();
	return std::min( count, kLargestSubsteps );
}

/// A bound that was lowered holds whatever the step; else a step longer than a game runs at gets proportionally more, as it gets substeps.
int SoftBodySystem::mostSubsteps( btScalar gameStep ) const
{
	const double longer = maxSubsteps < kDefaultMaxSubsteps ? 1.0 : std::max( 1.0, double( gameStep ) / kLongestPlayedStep );
	return std::min( int( std::ceil( maxSubsteps * longer - 1e-3 ) ), kLargestSubsteps );
}

/// Lists the bodies that take substeps; returns the number that they need. `usual`: the number that explicit ones have at least.
int SoftBodySystem::listSubstepped( btScalar gameStep, int usual )
{
	int count = 1;
	const int most = mostSubsteps( gameStep );
	m_substepped.clear();
	for ( SoftBody* body : m_bodies )
	{
		if ( !moves( *body ) || body->impl().rigidProxy || isImplicitRigidPiece( *body ) )
		{
			continue;
		}
		const bool isImplicit = stepsImplicitly( *body );
		if ( isImplicit )
		{
			const ImplicitStepPlan plan = planImplicitStep( *body, double( gameStep ), usual );
			body->impl().body->dampNumerically( plan.numericalDamping );
			if ( plan.parts == 1 )
			{
				continue;
			}
			count = std::max( count, std::min( plan.parts, std::max( usual, most ) ) );
		}
		else
		{
			count = std::max( count, usual );
			count = std::max( count, std::min( planOf( *body, gameStep, count ).substepsNeeded, most ) );
		}
		m_substepped.push_back( body );
	}
	return count;
}

// Rigid bodies that an explicit one touches take its substeps, and so do those that they touch: in a heap, all of it.
bool SoftBodySystem::isGroupTooLarge( const SubstepGroup::Scene& scene, int count ) const
{
	return group.rigidCount( scene ) * ( count - 1 ) > kMostRigidSubsteps;
}

/// Bodies that may, and whose own group is too large, take the implicit step whole; the impacts of those that land are not resolved. The
/// group must be chosen again.
void SoftBodySystem::leaveLargeGroups( const SubstepGroup::Scene& scene, btScalar gameStep, int count )
{
	for ( SoftBody* body : m_substepped )
	{
		ElasticityState& state = body->impl().elasticity;
		const bool movesInParts = state.landingTime > 0.0 || state.rolling > 0.0;
		if ( !movesInParts && !ImplicitChoice::mayLeaveGroup( *body ) )
		{
			continue;
		}
		group.choose( scene, { body }, gameStep );
		if ( !isGroupTooLarge( scene, count ) )
		{
			continue;
		}
		state.landingTime = state.rolling = 0.0;
		movesInParts ? void() : ImplicitChoice::leaveGroup( *body );
	}
}

int SoftBodySystem::substepsOf( const SoftBody& body ) const
{
	return group.isEmpty() || ( group.isSplit() && !group.contains( body ) ) ? 1 : m_substepCount;
}

} // namespace pliant
