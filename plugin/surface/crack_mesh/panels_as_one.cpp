// A crack surface with intact panels drawn as one triangle: the reference implementation of CrackGatherer. Not in Ohta et al. 2009.

#include "surface/crack_mesh/crack_view.h"

#include <algorithm>

namespace pliant {

namespace {

/// New index of each kept vertex; kNone for the others.
std::vector<std::uint32_t> numbersOf( const std::vector<std::uint8_t>& isKept )
{
	std::vector<std::uint32_t> number;
	std::uint32_t next = 0;
	for ( const std::uint8_t keeps : isKept )
	{
		number.push_back( keeps != 0 ? next : CrackSurface::kNone );
		next += keeps;
	}
	return number;
}

template <class T>
std::vector<T> selectKept( const std::vector<T>& list, const std::vector<std::uint8_t>& isKept )
{
	std::vector<T> kept;
	for ( std::size_t k = 0; k < list.size(); ++k )
	{
		isKept[k] != 0 ? kept.push_back( list[k] ) : void();
	}
	return kept;
}

} // namespace

/// The body's vertex that draws a vertex of the complex, at a point with one side.
std::uint32_t CrackSurface::vertexOf( std::uint32_t kind ) const
{
	std::uint32_t vertex = m_side[m_firstSide[localPoint( m_complex->vertexPoint[kind] )]].newest;
	while ( m_vertex[vertex].kind != kind )
	{
		vertex = m_vertex[vertex].next;
	}
	return vertex;
}

/// Draws the pieces outside intact panels, then the intact panels, with vertices of the body.
void CrackSurface::drawIntactPanels( CrackView& view ) const
{
	view.growing = nullptr;
	view.ownKinds.clear();
	for ( std::size_t v = 0; v < m_vertex.size() && view.wantsKinds; ++v )
	{
		m_panels.isSpared( m_point[m_vertex[v].point] ) ? void() : view.ownKinds.push_back( m_vertex[v].kind );
	}
	view.ownTriangles.clear();
	view.ownSources.clear();
	for ( std::uint32_t cell = 0; cell < m_cell.size(); ++cell )
	{
		forSeparatePieces( cell, [&]( std::uint32_t t ) {
			view.ownTriangles.push_back( m_triangle[t] );
			view.ownSources.push_back( m_source[t] );
		} );
	}
	const Panels& all = m_complex->panels;
	const auto drawnAt = [&]( std::uint32_t entry ) {
		const std::uint32_t vertex = all.border.entry[entry];
		return m_panels.isSpared( m_complex->vertexPoint[vertex] ) ? kNone : vertexOf( vertex );
	};
	std::vector<std::uint32_t> around;
	for ( const std::uint32_t panel : intactPanels() )
	{
		drawPanel( all, panel, drawnAt, around, view.ownTriangles );
		view.ownSources.resize( view.ownTriangles.size(), all.source[panel] );
	}
	view.ownBinding.shadedTriangles = std::uint32_t( view.ownTriangles.size() );
	view.ownTriangles.insert( view.ownTriangles.end(), m_triangle.begin() + m_cellTriangle.back(), m_triangle.end() );
	view.ownSources.resize( view.ownTriangles.size(), kNone );
}

void CrackSurface::showPanelsAsOne( const float* texture, CrackView& view ) const
{
	SkinBinding& to = view.ownBinding;
	to = {};
	drawIntactPanels( view );
	std::vector<std::uint8_t> isKept;
	for ( const Vertex& vertex : m_vertex )
	{
		isKept.push_back( m_panels.isSpared( m_point[vertex.point] ) ? 0 : 1 );
	}
	const std::vector<std::uint32_t> number = numbersOf( isKept );
	const auto renumber = [&number](
							  auto& list ) { std::for_each( list.begin(), list.end(), [&number]( std::uint32_t& v ) { v = number[v]; } ); };
	std::for_each( view.ownTriangles.begin(), view.ownTriangles.end(), renumber );
	to.kind = m_binding.kind;
	to.restPosition = selectKept( m_binding.restPosition, isKept );
	to.restNormal = selectKept( m_binding.restNormal, isKept );
	to.normalShift = selectKept( m_binding.normalShift, isKept );
	to.normalGroup = selectKept( m_binding.normalGroup, isKept );
	to.normalGroups = m_binding.normalGroups;
	to.carrier = selectKept( m_binding.carrier, isKept );
	renumber( to.carrier );
	to.point = selectKept( m_binding.point, isKept );
	to.start.push_back( 0 );
	view.ownTexture.clear();
	for ( std::size_t v = 0; v < m_vertex.size(); ++v )
	{
		if ( isKept[v] == 0 )
		{
			continue;
		}
		to.node.insert( to.node.end(), m_binding.node.begin() + m_binding.start[v], m_binding.node.begin() + m_binding.start[v + 1] );
		to.weight.insert(
			to.weight.end(), m_binding.weight.begin() + m_binding.start[v], m_binding.weight.begin() + m_binding.start[v + 1] );
		to.start.push_back( std::uint32_t( to.node.size() ) );
		view.ownTexture.insert( view.ownTexture.end(), { texture[2 * v], texture[2 * v + 1] } );
	}
	for ( SkinBinding::Placed of : m_binding.placed )
	{
		if ( isKept[of.vertex] != 0 )
		{
			of.vertex = number[of.vertex];
			renumber( of.corner );
			to.placed.push_back( of );
		}
	}
	to.listBlended();
	if ( to.placed.empty() )
	{
		to.shadedTriangles = 0; // the drawn triangles contribute to normals
	}
	else
	{
		to.shading = m_binding.shading;
		std::for_each( to.shading.begin(), to.shading.end(), renumber );
	}
	view.binding = &to;
	view.triangles = view.ownTriangles.data();
	view.sources = view.ownSources.data();
	view.texture = view.ownTexture.data();
	view.triangleCount = int( view.ownTriangles.size() );
	view.change = {};
}

} // namespace pliant
