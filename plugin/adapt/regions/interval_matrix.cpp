#include "adapt/constants.h"
#include "adapt/regions/interval_regions.h"

#include <algorithm>
#include <cmath>

namespace pliant {

namespace {

void listMembers( const Octree& octree, const Cut& cut, const IntervalRegions& intervals, RegionMatrix& matrix )
{
	const std::vector<SlotSpan> spans = slotSpans( octree, cut );
	matrix.start.reserve( intervals.start.size() );
	matrix.start.push_back( 0 );
	for ( int r = 0; r < intervals.count(); ++r )
	{
		for ( std::uint32_t k = intervals.start[r]; k < intervals.start[r + 1]; ++k )
		{
			const SlotSpan span = spans[intervals.node[k]];
			for ( std::uint32_t slot = span.first; slot < span.end; ++slot )
			{
				matrix.member.push_back( slot );
			}
		}
		matrix.start.push_back( std::uint32_t( matrix.member.size() ) );
	}
	matrix.mass.resize( matrix.member.size() );
	matrix.fraction.resize( matrix.member.size() );
}

/// Stores u( a, r ) of all pairs together with its transpose. `weight( a, r )` must depend only on its arguments.
template <class F>
void setConserving( RegionMatrix& matrix, const F& weight )
{
	for ( std::uint32_t r = 0; r < std::uint32_t( matrix.count() ); ++r )
	{
		for ( std::uint32_t k = matrix.start[r]; k < matrix.start[r + 1]; ++k )
		{
			matrix.mass[k] = weight( matrix.member[k], r );
			matrix.fraction[k] = weight( r, matrix.member[k] );
		}
	}
}

} // namespace

RegionMatrix buildIntervalRegions( const Octree& octree, const Cut& cut, const IntervalRegions& intervals, IntervalWeights weights )
{
	RegionMatrix matrix;
	listMembers( octree, cut, intervals, matrix );
	std::vector<std::uint32_t> unit; // u( a, r ) where it is the same for all regions
	std::vector<double> perMass;     // m_a / M_a
	for ( std::uint32_t a = 0; a < std::uint32_t( cut.count() ); ++a )
	{
		// Membership is symmetric: the row of a also lists the regions that hold it.
		const std::uint32_t first = matrix.start[a], end = matrix.start[a + 1];
		const double mass = octree.mass[cut.node[a]];
		unit.push_back( inMassUnits( weights == IntervalWeights::Literal ? mass : mass / double( end - first ) ) );
		double owners = 0.0; // M_a
		for ( std::uint32_t k = first; k < end && weights == IntervalWeights::ConservingByMass; ++k )
		{
			owners += octree.mass[cut.node[matrix.member[k]]];
		}
		perMass.push_back( owners > 0.0 ? mass / owners : 0.0 );
	}
	switch ( weights )
	{
		case IntervalWeights::Literal:
			for ( std::size_t k = 0; k < matrix.member.size(); ++k )
			{
				matrix.mass[k] = matrix.fraction[k] = unit[matrix.member[k]];
			}
			break;
		case IntervalWeights::Conserving: setConserving( matrix, [&]( std::uint32_t a, std::uint32_t ) { return unit[a]; } ); break;
		case IntervalWeights::ConservingByMass:
			setConserving(
				matrix, [&]( std::uint32_t a, std::uint32_t r ) { return inMassUnits( perMass[a] * octree.mass[cut.node[r]] ); } );
			break;
	}
	matrix.unit.assign( cut.node.size(), kMassUnit );
	if ( weights != IntervalWeights::Literal )
	{
		weighUnits( octree, cut, matrix );
	}
	return matrix;
}

} // namespace pliant
