// What makes a body breakable, as bytes.

#include "archive/settings_archive.h"
#include "body/breaking.h"

#include <algorithm>

namespace pliant {

namespace {

/// The limits of all links, as they were inherited from body to piece.
void archiveLimits( Archive& archive, LinkLimits& limits, const Lattice& lattice )
{
	auto& [start, to, toughness, lengthSquared, weakest] = limits;
	archive( start, to, toughness, lengthSquared, weakest );
	const auto cells = std::uint32_t( lattice.cellCount() );
	archive.require( start.size() == std::size_t( cells ) + 1 && start.front() == 0 && start.back() == to.size() &&
			std::is_sorted( start.begin(), start.end() ) && lengthSquared.size() == to.size() &&
			( toughness.empty() || toughness.size() == to.size() ) &&
			std::all_of( to.begin(), to.end(), [cells]( std::uint32_t cell ) { return cell < cells; } ),
		"The limits of the links are not valid." );
}

} // namespace

void Breaking::archiveMake( Archive& archive, const Lattice& lattice, const Material& material, bool isWhole )
{
	archive( settings );
	if ( archive.isReading() && archive.isSound() )
	{
		archive.require( check( settings ).ok() && settings.rule != BreakRule::Never, "The settings of fracture are not valid." );
	}
	if ( !isWhole )
	{
		archiveLimits( archive, limits, lattice );
		if ( archive.isReading() && settings.rule == BreakRule::Plane )
		{
			planes = std::make_unique<PlaneCracks>( breakStrain( settings, material ), settings.growthFraction );
		}
		return;
	}
	archive( limits.toughness );
	if ( archive.require( limits.toughness.empty() || limits.toughness.size() == std::size_t( lattice.linkCount() ),
			 "The toughness is that of another body." ) &&
		archive.isReading() )
	{
		prepare( lattice, breakStrain( settings, material ), std::vector<float>( limits.toughness ) );
	}
}

void Breaking::archiveState( Archive& archive, const Lattice& lattice )
{
	archiveLinks( archive, broken, lattice );
	archive( sinceTest, coolDown );
	bool hasPlanes = planes != nullptr;
	archive( hasPlanes );
	if ( archive.require( hasPlanes == ( planes != nullptr ), "The cracks are those of another body." ) && planes )
	{
		planes->archive( archive );
	}
	if ( archive.isReading() )
	{
		refinementStates.forget();
	}
}

} // namespace pliant
