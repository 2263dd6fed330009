#include "body/levels.h"

#include "body/level_nodes.h"

#include "matching/lattice_matcher.h"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>

namespace pliant {

namespace {

/// How much of what splits it a node is strained by; limits at 0 do not count. Largest | s - 1 | over the singular values s of F lies between the
/// root of a third of their squares' sum and the root of it.
float loadOf( float squares, float strainLimit, float stretch, float stretchLimit )
{
	const float strained = strainLimit > 0.0f ? std::sqrt( squares ) / strainLimit : 0.0f;
	return stretchLimit > 0.0f ? std::max( strained, stretch / stretchLimit ) : strained;
}

} // namespace

Levels::Levels( std::shared_ptr<const LevelBase> base, const Lattice& lattice, const Material& material, const Adaptivity& settings,
	const std::vector<float>& stiffness, Cut cut ) :
	Levels( std::move( base ), lattice, settings, stiffness, std::move( cut ), {}, nullptr )
{
	m_regions = buildLevelRegions( *m_base, lattice, m_cut, material, settings );
	m_tables = buildLevelTables( *m_base, lattice, m_cut, m_regions, LevelSettings{ material, m_settings, stiffness } );
	prepareRoom();
}

Levels::Levels( std::shared_ptr<const LevelBase> base, const Lattice& lattice, const Adaptivity& settings, const std::vector<float>& stiffness, Cut cut,
	LevelRegions regions, std::shared_ptr<const RegionTables> tables ) :
	m_base( std::move( base ) ), m_lattice( &lattice ), m_settings( settings ), m_stiffness( &stiffness ), m_cut( std::move( cut ) ),
	m_regions( std::move( regions ) ), m_tables( std::move( tables ) ), m_quiet( m_cut.node.size(), 0.0f ), m_isWanted( m_cut.node.size(), 0 )
{
	countLevels();
	countRoom();
	for ( const std::uint32_t slot : m_cut.slotOfCell )
	{
		m_coarsest.push_back( std::uint8_t( levelOf( int( slot ) ) ) );
	}
}

void Levels::countLevels()
{
	m_nodesOnLevel.fill( 0 );
	for ( int i = 0; i < m_cut.count(); ++i )
	{
		++m_nodesOnLevel[std::size_t( levelOf( i ) )];
	}
}

void Levels::fillNodes( NodeState& nodes, float density ) const
{
	for ( AlignedArray<float>* array : arraysOf( nodes ) )
	{
		makeRoom( *array, std::size_t( m_hasRoom ? m_room.count : 0 ), 0 );
	}
	resizeNodes( nodes, m_cut.count() );
	const double fullCell = double( density ) * std::pow( double( m_lattice->cellSize ), 3 );
	for ( int i = 0; i < nodes.count; ++i )
	{
		nodes.x0.set( i, octree().restCentre[m_cut.node[i]] );
		nodes.mass[i] = float( fullCell * octree().mass[m_cut.node[i]] );
		nodes.freedom[i] = 1.0f;
	}
}

void Levels::requestSplit( int node )
{
	keep( node );
	if ( levelOf( node ) > m_finestLevel )
	{
		m_asked.push_back( m_cut.node[node] );
	}
}

void Levels::hold( int node )
{
	m_heldOn.resize( std::size_t( m_lattice->cellCount() ), 0 );
	const std::uint32_t held = m_cut.node[node], first = octree().cellStart[held];
	for ( std::uint32_t k = first; k < first + octree().cellCount[held]; ++k )
	{
		m_heldOn[octree().cells[k]] = std::uint8_t( levelOf( node ) );
	}
}

/// Whether each of its cells was held by a node at least as big, while it was held last.
bool Levels::isHeldAsOne( std::uint32_t node ) const
{
	const auto first = octree().cells.begin() + octree().cellStart[node];
	return !m_heldOn.empty() && std::all_of( first, first + octree().cellCount[node],
									[&]( std::uint32_t cell ) { return int( m_heldOn[cell] ) >= octree().levelOf( node ); } );
}

void Levels::measureLoads( const AlignedArray<float>& strain, const AlignedArray<float>& stretch )
{
	m_load.clear();
	for ( std::size_t i = 0; followsStrain() && !stretch.empty() && i < m_cut.node.size(); ++i )
	{
		m_load.push_back( loadOf( strain[i], m_settings.refineStrain, stretch[i], m_refineStretch ) );
	}
}

bool Levels::review( const NodeState& nodes, const AlignedArray<float>& strain, const AlignedArray<float>& stretch, float seconds )
{
	m_split.clear();
	m_merge.clear();
	measureLoads( strain, stretch );
	for ( int i = 0; i < m_cut.count() && !( followsStrain() && m_load.empty() ); ++i )
	{
		const bool isQuiet = !followsStrain() || m_load[std::size_t( i )] < m_settings.mergeShare;
		m_quiet[i] = isQuiet && m_isWanted[i] == 0 ? m_quiet[i] + seconds : 0.0f;
	}
	collectSplits();
	collectMerges( nodes );
	gatherMerges( seconds );
	std::fill( m_isWanted.begin(), m_isWanted.end(), std::uint8_t( 0 ) );
	return !m_split.empty() || !m_merge.empty();
}

// Above the threshold; and, where nodes are to be split together, all that hang together with such a one and are nearly as strained.
std::vector<std::uint8_t> Levels::strainedNodes() const
{
	std::vector<std::uint8_t> isStrained;
	if ( m_load.empty() )
	{
		return isStrained;
	}
	isStrained.resize( std::size_t( m_cut.count() ) );
	std::vector<std::uint32_t> front;
	for ( std::uint32_t i = 0; i < std::uint32_t( m_cut.count() ); ++i )
	{
		isStrained[i] = m_load[i] > 1.0f ? 1 : 0;
		if ( isStrained[i] != 0 && m_together < 1.0f && octree().levelOf( m_cut.node[i] ) > m_finestLevel )
		{
			front.push_back( i );
		}
	}
	while ( !front.empty() )
	{
		const std::uint32_t node = front.back();
		front.pop_back();
		for ( std::uint32_t k = matrix().start[node]; k < matrix().start[node + 1]; ++k )
		{
			const std::uint32_t to = matrix().member[k];
			if ( isStrained[to] == 0 && m_load[to] > m_together )
			{
				isStrained[to] = 1;
				front.push_back( to );
			}
		}
	}
	return isStrained;
}

void Levels::collectSplits()
{
	// What was asked for comes first, then what only the finest level allowed had kept merged, then the most strained.
	constexpr float kAsked = -std::numeric_limits<float>::infinity(), kTooBig = -std::numeric_limits<float>::max();
	std::vector<std::pair<float, std::uint32_t>> wanted;
	std::sort( m_asked.begin(), m_asked.end() );
	std::vector<std::uint32_t> waiting;
	const std::vector<std::uint8_t> isStrained = strainedNodes();
	for ( int i = 0; i < m_cut.count(); ++i )
	{
		const std::uint32_t node = m_cut.node[i];
		const int level = octree().levelOf( node );
		if ( level <= m_finestLevel )
		{
			continue;
		}
		if ( std::binary_search( m_asked.begin(), m_asked.end(), node ) )
		{
			wanted.emplace_back( kAsked, node );
			waiting.push_back( node );
		}
		else if ( isTooBig( node ) )
		{
			wanted.emplace_back( kTooBig, node );
		}
		else if ( !isStrained.empty() && isStrained[std::size_t( i )] != 0 )
		{
			wanted.emplace_back( -m_load[std::size_t( i )], node );
		}
	}
	std::stable_sort( wanted.begin(), wanted.end(), []( const auto& a, const auto& b ) { return a.first < b.first; } );
	int left = m_budget == kNoBudget ? m_settings.nodesPerStep : m_budget;
	m_hasBacklog = false;
	for ( const auto& [order, node] : wanted )
	{
		const int children = int( octree().childStart[node + 1] - octree().childStart[node] );
		m_hasBacklog = children > left;
		if ( m_hasBacklog )
		{
			left = 0; // what waits, waits together: a second change for a few nodes would cost nearly as much as one for all
			break;
		}
		left -= children;
		m_split.push_back( node );
	}
	m_budget = m_budget == kNoBudget ? kNoBudget : left;
	std::sort( m_split.begin(), m_split.end() );
	const auto isDone = [this]( std::uint32_t node ) { return std::binary_search( m_split.begin(), m_split.end(), node ); };
	waiting.erase( std::remove_if( waiting.begin(), waiting.end(), isDone ), waiting.end() );
	m_asked = std::move( waiting ); // each once, and only what is there: requests come again and again
}

bool Levels::mayMerge( const NodeState& nodes, std::uint32_t parent, int firstSlot ) const
{
	const Octree& tree = octree();
	const std::uint32_t children = tree.childStart[parent + 1] - tree.childStart[parent];
	if ( std::size_t( firstSlot ) + children > m_cut.node.size() )
	{
		return false;
	}
	const bool isFiner = tree.levelOf( parent ) <= m_finestLevel, isHeld = nodes.freedom[firstSlot] == 0.0f;
	for ( std::uint32_t k = 0; k < children; ++k )
	{
		const std::size_t slot = std::size_t( firstSlot ) + k;
		const bool isThere = m_cut.node[slot] == tree.child[tree.childStart[parent] + k];
		const bool isQuiet = isFiner || ( m_quiet[slot] > 0.0f && m_quiet[slot] >= m_settings.mergeDelay );
		const bool isAlike = ( nodes.freedom[slot] == 0.0f ) == isHeld; // a pin holds one node, not what surrounds it
		if ( !isThere || !isQuiet || !isAlike || std::binary_search( m_split.begin(), m_split.end(), m_cut.node[slot] ) )
		{
			return false;
		}
	}
	return ( isFiner || !isTooBig( parent ) ) && ( !isHeld || isHeldAsOne( parent ) );
}

void Levels::collectMerges( const NodeState& nodes )
{
	for ( int i = 0; i < m_cut.count(); ++i )
	{
		const std::uint32_t parent = octree().parent[m_cut.node[i]];
		const bool isFirst = parent != kNoNode && octree().child[octree().childStart[parent]] == m_cut.node[i];
		if ( isFirst && mayMerge( nodes, parent, i ) )
		{
			m_merge.push_back( parent );
		}
	}
}

void Levels::apply( NodeState& nodes, LatticeMatcher& matcher, const Material& material, TaskRunner* tasks, bool measuresEnergy )
{
	if ( !m_split.empty() || !m_merge.empty() )
	{
		const std::vector<std::uint32_t> split = std::move( m_split ), merge = std::move( m_merge );
		m_split.clear();
		m_merge.clear();
		change( nodes, matcher, material, split, merge, tasks, measuresEnergy );
	}
}

void Levels::change( NodeState& nodes, LatticeMatcher& matcher, const Material& material, const std::vector<std::uint32_t>& split,
	const std::vector<std::uint32_t>& merge, TaskRunner* tasks, bool measuresEnergy )
{
	if ( !m_hasRoom )
	{
		prepareRoom();
	}
	Cut next = changeCut( octree(), m_cut, split, merge, std::move( m_room.cut ) );
	numberHeirs( next );
	m_change.splits = int( split.size() );
	m_change.merges = int( merge.size() );
	NodeState changed = changedNodes( nodes, matcher, next, material.density );

	m_room.matrix.rowBefore.clear();
	m_regions = updateLevelRegions( RegionInput{ *m_base, *m_lattice, material, m_settings, tasks, &m_room.matrix }, m_cut, m_regions, next );
	std::shared_ptr<const RegionTables> old = m_tables;
	const bool isKnown = !m_room.matrix.rowBefore.empty();
	const TablesBefore before{ old.get(), isKnown ? std::move( m_room.matrix.rowBefore ) : unchangedRows( *old->matrix, next ), std::move( m_room.tables ),
		Vec3d::Zero(), m_leavesRows };
	m_tables = buildLevelTables( *m_base, *m_lattice, next, m_regions, LevelSettings{ material, m_settings, *m_stiffness, tasks }, before );
	m_change.measured.clear();
	for ( std::uint32_t r = 0; r < std::uint32_t( next.count() ); ++r )
	{
		if ( before.region[r] == kNoNode )
		{
			m_change.measured.push_back( r );
		}
	}
	const bool isMeasured = measuresEnergy && !m_leavesRows;
	const RegionWork workBefore = isMeasured ? matcher.workOf( nodes, regionsGone( before.region, m_cut.count() ) ) : RegionWork{};
	m_left = m_leavesRows ? m_change.measured : std::vector<std::uint32_t>();
	m_leavesRows = false;
	m_room.quiet.assign( next.node.size(), 0.0f );
	for ( int i = 0; i < next.count(); ++i )
	{
		const std::uint32_t heir = m_change.heir[i];
		m_room.quiet[i] = m_cut.node[heir] == next.node[i] ? m_quiet[heir] : 0.0f;
	}
	m_quiet.swap( m_room.quiet );
	m_isWanted.assign( next.node.size(), 0 );
	std::swap( m_cut, next );
	m_room.cut = std::move( next );
	countLevels();
	std::swap( nodes, changed );
	m_room.nodes = std::move( changed );
	matcher.setTables( m_tables, FlowHeirs{ m_change.heir, m_change.nodeNow, m_room.nodes.mass } );
	settle( nodes, matcher, isMeasured ? &workBefore : nullptr );
	keepRoom( std::move( old ) );
	++m_version;
}

void Levels::countRoom()
{
	const int cells = m_lattice->cellCount(), count = m_cut.count();
	m_room.count = int( std::min<long long>( cells, count + static_cast<long long>( kRoomChanges ) * m_settings.nodesPerStep ) );
}

// A change in a running game must not wait for the system to hand out memory, which takes longer than the change: each is built where the
// one before the last was. Reserved is what several changes may bring; what is not used of it takes no memory.
void Levels::prepareRoom()
{
	const int count = m_cut.count();
	m_hasRoom = true;
	const int touched = std::min( m_room.count, int( count * kRoomShare ) );
	const std::size_t edge = 2 * std::size_t( m_tables->regions.halfWidth ) + 1, entries = edge * edge * edge * std::size_t( m_room.count );
	RegionMatrix& matrix = *std::const_pointer_cast<RegionMatrix>( m_regions.matrix ); // it is ours, and what it holds stays
	const std::size_t touchedEntries = std::min( entries, std::size_t( double( matrix.member.size() ) * kRoomShare ) );
	for ( std::vector<std::uint32_t> RegionMatrix::*array : { &RegionMatrix::member, &RegionMatrix::mass, &RegionMatrix::share } )
	{
		makeRoom( matrix.*array, entries, 0 );
		makeRoom( m_room.matrix.matrix.*array, entries, touchedEntries );
	}
	m_room.tables = std::make_shared<RegionTables>();
	makeLevelRoom( *std::const_pointer_cast<RegionTables>( m_tables ), *m_room.tables, m_room.count, touched );
	makeRoom( m_room.cut.slotOfCell, m_cut.slotOfCell.size(), m_cut.slotOfCell.size() );
	for ( AlignedArray<float>* array : arraysOf( m_room.nodes ) )
	{
		makeRoom( *array, std::size_t( m_room.count ), std::size_t( touched ) );
	}
}

/// The tables before become room for those after the next change, unless somebody else looks at them still.
void Levels::keepRoom( std::shared_ptr<const RegionTables> old )
{
	std::shared_ptr<RegionTables> tables = std::const_pointer_cast<RegionTables>( std::move( old ) );
	if ( tables.use_count() != 1 )
	{
		return;
	}
	tables->plan.reset();
	if ( const auto matrix = std::const_pointer_cast<RegionMatrix>( std::move( tables->matrix ) ); matrix.use_count() == 1 )
	{
		m_room.matrix.matrix = std::move( *matrix );
	}
	tables->matrix.reset();
	m_room.tables = std::move( tables );
}

std::vector<std::uint32_t> Levels::unchangedRows( const RegionMatrix& old, const Cut& next ) const
{
	const RegionMatrix& now = matrix();
	// Nor may masses differ: in unions and intervals a member's share hangs on regions farther off, which may have changed.
	const auto isSame = [&]( std::uint32_t r ) {
		const std::uint32_t heir = m_change.heir[r], size = now.start[r + 1] - now.start[r];
		bool same = old.start[heir + 1] - old.start[heir] == size;
		for ( std::uint32_t k = 0; same && k < size; ++k )
		{
			const std::uint32_t a = now.member[now.start[r] + k], before = old.member[old.start[heir] + k];
			same = m_cut.node[before] == next.node[a] && now.mass[now.start[r] + k] == old.mass[old.start[heir] + k] && now.unit[a] == old.unit[before];
		}
		return same;
	};
	std::vector<std::uint32_t> before( next.node.size() );
	for ( std::uint32_t r = 0; r < std::uint32_t( next.count() ); ++r )
	{
		before[r] = m_cut.node[m_change.heir[r]] == next.node[r] && isSame( r ) ? m_change.heir[r] : kNoNode;
	}
	return before;
}

std::size_t Levels::bytes() const
{
	const std::size_t cut = ( m_cut.node.size() + m_cut.slotOfCell.size() ) * sizeof( std::uint32_t );
	const std::size_t change = ( m_change.heir.size() + m_change.nodeNow.size() + m_change.keptAs.size() + 4 * m_parts.size() ) * sizeof( std::uint32_t );
	const std::size_t base = m_room.fine.bytes() + ( m_ownsBase ? m_base->fine.bytes() + m_base->moments.bytes() : 0 );
	// Room is of the size of what is in use.
	return 2 * ( cut + m_tables->bytes() ) + base + change + ( m_quiet.size() + m_load.size() ) * sizeof( float ) + m_coarsest.size() + m_heldOn.size();
}

} // namespace pliant
