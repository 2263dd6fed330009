// Binding of crack sides to cells: a side follows those carriers of its points that are still connected to it by unbroken faces.

#include "surface/crack_state/crack_surface.h"

#include <algorithm>

namespace pliant {

/// Only points carried by cells along the crack, or on its faces, can change their binding.
void CrackSurface::updateBinding()
{
	std::vector<std::uint32_t> cells, points;
	for ( const std::uint32_t f : m_newlyBroken )
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
	const auto collectDrawn = [&]( const std::uint32_t* p, const std::uint32_t* end ) {
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
		collectDrawn( m_complex->boundPoints.begin( m_cell[cell] ), m_complex->boundPoints.end( m_cell[cell] ) );
	}
	for ( const std::uint32_t f : m_newlyBroken )
	{
		const CrackFace& known = m_complex->face[m_face[f].number];
		for ( const std::uint32_t beyond : { known.cellA, known.cellB } )
		{
			if ( localCell( beyond ) == kNone ) // drawn by a cell of another body, which need not carry it
			{
				collectDrawn( m_complex->boundPoints.begin( beyond ), m_complex->boundPoints.end( beyond ) );
			}
		}
		collectDrawn( m_complex->pointsOfFace.begin( m_face[f].number ), m_complex->pointsOfFace.end( m_face[f].number ) );
	}
	for ( const std::uint32_t point : m_foreign )
	{
		collect( point, points );
	}
	m_foreign.clear();
	m_newlyBroken.clear();
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

/// Writes the row of a side from the carriers in m_reached.
void CrackSurface::writeRow( std::uint32_t point, const Side& side, std::uint32_t firstCell )
{
	const float* const whole = m_complex->bindWeight.data() + m_complex->bindStart[m_point[point]];
	std::uint32_t* const node = m_binding.node.data() + m_binding.start[side.carrier];
	float* const weight = m_binding.weight.data() + m_binding.start[side.carrier];
	const std::size_t candidates = m_candidate.size(), count = m_reached.size();
	if ( count == candidates )
	{
		return; // all carriers are reached: the row is unchanged since addRow()
	}
	if ( count == 0 )
	{
		std::fill( node, node + candidates, firstCell );
		std::fill( weight, weight + candidates, 0.0f );
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
			node[k] = m_candidate[m_reached[k]];
			weight[k] = float( double( whole[m_reached[k]] ) / sum );
		}
		// The rest of the row has weight 0.
		std::fill( node + count, node + candidates, node[0] );
		std::fill( weight + count, weight + candidates, 0.0f );
	}
}

void CrackSurface::rebind( std::uint32_t point )
{
	if ( m_binding.kind == Skinning::None || m_slotStart[point] == m_slotStart[point + 1] )
	{
		return;
	}
	for ( std::uint32_t side = m_firstSide[point]; side != kNone; side = m_side[side].next )
	{
		reach( point, m_side[side] );
	}
}

/// Computes the row of a side: the carriers that unbroken faces connect to it, directly or through other carriers.
void CrackSurface::reach( std::uint32_t point, const Side& side )
{
	const std::uint32_t whole = m_point[point];
	const std::uint32_t first = m_complex->bindStart[whole], last = m_complex->bindStart[whole + 1];
	m_round += 2;
	const std::uint32_t candidates = m_round, reached = m_round + 1;
	m_candidate.clear();
	for ( std::uint32_t k = first; k < last; ++k )
	{
		m_candidate.push_back( localCell( m_complex->bindCell[k] ) );
		if ( m_candidate.back() != kNone )
		{
			m_mark[m_candidate.back()] = candidates;
		}
	}
	m_frontier.clear();
	std::size_t found = 0;
	for ( std::uint32_t s = m_slotStart[point]; s < m_slotStart[point + 1]; ++s )
	{
		if ( m_slotGroup[s] == side.group )
		{
			found += m_mark[m_slotCell[s]] == candidates;
			m_mark[m_slotCell[s]] = reached;
			m_frontier.push_back( m_slotCell[s] );
		}
	}
	const std::uint32_t firstCell = m_frontier.front();
	for ( std::size_t k = 0; k < m_frontier.size() && found < m_candidate.size(); ++k )
	{
		for ( std::uint32_t f = m_cellFaceStart[m_frontier[k]]; f < m_cellFaceStart[m_frontier[k] + 1]; ++f )
		{
			const std::uint32_t other = m_neighbour[f];
			if ( m_mark[other] == candidates )
			{
				m_mark[other] = reached;
				m_frontier.push_back( other );
				++found;
			}
		}
	}
	m_reached.clear();
	for ( std::uint32_t k = 0; k < std::uint32_t( m_candidate.size() ); ++k )
	{
		if ( m_candidate[k] != kNone && m_mark[m_candidate[k]] == reached )
		{
			m_reached.push_back( k );
		}
	}
	writeRow( point, side, firstCell );
}

} // namespace pliant
