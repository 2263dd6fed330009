// The data of breaking, as bytes.

#include "archive/settings_archive.h"
#include "body/breaking.h"
#include "fracture/shards/shard_cracks.h"

namespace pliant {

namespace {

/// The limits of all links, as they were inherited from body to piece; the links are the lattice's.
void archiveLimits( Archive& archive, LinkLimits& limits, const Lattice& lattice, float strain )
{
	archive( limits.toughness );
	if ( !archive.require( limits.toughness.empty() || limits.toughness.size() == std::size_t( lattice.linkCount() ),
			 "The toughness is that of another body." ) )
	{
		return;
	}
	if ( archive.isReading() )
	{
		limits = limitLinks( lattice, strain, std::vector<float>( limits.toughness ) );
	}
	archive.sameLength( limits.lengthSquared );
	archive( limits.weakest );
	archiveThinCells( archive, limits.thin, std::size_t( lattice.cellCount() ) );
}

} // namespace

void Breaking::archiveMake( Archive& archive, const Lattice& lattice, const Material& material, bool isWhole )
{
	archive( settings );
	if ( archive.isReading() && archive.isSound() )
	{
		archive.require( check( settings ).ok() && settings.rule != BreakRule::Never, "The settings of fracture are not valid." );
	}
	bool hasShards = shards != nullptr;
	archive( hasShards );
	archive.require( hasShards == ( settings.rule == BreakRule::Shards ), "The shards are those of another rule." );
	if ( hasShards && archive.isSound() )
	{
		shards = shards ? std::move( shards ) : ShardCracks::blank();
		shards->archive( archive, std::size_t( lattice.cellCount() ) );
	}
	if ( !archive.isSound() )
	{
		return;
	}
	if ( !isWhole )
	{
		archiveLimits( archive, limits, lattice, breakStrain( settings, material ) );
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
		limits.thin = findThinCells( lattice );
		prepare( lattice, material, std::vector<float>( limits.toughness ) );
	}
}

void Breaking::archiveState( Archive& archive, const Lattice& lattice )
{
	archiveLinks( archive, broken, lattice );
	archive( sinceTest, coolDown, energy );
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
