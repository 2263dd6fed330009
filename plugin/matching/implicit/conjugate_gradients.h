#pragma once

// Preconditioned conjugate gradients over one flat array of floats, for symmetric positive definite systems that are given by what they do
// to a vector (Hestenes and Stiefel 1952). Sums are in double and in one order.

#include "matching/aligned_array.h"

namespace pliant {

/// A v = b, as the iteration sees it.
class LinearSystem
{
public:
	virtual ~LinearSystem() = default;
	virtual int size() const = 0;                              ///< a multiple of kLanes
	virtual void apply( const float* v, float* to ) = 0;       ///< to = A v
	virtual void precondition( const float* r, float* z ) = 0; ///< z ~ A^-1 r
	virtual void moved( float ) {}                             ///< x has gone so many times what `apply` was last given
};

/// When to stop: at r . z <= relative * ( r . z at the start ) or <= absolute, or after so many products.
struct GradientLimits
{
	double relative = 0.0;
	double absolute = 0.0;
	int most = 0;
};

class ConjugateGradients
{
public:
	/// Improves x. Returns the number of products beyond the first. What is no number stops it.
	int solve( LinearSystem& system, const float* b, float* x, const GradientLimits& limits );
	/// The same in parts, for who knows what is off at x without a product, r = b - A x, or wants to look at x on the way: `begin`, then
	/// `goOn` as often as needed, each time from where it stood. Limits are shares of what was off at the beginning. `goOn` returns the
	/// number of its products.
	void begin( LinearSystem& system, const float* r );
	int goOn( LinearSystem& system, float* x, const GradientLimits& limits );
	std::size_t bytes() const { return ( m_r.size() + m_z.size() + m_p.size() + m_ap.size() ) * sizeof( float ); }

private:
	void beginFromResidual( LinearSystem& system );

	AlignedArray<float> m_r, m_z, m_p, m_ap;
	double m_rz = 0.0, m_rzFirst = 0.0;
};

/// a . b, kLanes sums side by side, folded halves onto halves.
double dot( const float* a, const float* b, int size );

} // namespace pliant
