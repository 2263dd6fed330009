#include "adapt/region_matrix.h"

#include <algorithm>
#include <cmath>

namespace pliant {

namespace {

std::uint32_t inUnits( double cells )
{
	return std::uint32_t( std::max( 1.0, std::round( cells / kMassUnit ) ) );
}

/// One row in the making: sums by slot, and the slots that have any.
class Row
{
public:
	explicit Row( int slots ) : m_mass( slots, 0 ), m_share( slots, 0 ), m_isListed( slots, 0 ) {}

	void add( std::uint32_t slot, std::uint32_t mass, std::uint32_t share )
	{
		if ( m_isListed[slot] == 0 )
		{
			m_isListed[slot] = 1;
			m_members.push_back( slot );
		}
		m_mass[slot] += mass;
		m_share[slot] += share;
	}

	void set( std::uint32_t slot, std::uint32_t mass, std::uint32_t share )
	{
		add( slot, 0, 0 );
		m_mass[slot] = mass;
		m_share[slot] = share;
	}

	/// Appends the row to the matrix, ascending, and is empty again.
	void appendTo( RegionMatrix& matrix )
	{
		std::sort( m_members.begin(), m_members.end() );
		for ( const std::uint32_t slot : m_members )
		{
			matrix.member.push_back( slot );
			matrix.mass.push_back( m_mass[slot] );
			matrix.share.push_back( m_share[slot] );
			m_mass[slot] = m_share[slot] = 0;
			m_isListed[slot] = 0;
		}
		m_members.clear();
		matrix.start.push_back( std::uint32_t( matrix.member.size() ) );
	}

private:
	std::vector<std::uint32_t> m_mass, m_share;
	std::vector<std::uint8_t> m_isListed;
	std::vector<std::uint32_t> m_members;
};

/// u( a, r ) = sum over cells c under a and fine regions f under r with c in f of m_c / n_c. Membership is symmetric: one walk over the
/// cells of the fine regions under a node finds both its row (what lies in its region) and its column (whose regions it lies in).
void countFromCells( const Octree& octree, const Cut& cut, const FineRegions& fine, std::uint32_t slot, Row& row )
{
	const std::uint32_t node = cut.node[slot];
	for ( std::uint32_t k = octree.cellStart[node]; k < octree.cellStart[node] + octree.cellCount[node]; ++k )
	{
		const std::uint32_t cell = octree.cells[k];
		for ( std::uint32_t m = fine.set.start[cell]; m < fine.set.start[cell + 1]; ++m )
		{
			const std::uint32_t other = fine.set.member[m];
			row.add( cut.slotOfCell[other], fine.mass[other], fine.mass[cell] );
		}
	}
}

/// What the change of a cut means for its slots.
struct SlotChange
{
	std::vector<std::uint32_t> now;    ///< of each old slot: its slot, or that of the merged node that took it in; kNoNode where it was split
	std::vector<std::uint32_t> before; ///< of each new slot: its old slot; kNoNode where it is new
	std::vector<std::uint8_t> wasMerged; ///< of each new slot
};

SlotChange compare( const Octree& octree, const Cut& from, const Cut& to )
{
	SlotChange change;
	change.now.assign( from.node.size(), kNoNode );
	change.before.assign( to.node.size(), kNoNode );
	change.wasMerged.assign( to.node.size(), 0 );
	std::size_t i = 0, j = 0;
	while ( i < from.node.size() )
	{
		const std::uint32_t old = from.node[i], now = to.node[j];
		const std::uint32_t oldEnd = octree.cellStart[old] + octree.cellCount[old], nowEnd = octree.cellStart[now] + octree.cellCount[now];
		if ( old == now )
		{
			change.now[i] = std::uint32_t( j );
			change.before[j] = std::uint32_t( i );
		}
		else if ( octree.cellCount[now] >= octree.cellCount[old] ) // taken in
		{
			change.now[i] = std::uint32_t( j );
			change.wasMerged[j] = 1;
		}
		i += oldEnd <= nowEnd ? 1 : 0;
		j += nowEnd <= oldEnd ? 1 : 0;
	}
	return change;
}

/// Makes the rows of a changed cut one after the other.
class Updater
{
public:
	Updater( const Octree& octree, const Cut& from, const RegionMatrix& matrix, const Cut& to, const FineRegions& fine ) :
		m_octree( octree ), m_from( from ), m_old( matrix ), m_to( to ), m_fine( fine ), m_change( compare( octree, from, to ) ), m_row( to.count() ),
		m_children( to.count() ), m_childRow( to.node.size(), kNoNode )
	{
		countNewRows();
	}

	RegionMatrix run()
	{
		RegionMatrix result;
		result.start.reserve( m_to.node.size() + 1 );
		result.start.push_back( 0 );
		result.member.reserve( m_old.member.size() + m_counted.member.size() );
		result.mass.reserve( result.member.capacity() );
		result.share.reserve( result.member.capacity() );
		std::uint32_t firstOld = 0;
		for ( std::uint32_t slot = 0; slot < std::uint32_t( m_to.count() ); ++slot )
		{
			if ( m_childRow[slot] != kNoNode )
			{
				appendCounted( slot, result );
				continue;
			}
			if ( !appendRenumbered( slot, result ) )
			{
				takeOld( slot, firstOld );
				m_row.appendTo( result );
			}
		}
		weighUnits( m_octree, m_to, result );
		return result;
	}

private:
	bool isCounted( std::uint32_t slot ) const { return m_change.before[slot] == kNoNode && m_change.wasMerged[slot] == 0; }

	void countNewRows()
	{
		m_counted.start.push_back( 0 );
		for ( std::uint32_t slot = 0; slot < std::uint32_t( m_to.count() ); ++slot )
		{
			if ( isCounted( slot ) )
			{
				m_childRow[slot] = std::uint32_t( m_counted.count() );
				countFromCells( m_octree, m_to, m_fine, slot, m_children );
				m_children.appendTo( m_counted );
			}
		}
		listChildren();
	}

	/// For each old node that was split: the slots of its children.
	void listChildren()
	{
		m_childStart.assign( m_from.node.size() + 1, 0 );
		for ( std::uint32_t slot = 0; slot < std::uint32_t( m_to.count() ); ++slot )
		{
			if ( isCounted( slot ) )
			{
				const std::uint32_t cell = m_octree.cells[m_octree.cellStart[m_to.node[slot]]];
				++m_childStart[m_from.slotOfCell[cell] + 1];
				m_childSlot.push_back( slot ); // ascending in both: the order is depth-first
			}
		}
		for ( std::size_t i = 1; i < m_childStart.size(); ++i )
		{
			m_childStart[i] += m_childStart[i - 1];
		}
	}

	void appendCounted( std::uint32_t slot, RegionMatrix& result ) const
	{
		const std::uint32_t first = m_counted.start[m_childRow[slot]], last = m_counted.start[m_childRow[slot] + 1];
		result.member.insert( result.member.end(), m_counted.member.begin() + first, m_counted.member.begin() + last );
		result.mass.insert( result.mass.end(), m_counted.mass.begin() + first, m_counted.mass.begin() + last );
		result.share.insert( result.share.end(), m_counted.share.begin() + first, m_counted.share.begin() + last );
		result.start.push_back( std::uint32_t( result.member.size() ) );
	}

	/// Most rows keep all their members under other numbers, which rise as the old ones did. False, and nothing done, for the others.
	bool appendRenumbered( std::uint32_t slot, RegionMatrix& result ) const
	{
		const std::uint32_t old = m_change.before[slot];
		if ( old == kNoNode )
		{
			return false;
		}
		const std::uint32_t first = m_old.start[old], last = m_old.start[old + 1];
		const std::size_t from = result.member.size();
		result.member.resize( from + ( last - first ) );
		for ( std::uint32_t k = first; k < last; ++k )
		{
			const std::uint32_t now = m_change.now[m_old.member[k]];
			if ( now == kNoNode || m_change.wasMerged[now] != 0 )
			{
				result.member.resize( from );
				return false;
			}
			result.member[from + ( k - first )] = now;
		}
		result.mass.insert( result.mass.end(), m_old.mass.begin() + first, m_old.mass.begin() + last );
		result.share.insert( result.share.end(), m_old.share.begin() + first, m_old.share.begin() + last );
		result.start.push_back( std::uint32_t( result.member.size() ) );
		return true;
	}

	/// Rows of nodes that stayed or were merged: sums of the old rows. Where a member was split, its children's own rows hold what they
	/// and this node have in common, with row and column swapped.
	void takeOld( std::uint32_t slot, std::uint32_t& firstOld )
	{
		while ( firstOld < m_change.now.size() && m_change.now[firstOld] != slot )
		{
			++firstOld;
		}
		for ( ; firstOld < m_change.now.size() && m_change.now[firstOld] == slot; ++firstOld )
		{
			for ( std::uint32_t k = m_old.start[firstOld]; k < m_old.start[firstOld + 1]; ++k )
			{
				const std::uint32_t member = m_old.member[k];
				if ( m_change.now[member] != kNoNode )
				{
					m_row.add( m_change.now[member], m_old.mass[k], m_old.share[k] );
					continue;
				}
				for ( std::uint32_t c = m_childStart[member]; c < m_childStart[member + 1]; ++c )
				{
					takeFromChild( slot, m_childSlot[c] );
				}
			}
		}
	}

	void takeFromChild( std::uint32_t slot, std::uint32_t child )
	{
		const std::uint32_t r = m_childRow[child];
		const auto first = m_counted.member.begin() + m_counted.start[r], last = m_counted.member.begin() + m_counted.start[r + 1];
		const auto found = std::lower_bound( first, last, slot );
		if ( found != last && *found == slot )
		{
			const std::size_t k = std::size_t( found - m_counted.member.begin() );
			m_row.set( child, m_counted.share[k], m_counted.mass[k] );
		}
	}

	const Octree& m_octree;
	const Cut& m_from;
	const RegionMatrix& m_old;
	const Cut& m_to;
	const FineRegions& m_fine;
	SlotChange m_change;
	Row m_row, m_children;
	RegionMatrix m_counted;                ///< rows of the nodes that splits brought
	std::vector<std::uint32_t> m_childRow; ///< of each new slot: its row there, or kNoNode
	std::vector<std::uint32_t> m_childStart, m_childSlot;
};

} // namespace

FineRegions buildFineRegions( const Lattice& lattice, int halfWidth )
{
	FineRegions fine;
	fine.set = buildRegions( lattice, halfWidth );
	fine.mass.reserve( lattice.fill.size() );
	for ( int c = 0; c < lattice.cellCount(); ++c )
	{
		fine.mass.push_back( inUnits( double( lattice.fill[c] ) / fine.set.size[c] ) );
	}
	return fine;
}

void weighUnits( const Octree& octree, const Cut& cut, RegionMatrix& matrix )
{
	matrix.unit.resize( cut.node.size() );
	for ( int a = 0; a < cut.count(); ++a )
	{
		std::uint64_t sum = 0;
		for ( std::uint32_t k = matrix.start[a]; k < matrix.start[a + 1]; ++k )
		{
			sum += matrix.share[k];
		}
		matrix.unit[a] = octree.mass[cut.node[a]] / double( sum );
	}
}

RegionMatrix buildMultiplicityRegions( const Octree& octree, const Cut& cut, const FineRegions& fine )
{
	RegionMatrix matrix;
	matrix.start.push_back( 0 );
	Row row( cut.count() );
	for ( std::uint32_t slot = 0; slot < std::uint32_t( cut.count() ); ++slot )
	{
		countFromCells( octree, cut, fine, slot, row );
		row.appendTo( matrix );
	}
	weighUnits( octree, cut, matrix );
	return matrix;
}

RegionMatrix updateMultiplicityRegions( const Octree& octree, const Cut& from, const RegionMatrix& matrix, const Cut& to, const FineRegions& fine )
{
	return Updater( octree, from, matrix, to, fine ).run();
}

namespace {

/// The unions as a pattern: rows, the mass m( a, r ) of each member in each, and W_a = sum over r of m_r m( a, r ) / m_a. Full cells.
struct UnionPattern
{
	RegionMatrix matrix; ///< start and member only
	std::vector<double> value, cover;
};

UnionPattern findUnions( const Octree& octree, const Cut& cut, const FineRegions& fine )
{
	// Each cell counts once, however many of the fine regions under r hold it.
	const std::uint32_t count = std::uint32_t( cut.count() );
	UnionPattern pattern;
	pattern.matrix.start.push_back( 0 );
	pattern.cover.assign( count, 0.0 );
	std::vector<std::uint32_t> seenBy( octree.cells.size(), kNoNode ), members;
	std::vector<double> covered( count, 0.0 );
	for ( std::uint32_t r = 0; r < count; ++r )
	{
		const std::uint32_t node = cut.node[r];
		members.clear();
		for ( std::uint32_t k = octree.cellStart[node]; k < octree.cellStart[node] + octree.cellCount[node]; ++k )
		{
			for ( std::uint32_t m = fine.set.start[octree.cells[k]]; m < fine.set.start[octree.cells[k] + 1]; ++m )
			{
				const std::uint32_t cell = fine.set.member[m], slot = cut.slotOfCell[cell];
				if ( seenBy[cell] == r )
				{
					continue;
				}
				seenBy[cell] = r;
				if ( covered[slot] == 0.0 )
				{
					members.push_back( slot );
				}
				covered[slot] += octree.mass[cell]; // node i of level 0 is cell i
			}
		}
		std::sort( members.begin(), members.end() );
		for ( const std::uint32_t a : members )
		{
			pattern.matrix.member.push_back( a );
			pattern.value.push_back( covered[a] );
			pattern.cover[a] += octree.mass[node] * covered[a] / octree.mass[cut.node[a]];
			covered[a] = 0.0;
		}
		pattern.matrix.start.push_back( std::uint32_t( pattern.matrix.member.size() ) );
	}
	return pattern;
}

} // namespace

RegionMatrix buildUnionRegions( const Octree& octree, const Cut& cut, const FineRegions& fine, UnionWeights weights )
{
	const std::uint32_t count = std::uint32_t( cut.count() );
	UnionPattern pattern = findUnions( octree, cut, fine );
	RegionMatrix& matrix = pattern.matrix;
	matrix.mass.resize( matrix.member.size() );
	matrix.share.resize( matrix.member.size() );
	for ( std::uint32_t r = 0; r < count; ++r )
	{
		const double ofRegion = octree.mass[cut.node[r]];
		for ( std::uint32_t k = matrix.start[r]; k < matrix.start[r + 1]; ++k )
		{
			const std::uint32_t a = matrix.member[k];
			const auto first = matrix.member.begin() + matrix.start[a], last = matrix.member.begin() + matrix.start[a + 1];
			const std::size_t back = std::size_t( std::lower_bound( first, last, r ) - matrix.member.begin() ); // symmetric: it is there
			if ( weights == UnionWeights::Conserving )
			{
				matrix.mass[k] = inUnits( ofRegion * pattern.value[k] / pattern.cover[a] );
				matrix.share[back] = matrix.mass[k];
			}
			else
			{
				matrix.mass[k] = inUnits( pattern.value[k] );
				matrix.share[back] = inUnits( ofRegion * pattern.value[k] / octree.mass[cut.node[a]] );
			}
		}
	}
	matrix.unit.assign( count, kMassUnit );
	if ( weights == UnionWeights::Conserving )
	{
		weighUnits( octree, cut, matrix );
	}
	return std::move( pattern.matrix );
}

} // namespace pliant
