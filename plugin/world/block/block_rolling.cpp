// Keeps contacts from braking the rotation of rolling bodies.

#include "world/block/island_block.h"
#include "world/constants.h"

#include <algorithm>
#include <cmath>

namespace pliant {

Vec3d IslandBlock::velocityOfCentre( const SoftPart& part, const float* v ) const
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

// Of the contacts in m_pressing, without sliding friction, and of the numerical damping of the part: sigma alpha v . ( 1 - P ) v, where the
// residual without contacts has the product that this takes.
double IslandBlock::energyTaken( const SoftPart& part ) const
{
	double sum = 0.0;
	for ( const std::size_t k : m_pressing )
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

void IslandBlock::keepRolling()
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
void IslandBlock::keepRolling( int index )
{
	const SoftPart& part = soft[std::size_t( index )];
	m_pressing.clear();
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
			m_pressing.push_back( k );
			press += contact.normalImpulse;
			mean += contact.normalImpulse * separation( contact );
			const Vec3d own = velocityOf( contact.side[side], contact.normal, m_bounced.data() ) - centre;
			central -= ( side == 0 ? 1.0 : -1.0 ) * contact.normalImpulse * contact.normal.dot( own );
		}
	}
	if ( m_pressing.size() < 2 || !( central > 0.0 ) )
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
	for ( const std::size_t k : m_pressing )
	{
		const BlockContact& contact = contacts[k];
		const double above = separation( contact ) - mean;
		most = std::max( most, std::abs( above ) );
		work += contact.normalImpulse * above * above;
		addPair( contact, contact.normalImpulse * above * contact.normal, m_rightSide.data() );
	}
	if ( most > 0.0 )
	{
		shiftRolling( energy, work, mean, kMostRollingShift / most );
	}
}

// s from   s work + s^2 square / 2 = energy.
void IslandBlock::shiftRolling( double energy, double work, double mean, double most )
{
	respondRigidly();
	const double square = dot( m_rightSide.data(), m_next.data(), m_size );
	const double shift = std::min( 2.0 * energy / ( work + std::sqrt( work * work + 2.0 * energy * square ) ), most );
	if ( !std::isfinite( shift ) )
	{
		return;
	}
	for ( const std::size_t k : m_pressing )
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
