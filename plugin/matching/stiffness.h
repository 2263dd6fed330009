#pragma once

// What a region's size says about stiffness: E = alpha rho d^2 mu / h^2, mu the second moment an axis of a full region, in cells^2.

#include "pliant/material.h"

namespace pliant {

/// A full cube of n cells an edge has mu = ( n^2 - 1 ) / 12; with n = 2w + 1 that is w ( w + 1 ) / 3.
inline double regionSecondMoment( const Material& material )
{
	const double edge = material.method == Method::Clusters ? material.clusterEdge : 2.0 * material.regionHalfWidth + 1.0;
	return ( edge * edge - 1.0 ) / 12.0;
}

} // namespace pliant
