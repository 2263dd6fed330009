// Conflicting contacts: fixed objects may require velocities of a node that it cannot have at once, e.g. a plate nearer to the floor than a
// node is wide, a slot between two walls, or a corner of one wall below another. Each contact has a target separation speed, and impulses
// carry over from substep to substep. Where no target is ever reached they would grow without bound and be released at once when the plate
// leaves. The targets of such contacts are therefore moved to a compromise.

#include "world/block/island_block.h"
#include "world/constants.h"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>

namespace pliant {

namespace {

/// n.w >= least, w the node's velocity.
struct Constraint
{
	Vec3d normal;
	double least;

	double violation( const Vec3d& w ) const { return least - normal.dot( w ); }
};

Constraint constraintOf( const BlockContact& contact, int side )
{
	const Vec3d normal = side == 0 ? contact.normal : Vec3d( -contact.normal );
	return Constraint{ normal, contact.target + normal.dot( contact.side[1 - side].prescribedVelocity ) };
}

/// Returns true if objects of prescribed velocity press on the block from opposite sides.
bool isSqueezed( const std::vector<BlockContact>& contacts )
{
	Vec3d low = Vec3d::Zero(), high = Vec3d::Zero();
	for ( const BlockContact& contact : contacts )
	{
		for ( int k = 0; k < 2; ++k )
		{
			const ContactSide& other = contact.side[1 - k];
			if ( contact.isActive && !contact.isAttachment() && other.soft < 0 && other.rigid < 0 )
			{
				const Vec3d normal = k == 0 ? contact.normal : Vec3d( -contact.normal );
				low = low.cwiseMin( normal );
				high = high.cwiseMax( normal );
			}
		}
	}
	return ( low.array() < -kSqueezeCosine && high.array() > kSqueezeCosine ).any();
}

} // namespace

void IslandBlock::reconcileTargets()
{
	m_prescribed.clear();
	for ( std::size_t c = 0; c < contacts.size(); ++c )
	{
		for ( int k = 0; k < 2; ++k )
		{
			const ContactSide &own = contacts[c].side[k], &other = contacts[c].side[1 - k];
			if ( own.soft >= 0 && other.soft < 0 && other.rigid < 0 && !contacts[c].isAttachment() )
			{
				m_prescribed.push_back( PrescribedContact{ own.block[0], c, k } );
			}
		}
	}
	std::stable_sort( m_prescribed.begin(), m_prescribed.end(),
		[]( const PrescribedContact& a, const PrescribedContact& b ) { return a.node < b.node; } );
	for ( std::size_t first = 0, end = 0; first < m_prescribed.size(); first = end )
	{
		for ( end = first; end < m_prescribed.size() && m_prescribed[end].node == m_prescribed[first].node; ++end )
		{}
		if ( end - first > 1 )
		{
			reconcileTargets( first, end );
		}
	}
}

// There is no conflict where some velocity satisfies all constraints and is not much larger than they require (between two walls that
// almost face each other it would be). Otherwise the compromise minimises the squared violations, with a small weight on the objects' mean
// velocity.
void IslandBlock::reconcileTargets( std::size_t first, std::size_t end )
{
	const auto constraint = [this]( std::size_t k ) { return constraintOf( contacts[m_prescribed[k].contact], m_prescribed[k].side ); };
	Vec3d mean = Vec3d::Zero();
	for ( std::size_t k = first; k < end; ++k )
	{
		mean += contacts[m_prescribed[k].contact].side[1 - m_prescribed[k].side].prescribedVelocity / double( end - first );
	}
	double largest = 0.0;
	for ( std::size_t k = first; k < end; ++k )
	{
		largest = std::max( largest, constraint( k ).violation( mean ) );
	}
	const auto violates = [&]( const Vec3d& w, std::size_t k ) { return constraint( k ).violation( w ) > kAgreedFraction * largest; };
	Vec3d velocity = mean;
	bool isViolated = true;
	for ( int sweep = 0; sweep < kAgreeSweeps && isViolated; ++sweep )
	{
		isViolated = false;
		for ( std::size_t k = first; k < end; ++k )
		{
			if ( violates( velocity, k ) )
			{
				const Constraint own = constraint( k );
				velocity += own.violation( velocity ) * own.normal;
				isViolated = true;
			}
		}
	}
	if ( !isViolated && ( velocity - mean ).norm() <= kLargestExitDistance * largest )
	{
		return;
	}
	velocity = mean;
	for ( int round = 0; round < kAgreeSweeps; ++round )
	{
		Eigen::Matrix3d sum = kAgreeRest * Eigen::Matrix3d::Identity();
		Vec3d right = Vec3d::Zero();
		for ( std::size_t k = first; k < end; ++k )
		{
			if ( const Constraint own = constraint( k ); own.violation( velocity ) > 0.0 )
			{
				sum += own.normal * own.normal.transpose();
				right += own.violation( mean ) * own.normal;
			}
		}
		const Vec3d next = mean + sum.inverse() * right;
		const bool isSame = ( next - velocity ).norm() <= kAgreedFraction * largest;
		velocity = next;
		if ( isSame )
		{
			break;
		}
	}
	for ( std::size_t k = first; k < end; ++k )
	{
		BlockContact& contact = contacts[m_prescribed[k].contact];
		const double reduction = std::max( 0.0, constraint( k ).violation( velocity ) );
		contact.target -= reduction;
		contact.targetWithoutBounce = std::min( contact.targetWithoutBounce, contact.target );
	}
}

// A block may also be squeezed with other bodies in between, so that no single node has conflicting contacts. A stuck contact there
// violates its target in every substep without changing; its carried impulse decays. If that removes support, the body moves and the decay
// ends.
void IslandBlock::carryImpulses()
{
	const bool isBlockSqueezed = isSqueezed( contacts );
	for ( BlockContact& contact : contacts )
	{
		contact.carried = contact.normalImpulse;
		const double along = contact.normal.dot( relativeVelocity( contact, m_v.data() ) ), violation = contact.target - along;
		const double change = std::abs( along - contact.normal.dot( contact.velocityBefore ) );
		if ( isBlockSqueezed && contact.isActive && !contact.isAttachment() && violation > kConflictViolation &&
			change < kConflictChange * violation )
		{
			contact.carried = std::max( 0.0, ( 1.0 - kConflictDecay ) * ( contact.normalImpulse - contact.stiffness * violation ) );
		}
	}
}

} // namespace pliant
