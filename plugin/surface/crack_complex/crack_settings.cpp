// Ranges of the settings of drawn cracks.

#include "surface/crack_complex/cell_complex.h"

#include <cmath>

namespace pliant {

namespace {

constexpr float kLongestWave = 100.0f;
constexpr int kMostSubdivision = 8;
constexpr float kMostTolerance = 0.5f;

Status refuse( const char* words )
{
	return { ResultCode::BadSettings, words };
}

} // namespace

Status check( const CrackSettings& settings )
{
	if ( !( settings.noiseAmplitude >= 0.0f && settings.noiseAmplitude <= kMostNoise ) )
	{
		return refuse( "CrackSettings::noiseAmplitude must be 0 to 0.35 cells." );
	}
	if ( !( settings.noiseWavelength >= 1.0f && settings.noiseWavelength <= kLongestWave ) )
	{
		return refuse( "CrackSettings::noiseWavelength must be 1 to 100 cells." );
	}
	if ( settings.subdivision < 1 || settings.subdivision > kMostSubdivision )
	{
		return refuse( "CrackSettings::subdivision must be 1 to 8." );
	}
	if ( !( settings.bendTolerance >= 0.0f && settings.bendTolerance <= kMostTolerance ) )
	{
		return refuse( "CrackSettings::bendTolerance must be 0 to 0.5 cells." );
	}
	if ( !( settings.textureTile > 0.0f && std::isfinite( settings.textureTile ) ) )
	{
		return refuse( "CrackSettings::textureTile must be above 0 m and finite." );
	}
	if ( int( settings.faces ) < int( CrackFaces::Exact ) || int( settings.faces ) > int( CrackFaces::Bricks ) )
	{
		return refuse( "CrackSettings::faces is none of CrackFaces' values." );
	}
	return {};
}

} // namespace pliant
