// Panels that no crack separates are drawn as in the input: their cuts are interpolated from the corners, or spared.

#include "surface/crack_mesh/crack_view.h"
#include "surface/crack_mesh/resize_for_overwrite.h"
#include "threads/parallel.h"

#include <algorithm>

namespace pliant {

/// In the order of the vertices; `shading` has the pieces outside intact panels in the triangles' order, then the panels in theirs.
void CrackGatherer::listPlaced( SkinBinding& to, TaskRunner* runner ) const
{
	resizeForOverwrite( to.placed, m_placedCount );
	runChunks( runner, ChunkedRange{ int( m_placedCount ) }, [&]( int, int begin, int end ) {
		for ( int k = begin; k < end; ++k )
		{
			to.placed[std::size_t( k )] = placedAt( m_placed[std::size_t( k )] );
		}
	} );
	to.listBlended();
	const bool areAny = m_placedCount > 0;
	to.shading.assign( m_shading.get(), m_shading.get() + ( areAny ? m_shadingCount : 0 ) );
	to.shadedTriangles = areAny ? m_outerTriangles : 0;
}

/// No crack separates the corners, so their carriers belong to their points' first slots.
SkinBinding::Placed CrackGatherer::placedAt( std::uint32_t vertex ) const
{
	const CrackPatches& patches = m_sides->patches();
	const CellComplex& complex = *patches.complex;
	const CellComplex::Origin& origin = complex.addedOrigin[patches.appearance[m_made[vertex].vertex].kind - complex.inputVertices];
	SkinBinding::Placed placed{ vertex, {}, origin.weight };
	for ( std::size_t k = 0; k < 3; ++k )
	{
		placed.corner[k] = origin.vertex[k] == kNone ? placed.corner[0]
													 : m_number[patches.numbersOfInput[origin.vertex[k]] + Carrier] - m_first;
	}
	return placed;
}

std::array<std::uint32_t, 3> CrackGatherer::ofCorners( std::uint32_t panel, std::uint32_t number ) const
{
	const CrackPatches& patches = m_sides->patches();
	const std::array<std::uint32_t, 3>& corner = patches.complex->panels.corner[panel];
	const auto at = [&]( std::size_t k ) { return m_number[patches.numbersOfInput[corner[k]] + number] - m_first; };
	return { at( 0 ), at( 1 ), at( 2 ) };
}

/// Draws the intact panels, all of whose cells are the body's. Sums areas where a corner is reshaded. Returns the end of the triangles
/// drawn.
std::array<std::uint32_t, 3>* CrackGatherer::takePanels( std::array<std::uint32_t, 3>* triangles )
{
	const CellComplex& complex = m_sides->complex();
	const IntactPanels& panels = m_sides->panels();
	for ( std::size_t k = 0; k < m_cells && panels.arePlaced(); ++k )
	{
		for ( std::uint32_t panel = complex.panels.firstOfCell[m_patch[k]]; panel < complex.panels.firstOfCell[m_patch[k] + 1]; ++panel )
		{
			if ( !panels.isOne( panel ) )
			{
				continue;
			}
			const auto& corner = complex.panels.corner[panel];
			const std::array<std::uint32_t, 3> points = {
				complex.vertexPoint[corner[0]], complex.vertexPoint[corner[1]], complex.vertexPoint[corner[2]] };
			m_shading[m_shadingCount++] = ofCorners( panel, Carrier ); // fewer than its pieces
			takePanel( panel );
			if ( std::any_of( points.begin(), points.end(), [this]( std::uint32_t p ) { return m_sides->isReshaded( p ); } ) )
			{
				addArea( points, ofCorners( panel, OuterNormals ) );
			}
		}
	}
	m_outerTriangles += std::uint32_t( m_panelTriangle.size() );
	return std::copy( m_panelTriangle.begin(), m_panelTriangle.end(), triangles );
}

/// Draws a panel as the input's triangle, or between those of its cuts that other triangles use.
void CrackGatherer::takePanel( std::uint32_t panel )
{
	const CrackPatches& patches = m_sides->patches();
	const Panels& all = patches.complex->panels;
	const auto numberAt = [this]( std::uint32_t number ) { return m_number[number] - m_first; };
	if ( m_sides->panels().isPlain( panel ) )
	{
		const auto& corner = patches.numbersOfCorners[panel];
		m_panelTriangle.push_back( { numberAt( corner[0] ), numberAt( corner[1] ), numberAt( corner[2] ) } );
	}
	else
	{
		const auto drawnAt = [&]( std::uint32_t entry ) {
			return m_sides->panels().isSpared( patches.complex->vertexPoint[all.border.entry[entry]] )
				? kNone
				: numberAt( patches.numberOfBorder[entry] );
		};
		drawPanel( all, panel, drawnAt, m_around, m_panelTriangle );
	}
	m_panelSource.resize( m_panelTriangle.size(), all.source[panel] );
}

} // namespace pliant
