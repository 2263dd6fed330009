// Keeps restitution in an implicit block from adding energy.
//
// With the block's A as the mass matrix the step is a leapfrog step, and an impulse P changes its energy by P . ( u' + u ) / 2, where u is
// the velocity at the start of the substep (restitution.cpp): by nothing where all contacts rebound with restitution 1. Contacts that push
// out of penetration, or are driven into something while they separate, may gain more than the others lose. Impulses scaled by s do the
// work s W - s ( 1 - s ) K, K = P . A^-1 P / 2: this takes one more system, solved only where W is above zero. Where s would be too small
// to stop the approaching bodies, only the bounce is reduced.

#include "world/constants.h"
#include "world/implicit/implicit_block.h"

#include <algorithm>
#include <cmath>

namespace pliant {

ImplicitBlock::Work ImplicitBlock::workOfContacts() const
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

void ImplicitBlock::limitEnergy( BlockCount& count )
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
void ImplicitBlock::reduceBounce( BlockCount& count )
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

bool ImplicitBlock::movesFreely() const
{
	return std::all_of( soft.begin(), soft.end(),
			   []( const SoftPart& part ) { return part.motion->isElastic() && !part.motion->hasHeldNodes(); } ) &&
		std::all_of( rigid.begin(), rigid.end(), []( const RigidPart& part ) { return part.linked < 0 && !part.hasLockedAxis(); } );
}

bool ImplicitBlock::mayCompleteBounce() const
{
	return std::all_of( contacts.begin(), contacts.end(),
			   []( const BlockContact& contact ) { return contact.bounces || contact.normalImpulse == 0.0; } ) &&
		std::any_of( contacts.begin(), contacts.end(), []( const BlockContact& contact ) { return contact.normalImpulse > 0.0; } ) &&
		std::all_of( soft.begin(), soft.end(), []( const SoftPart& part ) { return part.restitutionFraction == 1.0; } ) && movesFreely();
}

void ImplicitBlock::addRigidMotions( const float* momentum, float* velocity ) const
{
	for ( const ConnectedPart& own : m_connected )
	{
		const SoftPart& part = soft[std::size_t( own.soft )];
		const Vector12 sums = part.motion->affineSums( momentum + part.offset, own.part ); // f, then the columns of f p^T
		Vector6 rigidSums;
		rigidSums << sums.head<3>(), sums[8] - sums[10], sums[9] - sums[5], sums[4] - sums[6];
		const Vector6 motion = part.motion->rigidMass( own.part ).inverse() * rigidSums;
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

void ImplicitBlock::fillRigidMotions()
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
void ImplicitBlock::completeBounce()
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
	std::fill( m_next.begin(), m_next.end(), 0.0f );
	addRigidMotions( m_rightSide.data(), m_next.data() );

	double lack = 0.0, response = 0.0, work = 0.0;
	for ( const BlockContact& contact : contacts )
	{
		const Vec3d push = contact.normalImpulse * contact.normal;
		lack += contact.normalImpulse * contact.target - push.dot( relativeVelocity( contact, m_bounced.data() ) );
		response += push.dot( relativeVelocity( contact, m_next.data() ) );
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

Vec3d ImplicitBlock::velocityOfCentre( const SoftPart& part, const float* v ) const
{
	const NodeState& nodes = part.motion->nodes();
	Vec3d sum = Vec3d::Zero();
	double mass = 0.0;
	for ( int i = 0; i < nodes.count; ++i )
	{
		mass += double( nodes.mass[i] );
		for ( int k = 0; k < 3; ++k )
		{
			sum[k] += double( nodes.mass[i] ) * double( v[part.offset + k * nodes.padded + i] );
		}
	}
	return sum / mass;
}

// Of the contacts in m_rolling, without sliding friction, and of the numerical damping of the part: sigma alpha v . ( 1 - P ) v, where the
// residual without contacts has the product that this takes.
double ImplicitBlock::energyTaken( const SoftPart& part ) const
{
	double sum = 0.0;
	for ( const std::size_t k : m_rolling )
	{
		const BlockContact& contact = contacts[k];
		const bool sticks = contact.tangentImpulse.norm() < kStickingFriction * contact.friction * contact.normalImpulse;
		const Vec3d impulse = contact.normalImpulse * contact.normal + ( sticks ? contact.tangentImpulse : Vec3d( Vec3d::Zero() ) );
		sum -= 0.5 * impulse.dot( relativeVelocity( contact, m_v.data() ) + contact.velocityBefore );
	}
	const NodeState& nodes = part.motion->nodes();
	double damped = 0.0;
	for ( int k = 0; k < part.motion->size(); k += nodes.padded )
	{
		for ( int i = 0; i < nodes.count; ++i )
		{
			const int at = part.offset + k + i;
			const float own = part.motion->rightSide()[k + i] - m_freeNext[at] - nodes.mass[i] * m_v[at];
			damped += double( own ) * double( m_v[at] );
		}
	}
	return sum + part.motion->numericalPart() * std::max( 0.0, damped );
}

void ImplicitBlock::keepRolling()
{
	const auto bounces = []( const BlockContact& contact ) { return contact.bounces; };
	for ( int k = 0; k < int( soft.size() ); ++k )
	{
		if ( soft[std::size_t( k )].motion->rolling() > 0.0 && movesFreely() && std::none_of( contacts.begin(), contacts.end(), bounces ) )
		{
			keepRolling( k );
		}
	}
}

// The strain of a rolling body is at rest in space and turns in its material, which numerical damping takes for a vibration; and its nodes
// land one after the other, where a smooth surface would land without an impact. Both press the body's front more than its rear, and brake
// the rotation. So the energy that they take in a substep is returned, up to what the normal impulses P take from the rotation: they are
// shifted from where the rigid motions approach to where they separate,
//
//   P' = P ( 1 + s ( u - um ) ),   u: separation velocity of the rigid motions, um: its mean weighted with P
//
// Sum P is unchanged, and so is the motion along a common normal: a falling body is stopped as before.
void ImplicitBlock::keepRolling( int index )
{
	const SoftPart& part = soft[std::size_t( index )];
	m_rolling.clear();
	double press = 0.0, mean = 0.0, central = 0.0, work = 0.0, most = 0.0;
	fillRigidMotions();
	const auto separation = [&]( const BlockContact& contact ) {
		return contact.normal.dot( relativeVelocity( contact, m_bounced.data() ) );
	};
	const Vec3d centre = velocityOfCentre( part, m_bounced.data() );
	for ( std::size_t k = 0; k < contacts.size(); ++k )
	{
		const BlockContact& contact = contacts[k];
		const int side = contact.side[0].soft == index ? 0 : 1;
		if ( contact.side[side].soft == index && !contact.isAttachment() && contact.normalImpulse > 0.0 )
		{
			m_rolling.push_back( k );
			press += contact.normalImpulse;
			mean += contact.normalImpulse * separation( contact );
			const Vec3d own = velocityOf( contact.side[side], contact.normal, m_bounced.data() ) - centre;
			central -= ( side == 0 ? 1.0 : -1.0 ) * contact.normalImpulse * contact.normal.dot( own );
		}
	}
	if ( m_rolling.size() < 2 || !( central > 0.0 ) )
	{
		return;
	}
	const double energy = part.motion->rolling() * std::min( central, energyTaken( part ) );
	if ( !( energy > 0.0 ) )
	{
		return;
	}
	mean /= press;
	std::fill( m_rightSide.begin(), m_rightSide.end(), 0.0f );
	for ( const std::size_t k : m_rolling )
	{
		const BlockContact& contact = contacts[k];
		const double above = separation( contact ) - mean;
		most = std::max( most, std::abs( above ) );
		work += contact.normalImpulse * above * above;
		addPair( contact, contact.normalImpulse * above * contact.normal, m_rightSide.data() );
	}
	shiftRolling( energy, work, mean, kMostRollingShift / most );
}

// s from   s work + s^2 square / 2 = energy.
void ImplicitBlock::shiftRolling( double energy, double work, double mean, double most )
{
	std::fill( m_next.begin(), m_next.end(), 0.0f );
	addRigidMotions( m_rightSide.data(), m_next.data() );
	const double square = dot( m_rightSide.data(), m_next.data(), m_size );
	const double shift = std::min( 2.0 * energy / ( work + std::sqrt( work * work + 2.0 * energy * square ) ), most );
	if ( !std::isfinite( shift ) )
	{
		return;
	}
	for ( const std::size_t k : m_rolling )
	{
		BlockContact& contact = contacts[k];
		contact.normalImpulse *= 1.0 + shift * ( contact.normal.dot( relativeVelocity( contact, m_bounced.data() ) ) - mean );
	}
	for ( int k = 0; k < m_size; ++k )
	{
		m_v[k] += float( shift ) * m_next[k];
	}
}

} // namespace pliant
