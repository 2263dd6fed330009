// Ranges of the settings of drawn cracks.

#include "lattice/ranges.h"
#include "surface/constants.h"
#include "surface/crack_complex/cell_complex.h"

#include <cmath>

namespace pliant {

Status check( const CrackSettings& settings )
{
	return require( ResultCode::BadSettings,
		{ { isWithin( settings.noiseAmplitude, 0.0f, kMostNoise ), "CrackSettings::noiseAmplitude must be 0 to 0.35 cells." },
			{ isWithin( settings.noiseWavelength, 1.0f, kLongestWave ), "CrackSettings::noiseWavelength must be 1 to 100 cells." },
			{ isWithin( settings.subdivision, 1, kMostSubdivision ), "CrackSettings::subdivision must be 1 to 8." },
			{ isWithin( settings.bendTolerance, 0.0f, kMostBendTolerance ), "CrackSettings::bendTolerance must be 0 to 0.5 cells." },
			{ settings.textureTile > 0.0f && std::isfinite( settings.textureTile ),
				"CrackSettings::textureTile must be above 0 m and finite." },
			{ isChoice( settings.faces, CrackFaces::Bricks ), "CrackSettings::faces is none of CrackFaces' values." } } );
}

} // namespace pliant
