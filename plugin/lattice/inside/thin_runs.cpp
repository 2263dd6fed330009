// Weighs thin material by the lengths that rows across it measure.

#include "lattice/inside/thin_runs.h"

#include <algorithm>
#include <array>

namespace pliant {

void keepThinRuns( std::vector<Sliver>& slivers, Voxels& voxels )
{
	std::sort( slivers.begin(), slivers.end(), []( const Sliver& a, const Sliver& b ) {
		return a.cutCell != b.cutCell ? a.cutCell < b.cutCell
			: a.axis != b.axis        ? a.axis < b.axis
			: a.sample != b.sample    ? a.sample < b.sample
									  : a.point[a.axis] < b.point[b.axis];
	} );
	const std::size_t perCell = voxels.samplesPerCell();
	for ( std::size_t first = 0, last = 0; first < slivers.size(); first = last )
	{
		std::array<int, 3> seen{};
		std::array<int, 3> unseen{};
		for ( ; last < slivers.size() && slivers[last].cutCell == slivers[first].cutCell; ++last )
		{
			++( slivers[last].hasSample ? seen : unseen )[slivers[last].axis];
		}
		std::uint8_t* flags = &voxels.flags[std::size_t( slivers[first].cutCell ) * perCell];
		const auto inside = std::count_if( flags, flags + perCell, []( std::uint8_t f ) { return ( f & kInside ) != 0; } );
		std::size_t best = 0;
		for ( std::size_t axis = 1; axis < 3; ++axis )
		{
			best = seen[axis] + unseen[axis] > seen[best] + unseen[best] ? axis : best;
		}
		if ( unseen[best] == 0 || 2 * seen[best] < inside )
		{
			continue;
		}
		for ( std::size_t k = first; k < last; ++k )
		{
			if ( slivers[k].axis == std::uint8_t( best ) )
			{
				flags[slivers[k].sample] |= slivers[k].hasSample ? 0 : kSliver;
				voxels.slivers.push_back( slivers[k] );
			}
		}
	}
}

} // namespace pliant
