#include "pliant/fracture.h"

#include "fracture/constants.h"
#include "lattice/ranges.h"

#include <cmath>

namespace pliant {

namespace {

Status refuse( const char* sentence )
{
	return Status{ ResultCode::BadSettings, sentence };
}

Status checkShards( const Fracture& fracture )
{
	if ( !( fracture.shardSize > 0.0f ) || !isWithin( fracture.shardSize, 0.0f, kLargestShard ) )
	{
		return refuse( "Fracture::shardSize must be above 0 and at most 1e6 m." );
	}
	if ( !isWithin( fracture.toughness, 0.0f, kLargestToughness ) )
	{
		return refuse( "Fracture::toughness must lie in [0, 1e12] J/m^2." );
	}
	if ( !isWithin( fracture.crumbFraction, 0.0f, 1.0f ) )
	{
		return refuse( "Fracture::crumbFraction must lie in [0, 1]." );
	}
	if ( fracture.shardPattern != ShardPattern::Scattered && fracture.shardPattern != ShardPattern::Rings )
	{
		return refuse( "Fracture::shardPattern must be Scattered or Rings." );
	}
	if ( !isWithin( fracture.grainLength, 1.0f, kLongestGrain ) )
	{
		return refuse( "Fracture::grainLength must lie in [1, 100]." );
	}
	for ( const float component : fracture.grain )
	{
		if ( !std::isfinite( component ) )
		{
			return refuse( "Fracture::grain must be finite." );
		}
	}
	return {};
}

} // namespace

Status check( const Fracture& fracture )
{
	if ( !isChoice( fracture.rule, BreakRule::Shards ) )
	{
		return refuse( "Fracture::rule must be one of BreakRule." );
	}
	if ( !( fracture.breakStrain > 0.0f ) || !isWithin( fracture.breakStrain, 0.0f, kLargestBreakStrain ) )
	{
		return refuse( "Fracture::breakStrain must be above 0 and at most 10." );
	}
	if ( !isWithin( fracture.strength, 0.0f, kLargestStrength ) )
	{
		return refuse( "Fracture::strength must lie in [0, 1e12] Pa." );
	}
	if ( !isWithin( fracture.coolDown, 0.0f, kLongestCoolDown ) )
	{
		return refuse( "Fracture::coolDown must lie in [0, 10] s." );
	}
	if ( !( fracture.growthFraction > 0.0f ) || !isWithin( fracture.growthFraction, 0.0f, 1.0f ) )
	{
		return refuse( "Fracture::growthFraction must be above 0 and at most 1." );
	}
	if ( Status status = checkShards( fracture ); !status.ok() )
	{
		return status;
	}
	if ( fracture.smallCells < 0 || fracture.smallCells > kLargestSmallPiece )
	{
		return refuse( "Fracture::smallCells must lie in 0 to 1 000 000." );
	}
	if ( !isChoice( fracture.smallPieces, SmallPieces::Remove ) )
	{
		return refuse( "Fracture::smallPieces must be one of SmallPieces." );
	}
	if ( !( fracture.fadeTime > 0.0f ) || !isWithin( fracture.fadeTime, 0.0f, kLongestFade ) )
	{
		return refuse( "Fracture::fadeTime must be above 0 and at most 3600 s." );
	}
	if ( fracture.maxPieces < 1 || fracture.maxPieces > kMaxPieces )
	{
		return refuse( "Fracture::maxPieces must lie in 1 to 100 000." );
	}
	return {};
}

Status check( const DebrisBudget& budget )
{
	if ( budget.maxPieces < 0 || budget.maxPieces > kMostDebrisPieces )
	{
		return refuse( "DebrisBudget::maxPieces must lie in 0 to 1 000 000." );
	}
	if ( budget.maxNodes < 0 || budget.maxNodes > kMostDebrisNodes )
	{
		return refuse( "DebrisBudget::maxNodes must lie in 0 to 1 000 000 000." );
	}
	if ( !( budget.fadeTime > 0.0f ) || !isWithin( budget.fadeTime, 0.0f, kLongestFade ) )
	{
		return refuse( "DebrisBudget::fadeTime must be above 0 and at most 3600 s." );
	}
	if ( !isWithin( budget.settleTime, 0.0f, kLongestFade ) )
	{
		return refuse( "DebrisBudget::settleTime must lie in 0 to 3600 s." );
	}
	if ( budget.piecesPerStep < 0 || budget.piecesPerStep > kMostPiecesPerStep )
	{
		return refuse( "DebrisBudget::piecesPerStep must lie in 0 to 100 000." );
	}
	return {};
}

} // namespace pliant
