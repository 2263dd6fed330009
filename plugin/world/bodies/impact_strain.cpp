// The strain at the peak of an impact on a brittle body that sound crosses within the substep: docs/design/fracture.md, "Impacts on stiff
// bodies".

#include "body/breaking.h"
#include "body/implicit/implicit_motion.h"
#include "matching/implicit/conjugate_gradients.h"
#include "world/block/implicit_choice.h"
#include "world/bodies/soft_body_impl.h"
#include "world/constants.h"
#include "world/rigid/rigid_impacts.h"
#include "world/step/soft_body_system.h"

#include <algorithm>
#include <cmath>

namespace pliant {

namespace {

/// The load on one body of a block by its contacts.
struct ImpactLoad
{
	AlignedArray<float> impulse;  ///< on the nodes, N s, component after component
	AlignedArray<float> stopping; ///< the impulse that would stop all approaches within the substep
	Vec3d sum = Vec3d::Zero();    ///< of `impulse`, N s
	double energy = 0.0;          ///< that its impacts take from the motion of the bodies, J
	std::vector<int> partners;    ///< indices of the soft parts that hit it
};

/// Returns the velocity with which a contact meets, without what the substep's forces add, m/s.
double approachOf( const BlockContact& contact )
{
	return contact.isAttachment() ? 0.0 : std::max( 0.0, -contact.normal.dot( contact.velocityBefore ) );
}

/// Returns the factor to a contact's impulse that stops its approach at once: one that closes a gap within the substep ends it at the
/// velocity of that, and one that bounces goes on to its rebound. `fastest`: approach of the body's contacts; slow ones support it.
double stoppingFactor( const BlockContact& contact, double approach, double fastest )
{
	return approach > kLeastStopped * fastest ? approach / std::max( approach + contact.target, kLeastStopped * approach ) : 1.0;
}

void addImpulse( const ContactSide& side, const Vec3d& normal, const Vec3d& impulse, AlignedArray<float>& to )
{
	const std::size_t padded = to.size() / 3;
	side.shared.share( normal, impulse, [&]( int node, const Vec3d& own ) {
		for ( std::size_t k = 0; k < 3; ++k )
		{
			to[k * padded + std::size_t( node )] += float( own[int( k )] );
		}
	} );
}

/// Calls visit( contact, side ) for the contacts of a body that press, with its side.
template <class Visit>
void forPressing( const IslandBlock& block, int part, const Visit& visit )
{
	for ( const BlockContact& contact : block.contacts )
	{
		for ( int side = 0; side < 2; ++side )
		{
			if ( contact.side[side].soft == part && contact.normalImpulse != 0.0 )
			{
				visit( contact, side );
			}
		}
	}
}

ImpactLoad contactLoadOn( const IslandBlock& block, int part )
{
	ImpactLoad load;
	load.impulse.assign( std::size_t( block.soft[std::size_t( part )].owner->impl().body->nodes().padded ) * 3, 0.0f );
	load.stopping = load.impulse;
	double fastest = 0.0;
	forPressing( block, part, [&]( const BlockContact& contact, int ) { fastest = std::max( fastest, approachOf( contact ) ); } );
	forPressing( block, part, [&]( const BlockContact& contact, int side ) {
		const double approach = approachOf( contact ), factor = stoppingFactor( contact, approach, fastest );
		const Vec3d impulse = ( side == 0 ? 1.0 : -1.0 ) * contact.impulse();
		load.sum += impulse;
		addImpulse( contact.side[side], contact.normal, impulse, load.impulse );
		addImpulse( contact.side[side], contact.normal, factor * impulse, load.stopping );
		load.energy += 0.5 * factor * contact.normalImpulse * approach;
		const int partner = contact.side[1 - side].soft;
		if ( partner >= 0 && std::find( load.partners.begin(), load.partners.end(), partner ) == load.partners.end() )
		{
			load.partners.push_back( partner );
		}
	} );
	return load;
}

/// The energy of impulses on the nodes of a body whose elasticity is not part of the solution, J.
double energyOfNodes( const SoftBody& body, const AlignedArray<float>& impulse )
{
	const NodeState& nodes = body.impl().body->nodes();
	double sum = 0.0;
	for ( std::size_t i = 0; i < impulse.size(); ++i )
	{
		const double mass = double( nodes.mass[i % std::size_t( nodes.padded )] ), own = double( impulse[i] );
		sum += mass > 0.0 ? 0.5 * own * own / mass : 0.0;
	}
	return sum;
}

/// Returns impulses on the nodes of an implicit body less those of the rigid motions of its free parts.
AlignedArray<float> withoutRigidMotion( SoftBody& body, const AlignedArray<float>& impulse )
{
	const NodeState& nodes = body.impl().body->nodes();
	AlignedArray<float> rest( impulse.size() );
	body.impl().body->implicit()->giveMomentum( impulse.data(), rest.data() );
	for ( std::size_t i = 0; i < rest.size(); ++i )
	{
		rest[i] = impulse[i] - nodes.mass[i % std::size_t( nodes.padded )] * rest[i];
	}
	return rest;
}

/// The fraction of the energy of impulses on the nodes that is left without the rigid motions of their momentum: none of an impulse that
/// stops every node alike, as that of a pane of one layer that lands flat, strains the body.
double strainingFraction( SoftBody& body, const AlignedArray<float>& impulse )
{
	const double whole = energyOfNodes( body, impulse );
	return whole > 0.0 ? energyOfNodes( body, withoutRigidMotion( body, impulse ) ) / whole : 0.0;
}

/// Whether an impact on an implicit body is over before its links are tested, or damped by the step.
bool missesImpacts( const SoftBody& body, double h )
{
	return resolvedFraction( body, h ) == 0.0 || body.impl().body->numericalDamping() > kMostResolvedDamping;
}

} // namespace

bool couldBreak( const SoftBody& body, double energy )
{
	const double d = double( body.impl().bodyTemplate->cellSize() ), strain = body.impl().body->weakestBreakStrain();
	return energy > 0.0 && energy > 0.5 * double( body.material().youngsModulus ) * strain * strain * d * d * d;
}

// An impact lasts as long as sound takes to cross the body a few times. A substep that is longer spreads its impulse p over h: its force is
// too small by the ratio of the two. As the body is in equilibrium meanwhile, the strain at the peak has the shape of its response to p,
// w = A^-1 p without rigid motions, and its energy is what the impact has taken from the bodies' motion:
//
//   peak displacement = s h w,   s^2 = 1.7 gamma f E / U,   E = sum jn a / 2 over the contacts,   U = sum p w / 2 over the body and those
//   that hit it
//
// a: the velocity at which a contact meets; f: strainingFraction; 1.7 for the waves that add to it (kImpactWaves). The tolerance of the
// solution is a fraction of the whole impulse and may strain a stiff body by more than the impact: the velocities that strain it are solved
// more accurately, for the same impulses.
void SoftBodySystem::noteImpacts( double h )
{
	for ( int k = 0; k < implicitSolve().blockCount(); ++k )
	{
		const IslandBlock& block = implicitSolve().block( k );
		for ( int part = 0; part < int( block.soft.size() ); ++part )
		{
			SoftBody& body = *block.soft[std::size_t( part )].owner;
			if ( body.impl().isImplicit && body.impl().body->breaking() && missesImpacts( body, h ) )
			{
				strainByImpact( block, part, h );
			}
		}
	}
}

double SoftBodySystem::respondTo( SoftBody& body, const AlignedArray<float>& impulse, AlignedArray<float>& response, double fraction )
{
	IslandBlock& block = implicitSolve().responseBlock( body, tasks() );
	const ImplicitMotion& motion = *body.impl().body->implicit();
	const AlignedArray<float> load = withoutRigidMotion( body, impulse ), none( impulse.size() );
	motion.giveMomentum( none.data(), response.data() );
	block.respond( load.data(), response.data(), fraction );
	motion.giveMomentum( none.data(), response.data() );
	return 0.5 * dot( load.data(), response.data(), int( load.size() ) );
}

// Parts that hardly resist, as one that hangs by a link, would be thrown by impulses that are not exact.
void SoftBodySystem::refineSolution( SoftBody& body, const AlignedArray<float>& impulse, double most )
{
	ImplicitMotion& motion = *body.impl().body->implicit();
	const std::size_t padded = std::size_t( motion.padded() );
	AlignedArray<float> all( impulse.size() ), momentum( impulse.size() ), velocity( impulse.size() );
	motion.copyVelocities( velocity.data() );
	for ( std::size_t i = 0; i < all.size(); ++i )
	{
		all[i] = motion.rightSide()[i] + impulse[i];
		momentum[i] = motion.nodes().mass[i % padded] * velocity[i];
	}
	respondTo( body, all, velocity, kResponseFraction );
	motion.giveMomentum( momentum.data(), velocity.data() );
	for ( std::size_t i = 0; i < all.size(); ++i )
	{
		all[i] = motion.nodes().mass[i % padded] * velocity[i] - momentum[i];
	}
	if ( energyOfNodes( body, all ) <= most )
	{
		motion.setNodeVelocities( velocity.data() );
	}
}

void SoftBodySystem::strainByImpact( const IslandBlock& block, int part, double h )
{
	const ImpactLoad load = contactLoadOn( block, part );
	SoftBody& body = *block.soft[std::size_t( part )].owner;
	// The impulse without that of the weight, and its energy: what rests or slides is not solved again.
	const Vec3d pushed = load.sum + body.impl().mass * h * toVec3d( gravityOf( body ) );
	const double pushEnergy = pushed.squaredNorm() / ( 2.0 * body.impl().mass );
	const double largestEnergy = std::max( load.energy, kSolutionError * pushEnergy );
	if ( !couldBreak( body, largestEnergy ) )
	{
		return;
	}
	const double strains = strainingFraction( body, load.stopping ), energy = strains * load.energy;
	if ( strains < kLeastStrainingImpulse )
	{
		return; // the velocities are better than these impulses: their differences would bend a pane
	}
	if ( !block.isUnsettled() ) // else the velocities are better than these impulses too: a piece of six cells took 217 m/s
	{
		refineSolution( body, load.impulse, largestEnergy );
	}
	if ( !couldBreak( body, energy ) )
	{
		return;
	}
	AlignedArray<float> other;
	double stored = 0.0;
	for ( const int partner : load.partners )
	{
		SoftBody& hit = *block.soft[std::size_t( partner )].owner;
		const ImpactLoad back = contactLoadOn( block, partner );
		other.assign( back.stopping.size(), 0.0f );
		stored += hit.impl().isImplicit ? respondTo( hit, back.stopping, other, kPeakFraction ) : energyOfNodes( hit, back.stopping );
	}
	strainAtPeak( body, load.stopping, energy, stored, h );
}

// Positions stay those at the start of the substep, in which the body is not strained.
void SoftBodySystem::strainRigid( SoftBody& body, const AlignedArray<float>& stopping, double energy, double h )
{
	Body& own = *body.impl().body;
	const Breaking& breaking = *own.breaking();
	if ( !breaking.broken.empty() || ( breaking.coolDown > 0.0f && !breaking.planes ) )
	{
		return;
	}
	const Vec3Array velocity = own.nodes().v;
	own.pushImplicitly( float( h ), body.impl().plan.alpha, Vec3::Zero(), tasks() );
	const double strains = strainingFraction( body, stopping );
	if ( strains >= kLeastStrainingImpulse && couldBreak( body, strains * energy ) )
	{
		strainAtPeak( body, stopping, strains * energy, 0.0, h );
		own.testLinks( 0.0f ); // accelerateRigid has counted the time
	}
	own.nodes().v = velocity;
}

void SoftBodySystem::strainAtPeak( SoftBody& body, const AlignedArray<float>& stopping, double energy, double storedElsewhere, double h )
{
	AlignedArray<float> response( stopping.size() );
	const double stored = respondTo( body, stopping, response, kPeakFraction ) + storedElsewhere;
	if ( !( stored > 0.0 ) )
	{
		return; // the impulses only move the body
	}
	const double square = body.impl().body->implicit()->gamma() * energy / stored;
	if ( const double strained = kImpactWaves * std::sqrt( square ); strained > 1.0 && std::isfinite( strained ) ) // s
	{
		std::transform(
			response.begin(), response.end(), response.begin(), [by = float( ( strained - 1.0 ) * h )]( float w ) { return by * w; } );
		body.impl().body->noteImpact( response.data(), energy );
	}
}

} // namespace pliant
