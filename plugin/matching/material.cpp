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

Status refuse( const char* sentence )
{
	return Status{ ResultCode::BadMaterial, sentence };
}

Status checkChoices( const Material& material )
{
	const struct
	{
		bool isSound;
		const char* sentence;
	} choices[] = { { isChoice( material.stiffness, Stiffness::RawAlpha ), "Material::stiffness is none of Stiffness's values." },
		{ isChoice( material.elasticity, Elasticity::Automatic ), "Material::elasticity is none of Elasticity's values." },
		{ isChoice( material.method, Method::Clusters ), "Material::method is none of Method's values." },
		{ isChoice( material.clusterMode, ClusterMode::Quadratic ), "Material::clusterMode is none of ClusterMode's values." },
		{ isChoice( material.weights, Weights::Literal ), "Material::weights is none of Weights' values." },
		{ isChoice( material.rotationFrom, RotationFrom::F ), "Material::rotationFrom is none of RotationFrom's values." } };
	for ( const auto& [isSound, sentence] : choices )
	{
		if ( !isSound )
		{
			return refuse( sentence );
		}
	}
	return {};
}

Status checkFlow( const Material& material )
{
	if ( !isWithin( material.yieldStrain, 0.0f, kLargestYieldStrain ) )
	{
		return refuse( "Material::yieldStrain must lie in [0, 10]." );
	}
	if ( !( material.plasticCreep > 0.0f ) || !isWithin( material.plasticCreep, 0.0f, kLargestCreep ) )
	{
		return refuse( "Material::plasticCreep must be above 0 and at most 1e4 1/s." );
	}
	if ( !( material.plasticLimit > 0.0f ) || !isWithin( material.plasticLimit, 0.0f, kLargestPlasticLimit ) )
	{
		return refuse( "Material::plasticLimit must be above 0 and at most 2." );
	}
	if ( material.yieldStrain > 0.0f && material.method != Method::Lattice )
	{
		return refuse( "Material::yieldStrain needs Method::Lattice." );
	}
	return {};
}

Status checkFarLevels( const Material& material )
{
	if ( material.farLevels < 0 || material.farLevels > kMostFarLevels )
	{
		return refuse( "Material::farLevels must lie in 0 to 3." );
	}
	if ( material.farLevels == 0 )
	{
		return {};
	}
	if ( material.method != Method::Lattice || material.stiffness != Stiffness::YoungsModulus )
	{
		return refuse( "Material::farLevels needs Method::Lattice and Stiffness::YoungsModulus." );
	}
	if ( material.yieldStrain > 0.0f )
	{
		return refuse( "Material::farLevels knows the first rest shape only: yieldStrain must be 0." );
	}
	return {};
}

Status checkElasticity( const Material& material )
{
	if ( !isWithin( material.rigidStrain, 0.0f, kLargestRigidStrain ) )
	{
		return refuse( "Material::rigidStrain must lie in [0, 0.1]." );
	}
	if ( !isWithin( material.numericalDamping, 0.0f, 1.0f ) )
	{
		return refuse( "Material::numericalDamping must lie in [0, 1]." );
	}
	if ( material.elasticity != Elasticity::Implicit )
	{
		return {};
	}
	if ( material.method != Method::Lattice || material.weights != Weights::Conserving || material.rotationFrom != RotationFrom::Apq )
	{
		return refuse( "Elasticity::Implicit needs Method::Lattice, Weights::Conserving and RotationFrom::Apq." );
	}
	if ( material.farLevels > 0 )
	{
		return refuse( "Elasticity::Implicit reaches any stiffness by itself: Material::farLevels must be 0." );
	}
	return {};
}

} // namespace

namespace {

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

} // namespace

Status check( const Material& material )
{
	Status choices = checkChoices( material );
	if ( choices = choices.ok() ? checkBuild( material ) : choices; !choices.ok() )
	{
		return choices;
	}
	if ( !( material.density > 0.0f ) || !isWithin( material.density, 0.0f, kLargestDensity ) )
	{
		return refuse( "Material::density must be above 0 and at most 1e6 kg/m^3." );
	}
	if ( !( material.youngsModulus >= 0.0f ) || !std::isfinite( material.youngsModulus ) )
	{
		return refuse( "Material::youngsModulus must be at least 0 Pa and finite; 0 stands for the default of the body's size." );
	}
	if ( !( material.alpha > 0.0f ) || !isWithin( material.alpha, 0.0f, kLargestAlpha ) )
	{
		return refuse( "Material::alpha must be above 0 and at most 1." );
	}
	if ( !isWithin( material.beta, 0.0f, kLargestBeta ) )
	{
		return refuse( "Material::beta must lie in [0, 0.95]." );
	}
	if ( material.regionHalfWidth < 1 || material.regionHalfWidth > kLargestHalfWidth )
	{
		return refuse( "Material::regionHalfWidth must lie in 1 to 4 cells." );
	}
	if ( !isWithin( material.damping, 0.0f, kLargestDamping ) )
	{
		return refuse( "Material::damping must lie in [0, 1000] 1/s." );
	}
	if ( !isWithin( material.wobbleDamping, 0.0f, 1.0f ) )
	{
		return refuse( "Material::wobbleDamping must lie in [0, 1]." );
	}
	if ( !isWithin( material.volumeKeeping, 0.0f, kLargestVolumeKeeping ) )
	{
		return refuse( "Material::volumeKeeping must lie in [0, 2]." );
	}
	if ( material.stiffness == Stiffness::RawAlpha && material.alpha > largestAlpha( material ) )
	{
		return refuse( "Material::alpha is too large for this volumeKeeping: alpha ( 1 + 3 kappa ) must be at most 3.5." );
	}
	if ( Status status = checkFlow( material ); !status.ok() )
	{
		return status;
	}
	if ( Status status = checkFarLevels( material ); !status.ok() )
	{
		return status;
	}
	if ( Status status = checkElasticity( material ); !status.ok() )
	{
		return status;
	}
	if ( material.clusterEdge < 2 || material.clusterEdge > kLargestClusterEdge )
	{
		return refuse( "Material::clusterEdge must lie in 2 to 64 cells." );
	}
	return {};
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
