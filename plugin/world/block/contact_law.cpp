// The contact law of a block, linearised at given velocities.
//
//   jn = max( 0, ln + k ( b - u.n ) ),   ln the impulse of the last substep
//   jt = s ( lt - ks ut ),   s = min( 1, mu jn / | lt - ks ut | ),   ks = min( k, mu jn / u_eps )
//
// Both follow from an augmented Lagrangian of Signorini's and Coulomb's laws with one multiplier update per substep (Alart and Curnier
// 1991): a contact that stays active converges to u.n = b and, while it sticks, to ut = 0, however soft k is. The derivative of jt is
// replaced by its secant, - s ks, which can only dissipate; Newton's derivative reverses small slips and makes stacks fly apart.
//
// Anisotropic friction (btCollisionObject::setAnisotropicFriction): the same law yields t, of length mu jn at most, and jt = S t. S holds
// the objects' scales in their own axes, without the normal. Sliding along t is resisted by mu jn S t, as in Bullet's solver.

#include "world/block/island_block.h"
#include "world/bodies/soft_body_impl.h"
#include "world/constants.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

namespace pliant {

namespace {

struct Law
{
	double tangentStiffness;
	Vec3d scaledMultiplier;
};

double pressAt( const BlockContact& contact, const Vec3d& u )
{
	return contact.normalMultiplier + contact.stiffness * ( contact.target - contact.normal.dot( u ) );
}

Vec3d velocityOfNodes( const BlockContact& contact, const ContactSide& side, const Vec3Array& v )
{
	return side.shared.velocity( contact.normal, [&]( int node ) { return Vec3d( v.get( node ).cast<double>() ); } );
}

Law lawAt( const BlockContact& contact, const Vec3d& u, double press )
{
	if ( contact.isAttachment() )
	{
		return Law{ contact.stiffness, contact.tangentMultiplier };
	}
	const double along = contact.normal.dot( u );
	if ( !( press > 0.0 ) )
	{
		return Law{ 0.0, Vec3d::Zero() };
	}
	const double limit = contact.friction * press;
	const double stick = std::min( contact.stiffness, limit / kSlipSpeed );
	const Vec3d trial = contact.tangentMultiplier - stick * ( u - along * contact.normal );
	const double size = trial.norm();
	const double fraction = size > limit ? limit / size : 1.0;
	return Law{ fraction * stick, fraction * contact.tangentMultiplier };
}

/// Returns the relative velocity at a contact, m/s, where nodes have the velocities `ofNodes`( part ) and rigid parts `ofRigid`.
template <class OfNodes>
Vec3d velocityBetween( const IslandBlock& block, const BlockContact& contact, const OfNodes& ofNodes, Vector6 RigidPart::*ofRigid )
{
	Vec3d velocity[2];
	for ( int k = 0; k < 2; ++k )
	{
		const ContactSide& side = contact.side[k];
		velocity[k] = side.prescribedVelocity;
		if ( side.soft >= 0 )
		{
			velocity[k] += velocityOfNodes( contact, side, ofNodes( block.soft[std::size_t( side.soft )] ) );
		}
		else if ( side.rigid >= 0 )
		{
			const Vector6& motion = block.rigid[std::size_t( side.rigid )].*ofRigid;
			velocity[k] += motion.head<3>() + motion.tail<3>().cross( side.arm );
		}
	}
	return velocity[0] - velocity[1];
}

} // namespace

Vec3d IslandBlock::freeVelocity( const BlockContact& contact ) const
{
	return velocityBetween(
		*this, contact, []( const SoftPart& part ) -> const Vec3Array& { return part.motion->nodes().v; }, &RigidPart::freeVelocity );
}

const Vec3d& IslandBlock::angularVelocityOf( const ContactSide& side )
{
	SoftPart& part = soft[std::size_t( side.soft )];
	const ImplicitMotion& motion = wholeOf( part );
	if ( part.angularVelocity.empty() )
	{
		for ( int k = 0; k < motion.parts().count(); ++k )
		{
			part.angularVelocity.push_back(
				motion.hasShape( k ) ? Vec3d( motion.rigidMotion( motion.momentum( k ), k ).tail<3>() ) : Vec3d( Vec3d::Zero() ) );
		}
	}
	return part.angularVelocity[std::size_t( motion.parts().partOf( side.node ) )];
}

double IslandBlock::rollingLag( const BlockContact& contact, double h )
{
	double sum = 0.0;
	for ( int k = 0; k < 2; ++k )
	{
		const ContactSide& side = contact.side[k];
		if ( side.soft < 0 )
		{
			continue;
		}
		const SoftBody::Impl& impl = soft[std::size_t( side.soft )].owner->impl();
		const double radius = impl.surfaceNow().rollingRadius(
			impl.body->nodes(), side.node, k == 0 ? Vec3d( -contact.normal ) : contact.normal );
		if ( radius > 0.0 )
		{
			const Vec3d& turn = angularVelocityOf( side );
			sum += 0.5 * h * radius * ( turn - turn.dot( contact.normal ) * contact.normal ).squaredNorm();
		}
	}
	return sum;
}

// A node of a rolling body that lands within a step is stopped at the surface at its end, on average half a step too early: this presses
// the front of the body and brakes the rotation. So it may end deeper, the more the farther it was apart. Contacts on the drawn surface do
// not need it.
double IslandBlock::landingDepth( const BlockContact& contact, double gap ) const
{
	double depth = 0.0;
	for ( const ContactSide& side : contact.side )
	{
		if ( side.soft >= 0 && !contact.isDrawn )
		{
			const SoftPart& part = soft[std::size_t( side.soft )];
			const double most = kLandingDepth * double( part.owner->impl().shape->sphereOfNode( side.node )->getRadius() );
			depth = std::max( depth, part.owner->impl().elasticity.rolling * std::min( kLandingGaps * gap, most ) );
		}
	}
	return depth;
}

Vec3d IslandBlock::velocityBefore( const BlockContact& contact ) const
{
	return velocityBetween(
		*this, contact, []( const SoftPart& part ) -> const Vec3Array& { return *part.velocityBefore; }, &RigidPart::velocityBefore );
}

// Returns the last substep's impulse t from the stored S t; components that S suppresses are zero.
Vec3d IslandBlock::unscaledTangentImpulse( const BlockContact& contact ) const
{
	if ( contact.frictionScale < 0 )
	{
		return contact.tangentImpulse;
	}
	const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes( frictionScales[std::size_t( contact.frictionScale )] );
	const double floor = kLeastDirection * std::max( 1.0, axes.eigenvalues()[2] );
	const Vec3d inverse = ( axes.eigenvalues().array() > floor ).select( axes.eigenvalues().array().max( floor ).inverse(), 0.0 );
	return axes.eigenvectors() * ( inverse.asDiagonal() * ( axes.eigenvectors().transpose() * contact.tangentImpulse ) );
}

// A small piece that comes off under a load keeps its contacts' impulses. An impulse ln separates a contact by ln / k at most, so that the
// piece leaves at no more than kPushOutSpeed with the k that is returned, kg; 0 where the body is heavy enough for the k of its nodes.
double IslandBlock::stiffnessForPieces( const BlockContact& contact ) const
{
	const bool isThrowable = !contact.isAttachment() &&
		std::any_of( std::begin( contact.side ), std::end( contact.side ), [&]( const ContactSide& side ) {
			return side.soft >= 0 &&
				contact.normalImpulse > kContactStiffness * kPushOutSpeed * double( soft[std::size_t( side.soft )].owner->mass() );
		} );
	return isThrowable ? contact.normalImpulse / kPushOutSpeed : 0.0;
}

// k is a multiple of the nodes' own resistance: large enough for a small error at first contact, and small enough for good conditioning.
void IslandBlock::chooseStiffness()
{
	for ( BlockContact& contact : contacts )
	{
		double least = HUGE_VAL;
		for ( const ContactSide& side : contact.side )
		{
			least = side.soft < 0 ? least : std::min( least, double( soft[std::size_t( side.soft )].motion->diagonal( side.node ) ) );
		}
		// A marble has a thousandth of the resistance of a stiff body's nodes. With k from the nodes the iteration's final error would be
		// as large as the marble's weight. One that carries much more than itself needs more: pressed with little, it would give
		// way for several steps, and be thrown.
		const bool hasNode = contact.side[0].soft >= 0 || contact.side[1].soft >= 0;
		const double load = contact.isAttachment() ? 0.0 : contact.normalImpulse / kLoadVelocity;
		for ( const ContactSide& side : contact.side )
		{
			const RigidPart* const part = side.rigid < 0 ? nullptr : &rigid[std::size_t( side.rigid )];
			// An attachment's load may be heavy for the body, which resists with more than its mass where joints hold it.
			const bool isJointed = contact.isAttachment() && part && part->linked >= 0 && linked[std::size_t( part->linked )].joints;
			if ( part && !isJointed && !( hasNode && !contact.isDrawn && !contact.isAttachment() ) )
			{
				least = std::min( least, std::max( part->mass, load ) );
			}
		}
		contact.stiffness = ( contact.hasExplicitSide ? kExplicitAttachmentStiffness : kContactStiffness ) * least;
		contact.stiffness = std::max( contact.stiffness, stiffnessForPieces( contact ) );
		contact.normalMultiplier = contact.normalImpulse;
		contact.tangentMultiplier = unscaledTangentImpulse( contact );
		if ( contact.compliance > 0.0 )
		{
			contact.stiffness = contact.timeStep * contact.timeStep / contact.compliance;
		}
		if ( contact.isAttachment() )
		{
			contact.tangentMultiplier += contact.stiffness * contact.tangentTarget;
		}
	}
}

// In the first pass the velocities are the last substep's, for which the law's impulses mean little: contacts keep their last impulses.
//
// Friction limits are mu times the last solved normal impulse, not the law's impulse at the current velocities: k is ten times the nodes'
// resistance, so after a partial step or for a new contact the law's impulse is ten times too large or more and would stop light objects.
// New contacts therefore have no friction in the first pass, and contacts that were active keep their limits after an unphysical pass, up
// to kMostFairPasses: limits that are too high can themselves keep passes unphysical.
void IslandBlock::linearise( const float* v, int passes )
{
	const bool isFirst = passes == 0, keeps = !isFirst && passes < kMostFairPasses && isUnphysical();
	for ( BlockContact& contact : contacts )
	{
		const bool wasActive = contact.normalMultiplier > 0.0;
		if ( !( keeps && wasActive ) )
		{
			contact.frictionLoad = std::max( 0.0, isFirst ? contact.normalMultiplier : contact.normalImpulse );
		}
		const Vec3d u = relativeVelocity( contact, v );
		const Law law = lawAt( contact, u, contact.frictionLoad );
		contact.isActive = contact.isAttachment() || ( isFirst && wasActive ) || pressAt( contact, u ) > 0.0;
		contact.tangentStiffness = law.tangentStiffness;
		contact.scaledMultiplier = law.scaledMultiplier;
	}
	listActive();
}

IslandBlock::Match IslandBlock::matchAt( const float* v )
{
	double normalError = 0.0, totalNormal = 0.0, tangentError = 0.0, totalLimit = 0.0;
	m_partErrors.assign( soft.size() + rigid.size(), PartError{} );
	for ( const BlockContact& contact : contacts )
	{
		if ( contact.isAttachment() )
		{
			continue; // its law is linear
		}
		const Vec3d u = relativeVelocity( contact, v );
		const double along = contact.normal.dot( u );
		const double press = std::max( 0.0, pressAt( contact, u ) ), limit = contact.friction * press;
		const Law law = lawAt( contact, u, press );
		const Vec3d error = applyFrictionScale( contact, law.scaledMultiplier - law.tangentStiffness * ( u - along * contact.normal ) ) -
			contact.tangentImpulse;
		normalError += std::abs( press - contact.normalImpulse );
		tangentError += error.norm();
		totalNormal += press;
		totalLimit += limit;
		for ( int k = 0; k < 2; ++k )
		{
			const ContactSide& side = contact.side[k];
			if ( const int part = side.soft >= 0 ? side.soft : side.rigid >= 0 ? int( soft.size() ) + side.rigid : -1; part >= 0 )
			{
				m_partErrors[std::size_t( part )].tangent += k == 0 ? error : Vec3d( -error );
				m_partErrors[std::size_t( part )].limit += limit;
			}
		}
	}
	const auto isClose = []( const PartError& part ) { return part.tangent.norm() <= kPartError * part.limit; };
	return Match{ normalError <= kImpulseError * totalNormal && tangentError <= kImpulseError * totalLimit,
		std::all_of( m_partErrors.begin(), m_partErrors.end(), isClose ) };
}

// Contacts that pull while they approach add energy, and so does excessive friction on bouncing objects. A small error in friction, with
// which most last passes end, does not.
bool IslandBlock::isUnphysical() const
{
	double pull = 0.0, press = 0.0, tangent = 0.0, limit = 0.0;
	for ( const BlockContact& contact : contacts )
	{
		if ( contact.isAttachment() )
		{
			continue;
		}
		( contact.normalImpulse < 0.0 ? pull : press ) += std::abs( contact.normalImpulse );
		tangent += contact.tangentImpulse.norm();
		limit += contact.friction * std::max( 0.0, contact.normalImpulse );
	}
	return pull > kImpulseError * press || tangent > kLargestFrictionTorque * limit;
}

namespace {

/// The smaller mass of a contact's nodes, kg.
double nodeMass( const IslandBlock& block, const BlockContact& contact )
{
	double least = std::numeric_limits<double>::max();
	for ( const ContactSide& side : contact.side )
	{
		if ( side.soft >= 0 )
		{
			least = std::min( least, double( block.soft[std::size_t( side.soft )].motion->nodes().mass[std::size_t( side.node )] ) );
		}
	}
	return least;
}

} // namespace

// After a pass in which contacts of a stiff body pull, all of them may release at once. For each body, because a light one counts little
// beside a heap.
bool IslandBlock::leavesApproach()
{
	m_partErrors.assign( soft.size(), PartError{} );
	for ( const BlockContact& contact : contacts )
	{
		double left = 0.0;
		if ( !contact.isActive )
		{
			const double along = contact.normal.dot( relativeVelocity( contact, m_next.data() ) );
			left = nodeMass( *this, contact ) * std::max( 0.0, contact.target - along - double( kGradientSpeed ) );
		}
		for ( const ContactSide& side : contact.side )
		{
			if ( side.soft >= 0 && !contact.isAttachment() )
			{
				PartError& part = m_partErrors[std::size_t( side.soft )];
				part.limit += std::abs( contact.normalImpulse );
				part.left += left;
			}
		}
	}
	return std::any_of(
		m_partErrors.begin(), m_partErrors.end(), []( const PartError& part ) { return part.left > kLargestMomentumLeft * part.limit; } );
}

// Uses the linearised law, not the law at v: impulses that belong to no solved system would add energy.
void IslandBlock::readImpulses( const float* v )
{
	for ( BlockContact& contact : contacts )
	{
		const Vec3d u = relativeVelocity( contact, v );
		const double along = contact.normal.dot( u );
		contact.normalImpulse = contact.isActive ? contact.normalMultiplier + contact.stiffness * ( contact.target - along ) : 0.0;
		const Vec3d tangent = contact.scaledMultiplier - contact.tangentStiffness * ( u - along * contact.normal );
		contact.tangentImpulse = contact.isActive ? applyFrictionScale( contact, tangent ) : Vec3d( Vec3d::Zero() );
	}
}

// With fixed friction secants the minimised energy is convex and piecewise quadratic. Returns the fraction t of the step d with the lowest
// energy, where slope( t ) = d.( M v - b ) + t d.M d - sum over contacts of ( jn n + jt ).u( d ) is zero.
double IslandBlock::lowestFraction( double slope, double curvature ) const
{
	const auto slopeAt = [&]( double t ) {
		double sum = slope + t * curvature;
		for ( const LineContact& line : m_lineContacts )
		{
			const double law = line.normalMultiplier + line.stiffness * ( line.target - line.normalStart - t * line.normalChange );
			sum -= ( line.pulls ? law : std::max( 0.0, law ) ) * line.normalChange + ( line.slideStart + t * line.slideChange );
		}
		return sum;
	};
	if ( slopeAt( 1.0 ) <= 0.0 )
	{
		return 1.0;
	}
	double low = 0.0, high = 1.0;
	for ( int k = 0; k < kLineSearchHalvings; ++k )
	{
		const double middle = 0.5 * ( low + high );
		( slopeAt( middle ) > 0.0 ? high : low ) = middle;
	}
	return low;
}

double IslandBlock::stepTowards()
{
	AlignedArray<float>&d = m_scratch, &change = m_rightSide; // step in v, and in M v
	for ( int k = 0; k < m_size; ++k )
	{
		d[k] = m_next[k] - m_v[k];
		change[k] = m_free[k] - m_freeNext[k];
	}
	m_lineContacts.clear();
	for ( const BlockContact& contact : contacts )
	{
		const Vec3d u = relativeVelocity( contact, m_v.data() ),
					du = velocityOf( contact.side[0], contact.normal, d.data() ) - velocityOf( contact.side[1], contact.normal, d.data() );
		const double un = contact.normal.dot( u ), dn = contact.normal.dot( du );
		const Vec3d ut = u - un * contact.normal, dt = du - dn * contact.normal, scaled = applyFrictionScale( contact, dt );
		const double slideStart = contact.scaledMultiplier.dot( scaled ) - contact.tangentStiffness * ut.dot( scaled ),
					 slideChange = -contact.tangentStiffness * dt.dot( scaled );
		const bool isActive = contact.isActive;
		m_lineContacts.push_back( LineContact{ un, dn, isActive ? slideStart : 0.0, isActive ? slideChange : 0.0, contact.normalMultiplier,
			contact.stiffness, contact.target, contact.isAttachment() } );
	}
	return lowestFraction( -dot( d.data(), m_free.data(), m_size ), dot( d.data(), change.data(), m_size ) );
}

} // namespace pliant
