// Keeps restitution in a block from adding energy.
//
// With the block's A as the mass matrix the step is a leapfrog step, and an impulse P changes its energy by P . ( u' + u ) / 2, where u is
// the velocity at the start of the substep (docs/design/contacts.md, Restitution): by nothing where all contacts rebound with
// restitution 1. Contacts that push out of penetration, or are driven into something while they separate, may gain more than the others
// lose. Impulses scaled by s do the work s W - s ( 1 - s ) K, K = P . A^-1 P / 2: this takes one more system, solved only where W is above
// zero. Where s would be too small to stop the approaching bodies, only the bounce is reduced.

#include "world/block/island_block.h"
#include "world/constants.h"

#include <algorithm>
#include <cmath>

namespace pliant {

IslandBlock::Work IslandBlock::workOfContacts() const
{
	Work work;
	for ( const BlockContact& contact : contacts )
	{
		const Vec3d impulse = contact.impulse();
		const double after = impulse.dot( relativeVelocity( contact, m_v.data() ) ), before = impulse.dot( contact.velocityBefore );
		work.sum += 0.5 * ( after + before );
		work.moved += 0.5 * ( std::abs( after ) + std::abs( before ) );
	}
	return work;
}

void IslandBlock::limitEnergy( BlockCount& count )
{
	if ( std::none_of( contacts.begin(), contacts.end(), []( const BlockContact& contact ) { return contact.bounces; } ) )
	{
		return;
	}
	const Work work = workOfContacts();
	if ( !( work.sum > kBounceSlack * work.moved ) )
	{
		return;
	}
	std::fill( m_rightSide.begin(), m_rightSide.end(), 0.0f );
	for ( BlockContact& contact : contacts )
	{
		addPair( contact, contact.impulse(), m_rightSide.data() );
		contact.isActive = false;
	}
	listActive();
	fillPreconditioner();
	std::fill( m_next.begin(), m_next.end(), 0.0f );
	count.products += m_gradients.solve(
						  *this, m_rightSide.data(), m_next.data(), GradientLimits{ kGradientFraction, 0.0, kMostGradients } ) +
		1;

	const double energy = 0.5 * dot( m_rightSide.data(), m_next.data(), m_size );
	const double fraction = 1.0 - work.sum / energy;
	if ( fraction < kLeastBounce )
	{
		reduceBounce( count );
		return;
	}
	for ( int k = 0; k < m_size; ++k )
	{
		m_v[k] -= float( 1.0 - fraction ) * m_next[k];
	}
	for ( BlockContact& contact : contacts )
	{
		contact.normalImpulse *= fraction;
		contact.tangentImpulse *= fraction;
	}
}

// Without restitution contacts add no energy. Between that solution and the one with full restitution, P + s dP and u + s du, no contact is
// violated and friction stays within its limits. Takes the largest s with ( P + s dP ) . ( ( u + s du ) + before ) <= 0.
void IslandBlock::reduceBounce( BlockCount& count )
{
	m_bounced = m_v;
	m_bouncedImpulses.clear();
	for ( BlockContact& contact : contacts )
	{
		m_bouncedImpulses.push_back( ContactImpulse{ contact.normalImpulse, contact.tangentImpulse } );
		contact.target = contact.bounces ? contact.targetWithoutBounce : contact.target;
	}
	solveLaw( count );
	double constant = 0.0, linear = 0.0, square = 0.0;
	for ( std::size_t k = 0; k < contacts.size(); ++k )
	{
		const BlockContact& contact = contacts[k];
		const Vec3d impulse = contact.impulse();
		const Vec3d impulseChange = m_bouncedImpulses[k].normal * contact.normal + m_bouncedImpulses[k].tangent - impulse;
		const Vec3d after = relativeVelocity( contact, m_v.data() ), velocityChange = relativeVelocity( contact, m_bounced.data() ) - after;
		constant += impulse.dot( after + contact.velocityBefore );
		linear += impulse.dot( velocityChange ) + impulseChange.dot( after + contact.velocityBefore );
		square += impulseChange.dot( velocityChange );
	}
	double fraction = 0.0;
	for ( double step = 0.5; step > kLeastBounceStep; step *= 0.5 )
	{
		const double candidate = fraction + step;
		fraction = constant + candidate * ( linear + candidate * square ) <= 0.0 ? candidate : fraction;
	}
	for ( int k = 0; k < m_size; ++k )
	{
		m_v[k] += float( fraction ) * ( m_bounced[k] - m_v[k] );
	}
	for ( std::size_t k = 0; k < contacts.size(); ++k )
	{
		contacts[k].normalImpulse += fraction * ( m_bouncedImpulses[k].normal - contacts[k].normalImpulse );
		contacts[k].tangentImpulse += fraction * ( m_bouncedImpulses[k].tangent - contacts[k].tangentImpulse );
	}
}

bool IslandBlock::movesFreely() const
{
	return std::all_of( soft.begin(), soft.end(), []( const SoftPart& part ) { return !part.motion->hasHeldNodes(); } ) &&
		std::all_of( rigid.begin(), rigid.end(), []( const RigidPart& part ) { return part.linked < 0 && !part.hasLockedAxis(); } );
}

bool IslandBlock::mayCompleteBounce() const
{
	return std::all_of( contacts.begin(), contacts.end(),
			   []( const BlockContact& contact ) { return contact.bounces || contact.normalImpulse == 0.0; } ) &&
		std::any_of( contacts.begin(), contacts.end(), []( const BlockContact& contact ) { return contact.normalImpulse > 0.0; } ) &&
		std::all_of( soft.begin(), soft.end(),
			[]( const SoftPart& part ) { return part.motion->isElastic() && part.restitutionFraction == 1.0; } ) &&
		movesFreely();
}

void IslandBlock::addRigidMotions( const float* momentum, float* velocity ) const
{
	for ( const ConnectedPart& own : m_connected )
	{
		const SoftPart& part = soft[std::size_t( own.soft )];
		const Vector12 sums = part.motion->affineSums( momentum + part.offset, own.part ); // f, then the columns of f p^T
		Vector6 rigidSums;
		rigidSums << sums.head<3>(), sums[8] - sums[10], sums[9] - sums[5], sums[4] - sums[6];
		const Vector6 motion = part.motion->rigidMotion( rigidSums, own.part );
		const Vec3d turn = motion.tail<3>();
		Vector12 affine;
		affine << motion.head<3>(), turn.cross( Vec3d::UnitX() ), turn.cross( Vec3d::UnitY() ), turn.cross( Vec3d::UnitZ() );
		part.motion->addAffine( affine, velocity + part.offset, own.part );
	}
	for ( const RigidPart& part : rigid )
	{
		const Eigen::Map<const Eigen::Matrix<float, 6, 1>> own( momentum + part.offset );
		Eigen::Map<Eigen::Matrix<float, 6, 1>> to( velocity + part.offset );
		to.head<3>() += own.head<3>() / float( part.mass );
		to.tail<3>() += ( part.inertia.inverse() * own.tail<3>().cast<double>() ).cast<float>();
	}
}

/// m_next = the changes of the rigid motions by the impulses in m_rightSide.
void IslandBlock::respondRigidly()
{
	std::fill( m_next.begin(), m_next.end(), 0.0f );
	addRigidMotions( m_rightSide.data(), m_next.data() );
}

void IslandBlock::fillRigidMotions()
{
	std::fill( m_rightSide.begin(), m_rightSide.end(), 0.0f );
	for ( const SoftPart& part : soft )
	{
		const NodeState& nodes = part.motion->nodes();
		for ( int k = 0; k < part.motion->size(); k += nodes.padded )
		{
			for ( int i = 0; i < nodes.count; ++i )
			{
				m_rightSide[part.offset + k + i] = nodes.mass[i] * m_v[part.offset + k + i];
			}
		}
	}
	m_bounced = m_v;
	std::fill( m_bounced.begin(), m_bounced.end(), 0.0f );
	addRigidMotions( m_rightSide.data(), m_bounced.data() );
	for ( const RigidPart& part : rigid )
	{
		std::copy_n( m_v.data() + part.offset, 6, m_bounced.data() + part.offset );
	}
}

// At the end of the step the nodes of a contact have the velocity of restitution, but the body behind them is still being compressed. A
// step that does not resolve its vibrations damps the rebound by that compression. So if all contacts bounce, their normal impulses P are
// raised by a fraction s with which the rigid motions have the target velocities b in the mean,
//
//   sum jn ( n . ( u + s r ) - b ) = 0,   u: velocities of the rigid motions, r: those that P adds to them
//
// but at most so far that half of the energy that the contacts absorb is returned, - sum P . ( u' + before ) / 2 with the velocities u' of
// their nodes.
void IslandBlock::completeBounce()
{
	if ( !mayCompleteBounce() )
	{
		return;
	}
	fillRigidMotions();
	std::fill( m_rightSide.begin(), m_rightSide.end(), 0.0f );
	for ( const BlockContact& contact : contacts )
	{
		addPair( contact, contact.normalImpulse * contact.normal, m_rightSide.data() );
	}
	respondRigidly();

	double lack = 0.0, response = 0.0, work = 0.0;
	for ( const BlockContact& contact : contacts )
	{
		const Vec3d push = contact.normalImpulse * contact.normal;
		lack += contact.normalImpulse * contact.target - push.dot( relativeVelocity( contact, m_bounced.data() ) );
		response += push.dot( changeAt( contact, m_next.data() ) );
		work += push.dot( relativeVelocity( contact, m_v.data() ) + contact.velocityBefore );
	}
	const double fraction = std::min( { lack / response, -kBounceShare * work / response, kMostBounceRaise } );
	if ( !( fraction > 0.0 ) )
	{
		return;
	}
	for ( int k = 0; k < m_size; ++k )
	{
		m_v[k] += float( fraction ) * m_next[k];
	}
	for ( BlockContact& contact : contacts )
	{
		contact.normalImpulse *= 1.0 + fraction;
	}
}

/// Lists the contacts in which a body presses objects that move freely or not at all, in m_pressing; false if there are none or others.
bool IslandBlock::listPressing( int index )
{
	m_pressing.clear();
	for ( std::size_t k = 0; k < contacts.size(); ++k )
	{
		const BlockContact& contact = contacts[k];
		const bool isFirst = contact.side[0].soft == index;
		if ( ( !isFirst && contact.side[1].soft != index ) || !( contact.normalImpulse > 0.0 ) )
		{
			continue;
		}
		const ContactSide& other = contact.side[isFirst ? 1 : 0];
		const RigidPart* const object = other.rigid >= 0 ? &rigid[std::size_t( other.rigid )] : nullptr;
		if ( contact.isAttachment() || other.soft >= 0 || ( object && ( object->linked >= 0 || object->hasLockedAxis() ) ) )
		{
			return false; // two soft bodies rebound by their elasticity
		}
		m_pressing.push_back( k );
	}
	return !m_pressing.empty();
}

void IslandBlock::bounceAsRigid()
{
	for ( std::size_t k = 0; k < soft.size(); ++k )
	{
		if ( soft[k].bouncesAsRigid )
		{
			bounceAsRigid( soft[k], int( k ) );
		}
	}
}

// An explicit body that is simulated far softer than it is would be compressed for many substeps, and rebound by that elasticity. With the
// modulus that is set the impact lies within the substep. So the impulses P by which the solver stopped the body's nodes are raised by the
// fraction s with which its rigid motion, and that of the other body, separate at e times the velocity of approach,
//
//   sum P ( n . ( U + s R ) - e u ) = 0,   R the change of the rigid motions U by P,   u = n . ( R - U )
//
// and the body takes that rigid motion. The work is ( 1 + s ) ( e - 1 ) sum P u / 2, never positive.
void IslandBlock::bounceAsRigid( const SoftPart& part, int index )
{
	if ( !listPressing( index ) )
	{
		return;
	}
	fillRigidMotions();
	std::fill( m_rightSide.begin(), m_rightSide.end(), 0.0f );
	for ( const std::size_t k : m_pressing )
	{
		addPair( contacts[k], contacts[k].normalImpulse * contacts[k].normal, m_rightSide.data() );
	}
	respondRigidly();
	double press = 0.0, approach = 0.0, lack = 0.0, response = 0.0, friction = 0.0;
	for ( const std::size_t k : m_pressing )
	{
		const BlockContact& contact = contacts[k];
		const double after = contact.normal.dot( relativeVelocity( contact, m_bounced.data() ) );
		const double change = contact.normal.dot( changeAt( contact, m_next.data() ) );
		press += contact.normalImpulse;
		approach += contact.normalImpulse * ( change - after );
		lack += contact.normalImpulse * ( contact.restitution * ( change - after ) - after );
		response += contact.normalImpulse * change;
		friction += contact.normalImpulse * contact.friction;
	}
	const double fraction = lack / response;
	if ( !( approach > press * bounceThreshold ) || !( fraction > 0.0 ) )
	{
		return;
	}
	const NodeState& nodes = part.motion->nodes();
	for ( int k = 0; k < part.motion->size(); ++k )
	{
		float& v = m_v[std::size_t( part.offset + k )];
		v = nodes.freedom[k % nodes.padded] * m_bounced[std::size_t( part.offset + k )];
	}
	addMotion( part, fraction );
	for ( const std::size_t k : m_pressing )
	{
		contacts[k].normalImpulse *= 1.0 + fraction;
	}
	rubAsRigid( part, friction / press * fraction / ( 1.0 + fraction ) );
}

// v += factor times m_next, of the body and of all rigid objects.
void IslandBlock::addMotion( const SoftPart& part, double factor )
{
	const auto add = [&]( int from, int count ) {
		for ( int k = from; k < from + count; ++k )
		{
			m_v[std::size_t( k )] += float( factor ) * m_next[std::size_t( k )];
		}
	};
	add( part.offset, part.motion->size() );
	std::for_each( rigid.begin(), rigid.end(), [&]( const RigidPart& object ) { add( object.offset, 6 ); } );
}

// The raised impulses rub too, as far as Coulomb's limit, and not beyond the stop of the rigid motions' sliding,
//
//   sum P t . ( u + s r ) = 0,   t: opposite to the sliding, r the change of u by the impulses P t;   0 <= s <= mu
void IslandBlock::rubAsRigid( const SoftPart& part, double friction )
{
	Vec3d slip = Vec3d::Zero();
	for ( const std::size_t k : m_pressing )
	{
		const Vec3d u = relativeVelocity( contacts[k], m_v.data() );
		slip += contacts[k].normalImpulse * ( u - contacts[k].normal.dot( u ) * contacts[k].normal );
	}
	if ( slip.isZero( 0.0 ) )
	{
		return;
	}
	const Vec3d along = -slip.normalized();
	std::fill( m_rightSide.begin(), m_rightSide.end(), 0.0f );
	for ( const std::size_t k : m_pressing )
	{
		addPair( contacts[k], contacts[k].normalImpulse * along, m_rightSide.data() );
	}
	respondRigidly();
	double response = 0.0;
	for ( const std::size_t k : m_pressing )
	{
		response += contacts[k].normalImpulse * along.dot( changeAt( contacts[k], m_next.data() ) );
	}
	const double fraction = std::min( friction, slip.norm() / response );
	if ( !( fraction > 0.0 ) )
	{
		return;
	}
	addMotion( part, fraction );
	for ( const std::size_t k : m_pressing )
	{
		contacts[k].tangentImpulse += fraction * contacts[k].normalImpulse * along;
	}
}

} // namespace pliant
