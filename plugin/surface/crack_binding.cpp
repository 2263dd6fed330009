// Which cells a side of a crack follows: of those that carried its points, the ones that standing faces still join to it.

#include "surface/crack_surface.h"

#include <algorithm>
#include <bit>

namespace pliant {

/// A point follows cells on both sides only where both of the face's cells carried it.
void CrackSurface::settle()
{
	std::vector<std::uint32_t> cells, points;
	for ( const std::uint32_t f : m_unsettled )
	{
		for ( const std::uint32_t cell : { m_face[f].cellA, m_face[f].cellB } )
		{
			if ( cell != kNone )
			{
				collect( cell, cells );
			}
		}
	}
	clearMarks( cells );
	const auto look = [&]( const std::uint32_t* p, const std::uint32_t* end ) {
		for ( ; p != end; ++p )
		{
			const std::uint32_t local = localPoint( *p );
			if ( local != kNone && m_firstVertex[local] != kNone )
			{
				collect( local, points );
			}
		}
	};
	for ( const std::uint32_t cell : cells )
	{
		look( m_complex->boundPoints.begin( m_cell[cell] ), m_complex->boundPoints.end( m_cell[cell] ) );
	}
	for ( const std::uint32_t f : m_unsettled )
	{
		const CrackFace& known = m_complex->face[m_face[f].number];
		for ( const std::uint32_t beyond : { known.cellA, known.cellB } )
		{
			if ( localCell( beyond ) == kNone ) // drawn by the other, which need not carry it
			{
				look( m_complex->boundPoints.begin( beyond ), m_complex->boundPoints.end( beyond ) );
			}
		}
		look( m_complex->pointsOfFace.begin( m_face[f].number ), m_complex->pointsOfFace.end( m_face[f].number ) );
	}
	for ( const std::uint32_t point : m_strange )
	{
		collect( point, points );
	}
	m_strange.clear();
	m_unsettled.clear();
	clearMarks( points );
	for ( const std::uint32_t point : points )
	{
		rebind( point );
	}
	m_binding.normalShift.resize( m_vertex.size(), Vec3::Zero() );
	matchNormals( m_split );
	m_split.clear();
}

template <class IsReached>
void CrackSurface::writeRow( std::uint32_t first, std::uint32_t home, const IsReached& isReached )
{
	m_rowCell.clear();
	m_rowWeight.clear();
	double sum = 0.0;
	for ( std::size_t k = 0; k < m_asked.size(); ++k )
	{
		if ( isReached( k ) )
		{
			m_rowCell.push_back( m_asked[k] );
			m_rowWeight.push_back( m_complex->bindWeight[first + k] );
			sum += double( m_complex->bindWeight[first + k] );
		}
	}
	if ( m_rowCell.empty() )
	{
		m_rowCell.push_back( home );
		m_rowWeight.push_back( 1.0f );
	}
	else if ( m_rowCell.size() != m_asked.size() )
	{
		for ( float& weight : m_rowWeight )
		{
			weight = float( double( weight ) / sum );
		}
	}
	// What is left of the row weighs nothing.
	m_rowCell.resize( m_asked.size(), m_rowCell.front() );
	m_rowWeight.resize( m_asked.size(), 0.0f );
}

void CrackSurface::rebind( std::uint32_t point )
{
	if ( m_binding.kind == Skinning::None || m_slotStart[point] == m_slotStart[point + 1] )
	{
		return;
	}
	const bool isQuick = !m_bindsPlainly && askCarriers( point );
	for ( std::uint32_t v = m_firstVertex[point]; v != kNone; v = m_vertex[v].next )
	{
		if ( m_binding.carrier[v] == v )
		{
			isQuick ? reachInWords( point, m_vertex[v].group ) : reach( point, m_vertex[v].group );
			std::copy( m_rowCell.begin(), m_rowCell.end(), m_binding.node.begin() + m_binding.start[v] );
			std::copy( m_rowWeight.begin(), m_rowWeight.end(), m_binding.weight.begin() + m_binding.start[v] );
		}
	}
}

/// Cells of `asked` beyond a cell's standing faces, a bit each.
std::uint64_t CrackSurface::carriersBeside( std::uint32_t cell ) const
{
	std::uint64_t beside = 0;
	for ( std::uint32_t f = m_cellFaceStart[cell]; f < m_cellFaceStart[cell + 1]; ++f )
	{
		const std::uint32_t other = m_neighbour[f];
		if ( other != kNone && m_mark[other] == m_round )
		{
			beside |= std::uint64_t( 1 ) << m_bitOf[other];
		}
	}
	return beside;
}

/// Once for all sides of a point: the cells that carry it in the whole body, and which of them standing faces join. False where they are more
/// than a word has bits.
bool CrackSurface::askCarriers( std::uint32_t point )
{
	const std::uint32_t whole = m_point[point];
	const std::uint32_t first = m_complex->bindStart[whole], last = m_complex->bindStart[whole + 1];
	if ( last - first > 64 )
	{
		return false;
	}
	m_round += 2; // `reach` takes two
	m_bitOf.resize( m_cell.size() );
	m_asked.clear();
	for ( std::uint32_t k = first; k < last; ++k )
	{
		m_asked.push_back( localCell( m_complex->bindCell[k] ) );
		if ( m_asked.back() != kNone )
		{
			m_mark[m_asked.back()] = m_round;
			m_bitOf[m_asked.back()] = std::uint8_t( k - first );
		}
	}
	m_beside.clear();
	for ( const std::uint32_t cell : m_asked )
	{
		m_beside.push_back( cell == kNone ? 0 : carriersBeside( cell ) );
	}
	return true;
}

/// `reach` with a bit for each cell asked; after askCarriers.
void CrackSurface::reachInWords( std::uint32_t point, std::uint16_t group )
{
	std::uint64_t reached = 0;
	std::uint32_t home = kNone;
	for ( std::uint32_t s = m_slotStart[point]; s < m_slotStart[point + 1]; ++s )
	{
		if ( m_slotGroup[s] == group )
		{
			const std::uint32_t cell = m_slotCell[s];
			home = home == kNone ? cell : home;
			reached |= m_mark[cell] == m_round ? std::uint64_t( 1 ) << m_bitOf[cell] : carriersBeside( cell );
		}
	}
	for ( std::uint64_t open = reached; open != 0; )
	{
		const int bit = std::countr_zero( open );
		open &= open - 1;
		const std::uint64_t fresh = m_beside[std::size_t( bit )] & ~reached;
		reached |= fresh;
		open |= fresh;
	}
	writeRow( m_complex->bindStart[m_point[point]], home, [&]( std::size_t k ) { return ( reached >> k & 1 ) != 0; } );
}

/// The row of one side: of the cells that carry the point in the whole body, those that standing faces join to it, by way of one another.
void CrackSurface::reach( std::uint32_t point, std::uint16_t group )
{
	const std::uint32_t whole = m_point[point];
	const std::uint32_t first = m_complex->bindStart[whole], last = m_complex->bindStart[whole + 1];
	m_round += 2;
	const std::uint32_t asked = m_round, reached = m_round + 1;
	m_asked.clear();
	for ( std::uint32_t k = first; k < last; ++k )
	{
		m_asked.push_back( localCell( m_complex->bindCell[k] ) );
		if ( m_asked.back() != kNone )
		{
			m_mark[m_asked.back()] = asked;
		}
	}
	m_open.clear();
	std::size_t found = 0;
	for ( std::uint32_t s = m_slotStart[point]; s < m_slotStart[point + 1]; ++s )
	{
		if ( m_slotGroup[s] == group )
		{
			found += m_mark[m_slotCell[s]] == asked;
			m_mark[m_slotCell[s]] = reached;
			m_open.push_back( m_slotCell[s] );
		}
	}
	const std::uint32_t home = m_open.front();
	for ( std::size_t k = 0; k < m_open.size() && found < m_asked.size(); ++k )
	{
		for ( std::uint32_t f = m_cellFaceStart[m_open[k]]; f < m_cellFaceStart[m_open[k] + 1]; ++f )
		{
			const std::uint32_t other = m_neighbour[f];
			if ( other != kNone && m_mark[other] == asked )
			{
				m_mark[other] = reached;
				m_open.push_back( other );
				++found;
			}
		}
	}
	writeRow( first, home, [&]( std::size_t k ) { return m_asked[k] != kNone && m_mark[m_asked[k]] == reached; } );
}

} // namespace pliant
