// Bounces of an implicit block that would bring energy in.
//
// With the block's A as the masses the step is leapfrog's, and an impulse P changes its energy by P . ( u' + u ) / 2, u the speed at the substep's start
// (bounce.cpp): nothing where all contacts bounce off what they came with. Others, which push out of a depth or are driven into something while they part, may gain what
// those do not lose. All impulses times s do s W - s ( 1 - s ) K, K = P . A^-1 P / 2: one more system, solved only where W is above zero.

#include "world/constants.h"
#include "world/implicit_block.h"

#include <algorithm>
#include <cmath>

namespace pliant {

void ImplicitBlock::keepEnergy( BlockCount& count )
{
	if ( std::none_of( contacts.begin(), contacts.end(), []( const BlockContact& contact ) { return contact.bounces; } ) )
	{
		return;
	}
	double work = 0.0, moved = 0.0;
	for ( const BlockContact& contact : contacts )
	{
		const Vec3d impulse = contact.normalImpulse * contact.normal + contact.tangentImpulse;
		const double after = impulse.dot( relativeSpeed( contact, m_v.data() ) ), before = impulse.dot( contact.before );
		work += 0.5 * ( after + before );
		moved += 0.5 * ( std::abs( after ) + std::abs( before ) );
	}
	if ( !( work > kBounceSlack * moved ) )
	{
		return;
	}
	std::fill( m_rightSide.begin(), m_rightSide.end(), 0.0f );
	for ( BlockContact& contact : contacts )
	{
		addPair( contact, contact.normalImpulse * contact.normal + contact.tangentImpulse, m_rightSide.data() );
		contact.presses = false;
	}
	listPressing();
	fillPreconditioner();
	std::fill( m_next.begin(), m_next.end(), 0.0f );
	count.products += m_gradients.solve( *this, m_rightSide.data(), m_next.data(), GradientLimits{ kGradientShare, 0.0, kMostGradients } ) + 1;

	const double brought = 0.5 * dot( m_rightSide.data(), m_next.data(), m_size );
	const double share = std::max( 1.0 - work / brought, kLeastBounce );
	for ( int k = 0; k < m_size; ++k )
	{
		m_v[k] -= float( 1.0 - share ) * m_next[k];
	}
	for ( BlockContact& contact : contacts )
	{
		contact.normalImpulse *= share;
		contact.tangentImpulse *= share;
	}
}

} // namespace pliant
