#pragma once

// What a region's size says about stiffness: E = alpha rho d^2 mu / h^2, mu the second moment an axis of a full region, in cells^2.

#include "matching/constants.h"
#include "pliant/material.h"

#include <algorithm>

namespace pliant {

/// A full cube of n cells an edge has mu = ( n^2 - 1 ) / 12; with n = 2w + 1 that is w ( w + 1 ) / 3.
inline double regionSecondMoment( const Material& material )
{
	const double edge = material.method == Method::Clusters ? material.clusterEdge : 2.0 * material.regionHalfWidth + 1.0;
	return ( edge * edge - 1.0 ) / 12.0;
}

/// E = alpha rho d^2 mu f / h^2. Kept volume makes sigma = M ( eps + kappa tr( eps ) 1 ) with M = alpha rho d^2 mu / h^2, that is 2 G = M and
/// lambda = kappa M: hence f = E / M = ( 1 + 3 kappa ) / ( 1 + 2 kappa ) and nu = kappa / ( 1 + 2 kappa ).
inline double modulusMoment( const Material& material )
{
	const double kappa = material.method == Method::Lattice ? material.volumeKeeping : 0.0;
	return regionSecondMoment( material ) * ( 1.0 + 3.0 * kappa ) / ( 1.0 + 2.0 * kappa );
}

/// Pressing a region in all directions is answered 1 + 3 kappa times as hard as pulling it: alpha ( 1 + 3 kappa ) must stay below 4.
inline double largestAlpha( const Material& material )
{
	const double kappa = material.method == Method::Lattice ? material.volumeKeeping : 0.0;
	return std::min( double( kLargestAlpha ), kLargestVolumeAlpha / ( 1.0 + 3.0 * kappa ) );
}

} // namespace pliant
