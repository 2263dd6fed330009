#include "pliant/adaptivity.h"

#include "adapt/octree/octree.h"
#include "lattice/features.h"
#include "lattice/ranges.h"

#include <cmath>

namespace pliant {

namespace {

Status refuse( const char* sentence )
{
	return Status{ ResultCode::BadSettings, sentence };
}

} // namespace

Adaptivity steinemannAdaptivity( int coarseLevels )
{
	Adaptivity settings;
	settings.coarseLevels = coarseLevels;
	settings.regions = RegionRule::Interval;
	settings.softening = Softening::None;
	settings.residual = ResidualRule::Keep;
	return settings;
}

Adaptivity ohtaAdaptivity( int coarseLevels )
{
	Adaptivity settings;
	settings.coarseLevels = coarseLevels;
	settings.regions = RegionRule::Union;
	settings.softening = Softening::Ohta3D;
	settings.residual = ResidualRule::Keep;
	return settings;
}

Status check( const Adaptivity& settings )
{
	if ( Status status = settings.coarseLevels > 0 ? requireFeature( Feature::Levels ) : Status{}; !status.ok() )
	{
		return status;
	}
	if ( settings.coarseLevels < 0 || settings.coarseLevels > kMaxCoarseLevels )
	{
		return refuse( "Adaptivity: coarseLevels must be 0 to 4." );
	}
	if ( !( std::isfinite( settings.keepMass ) && settings.keepMass > 0.0f ) )
	{
		return refuse( "Adaptivity: keepMass must be above 0." );
	}
	const bool areChoices = isChoice( settings.regions, RegionRule::Interval ) && isChoice( settings.softening, Softening::EnergyTensor ) &&
		isChoice( settings.residual, ResidualRule::Larger );
	if ( !areChoices )
	{
		return refuse( "Adaptivity: regions, softening and residual must be values of RegionRule, Softening and ResidualRule." );
	}
	if ( !( isWithin( settings.coarseStiffness, 0.0f, 1.0f ) && settings.coarseStiffness > 0.0f ) )
	{
		return refuse( "Adaptivity: coarseStiffness must be above 0 and at most 1." );
	}
	if ( !isWithin( settings.intervalSlack, 0.0f, 4.0f ) )
	{
		return refuse( "Adaptivity: intervalSlack must be within 0 and 4." );
	}
	if ( !isWithin( settings.refineStrain, 0.0f, 10.0f ) )
	{
		return refuse( "Adaptivity: refineStrain must be within 0 and 10." );
	}
	if ( !( isWithin( settings.mergeFraction, 0.0f, 1.0f ) && settings.mergeFraction < 1.0f ) )
	{
		return refuse( "Adaptivity: mergeFraction must be within 0 and below 1." );
	}
	if ( !isWithin( settings.mergeDelay, 0.0f, 60.0f ) )
	{
		return refuse( "Adaptivity: mergeDelay must be within 0 and 60 s." );
	}
	if ( settings.nodesPerStep < 8 || settings.nodesPerStep > 1000000 )
	{
		return refuse( "Adaptivity: nodesPerStep must be 8 to 1 000 000." );
	}
	return {};
}

} // namespace pliant
