#include "adapt/regions/region_matrix.h"

#include "adapt/regions/slot_change.h"
#include "lattice/table.h"

#include <algorithm>

namespace pliant {

namespace {

/// One row under construction: sums by slot, and the slots with any.
class Row
{
public:
	explicit Row( int slots ) : m_sum( static_cast<std::size_t>( slots ) ) {}

	/// Fractions are at least 1: a slot with 0 is not listed yet.
	void add( std::uint32_t slot, std::uint32_t mass, std::uint32_t fraction )
	{
		Entry& entry = m_sum[slot];
		if ( entry.fraction == 0 )
		{
			m_members.push_back( slot );
		}
		entry.mass += mass;
		entry.fraction += fraction;
	}

	/// Appends the row to the matrix, ascending, and clears it.
	void appendTo( RegionMatrix& matrix )
	{
		std::sort( m_members.begin(), m_members.end() );
		for ( const std::uint32_t slot : m_members )
		{
			matrix.member.push_back( slot );
			matrix.mass.push_back( m_sum[slot].mass );
			matrix.fraction.push_back( m_sum[slot].fraction );
			m_sum[slot] = Entry{};
		}
		m_members.clear();
		matrix.start.push_back( std::uint32_t( matrix.member.size() ) );
	}

private:
	struct Entry
	{
		std::uint32_t mass = 0, fraction = 0;
	};

	std::vector<Entry> m_sum;
	std::vector<std::uint32_t> m_members;
};

/// u( a, r ) = sum over cells c under a and fine regions f under r with c in f of m_c / n_c. Membership is symmetric: one traversal of the
/// cells of the fine regions under a node yields both its row (the members of its region) and its column (the regions that hold it).
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

/// The weight of one unit of a node's mass.
double unitOf( double mass, const RegionMatrix& matrix, std::uint32_t row )
{
	std::uint64_t sum = 0;
	for ( std::uint32_t k = matrix.start[row]; k < matrix.start[row + 1]; ++k )
	{
		sum += matrix.fraction[k];
	}
	return mass / double( sum );
}

/// Builds the rows of a changed cut: runs of untouched rows at once, the others one after the other.
class Updater
{
public:
	Updater( const Octree& octree, const RegionMatrix& matrix, const Cut& to, const FineRegions& fine, SlotChange change ) :
		m_octree( octree ), m_old( matrix ), m_to( to ), m_fine( fine ), m_change( std::move( change ) ), m_row( to.count() ),
		m_children( to.count() ), m_childRow( to.node.size(), kNoNode )
	{
		findUntouched();
		countNewRows();
	}

	RegionMatrix run( MatrixScratch* scratch )
	{
		RegionMatrix result;
		if ( scratch )
		{
			result = std::move( scratch->matrix );
		}
		clear( result );
		std::uint32_t firstOld = 0;
		const std::uint32_t count = std::uint32_t( m_to.count() );
		for ( std::uint32_t slot = 0; slot < count; )
		{
			if ( m_untouched[slot] != kNoNode )
			{
				std::uint32_t end = slot + 1;
				while ( end < count && m_untouched[end] == m_untouched[slot] + ( end - slot ) )
				{
					++end;
				}
				appendUntouched( slot, end, result );
				slot = end;
				continue;
			}
			if ( m_childRow[slot] != kNoNode )
			{
				appendCounted( slot, result );
			}
			else
			{
				appendChanged( slot, firstOld, result );
			}
			result.unit.push_back( unitOf( m_octree.mass[m_to.node[slot]], result, slot ) );
			++slot;
		}
		if ( scratch )
		{
			scratch->rowBefore = std::move( m_untouched );
		}
		return result;
	}

private:
	struct Entry
	{
		std::uint32_t slot, mass, fraction;
	};

	bool isCounted( std::uint32_t slot ) const { return m_change.before[slot] == kNoNode && m_change.wasMerged[slot] == 0; }

	void clear( RegionMatrix& result ) const
	{
		for ( std::vector<std::uint32_t>* array : { &result.start, &result.member, &result.mass, &result.fraction } )
		{
			array->clear();
		}
		result.unit.clear();
		result.start.reserve( m_to.node.size() + 1 );
		result.start.push_back( 0 );
		result.unit.reserve( m_to.node.size() );
		for ( std::vector<std::uint32_t>* array : { &result.member, &result.mass, &result.fraction } )
		{
			array->reserve( m_old.member.size() + m_counted.member.size() );
		}
	}

	/// Membership is symmetric: a changed node's row lists all nodes whose rows hold it.
	void findUntouched()
	{
		m_untouched = m_change.before;
		for ( std::uint32_t i = 0; i < std::uint32_t( m_old.count() ); ++i )
		{
			const std::uint32_t own = m_change.now[i];
			if ( own == kNoNode || m_change.wasMerged[own] != 0 )
			{
				touchMembers( i );
			}
		}
		const std::vector<std::uint32_t> moved = slotsOutOfOrder( m_change.now );
		m_isReordered.assign( moved.empty() ? 0 : m_to.node.size(), 0 );
		for ( const std::uint32_t i : moved )
		{
			touchMembers( i );
			for ( std::uint32_t k = m_old.start[i]; k < m_old.start[i + 1]; ++k )
			{
				if ( const std::uint32_t now = m_change.now[m_old.member[k]]; now != kNoNode )
				{
					m_isReordered[now] = 1;
				}
			}
		}
	}

	void touchMembers( std::uint32_t old )
	{
		for ( std::uint32_t k = m_old.start[old]; k < m_old.start[old + 1]; ++k )
		{
			if ( const std::uint32_t now = m_change.now[m_old.member[k]]; now != kNoNode )
			{
				m_untouched[now] = kNoNode;
			}
		}
	}

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
		listColumns();
	}

	/// For each slot that is not counted: its entries with the nodes created by splits, read from their rows, since membership is
	/// symmetric.
	void listColumns()
	{
		const auto forEntries = [this]( auto&& visit ) {
			for ( std::uint32_t child = 0; child < std::uint32_t( m_to.count() ); ++child )
			{
				const std::uint32_t r = m_childRow[child];
				for ( std::uint32_t k = r == kNoNode ? 0 : m_counted.start[r]; r != kNoNode && k < m_counted.start[r + 1]; ++k )
				{
					if ( const std::uint32_t slot = m_counted.member[k]; !isCounted( slot ) )
					{
						visit( slot, Entry{ child, m_counted.fraction[k], m_counted.mass[k] } ); // row and column swapped
					}
				}
			}
		};
		sortIntoRows( m_to.node.size(), forEntries, m_columnStart, m_column );
	}

	void appendCounted( std::uint32_t slot, RegionMatrix& result ) const
	{
		const std::uint32_t first = m_counted.start[m_childRow[slot]], last = m_counted.start[m_childRow[slot] + 1];
		appendEntries( m_counted, first, last, result );
		result.start.push_back( std::uint32_t( result.member.size() ) );
	}

	static void appendEntries( const RegionMatrix& of, std::uint32_t first, std::uint32_t last, RegionMatrix& result )
	{
		result.member.insert( result.member.end(), of.member.begin() + first, of.member.begin() + last );
		result.mass.insert( result.mass.end(), of.mass.begin() + first, of.mass.begin() + last );
		result.fraction.insert( result.fraction.end(), of.fraction.begin() + first, of.fraction.begin() + last );
	}

	/// Appends rows that keep all their members, under new numbers in the old order.
	void appendUntouched( std::uint32_t slot, std::uint32_t end, RegionMatrix& result ) const
	{
		const std::uint32_t old = m_untouched[slot], oldEnd = old + ( end - slot );
		const std::uint32_t first = m_old.start[old], to = std::uint32_t( result.member.size() );
		appendEntries( m_old, first, m_old.start[oldEnd], result );
		std::uint32_t* const member = result.member.data();
		for ( std::size_t k = to; k < result.member.size(); ++k )
		{
			member[k] = m_change.now[member[k]];
		}
		for ( std::uint32_t r = old; r < oldEnd; ++r )
		{
			result.start.push_back( m_old.start[r + 1] - first + to );
		}
		result.unit.insert( result.unit.end(), m_old.unit.begin() + old, m_old.unit.begin() + oldEnd );
	}

	/// Appends rows of kept or merged nodes: sums of the old rows. Where a member was split, its children's entries are in the column.
	void appendChanged( std::uint32_t slot, std::uint32_t& firstOld, RegionMatrix& result )
	{
		const Entry* next = m_column.data() + m_columnStart[slot];
		const Entry* const last = m_column.data() + m_columnStart[slot + 1];
		const bool wasMerged = m_change.wasMerged[slot] != 0;
		if ( !wasMerged && ( m_isReordered.empty() || m_isReordered[slot] == 0 ) )
		{
			appendMerged( m_change.before[slot], next, last, result );
			return;
		}
		if ( !wasMerged )
		{
			addRow( m_change.before[slot] );
		}
		for ( ; wasMerged && m_change.now[firstOld] != slot; ++firstOld )
		{}
		for ( ; wasMerged && firstOld < m_change.now.size() && m_change.now[firstOld] == slot; ++firstOld )
		{
			addRow( firstOld );
		}
		for ( ; next != last; ++next )
		{
			m_row.add( next->slot, next->mass, next->fraction );
		}
		m_row.appendTo( result );
	}

	void addRow( std::uint32_t old )
	{
		for ( std::uint32_t k = m_old.start[old]; k < m_old.start[old + 1]; ++k )
		{
			if ( const std::uint32_t now = m_change.now[m_old.member[k]]; now != kNoNode )
			{
				m_row.add( now, m_old.mass[k], m_old.fraction[k] );
			}
		}
	}

	/// New numbers are in the order of the old ones, equal where members were merged; children are inserted at their parent's position.
	void appendMerged( std::uint32_t old, const Entry* next, const Entry* last, RegionMatrix& result ) const
	{
		const std::size_t first = result.member.size();
		const auto append = [&result]( const Entry& entry ) {
			result.member.push_back( entry.slot );
			result.mass.push_back( entry.mass );
			result.fraction.push_back( entry.fraction );
		};
		for ( std::uint32_t k = m_old.start[old]; k < m_old.start[old + 1]; ++k )
		{
			const std::uint32_t now = m_change.now[m_old.member[k]];
			if ( now == kNoNode )
			{
				continue;
			}
			for ( ; next != last && next->slot < now; ++next )
			{
				append( *next );
			}
			if ( result.member.size() > first && result.member.back() == now )
			{
				result.mass.back() += m_old.mass[k];
				result.fraction.back() += m_old.fraction[k];
				continue;
			}
			append( Entry{ now, m_old.mass[k], m_old.fraction[k] } );
		}
		for ( ; next != last; ++next )
		{
			append( *next );
		}
		result.start.push_back( std::uint32_t( result.member.size() ) );
	}

	const Octree& m_octree;
	const RegionMatrix& m_old;
	const Cut& m_to;
	const FineRegions& m_fine;
	SlotChange m_change;
	Row m_row, m_children;
	RegionMatrix m_counted;                   ///< rows of the nodes created by splits
	std::vector<std::uint32_t> m_childRow;    ///< of each new slot: its row there, or kNoNode
	std::vector<std::uint32_t> m_untouched;   ///< of each new slot: its old one, where its row is only renumbered
	std::vector<std::uint8_t> m_isReordered;  ///< of each new slot: 1 where the members of its row change order; empty: none do
	std::vector<std::uint32_t> m_columnStart; ///< of each new slot
	std::vector<Entry> m_column;              ///< ascending by slot
};

} // namespace

FineRegions buildFineRegions( const Lattice& lattice, int halfWidth )
{
	FineRegions fine;
	fine.set = buildRegions( lattice, halfWidth );
	fine.mass.reserve( lattice.fill.size() );
	for ( int c = 0; c < lattice.cellCount(); ++c )
	{
		fine.mass.push_back( inMassUnits( double( lattice.fill[c] ) / fine.set.size[c] ) );
	}
	return fine;
}

void weighUnits( const Octree& octree, const Cut& cut, RegionMatrix& matrix )
{
	matrix.unit.resize( cut.node.size() );
	for ( std::uint32_t a = 0; a < std::uint32_t( cut.count() ); ++a )
	{
		matrix.unit[a] = unitOf( octree.mass[cut.node[a]], matrix, a );
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

RegionMatrix updateMultiplicityRegions(
	const Octree& octree, const Cut& from, const RegionMatrix& matrix, const Cut& to, const FineRegions& fine, MatrixScratch* scratch )
{
	return Updater( octree, matrix, to, fine, slotChange( octree, from, to ) ).run( scratch );
}

RegionMatrix updateRelinkedRegions( const Octree& octree, const Cut& cut, const FineRegions& fine, const RegionMatrix& matrix,
	const RelinkedNodes& nodes, MatrixScratch* scratch )
{
	return Updater( octree, matrix, cut, fine, slotChange( nodes ) ).run( scratch );
}

} // namespace pliant
