#include "pliant/fracture.h"

#include "fracture/constants.h"

namespace pliant {

namespace {

bool within( float value, float low, float high )
{
	return value >= low && value <= high; // false for NaN
}

Status refuse( const char* sentence )
{
	return Status{ ResultCode::BadSettings, sentence };
}

} // namespace

Status check( const Fracture& fracture )
{
	if ( !( fracture.breakStrain > 0.0f ) || !within( fracture.breakStrain, 0.0f, kLargestBreakStrain ) )
	{
		return refuse( "Fracture::breakStrain must be above 0 and at most 10." );
	}
	if ( !within( fracture.strength, 0.0f, kLargestStrength ) )
	{
		return refuse( "Fracture::strength must lie in [0, 1e12] Pa." );
	}
	if ( !within( fracture.coolDown, 0.0f, kLongestCoolDown ) )
	{
		return refuse( "Fracture::coolDown must lie in [0, 10] s." );
	}
	if ( !( fracture.growthFraction > 0.0f ) || !within( fracture.growthFraction, 0.0f, 1.0f ) )
	{
		return refuse( "Fracture::growthFraction must be above 0 and at most 1." );
	}
	if ( fracture.smallCells < 0 || fracture.smallCells > kLargestSmallPiece )
	{
		return refuse( "Fracture::smallCells must lie in 0 to 1 000 000." );
	}
	if ( !( fracture.fadeTime > 0.0f ) || !within( fracture.fadeTime, 0.0f, kLongestFade ) )
	{
		return refuse( "Fracture::fadeTime must be above 0 and at most 3600 s." );
	}
	if ( fracture.maxPieces < 1 || fracture.maxPieces > kMaxPieces )
	{
		return refuse( "Fracture::maxPieces must lie in 1 to 100 000." );
	}
	return {};
}

} // namespace pliant
