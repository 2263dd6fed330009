// Which cells a side of a crack follows: of those that carried its points, the ones that standing faces still join to it.

#include "surface/crack_state/crack_surface.h"

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
			if ( local != kNone && m_firstSide[local] != kNone )
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
	if ( m_listedVersion != m_version )
	{
		listPlaced();
	}
	matchNormals( m_split );
	m_split.clear();
}

/// Of those asked, the ones in m_reached.
void CrackSurface::writeRow( std::uint32_t point, const Side& side, std::uint32_t home )
{
	const float* const whole = m_complex->bindWeight.data() + m_complex->bindStart[m_point[point]];
	std::uint32_t* const node = m_binding.node.data() + m_binding.start[side.carrier];
	float* const weight = m_binding.weight.data() + m_binding.start[side.carrier];
	const std::size_t asked = m_asked.size(), count = m_reached.size();
	if ( count == asked )
	{
		return; // they carried it all along: the row is as addRow() made it
	}
	if ( count == 0 )
	{
		std::fill( node, node + asked, home );
		std::fill( weight, weight + asked, 0.0f );
		weight[0] = 1.0f;
	}
	else
	{
		double sum = 0.0;
		for ( const std::uint32_t k : m_reached )
		{
			sum += double( whole[k] );
		}
		for ( std::size_t k = 0; k < count; ++k )
		{
			node[k] = m_asked[m_reached[k]];
			weight[k] = float( double( whole[m_reached[k]] ) / sum );
		}
		// What is left of the row weighs nothing.
		std::fill( node + count, node + asked, node[0] );
		std::fill( weight + count, weight + asked, 0.0f );
	}
}

void CrackSurface::rebind( std::uint32_t point )
{
	if ( m_binding.kind == Skinning::None || m_slotStart[point] == m_slotStart[point + 1] )
	{
		return;
	}
	const bool isQuick = !m_bindsPlainly && askCarriers( point );
	for ( std::uint32_t side = m_firstSide[point]; side != kNone; side = m_side[side].next )
	{
		isQuick ? reachInWords( point, m_side[side] ) : reach( point, m_side[side] );
	}
	if ( isQuick )
	{
		forgetCarriers();
	}
}

/// Cells asked that lie beyond a cell's standing faces, a bit each.
std::uint64_t CrackSurface::carriersBeside( std::uint32_t cell ) const
{
	std::uint64_t beside = 0;
	for ( std::uint32_t f = m_cellFaceStart[cell]; f < m_cellFaceStart[cell + 1]; ++f )
	{
		beside |= m_bitOf[m_neighbour[f]];
	}
	return beside;
}

/// Once for all sides of a point: the cells that carry it in the whole body, and which of them standing faces join. False where they are
/// more than a word has bits.
bool CrackSurface::askCarriers( std::uint32_t point )
{
	const std::uint32_t whole = m_point[point];
	const std::uint32_t first = m_complex->bindStart[whole], last = m_complex->bindStart[whole + 1];
	if ( last - first > 64 )
	{
		return false;
	}
	m_bitOf.resize( m_cell.size() + 1, 0 );
	m_asked.clear();
	for ( std::uint32_t k = first; k < last; ++k )
	{
		m_asked.push_back( localCell( m_complex->bindCell[k] ) );
		if ( m_asked.back() != kNone )
		{
			m_bitOf[m_asked.back()] = std::uint64_t( 1 ) << ( k - first );
		}
	}
	m_beside.clear();
	for ( const std::uint32_t cell : m_asked )
	{
		m_beside.push_back( cell == kNone ? 0 : carriersBeside( cell ) );
	}
	return true;
}

void CrackSurface::forgetCarriers()
{
	for ( const std::uint32_t cell : m_asked )
	{
		m_bitOf[cell == kNone ? m_cell.size() : cell] = 0;
	}
}

/// `reach` with a bit for each cell asked; after askCarriers.
void CrackSurface::reachInWords( std::uint32_t point, const Side& side )
{
	std::uint64_t reached = 0;
	std::uint32_t home = kNone;
	for ( std::uint32_t s = m_slotStart[point]; s < m_slotStart[point + 1]; ++s )
	{
		if ( m_slotGroup[s] == side.group )
		{
			const std::uint32_t cell = m_slotCell[s];
			home = home == kNone ? cell : home;
			reached |= m_bitOf[cell] != 0 ? m_bitOf[cell] : carriersBeside( cell );
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
	m_reached.clear();
	for ( ; reached != 0; reached &= reached - 1 )
	{
		m_reached.push_back( std::uint32_t( std::countr_zero( reached ) ) );
	}
	writeRow( point, side, home );
}

/// The row of one side: of the cells that carry the point in the whole body, those that standing faces join to it, by way of one another.
void CrackSurface::reach( std::uint32_t point, const Side& side )
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
		if ( m_slotGroup[s] == side.group )
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
			if ( m_mark[other] == asked )
			{
				m_mark[other] = reached;
				m_open.push_back( other );
				++found;
			}
		}
	}
	m_reached.clear();
	for ( std::uint32_t k = 0; k < std::uint32_t( m_asked.size() ); ++k )
	{
		if ( m_asked[k] != kNone && m_mark[m_asked[k]] == reached )
		{
			m_reached.push_back( k );
		}
	}
	writeRow( point, side, home );
}

} // namespace pliant
