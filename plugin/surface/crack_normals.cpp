// Shading of the outer surface where it is cut: as on the whole mesh, until something moves.

#include "surface/crack_surface.h"

#include "surface/blade_path.h"

#include <Eigen/Geometry>

#include <algorithm>

namespace pliant {

/// A cut through the outer surface must not show as long as it is closed: at rest its vertices are shaded like the whole mesh, however few
/// of the triangles around are left on their side.
void CrackSurface::shadeLikeTheMesh( std::uint32_t vertex, const Vec3& area )
{
	if ( m_vertex[vertex].kind < kInside && !m_complex->vertexNormal.empty() )
	{
		m_binding.restNormal[vertex] = m_complex->vertexNormal[m_vertex[vertex].kind];
		m_binding.normalShift[vertex] = normalShift( m_binding.restNormal[vertex], area );
	}
}

Vec3 CrackSurface::normalShift( const Vec3& normal, const Vec3& area )
{
	const float largest = area.cwiseAbs().maxCoeff(); // its square would be nothing
	return largest > 0.0f ? Vec3( normal - ( area / largest ).normalized() ) : Vec3( Vec3::Zero() );
}

void CrackSurface::matchNormals()
{
	m_area.assign( std::size_t( m_binding.normalGroups ), Vec3::Zero() );
	for ( std::uint32_t t = 0; t < m_cellTriangle.back(); ++t )
	{
		addArea( t );
	}
	for ( std::uint32_t v = 0; v < vertexCount(); ++v )
	{
		shadeLikeTheMesh( v, m_area[m_binding.normalGroup[v]] );
	}
}

/// The same where only the groups of these points have changed: of all cells there, in the triangles' order.
void CrackSurface::matchNormals( std::vector<std::uint32_t>& points )
{
	std::vector<std::uint32_t> cells, once;
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
		if ( isOnSurface( point ) ) // inside there is no mesh to be like
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
	}
	clearMarks( cells );
	std::sort( cells.begin(), cells.end() );
	for ( const std::uint32_t cell : cells )
	{
		for ( std::uint32_t t = m_cellTriangle[cell]; t < m_cellTriangle[cell + 1]; ++t )
		{
			addArea( t );
		}
	}
	for ( const std::uint32_t point : once )
	{
		for ( std::uint32_t side = m_firstSide[point]; side != kNone; side = m_side[side].next )
		{
			for ( std::uint32_t v = m_side[side].newest; v != kNone; v = m_vertex[v].next )
			{
				shadeLikeTheMesh( v, m_area[m_binding.normalGroup[v]] );
			}
		}
	}
}

// Triangles around a moved point change, and with them the shading of all their corners.
void CrackSurface::follow( const BladePath& path, const std::vector<std::uint32_t>& points )
{
	std::vector<std::uint32_t> cells, shaded;
	for ( const std::uint32_t known : points )
	{
		const std::uint32_t point = localPoint( known );
		const Vec3 place = point != kNone ? path.placeOf( known ) : Vec3( Vec3::Zero() );
		if ( point == kNone || place == restOf( point ) )
		{
			continue;
		}
		if ( m_place.empty() )
		{
			for ( const std::uint32_t any : m_point )
			{
				m_place.push_back( m_complex->pointRest[any] );
			}
		}
		m_place[point] = place;
		for ( std::uint32_t side = m_firstSide[point]; side != kNone; side = m_side[side].next )
		{
			for ( std::uint32_t v = m_side[side].newest; v != kNone; v = m_vertex[v].next )
			{
				m_binding.restPosition[v] = place - m_shift;
			}
		}
		std::for_each( m_slotCell.begin() + m_slotStart[point], m_slotCell.begin() + m_slotStart[point + 1],
			[&]( std::uint32_t cell ) { collect( cell, cells ); } );
	}
	clearMarks( cells );
	for ( const std::uint32_t cell : cells )
	{
		for ( const std::uint32_t* p = m_complex->pointsOfCell.begin( m_cell[cell] ); p != m_complex->pointsOfCell.end( m_cell[cell] ); ++p )
		{
			shaded.push_back( localPoint( *p ) );
		}
	}
	matchNormals( shaded );
}

void CrackSurface::addArea( std::uint32_t triangle )
{
	const auto& corner = m_triangle[triangle];
	const Vec3& a = m_binding.restPosition[corner[0]];
	const Vec3 area = ( m_binding.restPosition[corner[1]] - a ).cross( m_binding.restPosition[corner[2]] - a );
	for ( const std::uint32_t v : corner )
	{
		m_area[m_binding.normalGroup[v]] += area;
	}
}

} // namespace pliant
