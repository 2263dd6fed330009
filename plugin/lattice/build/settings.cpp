// Checks the ranges of the settings.

#include "lattice/build/build_lattice.h"

#include "lattice/constants.h"
#include "lattice/ranges.h"

#include <cmath>

namespace pliant {

Status checkSettings( const LatticeSettings& settings )
{
	return require( ResultCode::BadSettings,
		{ { settings.cellSize >= 0.0f && std::isfinite( settings.cellSize ),
			  "LatticeSettings::cellSize must be 0 (chosen from targetCells) or above." },
			{ isWithin( settings.maxCells, 1, kMaxCellsLimit ), "LatticeSettings::maxCells must be 1 to 10000000." },
			{ settings.cellSize != 0.0f || isWithin( settings.targetCells, 1, settings.maxCells ),
				"LatticeSettings::targetCells must be 1 to maxCells." },
			{ isWithin( settings.maxTriangles, 1, kMaxTrianglesLimit ), "LatticeSettings::maxTriangles must be 1 to 100000000." },
			{ isWithin( settings.samplesPerEdge, 1, kMaxSamplesPerEdge ), "LatticeSettings::samplesPerEdge must be 1 to 8." },
			{ isWithin( settings.weldTolerance, 0.0f, kMaxWeldTolerance ), "LatticeSettings::weldTolerance must be 0 to 0.01." },
			{ isWithin( settings.minimumFill, 0.0f, kMaxMinimumFill ), "LatticeSettings::minimumFill must be 0 to 0.5." },
			{ isWithin( settings.shellThickness, 0.0f, kMaxShellThickness ),
				"LatticeSettings::shellThickness must be 0 (a cell's edge) to 1e7 m." },
			{ isChoice( settings.shell, Shell::Always ), "LatticeSettings::shell is none of Shell's values." },
			{ isChoice( settings.skinning, Skinning::None ), "LatticeSettings::skinning is none of Skinning's values." } } );
}

} // namespace pliant
