// The grid from which cells are cut. Ohta et al. 2009, "Preprocessing": the finest lattice.

#include "lattice/inside/grid.h"

#include "lattice/constants.h"

#include <algorithm>
#include <cmath>

namespace pliant {

bool makeGrid( const Vec3d& low, const Vec3d& high, double cellSize, int samples, Grid& out )
{
	const Vec3d count = ( ( high - low ) / cellSize ).array().max( kOverhang );
	if ( !( count.maxCoeff() < kMaxExtent ) )
	{
		return false;
	}
	out.cellSize = cellSize;
	out.samples = samples;
	int bitsOfExtent = 1;
	for ( int axis = 0; axis < 3; ++axis )
	{
		out.extent[axis] = std::max( 1, int( std::ceil( count[axis] - kOverhang ) ) );
		while ( ( 1 << bitsOfExtent ) <= out.extent[axis] )
		{
			++bitsOfExtent;
		}
	}
	out.bits = kCoordinateBits - bitsOfExtent;
	out.corner = 0.5 * ( low + high - cellSize * out.extent.cast<double>() );
	for ( int k = 0; k < samples; ++k )
	{
		out.offset[std::size_t( k )] = std::int32_t( ( std::int64_t( 2 * k + 1 ) << out.bits ) / ( 2 * samples ) );
	}
	return true;
}

int Grid::firstAbove( int axis, double coordinate ) const
{
	// Samples have whole quanta as coordinates. Coordinates outside the grid may exceed an integer's range.
	const double end = double( std::int64_t( extent[axis] ) << bits );
	return coordinate < 0.0 ? 0 : coordinate >= end ? sampleCount( axis ) : firstAbove( axis, std::int64_t( coordinate ) );
}

PositionIndex::PositionIndex( const Grid& grid, const std::vector<std::uint64_t>& keys ) : m_keys( keys )
{
	if ( grid.positions() <= kMaxTableEntries )
	{
		m_table.assign( std::size_t( grid.positions() ), kNone );
		for ( std::size_t k = keys.size(); k-- > 0; )
		{
			m_table[std::size_t( keys[k] )] = std::int32_t( k );
		}
	}
}

std::int32_t PositionIndex::find( std::uint64_t key ) const
{
	if ( !m_table.empty() )
	{
		return m_table[std::size_t( key )];
	}
	const auto found = std::lower_bound( m_keys.begin(), m_keys.end(), key );
	return found != m_keys.end() && *found == key ? std::int32_t( found - m_keys.begin() ) : kNone;
}

} // namespace pliant
