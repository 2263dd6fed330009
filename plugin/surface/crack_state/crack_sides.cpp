#include "surface/crack_state/crack_sides.h"

#include "surface/constants.h"
#include "surface/crack_complex/blade_path.h"
#include "threads/parallel.h"

#include <algorithm>
#include <bit>

namespace pliant {

namespace {

/// The lowest `count` bits.
std::uint64_t bitsUpTo( std::uint32_t count )
{
	return count == 64 ? ~std::uint64_t( 0 ) : ( std::uint64_t( 1 ) << count ) - 1;
}

/// Lists the numbers below `count` for which `holds` is true, ascending. Branch-free: each is written, and counted if it holds.
template <class Holds>
void list( std::vector<std::uint32_t>& to, std::size_t count, Holds&& holds )
{
	to.resize( count + 1 );
	std::uint32_t* const all = to.data();
	std::size_t kept = 0;
	for ( std::uint32_t k = 0; k < std::uint32_t( count ); ++k )
	{
		all[kept] = k;
		kept += holds( k ) ? 1 : 0;
	}
	to.resize( kept );
}

/// Sorts a list by the marks of its items, so that their data is accessed in memory order. Sparse lists stay unsorted.
void sortByMarks( std::vector<std::uint32_t>& items, const std::vector<std::uint8_t>& isMarked )
{
	if ( items.size() * kSparseFraction > isMarked.size() )
	{
		const std::uint8_t* const marks = isMarked.data();
		list( items, isMarked.size(), [marks]( std::uint32_t k ) { return marks[k] != 0; } );
	}
}

} // namespace

CrackSides::CrackSides( std::shared_ptr<const CrackPatches> patches ) :
	m_patches( std::move( patches ) ), m_isBroken( complex().face.size(), 0 ), m_side( m_patches->pointOfSlot.size() ),
	m_carriers( m_side.size() ), m_joined( m_patches->firstOfClass.back() ), m_isDrawn( complex().pointCount(), 0 ),
	m_isReshaded( m_isDrawn.size(), 0 ), m_isMarked( m_isDrawn.size(), 0 ), m_isSplit( m_isDrawn.size(), 0 ), m_panels( complex().panels ),
	m_isClassMarked( m_patches->classCount(), 0 )
{
	const CellComplex& c = complex();
	for ( std::size_t slot = 0; slot < m_side.size(); ++slot )
	{
		const std::uint32_t point = m_patches->pointOfSlot[slot];
		m_side[slot] = c.cellsOfPoint.start[point];
		m_carriers[slot] = bitsUpTo( c.bindStart[point + 1] - c.bindStart[point] );
	}
	for ( const std::uint32_t point : c.vertexPoint )
	{
		m_isDrawn[point] = 1;
	}
	m_found = m_patches->dividedPoints;
	runOver( m_found, &CrackSides::regroup, nullptr );
	separatePanels();
	std::vector<std::uint32_t> unlinked;
	for ( std::uint32_t face = 0; face < std::uint32_t( c.face.size() ); ++face )
	{
		if ( !c.face[face].isLinked && !isHeld( face ) )
		{
			unlinked.push_back( face );
		}
	}
	breakFaces( unlinked );
}

void CrackSides::breakFaces( const std::vector<std::uint32_t>& faces, TaskRunner* runner )
{
	std::vector<std::uint32_t> added;
	for ( const std::uint32_t face : faces )
	{
		if ( m_isBroken[face] == 0 )
		{
			m_isBroken[face] = 1;
			added.push_back( face );
		}
	}
	addUnheld( added );
	splitSides( added, runner );
	updateCarriersAround( added, runner );
}

/// True for a face without a link that is still held by a chain of linked faces.
bool CrackSides::isHeld( std::uint32_t face ) const
{
	bool isHeld = false;
	for ( const std::uint32_t* h = complex().holdersOfFace.begin( face ); !isHeld && h != complex().holdersOfFace.end( face ); h += 3 )
	{
		isHeld = !isBroken( h[0] ) && !isBroken( h[1] ) && !isBroken( h[2] );
	}
	return isHeld;
}

void CrackSides::addUnheld( std::vector<std::uint32_t>& added )
{
	const std::size_t count = added.size();
	for ( std::size_t k = 0; k < count; ++k )
	{
		for ( const std::uint32_t* held = complex().heldByFace.begin( added[k] ); held != complex().heldByFace.end( added[k] ); ++held )
		{
			if ( m_isBroken[*held] == 0 && !isHeld( *held ) )
			{
				m_isBroken[*held] = 1;
				added.push_back( *held );
			}
		}
	}
	std::sort( added.begin(), added.end() );
}

void CrackSides::splitSides( const std::vector<std::uint32_t>& added, TaskRunner* runner )
{
	m_found.clear();
	for ( const std::uint32_t face : added )
	{
		const std::uint32_t* const first = complex().pointsOfFace.begin( face );
		const std::uint32_t* const last = complex().pointsOfFace.end( face );
		std::for_each( first, last, [this]( std::uint32_t point ) {
			m_isDrawn[point] = 1;
			m_panels.uncover( point );
		} );
		collect( first, last );
	}
	sortByMarks( m_found, m_isMarked );
	runOver( m_found, &CrackSides::regroup, runner );
	separatePanels();
}

void CrackSides::separatePanels()
{
	std::vector<std::uint32_t> reshaded;
	for ( std::size_t k = 0; k < m_found.size() && m_panels.arePlaced(); ++k )
	{
		if ( m_isSplit[m_found[k]] != 0 )
		{
			m_panels.separate( m_found[k], reshaded );
		}
	}
	for ( const std::uint32_t point : reshaded )
	{
		m_isReshaded[point] = 1;
	}
}

/// Adds the drawn points to m_found, each once.
void CrackSides::collect( const std::uint32_t* point, const std::uint32_t* end )
{
	for ( ; point != end; ++point )
	{
		if ( m_isMarked[*point] < m_isDrawn[*point] )
		{
			m_isMarked[*point] = 1;
			m_found.push_back( *point );
		}
	}
}

void CrackSides::regroup( std::uint32_t point )
{
	m_isMarked[point] = 0;
	const std::uint32_t first = complex().cellsOfPoint.start[point], last = complex().cellsOfPoint.start[point + 1];
	for ( std::uint32_t slot = first; slot < last; ++slot )
	{
		m_side[slot] = slot;
	}
	const auto rootOf = [this]( std::uint32_t slot ) {
		while ( m_side[slot] != slot )
		{
			slot = m_side[slot];
		}
		return slot;
	};
	for ( std::uint32_t t = m_patches->slotTieStart[point]; t < m_patches->slotTieStart[point + 1]; ++t )
	{
		const CrackPatches::Tie& tie = m_patches->slotTie[t];
		if ( !isBroken( tie.face ) )
		{
			const std::uint32_t a = rootOf( first + tie.a ), b = rootOf( first + tie.b );
			m_side[std::max( a, b )] = std::min( a, b );
		}
	}
	for ( std::uint32_t slot = first; slot < last; ++slot )
	{
		m_side[slot] = m_side[m_side[slot]]; // earlier slots already have their roots
		m_isSplit[point] |= m_side[slot] != first ? 1 : 0;
	}
	m_isReshaded[point] |= m_isSplit[point];
}

/// Both cells of each face, ascending, without duplicates. Marking is faster than sorting where most of a body breaks.
std::vector<std::uint32_t> CrackSides::cellsAt( const std::vector<std::uint32_t>& faces ) const
{
	std::vector<std::uint8_t> isOne( complex().cellCount(), 0 );
	std::vector<std::uint32_t> cells;
	for ( const std::uint32_t face : faces )
	{
		for ( const std::uint32_t cell : { complex().face[face].cellA, complex().face[face].cellB } )
		{
			if ( isOne[cell] == 0 )
			{
				isOne[cell] = 1;
				cells.push_back( cell );
			}
		}
	}
	if ( cells.size() * kSparseFraction > isOne.size() )
	{
		sortByMarks( cells, isOne );
	}
	else
	{
		std::sort( cells.begin(), cells.end() );
	}
	return cells;
}

/// Only points with carriers along the crack can lose carriers. Not all of these have a tie of a broken face: a side drops carriers that
/// are connected to it by no face when it is first updated.
void CrackSides::updateCarriersAround( const std::vector<std::uint32_t>& added, TaskRunner* runner )
{
	const std::vector<std::uint32_t> cells = cellsAt( added );
	m_found.clear();
	if ( cells.size() * kSparseFraction > complex().cellCount() )
	{
		collectByClass( cells );
	}
	for ( std::size_t k = 0; k < cells.size() && cells.size() * kSparseFraction <= complex().cellCount(); ++k )
	{
		collect( complex().boundPoints.begin( cells[k] ), complex().boundPoints.end( cells[k] ) );
	}
	for ( const std::uint32_t face : added )
	{
		collect( complex().pointsOfFace.begin( face ), complex().pointsOfFace.end( face ) );
	}
	sortByMarks( m_found, m_isMarked );
	for ( const std::uint32_t point : m_found )
	{
		m_isMarked[point] = 0;
		const std::uint32_t ofClass = m_patches->classOfPoint[point];
		if ( m_isClassMarked[ofClass] == 0 )
		{
			m_isClassMarked[ofClass] = 1;
			m_foundClass.push_back( ofClass );
		}
	}
	sortByMarks( m_foundClass, m_isClassMarked );
	runOver( m_foundClass, &CrackSides::joinCarriers, runner );
	m_foundClass.clear();
	runOver( m_found, &CrackSides::updateCarriers, runner );
}

void CrackSides::collectByClass( const std::vector<std::uint32_t>& cells )
{
	for ( const std::uint32_t cell : cells )
	{
		std::for_each( m_patches->classesOfCell.begin( cell ), m_patches->classesOfCell.end( cell ),
			[this]( std::uint32_t c ) { m_isClassMarked[c] = 1; } );
	}
	const std::uint8_t *const isClassMarked = m_isClassMarked.data(), *const isDrawn = m_isDrawn.data();
	const std::uint32_t* const classOfPoint = m_patches->classOfPoint.data();
	list( m_found, m_isMarked.size(), [=]( std::uint32_t point ) { return ( isClassMarked[classOfPoint[point]] & isDrawn[point] ) != 0; } );
	for ( const std::uint32_t point : m_found )
	{
		m_isMarked[point] = 1;
	}
	std::fill( m_isClassMarked.begin(), m_isClassMarked.end(), 0 );
}

void CrackSides::runOver( std::vector<std::uint32_t>& list, void ( CrackSides::*each )( std::uint32_t ), TaskRunner* runner )
{
	auto items = [&]( int chunk ) {
		const std::size_t first = std::size_t( chunk ) * kCrackPointsPerTask, last = std::min( list.size(), first + kCrackPointsPerTask );
		for ( std::size_t k = first; k < last; ++k )
		{
			( this->*each )( list[k] );
		}
	};
	runTasks( runner, int( ( list.size() + kCrackPointsPerTask - 1 ) / kCrackPointsPerTask ), items );
}

/// Finds which carriers of a class are connected, directly or through each other.
void CrackSides::joinCarriers( std::uint32_t ofClass )
{
	const CrackPatches& p = *m_patches;
	m_isClassMarked[ofClass] = 0;
	const std::uint32_t first = p.firstOfClass[ofClass], count = p.firstOfClass[ofClass + 1] - first;
	std::uint64_t beside[kMostCarriers];
	std::fill_n( beside, count, 0 );
	for ( std::uint32_t t = p.carrierTieStart[ofClass]; t < p.carrierTieStart[ofClass + 1]; ++t )
	{
		const CrackPatches::Tie& tie = p.carrierTie[t];
		const std::uint64_t unbroken = m_isBroken[tie.face] ^ 1u;
		beside[tie.a] |= unbroken << tie.b;
		beside[tie.b] |= unbroken << tie.a;
	}
	for ( std::uint64_t remaining = bitsUpTo( count ); remaining != 0; )
	{
		std::uint64_t joined = remaining & ( ~remaining + 1 ), frontier = joined;
		while ( frontier != 0 )
		{
			const std::uint64_t added = beside[std::countr_zero( frontier )] & ~joined;
			frontier &= frontier - 1;
			joined |= added;
			frontier |= added;
		}
		remaining &= ~joined;
		for ( std::uint64_t each = joined; each != 0; each &= each - 1 )
		{
			m_joined[first + std::uint32_t( std::countr_zero( each ) )] = joined;
		}
	}
}

/// A side has the carriers that are among its cells or adjacent to them, and all carriers connected to these.
void CrackSides::updateCarriers( std::uint32_t point )
{
	const CrackPatches& p = *m_patches;
	const std::uint64_t* const joined = m_joined.data() + p.firstOfClass[p.classOfPoint[point]];
	const std::uint32_t first = complex().cellsOfPoint.start[point], last = complex().cellsOfPoint.start[point + 1];
	std::fill( m_carriers.begin() + first, m_carriers.begin() + last, 0 );
	for ( std::uint32_t slot = first; slot < last; ++slot )
	{
		m_carriers[m_side[slot]] |= p.bitOfSlot[slot] == CrackPatches::kNoBit ? 0 : joined[p.bitOfSlot[slot]];
	}
	for ( std::uint32_t t = p.looseTieStart[point]; t < p.looseTieStart[point + 1]; ++t )
	{
		const CrackPatches::Tie& tie = p.looseTie[t];
		m_carriers[m_side[first + tie.a]] |= m_isBroken[tie.face] == 0 ? joined[tie.b] : 0;
	}
}

void CrackSides::follow( const BladePath& path, const std::vector<std::uint32_t>& points )
{
	m_position = m_position.empty() ? complex().pointRest : std::move( m_position );
	std::vector<std::uint32_t> reshaded;
	for ( const std::uint32_t point : points )
	{
		m_panels.touch( point, reshaded ); // even if it does not move, so that the order of reports does not matter
		const Vec3 position = path.positionOf( point );
		if ( position != m_position[point] )
		{
			m_position[point] = position;
			reshadeAround( point );
		}
	}
	std::for_each( reshaded.begin(), reshaded.end(), [this]( std::uint32_t point ) { m_isReshaded[point] = 1; } );
}

/// The shading of all corners of triangles around a moved point changes.
void CrackSides::reshadeAround( std::uint32_t point )
{
	for ( const std::uint32_t* cell = complex().cellsOfPoint.begin( point ); cell != complex().cellsOfPoint.end( point ); ++cell )
	{
		std::for_each( complex().pointsOfCell.begin( *cell ), complex().pointsOfCell.end( *cell ),
			[this]( std::uint32_t p ) { m_isReshaded[p] = 1; } );
	}
}

} // namespace pliant
