// Checks the ranges of the settings.

#include "lattice/build/build_lattice.h"

#include "lattice/build/sentence.h"
#include "lattice/constants.h"
#include "lattice/ranges.h"

#include <cmath>
#include <new>

namespace pliant {

namespace {

constexpr int kMaxCellsLimit = 10000000;
constexpr int kMaxTrianglesLimit = 100000000;
constexpr int kMaxSamplesPerEdge = 8;
constexpr float kMaxWeldTolerance = 0.01f;
constexpr float kMaxMinimumFill = 0.5f;
constexpr float kMaxShellThickness = 1.0e7f;

} // namespace

Status checkSettings( const LatticeSettings& settings )
{
	const auto bad = []( std::string words ) { return Status{ ResultCode::BadSettings, std::move( words ) }; };
	if ( !( settings.cellSize >= 0.0f && std::isfinite( settings.cellSize ) ) )
	{
		return bad( "LatticeSettings::cellSize must be 0 (chosen from targetCells) or above." );
	}
	if ( !isWithin( settings.maxCells, 1, kMaxCellsLimit ) )
	{
		return bad( sentence( "LatticeSettings::maxCells must be 1 to ", kMaxCellsLimit, "." ) );
	}
	if ( settings.cellSize == 0.0f && !isWithin( settings.targetCells, 1, settings.maxCells ) )
	{
		return bad( "LatticeSettings::targetCells must be 1 to maxCells." );
	}
	if ( !isWithin( settings.maxTriangles, 1, kMaxTrianglesLimit ) )
	{
		return bad( sentence( "LatticeSettings::maxTriangles must be 1 to ", kMaxTrianglesLimit, "." ) );
	}
	if ( !isWithin( settings.samplesPerEdge, 1, kMaxSamplesPerEdge ) )
	{
		return bad( sentence( "LatticeSettings::samplesPerEdge must be 1 to ", kMaxSamplesPerEdge, "." ) );
	}
	if ( !isWithin( settings.weldTolerance, 0.0f, kMaxWeldTolerance ) )
	{
		return bad( sentence( "LatticeSettings::weldTolerance must be 0 to ", kMaxWeldTolerance, "." ) );
	}
	if ( !isWithin( settings.minimumFill, 0.0f, kMaxMinimumFill ) )
	{
		return bad( sentence( "LatticeSettings::minimumFill must be 0 to ", kMaxMinimumFill, "." ) );
	}
	if ( !isWithin( settings.shellThickness, 0.0f, kMaxShellThickness ) )
	{
		return bad( "LatticeSettings::shellThickness must be 0 (a cell's edge) to 1e7 m." );
	}
	if ( !isWithin( int( settings.shell ), int( Shell::WhereNeeded ), int( Shell::Always ) ) )
	{
		return bad( "LatticeSettings::shell is none of Shell's values." );
	}
	if ( !isWithin( int( settings.skinning ), int( Skinning::NearbyNodes ), int( Skinning::None ) ) )
	{
		return bad( "LatticeSettings::skinning is none of Skinning's values." );
	}
	return {};
}

Status outOfMemory() noexcept
{
	Status status;
	status.code = ResultCode::OutOfMemory;
	try
	{
		status.sentence = "Not enough memory to build the body; a larger LatticeSettings::cellSize needs less.";
	}
	catch ( const std::bad_alloc& )
	{
		status.sentence = "Out of memory."; // short enough to be stored without an allocation
	}
	return status;
}

} // namespace pliant
