// One pass over the linearised system of a block: its initial residual and its stopping criterion.

#include "world/block/island_block.h"
#include "world/constants.h"

#include <algorithm>

namespace pliant {

// Costs one product per substep; from then on the iteration reports each change of M v (`moved`). Updated from the full residual, contact
// terms included, it would be too inaccurate in float for stiff bodies: bullets would rebound at .63 of their speed instead of .8.
void IslandBlock::fillFree()
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
		if ( part.linked >= 0 )
		{
			Eigen::Map<Eigen::Matrix<float, 6, 1>> free( m_free.data() + part.offset );
			free = linkMomentum( part, []( const RigidPart& link ) { return link.freeVelocity; } ).cast<float>() - free;
			continue;
		}
		const Vec3d spin = part.inertia * part.freeVelocity.tail<3>();
		for ( int k = 0; k < 3; ++k )
		{
			float& push = m_free[std::size_t( part.offset + k )];
			float& turn = m_free[std::size_t( part.offset + 3 + k )];
			push = ( part.moves[k] ? float( part.mass * part.freeVelocity[k] ) : 0.0f ) - push;
			turn = ( part.turns[k] ? float( spin[k] ) : 0.0f ) - turn;
		}
	}
}

// Called at the start of a pass and again before its final stretch, because the residual kept by the iteration drifts from the true one.
void IslandBlock::beginIteration()
{
	AlignedArray<float>& residual = m_scratch;
	residual = m_freeNext;
	for ( const BlockContact& contact : contacts )
	{
		if ( contact.isActive )
		{
			const Vec3d u = relativeVelocity( contact, m_next.data() );
			const double along = contact.normal.dot( u );
			const Vec3d tangent = contact.scaledMultiplier - contact.tangentStiffness * ( u - along * contact.normal );
			addPair( contact,
				( contact.normalMultiplier + contact.stiffness * ( contact.target - along ) ) * contact.normal +
					applyFrictionScale( contact, tangent ),
				residual.data() );
		}
	}
	m_gradients.begin( *this, residual.data() );
}

// The impulses must be accurate, and their error is k times that of the velocities. The criterion is r . z, twice the energy of the error:
// it must fall below the energy of an error of kImpulseError in every impulse, sum of ( kImpulseError jn )^2 / k. Without contacts the
// velocities must be accurate to kGradientSpeed.
double IslandBlock::energyLeft() const
{
	double stored = 0.0;
	for ( const BlockContact& contact : contacts )
	{
		stored += contact.isActive ? contact.normalImpulse * contact.normalImpulse / contact.stiffness : 0.0;
	}
	const auto atSpeed = [this]( double speed ) { return m_softMass * speed * speed; };
	const double needed = kImpulseError * kImpulseError * stored;
	return contacts.empty() ? atSpeed( double( kGradientSpeed ) )
							: std::clamp( needed, atSpeed( kContactGradientSpeed ), atSpeed( kMostContactGradientSpeed ) );
}

void IslandBlock::iterate( double fraction, BlockCount& count )
{
	count.products += m_gradients.iterate( *this, m_next.data(), GradientLimits{ fraction, energyLeft(), kMostGradients } );
	readImpulses( m_next.data() );
}

} // namespace pliant
