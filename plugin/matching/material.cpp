#include "pliant/material.h"

#include "lattice/features.h"
#include "lattice/ranges.h"
#include "matching/constants.h"
#include "matching/stiffness.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace pliant {

namespace {

Status checkChoices( const Material& material )
{
	return require( ResultCode::BadMaterial,
		{ { isChoice( material.stiffness, Stiffness::RawAlpha ), "Material::stiffness is none of Stiffness's values." },
			{ isChoice( material.elasticity, Elasticity::Automatic ), "Material::elasticity is none of Elasticity's values." },
			{ isChoice( material.method, Method::Clusters ), "Material::method is none of Method's values." },
			{ isChoice( material.clusterMode, ClusterMode::Quadratic ), "Material::clusterMode is none of ClusterMode's values." },
			{ isChoice( material.weights, Weights::Literal ), "Material::weights is none of Weights' values." },
			{ isChoice( material.rotationFrom, RotationFrom::F ), "Material::rotationFrom is none of RotationFrom's values." } } );
}

/// Checks that this build has the optional features the material needs.
Status checkBuild( const Material& material )
{
	const struct
	{
		bool isUsed;
		Feature feature;
	} features[] = { { material.method != Method::Lattice, Feature::Clusters }, { material.yieldStrain > 0.0f, Feature::Plasticity },
		{ material.farLevels > 0, Feature::FarLevels } };
	for ( const auto& [isUsed, feature] : features )
	{
		if ( Status status = isUsed ? requireFeature( feature ) : Status{}; !status.ok() )
		{
			return status;
		}
	}
	return {};
}

/// False for 0.
bool isAbove( float value, float low, float high )
{
	return value > low && isWithin( value, low, high );
}

Status checkRanges( const Material& m )
{
	const bool isLattice = m.method == Method::Lattice, isImplicit = m.elasticity == Elasticity::Implicit, hasFarLevels = m.farLevels != 0;
	return require( ResultCode::BadMaterial,
		{ { isAbove( m.density, 0.0f, kLargestDensity ), "Material::density must be above 0 and at most 1e6 kg/m^3." },
			{ m.youngsModulus >= 0.0f && std::isfinite( m.youngsModulus ),
				"Material::youngsModulus must be at least 0 Pa and finite; 0 stands for the default of the body's size." },
			{ isAbove( m.alpha, 0.0f, kLargestAlpha ), "Material::alpha must be above 0 and at most 1." },
			{ isWithin( m.beta, 0.0f, kLargestBeta ), "Material::beta must lie in [0, 0.95]." },
			{ isWithin( m.regionHalfWidth, 1, kLargestHalfWidth ), "Material::regionHalfWidth must lie in 1 to 4 cells." },
			{ isWithin( m.damping, 0.0f, kLargestDamping ), "Material::damping must lie in [0, 1000] 1/s." },
			{ isWithin( m.wobbleDamping, 0.0f, 1.0f ), "Material::wobbleDamping must lie in [0, 1]." },
			{ isWithin( m.volumeKeeping, 0.0f, kLargestVolumeKeeping ), "Material::volumeKeeping must lie in [0, 24.5]." },
			{ m.stiffness != Stiffness::RawAlpha || m.alpha <= largestAlpha( m ),
				"Material::alpha is too large for this volumeKeeping: alpha ( 1 + 3 kappa ) must be at most 3.5." },
			{ isWithin( m.yieldStrain, 0.0f, kLargestYieldStrain ), "Material::yieldStrain must lie in [0, 10]." },
			{ isAbove( m.plasticCreep, 0.0f, kLargestCreep ), "Material::plasticCreep must be above 0 and at most 1e4 1/s." },
			{ isAbove( m.plasticLimit, 0.0f, kLargestPlasticLimit ), "Material::plasticLimit must be above 0 and at most 2." },
			{ !( m.yieldStrain > 0.0f ) || isLattice, "Material::yieldStrain needs Method::Lattice." },
			{ isWithin( m.farLevels, 0, kMostFarLevels ), "Material::farLevels must lie in 0 to 3." },
			{ !hasFarLevels || ( isLattice && m.stiffness == Stiffness::YoungsModulus ),
				"Material::farLevels needs Method::Lattice and Stiffness::YoungsModulus." },
			{ !hasFarLevels || !( m.yieldStrain > 0.0f ), "Material::farLevels knows the first rest shape only: yieldStrain must be 0." },
			{ isWithin( m.rigidStrain, 0.0f, kLargestRigidStrain ), "Material::rigidStrain must lie in [0, 0.1]." },
			{ isWithin( m.numericalDamping, 0.0f, 1.0f ), "Material::numericalDamping must lie in [0, 1]." },
			{ !isImplicit || ( isLattice && m.weights == Weights::Conserving && m.rotationFrom == RotationFrom::Apq ),
				"Elasticity::Implicit needs Method::Lattice, Weights::Conserving and RotationFrom::Apq." },
			{ !isImplicit || !hasFarLevels, "Elasticity::Implicit reaches any stiffness by itself: Material::farLevels must be 0." },
			{ isWithin( m.clusterEdge, 2, kLargestClusterEdge ), "Material::clusterEdge must lie in 2 to 64 cells." } } );
}

} // namespace

Status check( const Material& material )
{
	Status status = checkChoices( material );
	status = status.ok() ? checkBuild( material ) : status;
	return status.ok() ? checkRanges( material ) : status;
}

float defaultYoungsModulus( float density, float length )
{
	const float modulus = float( kDefaultStiffness * kStandardGravity * double( density ) * double( length ) );
	return density > 0.0f && length > 0.0f && std::isfinite( modulus ) ? modulus : 0.0f;
}

StiffnessPlan planStiffness( const Material& material, float cellSize, float gameStep, int substeps )
{
	assert( cellSize > 0.0f && gameStep > 0.0f && substeps >= 1 );
	StiffnessPlan plan;
	plan.reachable = cellSize > 0.0f && gameStep > 0.0f && substeps >= 1;
	if ( !plan.reachable )
	{
		return plan;
	}
	const double h = double( gameStep ) / substeps;

	// A lattice of regions with alpha at step h is an elastic solid of modulus E = alpha rho d^2 mu f / h^2 (stiffness.h), with mu = w ( w
	// + 1 ) / 3; the modulus per unit of alpha is therefore:
	const double modulusPerAlpha = material.density * double( cellSize ) * cellSize * modulusMoment( material ) / ( h * h );
	plan.reachable = modulusPerAlpha > 0.0 && std::isfinite( modulusPerAlpha ) && material.youngsModulus > 0.0f;
	if ( !plan.reachable )
	{
		return plan;
	}
	if ( material.stiffness == Stiffness::RawAlpha || material.method == Method::SingleCluster )
	{
		plan.alpha = material.alpha;
		plan.reachedModulus = float( modulusPerAlpha * material.alpha );
		plan.substepsNeeded = substeps;
		return plan;
	}

	const double alpha = material.youngsModulus / modulusPerAlpha, largest = largestAlpha( material );
	const bool isOutOfReach = alpha > largest * ( 1.0 + kAlphaSlack );
	if ( material.elasticity == Elasticity::Implicit ||
		( material.elasticity == Elasticity::Automatic && isOutOfReach && material.farLevels == 0 ) )
	{
		plan.alpha = float( alpha );
		plan.reachedModulus = material.youngsModulus;
		return plan;
	}
	const FarFractions far = farFractions( material, cellSize, h );
	const double farAlpha = farMoment( far ) / modulusMoment( material );
	plan.alpha = float( std::min( alpha, largest ) );
	plan.reachedModulus = float( modulusPerAlpha * ( plan.alpha + farAlpha ) );

	// alpha falls with the square of the substep: n substeps reach E when alpha( 1 substep ) <= n^2 times the largest, with far levels.
	const double largestReach = largest + farMoment( farFractions( material.farLevels, kMostReach ) ) / modulusMoment( material );
	plan.reachable = alpha <= largestReach * ( 1.0 + kAlphaSlack );
	const double needed = std::ceil( std::sqrt( alpha / largestReach ) * substeps - kAlphaSlack );
	plan.substepsNeeded = int( std::clamp( needed, 1.0, double( kMostSubstepsNamed ) ) );
	return plan;
}

} // namespace pliant
