// Updates when faces break: groups of cells split at the points along the crack, and triangles are redirected to the new groups.

#include "surface/crack_state/crack_surface.h"

#include <Eigen/Geometry>

#include <algorithm>

namespace pliant {

bool CrackSurface::isBroken( std::uint32_t face ) const
{
	const std::uint32_t local = localFace( face );
	return local == kNone || m_face[local].isBroken;
}

void CrackSurface::breakFaces( const std::vector<std::uint32_t>& faces )
{
	std::vector<std::uint32_t> added; // local indices
	for ( const std::uint32_t face : faces )
	{
		const std::uint32_t local = localFace( face );
		if ( local != kNone && !m_face[local].isBroken )
		{
			markBroken( local );
			added.push_back( local );
		}
	}
	if ( added.empty() )
	{
		return;
	}
	addUnheld( added );
	++m_version;
	m_change = { vertexCount(), std::uint32_t( m_triangle.size() ), std::uint32_t( m_triangle.size() ), 0 };
	splitGroups( added );
	for ( const std::uint32_t f : added )
	{
		drawSide( m_face[f], true );
		drawSide( m_face[f], false );
	}
	m_change.firstChanged = std::min( m_change.firstChanged, m_change.lastChanged );
	m_newlyBroken.insert( m_newlyBroken.end(), added.begin(), added.end() );
}

void CrackSurface::markBroken( std::uint32_t face )
{
	m_face[face].isBroken = true;
	for ( const std::uint32_t cell : { m_face[face].cellA, m_face[face].cellB } )
	{
		const auto first = m_cellFace.begin() + m_cellFaceStart[cell], last = m_cellFace.begin() + m_cellFaceStart[cell + 1];
		m_neighbour[std::size_t( std::find( first, last, face ) - m_cellFace.begin() )] = std::uint32_t( m_cell.size() );
	}
}

/// Adds the faces without a link whose holders are broken.
void CrackSurface::addUnheld( std::vector<std::uint32_t>& added )
{
	const std::size_t count = added.size();
	for ( std::size_t k = 0; k < count; ++k )
	{
		const std::uint32_t number = m_face[added[k]].number;
		for ( const std::uint32_t* held = m_complex->heldByFace.begin( number ); held != m_complex->heldByFace.end( number ); ++held )
		{
			const std::uint32_t local = localFace( *held );
			if ( local != kNone && !m_face[local].isBroken && !isHeld( local ) )
			{
				markBroken( local );
				added.push_back( local );
			}
		}
	}
	std::sort( added.begin(), added.end() );
}

void CrackSurface::splitGroups( const std::vector<std::uint32_t>& added )
{
	std::vector<std::uint32_t> points;
	for ( const std::uint32_t f : added )
	{
		const std::uint32_t number = m_face[f].number;
		for ( const std::uint32_t* p = m_complex->pointsOfFace.begin( number ); p != m_complex->pointsOfFace.end( number ); ++p )
		{
			collect( localPoint( *p ), points );
		}
	}
	clearMarks( points );
	std::vector<std::uint32_t> cells;
	std::vector<std::uint16_t> before;
	for ( const std::uint32_t point : points )
	{
		const std::uint32_t first = m_slotStart[point], last = m_slotStart[point + 1];
		m_panels.uncover( m_point[point] );
		before.assign( m_slotGroup.begin() + first, m_slotGroup.begin() + last );
		// A point without drawn vertices needs no copies: sides drawn later are assigned to its groups.
		if ( regroup( point ) && m_firstSide[point] != kNone )
		{
			m_split.push_back( point );
			separate( point );
			for ( std::uint32_t slot = first; slot < last; ++slot )
			{
				if ( m_slotGroup[slot] != before[slot - first] )
				{
					collect( m_slotCell[slot], cells );
				}
			}
		}
	}
	clearMarks( cells );
	std::sort( cells.begin(), cells.end() );
	for ( const std::uint32_t cell : cells )
	{
		redirect( cell );
	}
}

void CrackSurface::collect( std::uint32_t item, std::vector<std::uint32_t>& list )
{
	if ( !m_isMarked[item] )
	{
		m_isMarked[item] = 1;
		list.push_back( item );
	}
}

void CrackSurface::clearMarks( const std::vector<std::uint32_t>& list )
{
	for ( const std::uint32_t item : list )
	{
		m_isMarked[item] = 0;
	}
}

/// Splits the groups of a point's cells along broken faces. The part with a group's first cell keeps its number and its copies.
bool CrackSurface::regroup( std::uint32_t point )
{
	const std::uint32_t first = m_slotStart[point];
	const std::size_t count = m_slotStart[point + 1] - first;
	m_root.resize( count );
	for ( std::size_t k = 0; k < count; ++k )
	{
		m_root[k] = std::uint16_t( k );
	}
	const auto rootOf = [this]( std::uint16_t slot ) {
		while ( m_root[slot] != slot )
		{
			slot = m_root[slot];
		}
		return slot;
	};
	for ( std::uint32_t t = m_tieStart[point]; t < m_tieStart[point + 1]; ++t )
	{
		if ( !m_face[m_tie[t].face].isBroken )
		{
			const std::uint16_t a = rootOf( m_tie[t].a ), b = rootOf( m_tie[t].b );
			m_root[std::max( a, b )] = std::min( a, b );
		}
	}
	// In ascending order: earlier slots have their new groups, later ones still the old groups.
	const std::uint16_t before = m_groups[point];
	for ( std::size_t k = 0; k < count; ++k )
	{
		std::uint16_t& group = m_slotGroup[first + k];
		const std::uint16_t root = rootOf( std::uint16_t( k ) );
		if ( root != k )
		{
			group = m_slotGroup[first + root];
			continue;
		}
		const bool isTaken = std::any_of( m_slotGroup.begin() + first, m_slotGroup.begin() + first + std::ptrdiff_t( k ),
			[group]( std::uint16_t earlier ) { return earlier == group; } );
		group = isTaken ? m_groups[point]++ : group;
	}
	return m_groups[point] != before;
}

void CrackSurface::redirect( std::uint32_t cell )
{
	redirectTriangles( cell, m_cellTriangle[cell], m_cellTriangle[cell + 1] );
	for ( std::uint32_t k = m_cellFaceStart[cell]; k < m_cellFaceStart[cell + 1]; ++k )
	{
		const Face& face = m_face[m_cellFace[k]];
		const std::uint32_t first = face.cellA == cell ? face.firstA : face.firstB;
		if ( first != kNone )
		{
			const CrackFace& known = m_complex->face[face.number];
			redirectTriangles( cell, first, first + known.lastTriangle - known.firstTriangle );
		}
	}
}

void CrackSurface::redirectTriangles( std::uint32_t cell, std::uint32_t first, std::uint32_t last )
{
	for ( std::uint32_t t = first; t < last; ++t )
	{
		for ( std::size_t k = 0; k < 3; ++k )
		{
			const std::uint32_t old = m_triangle[t][k];
			const Vertex known = m_vertex[old];
			if ( m_groups[known.point] == 1 )
			{
				continue;
			}
			const std::uint16_t group = groupOf( known.point, cell );
			if ( group != known.group )
			{
				const std::uint32_t made = vertexFor( known.point, known.kind, group );
				m_triangle[t][k] = made;
				m_change.firstChanged = std::min( m_change.firstChanged, t );
				m_change.lastChanged = std::max( m_change.lastChanged, t + 1 );
			}
		}
	}
}

void CrackSurface::reserveScratch()
{
	// Upper bounds, were all faces to break; half of that is already much.
	const std::size_t triangles = m_complex->faceTriangle.size(), vertices = m_complex->pointsOfFace.entry.size();
	const std::size_t entries = m_binding.node.size();
	const auto more = []( auto& list, std::size_t count ) { list.reserve( list.size() + count ); };
	more( m_triangle, triangles );
	more( m_source, triangles );
	more( m_vertex, vertices );
	more( m_side, vertices );
	more( m_binding.node, entries );
	more( m_binding.weight, entries );
	more( m_binding.start, vertices );
	more( m_binding.restPosition, vertices );
	more( m_binding.restNormal, vertices );
	more( m_binding.normalGroup, vertices );
	more( m_binding.normalShift, vertices );
	more( m_binding.carrier, vertices );
	more( m_binding.point, vertices );
	more( m_binding.blended, vertices );
}

} // namespace pliant
