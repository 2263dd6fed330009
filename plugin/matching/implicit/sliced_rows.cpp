#include "matching/implicit/sliced_rows.h"

#include "adapt/regions/region_matrix.h"

#include <algorithm>
#include <limits>

namespace pliant {

void SlicedRows::layOut( const RegionMatrix& matrix )
{
	constexpr std::uint32_t tileRows = kTile, longest = std::numeric_limits<std::uint32_t>::max() / tileRows;
	const std::uint32_t count = std::uint32_t( matrix.count() );
	const auto lengthOf = [&matrix]( std::uint32_t row ) { return matrix.start[row + 1] - matrix.start[row]; };
	m_slices.clear();
	m_tiles.assign( 1, 0 );
	std::uint32_t terms = 0;
	for ( std::uint32_t begin = 0; begin < count; begin += tileRows )
	{
		// Longest rows first; sorting combined keys of length and row is faster than looking up each row's length.
		m_keys.clear();
		for ( std::uint32_t row = begin; row < std::min( count, begin + tileRows ); ++row )
		{
			m_keys.push_back( ( longest - lengthOf( row ) ) * tileRows + ( row - begin ) );
		}
		std::sort( m_keys.begin(), m_keys.end() );
		for ( std::size_t at = 0; at < m_keys.size(); at += kSliceRows )
		{
			RowSlice slice;
			for ( std::size_t j = 0; j < kSliceRows; ++j )
			{
				// The last row fills up an incomplete slice; summing it twice is harmless.
				slice.row[j] = std::uint8_t( m_keys[std::min( at + j, m_keys.size() - 1 )] % tileRows );
			}
			slice.first = terms;
			slice.terms = ( lengthOf( begin + slice.row[0] ) + 1 ) / 2 * 2;
			terms += slice.terms * kSliceRows;
			m_slices.push_back( slice );
		}
		m_tiles.push_back( std::uint32_t( m_slices.size() ) );
	}
	m_from.resize( terms );
	m_mass.resize( terms );
	m_fraction.resize( terms );
	for ( std::uint32_t tile = 0; tile + 1 < std::uint32_t( m_tiles.size() ); ++tile )
	{
		for ( std::uint32_t s = m_tiles[tile]; s < m_tiles[tile + 1]; ++s )
		{
			fill( matrix, m_slices[s], tile * tileRows );
		}
	}
}

void SlicedRows::fill( const RegionMatrix& matrix, const RowSlice& slice, std::uint32_t tileBegin )
{
	for ( std::uint32_t j = 0; j < std::uint32_t( kSliceRows ); ++j )
	{
		const std::uint32_t begin = matrix.start[tileBegin + slice.row[j]], end = matrix.start[tileBegin + slice.row[j] + 1];
		std::uint32_t to = slice.first + j;
		for ( std::uint32_t k = begin; k < end; ++k, to += kSliceRows )
		{
			m_from[to] = matrix.member[k] * kRateFloats;
			m_mass[to] = float( matrix.mass[k] );
			m_fraction[to] = float( matrix.fraction[k] );
		}
		for ( const std::uint32_t last = slice.first + slice.terms * kSliceRows; to < last; to += kSliceRows )
		{
			m_from[to] = matrix.member[begin] * kRateFloats;
			m_mass[to] = m_fraction[to] = 0.0f;
		}
	}
}

RowSlices SlicedRows::view() const
{
	return { m_slices.data(), m_tiles.data(), m_from.data(), m_mass.data(), m_fraction.data() };
}

std::size_t SlicedRows::bytes() const
{
	return m_slices.size() * sizeof( RowSlice ) + m_tiles.size() * sizeof( std::uint32_t ) +
		m_from.size() * ( sizeof( std::uint32_t ) + 2 * sizeof( float ) );
}

} // namespace pliant
