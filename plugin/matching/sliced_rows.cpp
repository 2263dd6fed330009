#include "matching/sliced_rows.h"

#include "adapt/region_matrix.h"

#include <algorithm>
#include <numeric>

namespace pliant {

void SlicedRows::layOut( const RegionMatrix& matrix )
{
	const std::uint32_t count = std::uint32_t( matrix.count() );
	const auto lengthOf = [&matrix]( std::uint32_t row ) { return matrix.start[row + 1] - matrix.start[row]; };
	m_slices.clear();
	m_tiles.assign( 1, 0 );
	std::uint32_t terms = 0;
	for ( std::uint32_t begin = 0; begin < count; begin += kTile )
	{
		m_order.resize( std::min<std::size_t>( kTile, count - begin ) );
		std::iota( m_order.begin(), m_order.end(), begin );
		std::sort( m_order.begin(), m_order.end(), [&lengthOf]( std::uint32_t a, std::uint32_t b ) {
			const std::uint32_t ofA = lengthOf( a ), ofB = lengthOf( b );
			return ofA != ofB ? ofA > ofB : a < b;
		} );
		for ( std::size_t at = 0; at < m_order.size(); at += kSliceRows )
		{
			RowSlice slice;
			slice.first = terms;
			slice.terms = ( lengthOf( m_order[at] ) + 1 ) / 2 * 2;
			for ( std::size_t j = 0; j < kSliceRows; ++j )
			{
				slice.row[j] =
				    std::uint8_t( m_order[std::min( at + j, m_order.size() - 1 )] - begin ); // the last may be summed twice over: no harm
			}
			terms += slice.terms * kSliceRows;
			m_slices.push_back( slice );
		}
		m_tiles.push_back( std::uint32_t( m_slices.size() ) );
	}
	m_from.resize( terms );
	m_mass.resize( terms );
	m_share.resize( terms );
	for ( std::uint32_t tile = 0; tile + 1 < std::uint32_t( m_tiles.size() ); ++tile )
	{
		for ( std::uint32_t s = m_tiles[tile]; s < m_tiles[tile + 1]; ++s )
		{
			fill( matrix, m_slices[s], tile * kTile );
		}
	}
}

void SlicedRows::fill( const RegionMatrix& matrix, const RowSlice& slice, std::uint32_t tileBegin )
{
	for ( std::size_t j = 0; j < kSliceRows; ++j )
	{
		const std::uint32_t begin = matrix.start[tileBegin + slice.row[j]], length = matrix.start[tileBegin + slice.row[j] + 1] - begin;
		for ( std::uint32_t k = 0; k < slice.terms; ++k )
		{
			const std::size_t to = slice.first + k * kSliceRows + j;
			const bool isThere = k < length;
			m_from[to] = matrix.member[begin + ( isThere ? k : 0 )] * kRateFloats;
			m_mass[to] = isThere ? float( matrix.mass[begin + k] ) : 0.0f;
			m_share[to] = isThere ? float( matrix.share[begin + k] ) : 0.0f;
		}
	}
}

RowSlices SlicedRows::view() const
{
	return { m_slices.data(), m_tiles.data(), m_from.data(), m_mass.data(), m_share.data() };
}

std::size_t SlicedRows::bytes() const
{
	return m_slices.size() * sizeof( RowSlice ) + m_tiles.size() * sizeof( std::uint32_t ) +
	       m_from.size() * ( sizeof( std::uint32_t ) + 2 * sizeof( float ) );
}

} // namespace pliant
