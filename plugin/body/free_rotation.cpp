#include "body/free_rotation.h"

#include "body/constants.h"
#include "matching/rotation.h"

#include <algorithm>
#include <cmath>

namespace pliant {

// The energy of rotation, with L in the principal axes and I3 the largest moment, has three parts,
//
//   H = | L |^2 / ( 2 I3 ) + L1^2 ( 1 / I1 - 1 / I3 ) / 2 + L2^2 ( 1 / I2 - 1 / I3 ) / 2
//
// each of which alone rotates the body by a constant rate: the first about L, which commutes with the others, those about the axes 1 and 2.
// The rotations one after another, half a step of the first axis, a step of the second, half a step of the first, keep | L | and, since the
// composition is symplectic, the energy within a bound for any number of steps (McLachlan 1993; Dullweber, Leimkuhler and McLachlan 1997).
// It is exact for symmetric bodies.
Eigen::Quaterniond freeRotation( const Vec3d& moments, const Eigen::Quaterniond& axes, const Vec3d& spin, double h )
{
	Eigen::Index reference = 0;
	const double largest = moments.maxCoeff( &reference );
	if ( !( largest > 0.0 ) )
	{
		return Eigen::Quaterniond::Identity();
	}
	const Eigen::Index first = ( reference + 1 ) % 3, second = ( reference + 2 ) % 3;
	const auto excess = [&]( Eigen::Index axis ) { return moments[axis] > 0.0 ? 1.0 / moments[axis] - 1.0 / largest : 0.0; };
	const double rate[2] = { excess( first ), excess( second ) };
	Vec3d own = axes.conjugate() * spin;
	const double turn = h * std::max( std::fabs( own[first] * rate[0] ), std::fabs( own[second] * rate[1] ) );
	const int parts = int( std::clamp( std::ceil( turn / kFreeTurnPart ), 1.0, double( kMostTurnParts ) ) );
	Eigen::Quaterniond turned = Eigen::Quaterniond::Identity();
	const auto rotate = [&]( Eigen::Index axis, double by ) {
		const Eigen::Quaterniond part = rotationBy( by * own[axis] * Vec3d::Unit( axis ) );
		turned = turned * part;
		own = part.conjugate() * own;
	};
	const double step = h / parts;
	for ( int k = 0; k < parts; ++k )
	{
		rotate( first, 0.5 * step * rate[0] );
		rotate( second, step * rate[1] );
		rotate( first, 0.5 * step * rate[0] );
	}
	return rotationBy( h / largest * spin ) * axes * turned * axes.conjugate();
}

} // namespace pliant
