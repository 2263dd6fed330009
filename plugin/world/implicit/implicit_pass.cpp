// One solution of an implicit block as it is linearised: where it begins, and where it is near enough.

#include "world/constants.h"
#include "world/implicit/implicit_block.h"

#include <algorithm>

namespace pliant {

// One product a substep: from then on the iteration tells what a change of speeds has changed (`moved`). Told by all it takes off the
// residual, contacts' shares among it, that is wrong in float where bodies are stiff: bullets came back at .63 of their speed for .8.
void ImplicitBlock::fillFree()
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
}

// At the start of a pass; and before it goes on to its end, for what the iteration has kept of the residual is not quite what there is.
void ImplicitBlock::beginIteration()
{
	AlignedArray<float>& residual = m_scratch;
	residual = m_freeNext;
	for ( const BlockContact& contact : contacts )
	{
		if ( contact.presses )
		{
			const Vec3d u = relativeSpeed( contact, m_next.data() );
			const double along = contact.normal.dot( u );
			const Vec3d rub = contact.held - contact.tangentStiffness * ( u - along * contact.normal );
			addPair( contact,
				( contact.pushed + contact.stiffness * ( contact.target - along ) ) * contact.normal + directed( contact, rub ),
				residual.data() );
		}
	}
	m_gradients.begin( *this, residual.data() );
}

// Impulses are what must be right, and k times what a speed is off by is what they are off by: r . z, twice the energy of all that is off,
// is small enough where it is less than kImpulseError of each impulse would store, sum of ( kImpulseError jn )^2 / k. Without contacts
// there are none, and speeds are what a body alone is asked for.
double ImplicitBlock::energyLeft() const
{
	double stored = 0.0;
	for ( const BlockContact& contact : contacts )
	{
		stored += contact.presses ? contact.normalImpulse * contact.normalImpulse / contact.stiffness : 0.0;
	}
	const auto atSpeed = [this]( double speed ) { return m_softMass * speed * speed; };
	const double needed = kImpulseError * kImpulseError * stored;
	return contacts.empty() ? atSpeed( double( kGradientSpeed ) )
							: std::clamp( needed, atSpeed( kContactGradientSpeed ), atSpeed( kMostContactGradientSpeed ) );
}

void ImplicitBlock::iterate( double fraction, BlockCount& count )
{
	count.products += m_gradients.iterate( *this, m_next.data(), GradientLimits{ fraction, energyLeft(), kMostGradients } );
	readImpulses( m_next.data() );
}

} // namespace pliant
