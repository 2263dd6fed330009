#pragma once

// A contact of a block in the compact form of its matrix products and sweeps.

#include "body/implicit/implicit_motion.h"
#include "world/touch/shared_nodes.h"

namespace pliant {

/// An active contact of a product: the force is across u + along ( u.n ) n.
struct ActiveContact
{
	struct Side
	{
		int count = 0;                                              ///< number of nodes; 1: a rigid body; 0: prescribed velocity
		int stride = 0;                                             ///< between a node's components; 0: six components of a rigid body
		int index[SharedNodes::kMost];                              ///< of each node's first component in the vector
		double rub[SharedNodes::kMost], excess[SharedNodes::kMost]; ///< SharedNodes::rub, and press - rub
		double arm[3];
	};
	Side side[2];
	double normal[3];
	double along = 0.0, across = 0.0; ///< k - kt and kt, kg; with anisotropic friction k and kt
	int frictionScale = -1;
};

/// u += sign times the velocity of one side, which is no prescribed one.
template <class Real>
void addVelocity( const ActiveContact::Side& side, const double ( &normal )[3], const Real* v, double sign, double ( &u )[3] )
{
	if ( side.stride > 0 )
	{
		double along = 0.0;
		for ( int j = 0; j < side.count; ++j )
		{
			const Real* const at = v + side.index[j];
			const double x = double( at[0] ), y = double( at[side.stride] ), z = double( at[2 * side.stride] );
			const double rub = sign * side.rub[j];
			u[0] += rub * x;
			u[1] += rub * y;
			u[2] += rub * z;
			along += side.excess[j] * ( ( normal[0] * x + normal[1] * y ) + normal[2] * z );
		}
		along *= sign;
		u[0] += along * normal[0];
		u[1] += along * normal[1];
		u[2] += along * normal[2];
		return;
	}
	const Real* const at = v + side.index[0];
	const double* const r = side.arm;
	const double w[3] = { double( at[3] ), double( at[4] ), double( at[5] ) };
	u[0] += sign * ( double( at[0] ) + ( w[1] * r[2] - w[2] * r[1] ) );
	u[1] += sign * ( double( at[1] ) + ( w[2] * r[0] - w[0] * r[2] ) );
	u[2] += sign * ( double( at[2] ) + ( w[0] * r[1] - w[1] * r[0] ) );
}

} // namespace pliant
