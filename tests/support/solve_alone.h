#pragma once

// Completes Body::pushImplicitly for a body without contacts, without a world.

#include "body/body.h"
#include "body/implicit/implicit_motion.h"
#include "matching/constants.h"
#include "matching/implicit/conjugate_gradients.h"

#include <algorithm>
#include <numeric>

namespace pliant::test {

/// System of a single body: its own matrix, preconditioned by the masses and the affine motions of the body, or of each of its parts.
class AloneSystem : public LinearSystem
{
public:
	explicit AloneSystem( ImplicitMotion& motion ) : m_motion( motion ) {}
	int size() const override { return m_motion.size(); }
	void apply( const float* v, float* to ) override { m_motion.apply( v, to, nullptr ); }
	void precondition( const float* r, float* z ) override
	{
		const int padded = m_motion.padded();
		std::fill( z, z + size(), 0.0f );
		for ( int i = 0; i < m_motion.nodes().count; ++i )
		{
			const float inverse = 1.0f / m_motion.diagonal( i );
			for ( int k = i; k < size(); k += padded )
			{
				z[k] = inverse * r[k];
			}
		}
		for ( int p = 0; p < m_motion.parts().count(); ++p )
		{
			if ( m_motion.hasShape( p ) )
			{
				m_motion.addAffine( m_motion.affineMatrix( p ).inverse() * m_motion.affineSums( r, p ), z, p );
			}
		}
	}

private:
	ImplicitMotion& m_motion;
};

/// Returns the number of products. A rigid motion of each free part corrects the momentum by the error of tolerance and rounding.
inline int solveAlone( Body& body )
{
	ImplicitMotion& motion = *body.implicit();
	AloneSystem system( motion );
	AlignedArray<float> v( std::size_t( system.size() ) );
	motion.copyVelocities( v.data() );
	const double mass = std::accumulate( body.nodes().mass.begin(), body.nodes().mass.end(), 0.0 );
	const int count = ConjugateGradients().solve( system, motion.rightSide(), v.data(),
		GradientLimits{ kGradientFraction, mass * double( kGradientSpeed ) * double( kGradientSpeed ), kMostGradients } );
	motion.setNodeVelocities( v.data() );
	for ( int p = 0; p < motion.parts().count(); ++p )
	{
		if ( !motion.isHeld( p ) )
		{
			motion.addMotion( motion.rigidMotion( motion.missingMomentum( p ), p ), p );
		}
	}
	return count;
}

} // namespace pliant::test
