// One solution of an implicit block as it is linearised: where it begins, and where it is near enough.

#include "world/constants.h"
#include "world/implicit_block.h"

#include <algorithm>

namespace pliant {

// b - A v: first without contacts, M and their b, then with the impulses of the linearised law. A pass begins with a product for it: what the last pass
// left says it too, but in float the contacts' share, which cancels, is as large as stiff bodies are, and bullets came back at .63 of their speed for .8.
void ImplicitBlock::fillResidual()
{
	applyMasses( m_v.data(), m_free.data() );
	for ( const SoftPart& part : soft )
	{
		const float* const from = part.motion->rightSide();
		for ( int k = 0; k < part.motion->size(); ++k )
		{
			m_free[std::size_t( part.offset + k )] = from[k] - m_free[std::size_t( part.offset + k )];
		}
	}
	for ( const RigidPart& part : rigid )
	{
		const Vec3d spin = part.inertia * part.free.tail<3>();
		for ( int k = 0; k < 3; ++k )
		{
			float& push = m_free[std::size_t( part.offset + k )];
			float& turn = m_free[std::size_t( part.offset + 3 + k )];
			push = ( part.moves[k] ? float( part.mass * part.free[k] ) : 0.0f ) - push;
			turn = ( part.turns[k] ? float( spin[k] ) : 0.0f ) - turn;
		}
	}
	m_residual = m_free;
	for ( const BlockContact& contact : contacts )
	{
		if ( contact.presses )
		{
			const Vec3d u = relativeSpeed( contact, m_v.data() );
			const double along = contact.normal.dot( u );
			const Vec3d rub = contact.held - contact.tangentStiffness * ( u - along * contact.normal );
			addPair( contact, ( contact.pushed + contact.stiffness * ( contact.target - along ) ) * contact.normal + directed( contact, rub ), m_residual.data() );
		}
	}
}

// Impulses are what must be right, and k times what a speed is off by is what they are off by: r . z, twice the energy of all that is off, is
// small enough where it is less than kImpulseError of each impulse would store, sum of ( kImpulseError jn )^2 / k. Without contacts there are none, and
// speeds are what a body alone is asked for.
double ImplicitBlock::energyLeft() const
{
	double stored = 0.0;
	for ( const BlockContact& contact : contacts )
	{
		stored += contact.presses ? contact.normalImpulse * contact.normalImpulse / contact.stiffness : 0.0;
	}
	const double least = m_softMass * kContactGradientSpeed * kContactGradientSpeed, most = m_softMass * double( kGradientSpeed ) * double( kGradientSpeed );
	return contacts.empty() ? most : std::clamp( kImpulseError * kImpulseError * stored, least, most );
}

// One product more where a pass goes on to its end. Without it a pile takes 1.44 to 1.64 times what the explicit step does for 1.85 to 2.15, and eight cubes 7.5
// products a frame for 8.6; but four take 3.2 for 4.6, so that eight are more than four times as dear. Not shown: that impulses are any truer for it.
void ImplicitBlock::refresh( BlockCount& count )
{
	for ( int k = 0; k < m_size; ++k )
	{
		m_scratch[k] = m_next[k] - m_v[k];
	}
	apply( m_scratch.data(), m_rightSide.data() );
	for ( int k = 0; k < m_size; ++k )
	{
		m_rightSide[k] = m_residual[k] - m_rightSide[k];
	}
	m_gradients.begin( *this, m_rightSide.data() );
	++count.products;
}

void ImplicitBlock::iterate( double share, BlockCount& count )
{
	count.products += m_gradients.goOn( *this, m_next.data(), GradientLimits{ share, energyLeft(), kMostGradients } );
	readImpulses( m_next.data() );
}

} // namespace pliant
