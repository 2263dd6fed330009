// Shading of the cut outer surface: equal to that of the whole mesh until something moves.

#include "surface/constants.h"
#include "surface/crack_state/crack_surface.h"

#include "surface/crack_complex/blade_path.h"

#include <Eigen/Geometry>

#include <algorithm>

namespace pliant {

/// A closed cut through the outer surface must be invisible: at rest its vertices are shaded as on the whole mesh, however few of the
/// adjacent triangles are on their side.
void CrackSurface::shadeAsMesh( std::uint32_t vertex, const Vec3& area )
{
	if ( m_vertex[vertex].kind < kInside && !m_complex->vertexNormal.empty() )
	{
		m_binding.restNormal[vertex] = m_complex->vertexNormal[m_vertex[vertex].kind];
		m_binding.normalShift[vertex] = isPlaced( m_vertex[vertex] ) ? Vec3( Vec3::Zero() )
																	 : normalShift( m_binding.restNormal[vertex], area );
	}
}

Vec3 CrackSurface::normalShift( const Vec3& normal, const Vec3& area )
{
	const float largest = area.cwiseAbs().maxCoeff(); // avoids underflow of its square
	const Vec3 shift = largest > 0.0f ? Vec3( normal - ( area / largest ).normalized() ) : Vec3( Vec3::Zero() );
	return shift.cwiseAbs().maxCoeff() > kSeenShift ? shift : Vec3( Vec3::Zero() );
}

void CrackSurface::matchNormals()
{
	m_area.assign( std::size_t( m_binding.normalGroups ), Vec3::Zero() );
	for ( std::uint32_t cell = 0; cell < m_cell.size(); ++cell )
	{
		addAreas( cell );
	}
	for ( const std::uint32_t panel : intactPanels() )
	{
		addArea( m_panelCorner[panel] );
	}
	for ( std::uint32_t v = 0; v < vertexCount(); ++v )
	{
		shadeAsMesh( v, m_area[m_binding.normalGroup[v]] );
	}
}

/// The same where only the groups or panels of these points have changed: sums over all cells there, in the triangles' order, then over
/// panels.
void CrackSurface::matchNormals( std::vector<std::uint32_t>& points )
{
	std::vector<std::uint32_t> cells, once, panels;
	const auto isOnSurface = [this]( std::uint32_t point ) {
		std::uint32_t side = m_firstSide[point];
		while ( side != kNone && m_side[side].outerNormals == kNone )
		{
			side = m_side[side].next;
		}
		return side != kNone;
	};
	for ( const std::uint32_t point : points )
	{
		if ( isOnSurface( point ) ) // there is no mesh normal inside
		{
			collect( point, once );
		}
	}
	clearMarks( once );
	m_area.resize( std::size_t( m_binding.normalGroups ), Vec3::Zero() );
	for ( const std::uint32_t point : once )
	{
		for ( std::uint32_t side = m_firstSide[point]; side != kNone; side = m_side[side].next )
		{
			for ( std::uint32_t v = m_side[side].newest; v != kNone; v = m_vertex[v].next )
			{
				m_area[m_binding.normalGroup[v]].setZero();
			}
		}
		std::for_each( m_slotCell.begin() + m_slotStart[point], m_slotCell.begin() + m_slotStart[point + 1],
			[&]( std::uint32_t cell ) { collect( cell, cells ); } );
		addPanelsAt( point, panels );
	}
	clearMarks( cells );
	std::sort( cells.begin(), cells.end() );
	std::for_each( cells.begin(), cells.end(), [this]( std::uint32_t cell ) { addAreas( cell ); } );
	std::sort( panels.begin(), panels.end() );
	panels.erase( std::unique( panels.begin(), panels.end() ), panels.end() );
	std::for_each( panels.begin(), panels.end(), [this]( std::uint32_t panel ) { addArea( m_panelCorner[panel] ); } );
	for ( const std::uint32_t point : once )
	{
		for ( std::uint32_t side = m_firstSide[point]; side != kNone; side = m_side[side].next )
		{
			for ( std::uint32_t v = m_side[side].newest; v != kNone; v = m_vertex[v].next )
			{
				shadeAsMesh( v, m_area[m_binding.normalGroup[v]] );
			}
		}
	}
}

// The shading of all corners of triangles around a moved point changes. A point near a blade is no longer placed, even if it did not move,
// so that the result does not depend on the order in which cuts are reported.
void CrackSurface::follow( const BladePath& path, const std::vector<std::uint32_t>& points )
{
	std::vector<std::uint32_t> cells, shaded;
	for ( const std::uint32_t known : points )
	{
		const std::uint32_t point = localPoint( known );
		if ( point != kNone )
		{
			separate( point, true );
		}
		const Vec3 position = point != kNone ? path.positionOf( known ) : Vec3( Vec3::Zero() );
		if ( point == kNone || position == restOf( point ) )
		{
			continue;
		}
		if ( m_position.empty() )
		{
			for ( const std::uint32_t any : m_point )
			{
				m_position.push_back( m_complex->pointRest[any] );
			}
		}
		m_position[point] = position;
		for ( std::uint32_t side = m_firstSide[point]; side != kNone; side = m_side[side].next )
		{
			for ( std::uint32_t v = m_side[side].newest; v != kNone; v = m_vertex[v].next )
			{
				m_binding.restPosition[v] = position - m_shift;
			}
		}
		std::for_each( m_slotCell.begin() + m_slotStart[point], m_slotCell.begin() + m_slotStart[point + 1],
			[&]( std::uint32_t cell ) { collect( cell, cells ); } );
	}
	clearMarks( cells );
	for ( const std::uint32_t cell : cells )
	{
		for ( const std::uint32_t* p = m_complex->pointsOfCell.begin( m_cell[cell] ); p != m_complex->pointsOfCell.end( m_cell[cell] );
			  ++p )
		{
			shaded.push_back( localPoint( *p ) );
		}
	}
	shaded.insert( shaded.end(), m_split.begin(), m_split.end() );
	m_split.clear();
	listPlaced();
	matchNormals( shaded );
}

/// Adds the areas of a cell's pieces, except those of panels shaded as one.
void CrackSurface::addAreas( std::uint32_t cell )
{
	forSeparatePieces( cell, [this]( std::uint32_t t ) { addArea( m_triangle[t] ); } );
}

void CrackSurface::addArea( const std::array<std::uint32_t, 3>& corner )
{
	const Vec3& a = m_binding.restPosition[corner[0]];
	const Vec3 area = ( m_binding.restPosition[corner[1]] - a ).cross( m_binding.restPosition[corner[2]] - a );
	for ( const std::uint32_t v : corner )
	{
		m_area[m_binding.normalGroup[v]] += area;
	}
}

} // namespace pliant
