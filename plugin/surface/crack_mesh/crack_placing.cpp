// Panels that no crack separates are drawn as in the input: their cuts are interpolated from the corners, or spared.

#include "surface/crack_mesh/crack_view.h"
#include "surface/crack_mesh/resize_for_overwrite.h"
#include "threads/parallel.h"

#include <algorithm>

namespace pliant {

// === A body whose surface grows with its cracks ===

/// Separates the panels at a local point where several sides meet, where cells belong to another body, or near a blade.
void CrackSurface::separate( std::uint32_t point, bool isByBlade )
{
	m_reshaded.clear();
	isByBlade ? m_panels.touch( m_point[point], m_reshaded ) : m_panels.separate( m_point[point], m_reshaded );
	for ( const std::uint32_t reshaded : m_reshaded )
	{
		if ( const std::uint32_t local = localPoint( reshaded ); local != kNone )
		{
			m_split.push_back( local );
		}
	}
}

/// The carrier at the position of an input vertex that has only one side.
std::uint32_t CrackSurface::carrierAt( std::uint32_t input ) const
{
	const std::uint32_t point = localPoint( m_complex->vertexPoint[input] );
	const std::uint32_t side = point == kNone ? kNone : m_firstSide[point];
	return side == kNone ? kNone : m_side[side].carrier;
}

SkinBinding::Placed CrackSurface::placedFrom( const CellComplex::Origin& origin, std::uint32_t vertex ) const
{
	SkinBinding::Placed placed{ vertex, {}, origin.weight };
	for ( std::size_t k = 0; k < 3; ++k )
	{
		placed.corner[k] = origin.vertex[k] == kNone ? placed.corner[0] : carrierAt( origin.vertex[k] );
	}
	return placed;
}

/// Called once all is drawn. Later, panels are only separated, and placed vertices keep their position in the binding: the outer surface is
/// drawn first, so each of these sides has an outer copy as its carrier.
void CrackSurface::placeIntactPanels()
{
	m_split.clear(); // everything is shaded
	for ( std::uint32_t v = 0; v < vertexCount() && m_panels.arePlaced(); ++v )
	{
		if ( isPlaced( m_vertex[v] ) )
		{
			m_binding.placed.push_back( placedFrom( m_complex->addedOrigin[m_vertex[v].kind - m_complex->inputVertices], v ) );
		}
	}
	m_panelCorner.resize( m_complex->panels.count() );
	for ( const std::uint32_t panel : intactPanels() )
	{
		const std::array<std::uint32_t, 3>& corner = m_complex->panels.corner[panel];
		m_panelCorner[panel] = { carrierAt( corner[0] ), carrierAt( corner[1] ), carrierAt( corner[2] ) };
	}
}

void CrackSurface::listPlaced()
{
	m_listedVersion = m_version;
	std::vector<SkinBinding::Placed>& placed = m_binding.placed;
	placed.erase( std::remove_if(
					  placed.begin(), placed.end(), [this]( const SkinBinding::Placed& of ) { return !isPlaced( m_vertex[of.vertex] ); } ),
		placed.end() );
	m_binding.listBlended();
	listShading();
}

/// Lists the pieces outside intact panels in the triangles' order, then the panels in theirs.
void CrackSurface::listShading()
{
	m_binding.shading.clear();
	m_binding.shadedTriangles = m_binding.placed.empty() ? 0 : m_cellTriangle.back();
	m_binding.shading.reserve( m_binding.shadedTriangles ); // each panel replaces several of them
	m_binding.shadingPlace.clear();
	m_binding.shadingPlaces = m_binding.shadedTriangles + std::uint32_t( m_complex->panels.count() );
	for ( std::uint32_t cell = 0; cell < m_cell.size() && m_binding.shadedTriangles > 0; ++cell )
	{
		forSeparatePieces( cell, [this]( std::uint32_t t ) {
			m_binding.shading.push_back( m_triangle[t] );
			m_binding.shadingPlace.push_back( t );
		} );
	}
	for ( const std::uint32_t panel : intactPanels() )
	{
		m_binding.shading.push_back( m_panelCorner[panel] );
		m_binding.shadingPlace.push_back( m_binding.shadedTriangles + panel );
	}
}

/// Panels that contribute to normals as one triangle: all their cells are the body's.
std::vector<std::uint32_t> CrackSurface::intactPanels() const
{
	std::vector<std::uint32_t> panels;
	for ( std::size_t k = 0; k < m_cell.size() && !m_binding.placed.empty(); ++k )
	{
		const Panels& all = m_complex->panels;
		for ( std::uint32_t panel = all.firstOfCell[m_cell[k]]; panel < all.firstOfCell[m_cell[k] + 1]; ++panel )
		{
			if ( m_panels.isOne( panel ) )
			{
				panels.push_back( panel );
			}
		}
	}
	return panels;
}

void CrackSurface::addPanelsAt( std::uint32_t point, std::vector<std::uint32_t>& panels ) const
{
	const Table& all = m_complex->panels.atPoint;
	if ( m_panels.arePlaced() )
	{
		std::copy_if( all.begin( m_point[point] ), all.end( m_point[point] ), std::back_inserter( panels ),
			[this]( std::uint32_t panel ) { return m_panels.isOne( panel ); } );
	}
}

// === A body assembled from its cells' patches ===

/// Lists in the same order as CrackSurface.
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
