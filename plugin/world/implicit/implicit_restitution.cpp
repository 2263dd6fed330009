// RestitutionCorrection of an implicit block that would bring energy in.
//
// With the block's A as the masses the step is leapfrog's, and an impulse P changes its energy by P . ( u' + u ) / 2, u the speed at the
// substep's start (restitution.cpp): nothing where all contacts bounce off what they came with. Others, which push out of a depth or are
// driven into something while they part, may gain what those do not lose. All impulses times s do s W - s ( 1 - s ) K, K = P . A^-1 P / 2:
// one more system, solved only where W is above zero. Where much less than all of them is left so, they no longer stop what came: less of
// the bounce, then, and not of all.

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
		const double after = impulse.dot( relativeSpeed( contact, m_v.data() ) ), before = impulse.dot( contact.before );
		work.sum += 0.5 * ( after + before );
		work.moved += 0.5 * ( std::abs( after ) + std::abs( before ) );
	}
	return work;
}

void ImplicitBlock::keepEnergy( BlockCount& count )
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
		contact.presses = false;
	}
	listPressing();
	fillPreconditioner();
	std::fill( m_next.begin(), m_next.end(), 0.0f );
	count.products += m_gradients.solve(
						  *this, m_rightSide.data(), m_next.data(), GradientLimits{ kGradientFraction, 0.0, kMostGradients } ) +
		1;

	const double brought = 0.5 * dot( m_rightSide.data(), m_next.data(), m_size );
	const double fraction = 1.0 - work.sum / brought;
	if ( fraction < kLeastBounce )
	{
		bounceLess( count );
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

// Where nothing bounces contacts bring nothing in. On the way from there to where all does,  P + s dP  and  u + s du,  nothing is pressed
// into anything and friction stays within its limits: as far as  ( P + s dP ) . ( ( u + s du ) + before ) <= 0.
void ImplicitBlock::bounceLess( BlockCount& count )
{
	m_bounced = m_v;
	m_bounces.clear();
	for ( BlockContact& contact : contacts )
	{
		m_bounces.push_back( Bounce{ contact.normalImpulse, contact.tangentImpulse } );
		contact.target = contact.bounces ? contact.parting : contact.target;
	}
	solveLaw( count );
	double none = 0.0, linear = 0.0, square = 0.0;
	for ( std::size_t k = 0; k < contacts.size(); ++k )
	{
		const BlockContact& contact = contacts[k];
		const Vec3d impulse = contact.impulse();
		const Vec3d more = m_bounces[k].normal * contact.normal + m_bounces[k].tangent - impulse;
		const Vec3d after = relativeSpeed( contact, m_v.data() ), faster = relativeSpeed( contact, m_bounced.data() ) - after;
		none += impulse.dot( after + contact.before );
		linear += impulse.dot( faster ) + more.dot( after + contact.before );
		square += more.dot( faster );
	}
	double fraction = 0.0;
	for ( double step = 0.5; step > kLeastBounceStep; step *= 0.5 )
	{
		const double further = fraction + step;
		fraction = none + further * ( linear + further * square ) <= 0.0 ? further : fraction;
	}
	for ( int k = 0; k < m_size; ++k )
	{
		m_v[k] += float( fraction ) * ( m_bounced[k] - m_v[k] );
	}
	for ( std::size_t k = 0; k < contacts.size(); ++k )
	{
		contacts[k].normalImpulse += fraction * ( m_bounces[k].normal - contacts[k].normalImpulse );
		contacts[k].tangentImpulse += fraction * ( m_bounces[k].tangent - contacts[k].tangentImpulse );
	}
}

} // namespace pliant
