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

} // namespace pliant
