#include "matching/sliced_rows.h"

#include "adapt/region_matrix.h"

#include <algorithm>

namespace pliant {

void SlicedRows::layOut( const RegionMatrix& matrix )
{
	m_slices.clear();
	m_tiles.assign( 1, 0 );
	m_from.clear();
	m_mass.clear();
	m_share.clear();
	const std::uint32_t count = std::uint32_t( matrix.count() );
	const auto isLonger = [&matrix]( std::uint32_t a, std::uint32_t b ) {
		const std::uint32_t ofA = matrix.start[a + 1] - matrix.start[a], ofB = matrix.start[b + 1] - matrix.start[b];
		return ofA != ofB ? ofA > ofB : a < b;
	};
	std::vector<std::uint32_t> rows;
	for ( std::uint32_t begin = 0; begin < count; begin += kTile )
	{
		rows.clear();
		for ( std::uint32_t row = begin; row < std::min( count, begin + std::uint32_t( kTile ) ); ++row )
		{
			rows.push_back( row );
		}
		std::sort( rows.begin(), rows.end(), isLonger );
		while ( rows.size() % kSliceRows != 0 )
		{
			rows.push_back( rows.back() ); // summed twice over: no harm
		}
		for ( std::size_t at = 0; at < rows.size(); at += kSliceRows )
		{
			addSlice( matrix, rows, at, begin );
		}
		m_tiles.push_back( std::uint32_t( m_slices.size() ) );
	}
}

void SlicedRows::addSlice( const RegionMatrix& matrix, const std::vector<std::uint32_t>& rows, std::size_t at, std::uint32_t tileBegin )
{
	RowSlice slice;
	slice.first = std::uint32_t( m_from.size() );
	const std::uint32_t longest = matrix.start[rows[at] + 1] - matrix.start[rows[at]];
	slice.terms = ( longest + 1 ) / 2 * 2;
	for ( std::uint32_t k = 0; k < slice.terms; ++k )
	{
		for ( std::size_t j = 0; j < kSliceRows; ++j )
		{
			const std::uint32_t begin = matrix.start[rows[at + j]], term = begin + k;
			const bool isThere = term < matrix.start[rows[at + j] + 1];
			m_from.push_back( matrix.member[isThere ? term : begin] * kRateFloats );
			m_mass.push_back( isThere ? float( matrix.mass[term] ) : 0.0f );
			m_share.push_back( isThere ? float( matrix.share[term] ) : 0.0f );
		}
	}
	for ( std::size_t j = 0; j < kSliceRows; ++j )
	{
		slice.row[j] = std::uint8_t( rows[at + j] - tileBegin );
	}
	m_slices.push_back( slice );
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
