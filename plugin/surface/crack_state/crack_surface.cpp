// Selection of a body's part of the complex.

#include "surface/crack_state/crack_surface.h"

#include "surface/constants.h"
#include "surface/crack_shapes/cell_owners.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <numeric>

namespace pliant {

std::uint32_t numberIn( const std::vector<std::uint32_t>& list, std::uint32_t wanted )
{
	const auto found = std::lower_bound( list.begin(), list.end(), wanted );
	return found != list.end() && *found == wanted ? std::uint32_t( found - list.begin() ) : CellComplex::kNone;
}

namespace {

std::vector<std::uint32_t> tableOf( const std::vector<std::uint32_t>& list, std::size_t all )
{
	std::vector<std::uint32_t> table;
	if ( list.size() * kTableFraction >= all )
	{
		table.assign( all, CrackSurface::kNone );
		for ( std::uint32_t k = 0; k < list.size(); ++k )
		{
			table[list[k]] = k;
		}
	}
	return table;
}

std::vector<std::uint32_t> allUpTo( std::size_t count )
{
	std::vector<std::uint32_t> all( count );
	std::iota( all.begin(), all.end(), 0u );
	return all;
}

/// By face: true where the lattice of a body lacks its link.
std::vector<std::uint8_t> unlinkedFaces( const CellComplex& complex, const std::vector<std::uint32_t>& cells, const Lattice& body )
{
	std::vector<std::uint8_t> isBroken( complex.face.size(), 0 );
	for ( std::uint32_t cell = 0; cell < cells.size(); ++cell )
	{
		for ( const std::uint32_t* f = complex.facesOfCell.begin( cells[cell] ); f != complex.facesOfCell.end( cells[cell] ); ++f )
		{
			const CrackFace& face = complex.face[*f];
			const std::uint32_t other = numberIn( cells, face.cellA == cells[cell] ? face.cellB : face.cellA );
			if ( face.isLinked && other != CrackSurface::kNone && other > cell )
			{
				isBroken[*f] = areLinked( body, cell, other ) ? 0 : 1;
			}
		}
	}
	return isBroken;
}

} // namespace

CrackSurface::CrackSurface( std::shared_ptr<const CellComplex> complex ) :
	CrackSurface( complex, allUpTo( complex->cellCount() ), std::vector<std::uint8_t>( complex->face.size(), 0 ), Vec3::Zero() )
{}

CrackSurface::CrackSurface( std::shared_ptr<const CellComplex> complex, std::vector<std::uint32_t> cells,
	const std::vector<std::uint8_t>& isBroken, const Vec3& shift ) :
	m_complex( std::move( complex ) ),
	m_shift( shift ), m_cell( std::move( cells ) ), m_panels( m_complex->panels ), m_mark( m_cell.size() + 1, 0 )
{
	m_localCell = tableOf( m_cell, m_complex->cellCount() );
	selectFaces( isBroken );
	selectPoints();
	drawAll();
}

CrackSurface::CrackSurface(
	std::shared_ptr<const CellComplex> complex, std::vector<std::uint32_t> cells, const Lattice& body, const Vec3& shift ) :
	CrackSurface( complex, cells, unlinkedFaces( *complex, cells, body ), shift )
{}

// === Selection ===

void CrackSurface::selectFaces( const std::vector<std::uint8_t>& isBroken )
{
	std::vector<std::uint32_t> numbers;
	for ( const std::uint32_t cell : m_cell )
	{
		numbers.insert( numbers.end(), m_complex->facesOfCell.begin( cell ), m_complex->facesOfCell.end( cell ) );
	}
	std::sort( numbers.begin(), numbers.end() );
	numbers.erase( std::unique( numbers.begin(), numbers.end() ), numbers.end() );
	m_localFace = tableOf( numbers, m_complex->face.size() );
	m_face.reserve( numbers.size() );
	for ( const std::uint32_t number : numbers )
	{
		const CrackFace& known = m_complex->face[number];
		Face face{ number, localCell( known.cellA ), localCell( known.cellB ), kNone, kNone, false };
		face.isBroken = isBroken[number] != 0 || face.cellA == kNone || face.cellB == kNone;
		m_face.push_back( face );
	}
	for ( std::uint32_t f = 0; f < m_face.size(); ++f )
	{
		m_face[f].isBroken = m_face[f].isBroken || !isHeld( f );
	}
	m_cellFaceStart.push_back( 0 );
	for ( const std::uint32_t cell : m_cell )
	{
		for ( const std::uint32_t* f = m_complex->facesOfCell.begin( cell ); f != m_complex->facesOfCell.end( cell ); ++f )
		{
			const Face& face = m_face[m_cellFace.emplace_back( localFace( *f ) )];
			m_neighbour.push_back( face.isBroken ? std::uint32_t( m_cell.size() ) : m_cell[face.cellA] == cell ? face.cellB : face.cellA );
		}
		m_cellFaceStart.push_back( std::uint32_t( m_cellFace.size() ) );
	}
}

/// True for a face that stays unbroken: its cells are linked, or a chain of linked faces connects them.
bool CrackSurface::isHeld( std::uint32_t face ) const
{
	const std::uint32_t number = m_face[face].number;
	bool isHeld = m_complex->face[number].isLinked;
	for ( const std::uint32_t* h = m_complex->holdersOfFace.begin( number ); !isHeld && h != m_complex->holdersOfFace.end( number );
		  h += 3 )
	{
		isHeld = !isBroken( h[0] ) && !isBroken( h[1] ) && !isBroken( h[2] );
	}
	return isHeld;
}

void CrackSurface::selectPoints()
{
	if ( m_cell.size() == m_complex->cellCount() )
	{
		m_point = allUpTo( m_complex->pointCount() );
	}
	else
	{
		for ( const std::uint32_t cell : m_cell )
		{
			m_point.insert( m_point.end(), m_complex->pointsOfCell.begin( cell ), m_complex->pointsOfCell.end( cell ) );
		}
		std::sort( m_point.begin(), m_point.end() );
		m_point.erase( std::unique( m_point.begin(), m_point.end() ), m_point.end() );
	}
	m_localPoint = tableOf( m_point, m_complex->pointCount() );
	m_firstSide.assign( m_point.size(), kNone );
	m_sideVertex.resize( m_point.size() );
	m_groups.assign( m_point.size(), 1 );
	m_slotStart.push_back( 0 );
	m_tieStart.push_back( 0 );
	for ( const std::uint32_t point : m_point )
	{
		const std::uint32_t first = m_slotStart.back();
		for ( const std::uint32_t* c = m_complex->cellsOfPoint.begin( point ); c != m_complex->cellsOfPoint.end( point ); ++c )
		{
			if ( const std::uint32_t cell = localCell( *c ); cell != kNone )
			{
				m_slotCell.push_back( cell );
			}
		}
		const auto slot = [&]( std::uint32_t cell ) {
			return std::uint16_t( std::lower_bound( m_slotCell.begin() + first, m_slotCell.end(), cell ) - m_slotCell.begin() - first );
		};
		for ( const std::uint32_t* f = m_complex->facesOfPoint.begin( point ); f != m_complex->facesOfPoint.end( point ); ++f )
		{
			const std::uint32_t number = localFace( *f );
			if ( number != kNone && m_face[number].cellA != kNone && m_face[number].cellB != kNone )
			{
				m_tie.push_back( { number, slot( m_face[number].cellA ), slot( m_face[number].cellB ) } );
			}
		}
		m_slotStart.push_back( std::uint32_t( m_slotCell.size() ) );
		m_tieStart.push_back( std::uint32_t( m_tie.size() ) );
	}
	m_slotGroup.assign( m_slotCell.size(), 0 );
	m_isMarked.assign( std::max( m_point.size(), m_cell.size() ), 0 );
}

std::uint32_t CrackSurface::localFace( std::uint32_t face ) const
{
	if ( !m_localFace.empty() )
	{
		return m_localFace[face];
	}
	const auto found = std::lower_bound(
		m_face.begin(), m_face.end(), face, []( const Face& a, std::uint32_t wanted ) { return a.number < wanted; } );
	return found != m_face.end() && found->number == face ? std::uint32_t( found - m_face.begin() ) : kNone;
}

} // namespace pliant
