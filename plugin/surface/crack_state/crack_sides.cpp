#include "surface/crack_state/crack_sides.h"

#include "surface/crack_complex/blade_path.h"
#include "surface/crack_state/crack_surface.h"
#include "threads/parallel.h"

#include <algorithm>
#include <bit>

namespace pliant {

namespace {

/// Points of one task.
constexpr std::size_t kChunk = 1024;

/// Less than one in so many is few.
constexpr std::size_t kFew = 32;

/// The lowest so many bits.
std::uint64_t bitsUpTo( std::uint32_t count )
{
	return count == 64 ? ~std::uint64_t( 0 ) : ( std::uint64_t( 1 ) << count ) - 1;
}

/// The numbers below `count` that `holds` is true of, ascending. Each is written, and counted if it is one: no branch to foretell.
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

/// Those that are marked, ascending, so that what is theirs is gone through in the order of memory. Few stay as they are.
void inOrder( std::vector<std::uint32_t>& some, const std::vector<std::uint8_t>& isMarked )
{
	if ( some.size() * kFew > isMarked.size() )
	{
		const std::uint8_t* const marks = isMarked.data();
		list( some, isMarked.size(), [marks]( std::uint32_t k ) { return marks[k] != 0; } );
	}
}

} // namespace

CrackSides::CrackSides( std::shared_ptr<const CrackPatches> patches, const CrackSurface& whole, TaskRunner* runner ) :
	m_patches( std::move( patches ) ), m_isBroken( complex().face.size(), 0 ), m_side( m_patches->pointOfSlot.size() ),
	m_carriers( m_side.size() ), m_joined( m_patches->firstOfClass.back() ), m_isDrawn( complex().pointCount(), 0 ),
	m_isShadedAnew( m_isDrawn.size(), 0 ), m_isMarked( m_isDrawn.size(), 0 ), m_isSplit( m_isDrawn.size(), 0 ), m_panels( whole.m_panels ),
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
	shadePartedPanels();
	std::vector<std::uint32_t> fresh;
	for ( const CrackSurface::Face& face : whole.m_face )
	{
		m_isBroken[face.number] = face.isBroken ? 1 : 0;
		if ( face.isBroken )
		{
			fresh.push_back( face.number );
		}
	}
	splitSides( fresh, runner );
	askAround( fresh, runner );
	if ( !whole.m_position.empty() )
	{
		m_position = whole.m_position;
		for ( std::uint32_t point = 0; point < std::uint32_t( m_position.size() ); ++point )
		{
			if ( m_position[point] != c.pointRest[point] )
			{
				shadeAnewAround( point );
			}
		}
	}
}

void CrackSides::breakFaces( const std::vector<std::uint32_t>& faces, TaskRunner* runner )
{
	std::vector<std::uint32_t> fresh;
	for ( const std::uint32_t face : faces )
	{
		if ( m_isBroken[face] == 0 )
		{
			m_isBroken[face] = 1;
			fresh.push_back( face );
		}
	}
	addUnheld( fresh );
	splitSides( fresh, runner );
	askAround( fresh, runner );
}

/// Whether a face without a link may stand: linked ones lead round it.
bool CrackSides::isHeld( std::uint32_t face ) const
{
	bool isHeld = false;
	for ( const std::uint32_t* h = complex().holdersOfFace.begin( face ); !isHeld && h != complex().holdersOfFace.end( face ); h += 3 )
	{
		isHeld = !isBroken( h[0] ) && !isBroken( h[1] ) && !isBroken( h[2] );
	}
	return isHeld;
}

void CrackSides::addUnheld( std::vector<std::uint32_t>& fresh )
{
	const std::size_t count = fresh.size();
	for ( std::size_t k = 0; k < count; ++k )
	{
		for ( const std::uint32_t* held = complex().heldByFace.begin( fresh[k] ); held != complex().heldByFace.end( fresh[k] ); ++held )
		{
			if ( m_isBroken[*held] == 0 && !isHeld( *held ) )
			{
				m_isBroken[*held] = 1;
				fresh.push_back( *held );
			}
		}
	}
	std::sort( fresh.begin(), fresh.end() );
}

void CrackSides::splitSides( const std::vector<std::uint32_t>& fresh, TaskRunner* runner )
{
	m_found.clear();
	for ( const std::uint32_t face : fresh )
	{
		const std::uint32_t* const first = complex().pointsOfFace.begin( face );
		const std::uint32_t* const last = complex().pointsOfFace.end( face );
		std::for_each( first, last, [this]( std::uint32_t point ) { m_isDrawn[point] = 1; } );
		collect( first, last );
	}
	inOrder( m_found, m_isMarked );
	runOver( m_found, &CrackSides::regroup, runner );
	partPanels();
}

/// Of the points just found.
void CrackSides::partPanels()
{
	std::vector<std::uint32_t> anew;
	for ( std::size_t k = 0; k < m_found.size() && m_panels.arePlaced(); ++k )
	{
		m_panels.uncover( m_found[k] );
		if ( m_isSplit[m_found[k]] != 0 )
		{
			m_panels.part( m_found[k], anew );
		}
	}
	for ( const std::uint32_t point : anew )
	{
		m_isShadedAnew[point] = 1;
	}
}

/// Around what was placed when nothing was broken, and is no more.
void CrackSides::shadePartedPanels()
{
	const Panels& all = complex().panels;
	for ( std::uint32_t point = 0; point < std::uint32_t( all.isPlaceable.size() ); ++point )
	{
		const bool isPlacedNoMore = all.isPlaceable[point] != 0 && !m_panels.isPlaced( point );
		for ( const std::uint32_t* panel = all.atPoint.begin( point ); isPlacedNoMore && panel != all.atPoint.end( point ); ++panel )
		{
			std::for_each( all.points.begin( *panel ), all.points.end( *panel ), [this]( std::uint32_t p ) { m_isShadedAnew[p] = 1; } );
		}
	}
}

/// Those that are drawn, each once.
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
		m_side[slot] = m_side[m_side[slot]]; // those before it have their roots by now
		m_isSplit[point] |= m_side[slot] != first ? 1 : 0;
	}
	m_isShadedAnew[point] |= m_isSplit[point];
}

/// Both cells of each, ascending, each once. To mark them takes less than to sort them where most of a body breaks.
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
	if ( cells.size() * kFew > isOne.size() )
	{
		inOrder( cells, isOne );
	}
	else
	{
		std::sort( cells.begin(), cells.end() );
	}
	return cells;
}

/// A point can be carried by others now only where a cell along the crack carried it. Not every one of those has a tie of a broken face:
/// where crumbs hang on by no face at all, a side lets go of them the first time it is asked.
void CrackSides::askAround( const std::vector<std::uint32_t>& fresh, TaskRunner* runner )
{
	const std::vector<std::uint32_t> cells = cellsAt( fresh );
	m_found.clear();
	if ( cells.size() * kFew > complex().cellCount() )
	{
		collectByClass( cells );
	}
	for ( std::size_t k = 0; k < cells.size() && cells.size() * kFew <= complex().cellCount(); ++k )
	{
		collect( complex().boundPoints.begin( cells[k] ), complex().boundPoints.end( cells[k] ) );
	}
	for ( const std::uint32_t face : fresh )
	{
		collect( complex().pointsOfFace.begin( face ), complex().pointsOfFace.end( face ) );
	}
	inOrder( m_found, m_isMarked );
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
	inOrder( m_foundClass, m_isClassMarked );
	runOver( m_foundClass, &CrackSides::joinCarriers, runner );
	m_foundClass.clear();
	runOver( m_found, &CrackSides::ask, runner );
}

/// All points that these cells carry.
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
	auto some = [&]( int chunk ) {
		const std::size_t first = std::size_t( chunk ) * kChunk, last = std::min( list.size(), first + kChunk );
		for ( std::size_t k = first; k < last; ++k )
		{
			( this->*each )( list[k] );
		}
	};
	runTasks( runner, int( ( list.size() + kChunk - 1 ) / kChunk ), some );
}

/// Of the cells that carry the points of a class: which of them each reaches by way of one another.
void CrackSides::joinCarriers( std::uint32_t ofClass )
{
	const CrackPatches& p = *m_patches;
	m_isClassMarked[ofClass] = 0;
	const std::uint32_t first = p.firstOfClass[ofClass], count = p.firstOfClass[ofClass + 1] - first;
	std::uint64_t beside[CrackPatches::kMostCarriers];
	std::fill_n( beside, count, 0 );
	for ( std::uint32_t t = p.carrierTieStart[ofClass]; t < p.carrierTieStart[ofClass + 1]; ++t )
	{
		const CrackPatches::Tie& tie = p.carrierTie[t];
		const std::uint64_t stands = m_isBroken[tie.face] ^ 1u;
		beside[tie.a] |= stands << tie.b;
		beside[tie.b] |= stands << tie.a;
	}
	for ( std::uint64_t left = bitsUpTo( count ); left != 0; )
	{
		std::uint64_t joined = left & ( ~left + 1 ), open = joined;
		while ( open != 0 )
		{
			const std::uint64_t fresh = beside[std::countr_zero( open )] & ~joined;
			open &= open - 1;
			joined |= fresh;
			open |= fresh;
		}
		left &= ~joined;
		for ( std::uint64_t each = joined; each != 0; each &= each - 1 )
		{
			m_joined[first + std::uint32_t( std::countr_zero( each ) )] = joined;
		}
	}
}

/// Each side has the carriers that its cells are or stand beside, and what those reach.
void CrackSides::ask( std::uint32_t point )
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
	std::vector<std::uint32_t> anew;
	for ( const std::uint32_t point : points )
	{
		m_panels.touch( point, anew ); // as CrackSurface does
		const Vec3 place = path.positionOf( point );
		if ( place != m_position[point] )
		{
			m_position[point] = place;
			shadeAnewAround( point );
		}
	}
	std::for_each( anew.begin(), anew.end(), [this]( std::uint32_t point ) { m_isShadedAnew[point] = 1; } );
}

/// Triangles around a moved point change, and with them the shading of all their corners.
void CrackSides::shadeAnewAround( std::uint32_t point )
{
	for ( const std::uint32_t* cell = complex().cellsOfPoint.begin( point ); cell != complex().cellsOfPoint.end( point ); ++cell )
	{
		std::for_each( complex().pointsOfCell.begin( *cell ), complex().pointsOfCell.end( *cell ),
			[this]( std::uint32_t p ) { m_isShadedAnew[p] = 1; } );
	}
}

std::size_t CrackSides::bytes() const
{
	const auto sizeOf = []( const auto& list ) { return list.size() * sizeof( list[0] ); };
	return sizeOf( m_isBroken ) + sizeOf( m_side ) + sizeOf( m_carriers ) + sizeOf( m_joined ) + 4 * sizeOf( m_isDrawn ) +
		m_panels.bytes() + sizeOf( m_position );
}

} // namespace pliant
