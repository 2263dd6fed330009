#include "pliant/adaptivity.h"

#include "adapt/constants.h"
#include "adapt/octree/octree.h"
#include "lattice/features.h"
#include "lattice/ranges.h"

#include <cmath>

namespace pliant {

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
	return require( ResultCode::BadSettings,
		{ { isWithin( settings.coarseLevels, 0, kMaxCoarseLevels ), "Adaptivity: coarseLevels must be 0 to 4." },
			{ std::isfinite( settings.keepMass ) && settings.keepMass > 0.0f, "Adaptivity: keepMass must be above 0." },
			{ isChoice( settings.regions, RegionRule::Interval ) && isChoice( settings.softening, Softening::EnergyTensor ) &&
					isChoice( settings.residual, ResidualRule::Larger ),
				"Adaptivity: regions, softening and residual must be values of RegionRule, Softening and ResidualRule." },
			{ isWithin( settings.coarseStiffness, 0.0f, 1.0f ) && settings.coarseStiffness > 0.0f,
				"Adaptivity: coarseStiffness must be above 0 and at most 1." },
			{ isWithin( settings.intervalSlack, 0.0f, 4.0f ), "Adaptivity: intervalSlack must be within 0 and 4." },
			{ isWithin( settings.refineStrain, 0.0f, 10.0f ), "Adaptivity: refineStrain must be within 0 and 10." },
			{ isWithin( settings.mergeFraction, 0.0f, 1.0f ) && settings.mergeFraction < 1.0f,
				"Adaptivity: mergeFraction must be within 0 and below 1." },
			{ isWithin( settings.mergeDelay, 0.0f, 60.0f ), "Adaptivity: mergeDelay must be within 0 and 60 s." },
			{ isWithin( settings.nodesPerStep, 8, 1000000 ), "Adaptivity: nodesPerStep must be 8 to 1 000 000." } } );
}

} // namespace pliant
