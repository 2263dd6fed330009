#pragma once

// Preconditioned conjugate gradients over one flat float array, for symmetric positive definite matrix-free systems (Hestenes and Stiefel
// 1952). Sums are in double and in a fixed order.

#include "matching/aligned_array.h"

namespace pliant {

/// The system A v = b.
class LinearSystem
{
public:
	virtual ~LinearSystem() = default;
	virtual int size() const = 0;                              ///< a multiple of kLanes
	virtual void apply( const float* v, float* to ) = 0;       ///< to = A v
	virtual void precondition( const float* r, float* z ) = 0; ///< z ~ A^-1 r
	virtual void moved( float ) {}                             ///< called after x += step * p, p the last argument of `apply`
};

/// Stop criteria: r . z <= relative * ( r . z at the start ), or <= absolute, or this number of products.
struct GradientLimits
{
	double relative = 0.0;
	double absolute = 0.0;
	int maxProducts = 0;
};

class ConjugateGradients
{
public:
	/// Improves x. Returns the number of products beyond the first. Stops at NaN.
	int solve( LinearSystem& system, const float* b, float* x, const GradientLimits& limits );
	/// The same in parts, for callers that know the residual r = b - A x without a product, or inspect x between iterations: `begin`, then
	/// `iterate` as often as needed, each time continuing from the last state. Relative limits refer to the residual at `begin`. `iterate`
	/// returns the number of its products.
	void begin( LinearSystem& system, const float* r );
	int iterate( LinearSystem& system, float* x, const GradientLimits& limits );

private:
	void beginFromResidual( LinearSystem& system );

	AlignedArray<float> m_r, m_z, m_p, m_ap;
	double m_rz = 0.0, m_rzFirst = 0.0;
};

/// a . b, summed in kLanes independent sums that are folded pairwise.
double dot( const float* a, const float* b, int size );

} // namespace pliant
