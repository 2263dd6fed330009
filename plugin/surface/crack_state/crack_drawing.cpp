// Draws a body's part of the complex. Each vertex is the copy of a point for one side of the cracks there.

#include "surface/crack_state/crack_surface.h"

#include <algorithm>

namespace pliant {

void CrackSurface::drawAll()
{
	m_binding.kind = m_complex->skinning;
	m_binding.start.push_back( 0 );
	const bool isWhole = m_cell.size() == m_complex->cellCount();
	for ( std::uint32_t p = 0; p < m_point.size(); ++p )
	{
		regroup( p );
		if ( m_groups[p] > 1 || m_slotStart[p + 1] - m_slotStart[p] < m_complex->cellsOfPoint.size( m_point[p] ) )
		{
			separate( p );
		}
	}
	for ( std::uint32_t v = 0; isWhole && v < m_complex->inputVertices; ++v )
	{
		addVertex( m_complex->vertexPoint[v], v, 0, sideAt( m_complex->vertexPoint[v], 0 ) );
	}
	for ( std::uint32_t cell = 0; cell < m_cell.size(); ++cell )
	{
		m_cellTriangle.push_back( std::uint32_t( m_triangle.size() ) );
		for ( std::uint32_t t = m_complex->cellTriangleStart[m_cell[cell]]; t < m_complex->cellTriangleStart[m_cell[cell] + 1]; ++t )
		{
			std::array<std::uint32_t, 3> corner = m_complex->triangle[t];
			for ( std::uint32_t& v : corner )
			{
				const std::uint32_t point = localPoint( m_complex->vertexPoint[v] );
				v = vertexFor( point, v, groupOf( point, cell ) );
			}
			m_triangle.push_back( corner );
			m_source.push_back( m_complex->triangleSource[t] );
		}
	}
	m_cellTriangle.push_back( std::uint32_t( m_triangle.size() ) );
	for ( std::uint32_t f = 0; f < m_face.size(); ++f )
	{
		if ( m_face[f].isBroken )
		{
			m_newlyBroken.push_back( f );
			const Table& points = m_complex->pointsOfFace;
			std::for_each( points.begin( m_face[f].number ), points.end( m_face[f].number ),
				[this]( std::uint32_t point ) { m_panels.uncover( point ); } );
			drawSide( m_face[f], true );
			drawSide( m_face[f], false );
		}
	}
	placeIntactPanels();
	updateBinding();
	matchNormals();
}

void CrackSurface::drawSide( Face& face, bool isA )
{
	const std::uint32_t cell = isA ? face.cellA : face.cellB;
	if ( cell == kNone )
	{
		return;
	}
	( isA ? face.firstA : face.firstB ) = std::uint32_t( m_triangle.size() );
	const CrackFace& known = m_complex->face[face.number];
	std::uint32_t kindBefore = kNone;
	for ( std::uint32_t t = known.firstTriangle; t < known.lastTriangle; ++t )
	{
		std::array<std::uint32_t, 3> corner = m_complex->faceTriangle[t];
		if ( !isA )
		{
			std::swap( corner[1], corner[2] );
		}
		const std::uint32_t kind = kInside + ( m_complex->faceAxis[t] ^ ( isA ? 0u : 1u ) );
		m_sideRound += kind != kindBefore ? 1 : 0; // shared corners are searched only once
		kindBefore = kind;
		for ( std::uint32_t& v : corner )
		{
			const std::uint32_t point = localPoint( v );
			SideVertex& drawn = m_sideVertex[point];
			if ( drawn.round != m_sideRound )
			{
				drawn = { m_sideRound, vertexFor( point, kind, groupOf( point, cell ) ) };
			}
			v = drawn.vertex;
		}
		m_triangle.push_back( corner );
		m_source.push_back( kNone );
	}
}

std::uint16_t CrackSurface::groupOf( std::uint32_t point, std::uint32_t cell ) const
{
	std::uint32_t slot = m_slotStart[point];
	while ( m_slotCell[slot] != cell )
	{
		++slot;
	}
	return m_slotGroup[slot];
}

std::uint32_t CrackSurface::sideAt( std::uint32_t point, std::uint16_t group ) const
{
	std::uint32_t side = m_firstSide[point];
	while ( side != kNone && m_side[side].group != group )
	{
		side = m_side[side].next;
	}
	return side;
}

std::uint32_t CrackSurface::vertexFor( std::uint32_t point, std::uint32_t kind, std::uint16_t group )
{
	const std::uint32_t side = sideAt( point, group );
	for ( std::uint32_t v = side == kNone ? kNone : m_side[side].newest; v != kNone; v = m_vertex[v].next )
	{
		if ( m_vertex[v].kind == kind )
		{
			return v;
		}
	}
	return addVertex( point, kind, group, side );
}

/// `side`: that of the group, or kNone for its first copy.
std::uint32_t CrackSurface::addVertex( std::uint32_t point, std::uint32_t kind, std::uint16_t group, std::uint32_t side )
{
	const std::uint32_t made = vertexCount();
	if ( side == kNone ) // one row per side
	{
		side = std::uint32_t( m_side.size() );
		m_side.push_back( { made, kNone, m_firstSide[point], kNone, kNone, group } );
		m_firstSide[point] = side;
		addRow( point );
	}
	Side& of = m_side[side];
	m_binding.carrier.push_back( of.carrier );
	m_binding.point.push_back( m_point[point] );
	m_binding.normalGroup.push_back( normalGroupFor( of, kind >= kInside ) );
	m_binding.restPosition.push_back( restOf( point ) - m_shift );
	m_binding.restNormal.push_back( Vec3::UnitZ() );
	if ( kind >= kInside )
	{
		m_binding.restNormal.back() = insideNormal( kind );
	}
	m_binding.start.push_back( std::uint32_t( m_binding.node.size() ) );
	m_vertex.push_back( { point, kind, of.newest, group } );
	of.newest = made;
	return made;
}

/// Adds a row with space for all carriers; where some belong to other bodies, updateBinding() rewrites it after drawing.
void CrackSurface::addRow( std::uint32_t point )
{
	const std::uint32_t whole = m_point[point];
	const std::uint32_t first = m_complex->bindStart[whole], last = m_complex->bindStart[whole + 1];
	m_binding.weight.insert( m_binding.weight.end(), m_complex->bindWeight.begin() + first, m_complex->bindWeight.begin() + last );
	if ( m_cell.size() == m_complex->cellCount() )
	{
		m_binding.node.insert( m_binding.node.end(), m_complex->bindCell.begin() + first, m_complex->bindCell.begin() + last );
		return;
	}
	bool isForeign = false;
	for ( std::uint32_t k = first; k < last; ++k )
	{
		m_binding.node.push_back( localCell( m_complex->bindCell[k] ) );
		isForeign = isForeign || m_binding.node.back() == kNone;
	}
	if ( isForeign )
	{
		m_foreign.push_back( point );
	}
}

/// Copies of one side at a point share a normal: one for the outer, one for the inner copies. Without noise the inner ones are faces of
/// cubes, and each has its own normal.
std::uint32_t CrackSurface::normalGroupFor( Side& side, bool isInside )
{
	std::uint32_t& known = isInside ? side.innerNormals : side.outerNormals;
	if ( known == kNone || ( isInside && !( m_complex->settings.noiseAmplitude > 0.0f ) ) )
	{
		known = std::uint32_t( m_binding.normalGroups++ );
	}
	return known;
}

std::pair<std::uint32_t, std::uint32_t> CrackSurface::sideOf( std::uint32_t vertex ) const
{
	return { m_point[m_vertex[vertex].point], m_vertex[vertex].group };
}

void CrackSurface::textureCoordinates( const float* input, std::uint32_t first, float* out ) const
{
	for ( std::uint32_t v = first; v < vertexCount(); ++v, out += 2 )
	{
		textureOf( *m_complex, m_point[m_vertex[v].point], m_vertex[v].kind, input, out );
	}
}

void CrackSurface::textureOf( const CellComplex& complex, std::uint32_t point, std::uint32_t kind, const float* input, float* out )
{
	out[0] = out[1] = 0.0f;
	if ( kind >= kInside )
	{
		const int axis = int( ( kind - kInside ) / 2 );
		const Vec3& position = complex.pointRest[point]; // of the template, so that pieces match
		out[0] = position[( axis + 1 ) % 3] / complex.settings.textureTile;
		out[1] = position[( axis + 2 ) % 3] / complex.settings.textureTile;
	}
	else if ( input && kind < complex.inputVertices )
	{
		out[0] = input[2 * std::size_t( kind )];
		out[1] = input[2 * std::size_t( kind ) + 1];
	}
	else if ( input )
	{
		const CellComplex::Origin& origin = complex.addedOrigin[kind - complex.inputVertices];
		for ( std::size_t k = 0; k < 3 && origin.vertex[k] != kNone; ++k )
		{
			out[0] += origin.weight[k] * input[2 * std::size_t( origin.vertex[k] )];
			out[1] += origin.weight[k] * input[2 * std::size_t( origin.vertex[k] ) + 1];
		}
	}
}

} // namespace pliant
