// What no crack parts is drawn as the input has it: cuts within panels stand where the panels' corners put them.

#include "surface/crack_view.h"
#include "surface/make_place.h"
#include "threads/parallel.h"

#include <algorithm>

namespace pliant {

namespace {

/// How far ahead of its use memory is asked for that lies anywhere in the template's.
constexpr int kFar = 24, kNear = 8;

} // namespace

// === Of a body that grows by its cracks ===

/// More than one side meets at a local point, or some of it is another body's; or a blade came by.
void CrackSurface::part( std::uint32_t point, bool isByBlade )
{
	m_parted.clear();
	isByBlade ? m_panels.touch( m_point[point], m_parted ) : m_panels.part( m_point[point], m_parted );
	for ( const std::uint32_t anew : m_parted )
	{
		if ( const std::uint32_t local = localPoint( anew ); local != kNone )
		{
			m_split.push_back( local );
		}
	}
}

/// The vertex that carries those at the place of one of the input's, where only one side is.
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

/// Once all is drawn. From then on panels are only parted, and what is placed stays where it is in the binding: the outer surface is drawn first, so that
/// an outer copy carries each of these sides.
void CrackSurface::placeWhatIsWhole()
{
	m_split.clear(); // all is shaded
	for ( std::uint32_t v = 0; v < vertexCount() && m_panels.arePlaced(); ++v )
	{
		if ( isPlaced( m_vertex[v] ) )
		{
			m_binding.placed.push_back( placedFrom( m_complex->addedOrigin[m_vertex[v].kind - m_complex->inputVertices], v ) );
		}
	}
	m_panelCorner.resize( m_complex->panels.count() );
	for ( const std::uint32_t panel : wholePanels() )
	{
		const std::array<std::uint32_t, 3>& corner = m_complex->panels.corner[panel];
		m_panelCorner[panel] = { carrierAt( corner[0] ), carrierAt( corner[1] ), carrierAt( corner[2] ) };
	}
}

void CrackSurface::listPlaced()
{
	m_listedVersion = m_version;
	std::vector<SkinBinding::Placed>& placed = m_binding.placed;
	placed.erase( std::remove_if( placed.begin(), placed.end(), [this]( const SkinBinding::Placed& of ) { return !isPlaced( m_vertex[of.vertex] ); } ), placed.end() );
	m_binding.listBlended();
	listShading();
}

/// Pieces that are by themselves, in the triangles' order, then panels in theirs.
void CrackSurface::listShading()
{
	m_binding.shading.clear();
	m_binding.shadedTriangles = m_binding.placed.empty() ? 0 : m_cellTriangle.back();
	m_binding.shading.reserve( m_binding.shadedTriangles ); // each panel is some of them
	for ( std::uint32_t cell = 0; cell < m_cell.size() && m_binding.shadedTriangles > 0; ++cell )
	{
		const std::uint32_t known = m_complex->cellTriangleStart[m_cell[cell]] - m_cellTriangle[cell];
		for ( std::uint32_t t = m_cellTriangle[cell]; t < m_cellTriangle[cell + 1]; ++t )
		{
			if ( !m_panels.isOfOne( known + t ) )
			{
				m_binding.shading.push_back( m_triangle[t] );
			}
		}
	}
	for ( const std::uint32_t panel : wholePanels() )
	{
		m_binding.shading.push_back( m_panelCorner[panel] );
	}
}

/// Those that add to normals as one: all their cells are the body's.
std::vector<std::uint32_t> CrackSurface::wholePanels() const
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
		std::copy_if( all.begin( m_point[point] ), all.end( m_point[point] ), std::back_inserter( panels ), [this]( std::uint32_t panel ) { return m_panels.isOne( panel ); } );
	}
}

// === Of a body put together from its cells' patches ===

/// In the order that CrackSurface has.
void CrackGatherer::listPlaced( SkinBinding& to, TaskRunner* runner ) const
{
	makePlace( to.placed, m_placedCount );
	runShares( runner, Shares{ int( m_placedCount ) }, [&]( int, int begin, int end ) {
		const auto lookAt = [&]( int k ) { return &m_sides->patches().look[m_made[m_placed[std::size_t( std::min( k, end - 1 ) )]].vertex]; };
		for ( int k = begin; k < end; ++k )
		{
			__builtin_prefetch( lookAt( k + kFar ) );
			__builtin_prefetch( &m_sides->complex().addedOrigin[lookAt( k + kNear )->kind - m_sides->complex().inputVertices] );
			to.placed[std::size_t( k )] = placedAt( m_placed[std::size_t( k )] );
		}
	} );
	to.listBlended();
	const bool areAny = m_placedCount > 0;
	to.shading.assign( m_shading.get(), m_shading.get() + ( areAny ? m_shadingCount : 0 ) );
	to.shadedTriangles = areAny ? m_outerTriangles : 0;
}

/// No crack parts the corners: they are carried where their points' first slots have them.
SkinBinding::Placed CrackGatherer::placedAt( std::uint32_t vertex ) const
{
	const CrackPatches& patches = m_sides->patches();
	const CellComplex& complex = *patches.complex;
	const CellComplex::Origin& origin = complex.addedOrigin[patches.look[m_made[vertex].vertex].kind - complex.inputVertices];
	SkinBinding::Placed placed{ vertex, {}, origin.weight };
	for ( std::size_t k = 0; k < 3; ++k )
	{
		placed.corner[k] = origin.vertex[k] == kNone ? placed.corner[0] : m_number[patches.numbersOfInput[origin.vertex[k]] + Carrier] - m_first;
	}
	return placed;
}

} // namespace pliant
