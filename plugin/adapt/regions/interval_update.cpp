#include "adapt/octree/bucket_moore.h"
#include "adapt/regions/interval_search.h"
#include "lattice/table.h"

namespace pliant {

namespace {

/// Returns the new slots and the kept ones that must be searched again.
std::vector<std::uint32_t> slotsToSearch( const IntervalInput& from, const IntervalInput& to, const CutChange& change,
	const IntervalRegions& old, const IntervalRegions& regions )
{
	const std::vector<std::uint32_t>& before = change.before;
	const std::vector<std::uint32_t>& after = change.after;
	std::vector<std::uint8_t> isDirty( before.size(), 0 );
	std::vector<std::uint32_t> removed, added;
	for ( std::uint32_t slot = 0; slot < std::uint32_t( after.size() ); ++slot )
	{
		if ( after[slot] == kNoNode )
		{
			removed.push_back( slot );
		}
	}
	std::uint32_t limit = 0;
	for ( std::uint32_t slot = 0; slot < std::uint32_t( before.size() ); ++slot )
	{
		if ( before[slot] == kNoNode )
		{
			added.push_back( slot );
		}
		isDirty[slot] = before[slot] == kNoNode || old.width[before[slot]] != regions.width[slot];
		limit = std::max( limit, limitOf( regions.width[slot], regions.eps ) );
	}
	for ( const std::uint32_t width : old.width )
	{
		limit = std::max( limit, limitOf( width, old.eps ) );
	}
	BucketMoore search;
	for ( const BucketMoore::Reached& r : search.fromAll( from.graph, removed, limit ) )
	{
		if ( after[r.node] != kNoNode && r.distance < limitOf( old.width[r.node], old.eps ) )
		{
			isDirty[after[r.node]] = 1;
		}
	}
	for ( const BucketMoore::Reached& r : search.fromAll( to.graph, added, limit ) )
	{
		isDirty[r.node] |= r.distance < limitOf( regions.width[r.node], regions.eps );
	}
	std::vector<std::uint32_t> slots;
	for ( std::uint32_t slot = 0; slot < std::uint32_t( isDirty.size() ); ++slot )
	{
		if ( isDirty[slot] != 0 )
		{
			slots.push_back( slot );
		}
	}
	return slots;
}

/// Step 3 for the rows that may have changed; all others are copied.
class SymmetryUpdate
{
public:
	SymmetryUpdate(
		const IntervalInput& from, const IntervalInput& to, const CutChange& change, const IntervalRegions& old, IntervalUpdate& update ) :
		m_to( to ),
		m_spans( slotSpans( to.octree, to.cut ) ), m_oldSpans( slotSpans( from.octree, from.cut ) ),
		m_collectedFor( change.before.size(), kNoNode ), m_change( change ), m_old( old ), m_regions( update.regions ),
		m_isSearched( change.before.size(), 0 ), m_isAffected( change.before.size(), 0 )
	{
		for ( const std::uint32_t slot : update.searched )
		{
			m_isSearched[slot] = m_isAffected[slot] = 1;
		}
		findAffected();
		listHolders( update.searched );
	}

	void run()
	{
		Cover cover( m_to.octree );
		m_regions.start.assign( 1, 0 );
		m_regions.node.reserve( m_old.node.size() );
		for ( std::uint32_t slot = 0; slot < std::uint32_t( m_isAffected.size() ); ++slot )
		{
			if ( m_isAffected[slot] == 0 )
			{
				copyRow( m_old.node, m_old.start, m_change.before[slot] );
			}
			else
			{
				const std::size_t members = collect( slot );
				if ( m_both.size() == members )
				{
					copyRow( m_regions.own, m_regions.ownStart, slot );
				}
				else
				{
					appendLargest( m_to, m_both, cover, m_regions.node );
				}
			}
			m_regions.start.push_back( std::uint32_t( m_regions.node.size() ) );
		}
	}

private:
	template <class F>
	static void forEachSlot( const std::vector<SlotSpan>& spans, const std::uint32_t* node, const std::uint32_t* end, const F& visit )
	{
		for ( ; node != end; ++node )
		{
			for ( std::uint32_t slot = spans[*node].first; slot < spans[*node].end; ++slot )
			{
				visit( slot );
			}
		}
	}

	template <class F>
	void forEachOwn( std::uint32_t slot, const F& visit ) const
	{
		const std::uint32_t* const own = m_regions.own.data();
		forEachSlot( m_spans, own + m_regions.ownStart[slot], own + m_regions.ownStart[slot + 1], visit );
	}

	/// Marks the members of rows that were removed or searched again.
	void findAffected()
	{
		for ( std::uint32_t before = 0; before < std::uint32_t( m_change.after.size() ); ++before )
		{
			const std::uint32_t now = m_change.after[before];
			if ( now != kNoNode && m_isSearched[now] == 0 )
			{
				continue;
			}
			const std::uint32_t* const own = m_old.own.data();
			forEachSlot( m_oldSpans, own + m_old.ownStart[before], own + m_old.ownStart[before + 1], [this]( std::uint32_t slot ) {
				if ( m_change.after[slot] != kNoNode )
				{
					m_isAffected[m_change.after[slot]] = 1;
				}
			} );
		}
	}

	/// Lists, for each slot, the searched slots whose rows hold it now, and marks it as affected.
	void listHolders( const std::vector<std::uint32_t>& searched )
	{
		const auto forHeld = [&]( auto&& visit ) {
			for ( const std::uint32_t holder : searched )
			{
				forEachOwn( holder, [&]( std::uint32_t slot ) {
					m_isAffected[slot] = 1;
					visit( slot, holder );
				} );
			}
		};
		sortIntoRows( m_isAffected.size(), forHeld, m_heldStart, m_heldBy );
	}

	/// Collects the union of a slot's row and column, ascending; returns the size of the row alone.
	std::size_t collect( std::uint32_t slot )
	{
		m_both.clear();
		forEachOwn( slot, [this, slot]( std::uint32_t member ) {
			m_collectedFor[member] = slot;
			m_both.push_back( member );
		} );
		const std::size_t members = m_both.size();
		const auto addOther = [this, slot]( std::uint32_t other ) {
			if ( std::exchange( m_collectedFor[other], slot ) != slot )
			{
				m_both.push_back( other );
			}
		};
		std::for_each( m_heldBy.begin() + m_heldStart[slot], m_heldBy.begin() + m_heldStart[slot + 1], addOther );
		// Rows that were not searched hold the slot now only if they held it before, so its old row lists them all.
		if ( const std::uint32_t before = m_change.before[slot]; before != kNoNode )
		{
			const std::uint32_t* const row = m_old.node.data();
			forEachSlot( m_oldSpans, row + m_old.start[before], row + m_old.start[before + 1], [&]( std::uint32_t other ) {
				const std::uint32_t now = m_change.after[other];
				if ( now != kNoNode && m_isSearched[now] == 0 && m_collectedFor[now] != slot && holds( now, slot ) )
				{
					addOther( now );
				}
			} );
		}
		if ( m_both.size() != members )
		{
			std::sort( m_both.begin(), m_both.end() );
		}
		return members;
	}

	/// True where the own row of one slot holds another: tests the last of its nodes that starts at or before it.
	bool holds( std::uint32_t holder, std::uint32_t slot ) const
	{
		const auto first = m_regions.own.begin() + m_regions.ownStart[holder], end = m_regions.own.begin() + m_regions.ownStart[holder + 1];
		const auto after = std::upper_bound(
			first, end, slot, [this]( std::uint32_t s, std::uint32_t node ) { return s < m_spans[node].first; } );
		return after != first && slot < m_spans[*( after - 1 )].end;
	}

	void copyRow( const std::vector<std::uint32_t>& list, const std::vector<std::uint32_t>& start, std::uint32_t row )
	{
		m_regions.node.insert( m_regions.node.end(), list.begin() + start[row], list.begin() + start[row + 1] );
	}

	const IntervalInput& m_to;
	std::vector<SlotSpan> m_spans, m_oldSpans;
	std::vector<std::uint32_t> m_collectedFor; ///< of each slot: the last slot for which it was collected
	const CutChange& m_change;
	const IntervalRegions& m_old;
	IntervalRegions& m_regions;
	std::vector<std::uint8_t> m_isSearched, m_isAffected;
	std::vector<std::uint32_t> m_heldStart, m_heldBy;
	std::vector<std::uint32_t> m_both;
};

} // namespace

IntervalUpdate updateIntervalRegions( const IntervalInput& from, const IntervalInput& to, const CutChange& change,
	const IntervalRegions& old, std::vector<std::uint32_t> width, TaskRunner* runner )
{
	IntervalUpdate update;
	IntervalRegions& regions = update.regions;
	regions.eps = old.eps;
	regions.width = std::move( width );
	update.searched = slotsToSearch( from, to, change, old, regions );
	const Rows rows = searchRows( to, regions, update.searched, runner );
	regions.ownStart.assign( 1, 0 );
	std::size_t next = 0;
	for ( std::uint32_t slot = 0; slot < std::uint32_t( to.cut.count() ); ++slot )
	{
		// Octree nodes keep their ids, so rows that were not searched again are copied.
		const bool wasSearched = next < update.searched.size() && update.searched[next] == slot;
		const std::size_t row = wasSearched ? next++ : change.before[slot];
		const std::vector<std::uint32_t>& start = wasSearched ? rows.start : old.ownStart;
		const std::vector<std::uint32_t>& entry = wasSearched ? rows.entry : old.own;
		regions.own.insert( regions.own.end(), entry.begin() + start[row], entry.begin() + start[row + 1] );
		regions.ownStart.push_back( std::uint32_t( regions.own.size() ) );
	}
	SymmetryUpdate( from, to, change, old, update ).run();
	return update;
}

} // namespace pliant
