#pragma once

// Stiffness from region size: E = alpha rho d^2 mu / h^2, mu the second moment per axis of a full region, in cells^2.

#include "matching/constants.h"
#include "matching/kernels/volume_limits.h"
#include "pliant/material.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace pliant {

/// A full cube of n cells along an edge has mu = ( n^2 - 1 ) / 12; with n = 2w + 1 that is w ( w + 1 ) / 3.
inline double regionSecondMoment( const Material& material )
{
	const double edge = material.method == Method::Clusters ? material.clusterEdge : 2.0 * material.regionHalfWidth + 1.0;
	return ( edge * edge - 1.0 ) / 12.0;
}

/// E = alpha rho d^2 mu f / h^2. Volume conservation gives sigma = M ( eps + kappa tr( eps ) 1 ) with M = alpha rho d^2 mu / h^2, that is
/// 2 G = M and lambda = kappa M: hence f = E / M = ( 1 + 3 kappa ) / ( 1 + 2 kappa ) and nu = kappa / ( 1 + 2 kappa ).
inline double modulusMoment( const Material& material )
{
	const double kappa = material.method == Method::Lattice ? material.volumeKeeping : 0.0;
	return regionSecondMoment( material ) * ( 1.0 + 3.0 * kappa ) / ( 1.0 + 2.0 * kappa );
}

/// The response to uniform compression is 1 + 3 kappa times that to uniaxial tension: alpha ( 1 + 3 kappa ) must stay below 4.
inline double largestAlpha( const Material& material )
{
	const double kappa = material.method == Method::Lattice ? material.volumeKeeping : 0.0;
	return std::min( double( kLargestAlpha ), kLargestVolumeAlpha / ( 1.0 + 3.0 * kappa ) );
}

/// Largest response to deformation that volume conservation may have in an explicit substep, in units of kappa: 3 at rest. That of a
/// deformed region grows, and alpha ( 1 + response kappa ) must not exceed 4.
inline float largestVolumeResponse( double alpha, double kappa )
{
	return kappa > 0.0 ? float( std::max( 0.0, kUnstableResponse / alpha - 1.0 ) / kappa ) : kAnyVolumeResponse;
}

/// Region damping factor of a substep, k = 1 - exp( - damping h ), limited to what is stable with `alpha`. A mode whose response factor is
/// lambda is stable below lambda ( alpha + 2 k ) = 4; and in a region compressed to a half, whose rotation responds with twice the torque,
/// an unlimited k would drive the motion instead of damping it. Volume conservation makes lambda 1 + 3 kappa at rest, and up to 1 + 9 kappa
/// in a crushed region: soft bodies may be crushed, those of half the largest alpha and more are not.
inline float dampingFraction( double damping, double h, double alpha, double kappa )
{
	const double largest = std::min( double( kLargestAlpha ), kLargestVolumeAlpha / ( 1.0 + 3.0 * kappa ) );
	const double response = kCrushedResponse + ( kRestResponse - kCrushedResponse ) * std::min( 1.0, 2.0 * alpha / largest );
	const double k = 1.0 - std::exp( -damping * h ), margin = 0.5 * ( kLargestDampedResponse / ( 1.0 + response * kappa ) - alpha );
	return float( std::max( 0.0, std::min( { k, kLargestDampingFraction, margin } ) ) );
}

/// Largest wobble damping factor f of an explicit substep. It acts on the velocity before matching, v' = ( 1 - f ) v - response x / h, and
/// is stable below response + 2 f = 4; the largest response is lambda ( alpha + 2 k ).
inline float largestWobbleFraction( double damping, double h, double alpha, double kappa )
{
	const double response = ( 1.0 + 3.0 * kappa ) * ( alpha + 2.0 * double( dampingFraction( damping, h, alpha, kappa ) ) );
	return float( std::clamp( 0.5 * ( kLargestWobbleResponse - response ), 0.0, 1.0 ) );
}

/// Alpha of each far level, finest first; 0: the level is not used.
using FarFractions = std::array<float, kMostFarLevels>;

/// Second moment per axis of a full region of far level l: three blocks of 2^l cells along an edge, in cells^2.
inline double farSecondMoment( int level )
{
	const double edge = 3.0 * double( 1 << level );
	return ( edge * edge - 1.0 ) / 12.0;
}

/// Contribution of the far levels: the sum of alpha_l mu_l, to be added to alpha mu f.
inline double farMoment( const FarFractions& fractions )
{
	double sum = 0.0;
	for ( int k = 0; k < kMostFarLevels; ++k )
	{
		sum += double( fractions[k] ) * farSecondMoment( k + 1 );
	}
	return sum;
}

/// The energies of all levels add up, and so do their moduli: E h^2 / ( rho d^2 ) = alpha mu f + sum of alpha_l mu_l. The remainder beyond
/// the finest level goes to the next level up to its limit, then to the one above: short waves become as stiff as possible, and unneeded
/// levels stay off. `beyond`: E h^2 / ( rho d^2 ) less the contribution of the finest level. Any remainder beyond all levels is dropped.
inline FarFractions farFractions( int levels, double beyond )
{
	FarFractions fractions = {};
	for ( int k = 0; k < levels && beyond > 0.0; ++k )
	{
		const double mu = farSecondMoment( k + 1 );
		fractions[k] = float( std::min( kLargestFarAlpha, beyond / mu ) );
		beyond -= kLargestFarAlpha * mu;
	}
	return fractions;
}

/// Alphas of Material::farLevels for a substep of h on cells of edge d.
inline FarFractions farFractions( const Material& material, double cellSize, double h )
{
	if ( material.farLevels == 0 )
	{
		return {};
	}
	const double wanted = material.youngsModulus * h * h / ( material.density * cellSize * cellSize );
	return farFractions( material.farLevels, wanted - largestAlpha( material ) * modulusMoment( material ) );
}

} // namespace pliant
