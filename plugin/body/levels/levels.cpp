#include "body/levels/levels.h"

#include "body/levels/level_nodes.h"

#include "matching/step/lattice_matcher.h"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>

namespace pliant {

Levels::Levels( std::shared_ptr<const LevelBase> base, const Lattice& lattice, const Material& material, const Adaptivity& settings,
	const std::vector<float>& stiffness, Cut cut ) :
	Levels( std::move( base ), lattice, settings, stiffness, std::move( cut ), {}, nullptr )
{
	m_regions = buildLevelRegions( RegionInput{ *m_base, lattice, material, m_settings }, m_cut );
	m_tables = buildLevelTables( *m_base, lattice, m_cut, m_regions, LevelSettings{ material, m_settings, stiffness } );
	prepareScratch();
}

Levels::Levels( std::shared_ptr<const LevelBase> base, const Lattice& lattice, const Adaptivity& settings,
	const std::vector<float>& stiffness, Cut cut, LevelRegions regions, std::shared_ptr<const RegionTables> tables ) :
	m_base( std::move( base ) ),
	m_lattice( &lattice ), m_settings( settings ), m_stiffness( &stiffness ), m_cut( std::move( cut ) ), m_regions( std::move( regions ) ),
	m_tables( std::move( tables ) ), m_quiet( m_cut.node.size(), 0.0f ), m_wasRequested( m_cut.node.size(), 0 )
{
	countLevels();
	planScratch();
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
		reserveScratch( *array, std::size_t( m_hasScratch ? m_scratch.count : 0 ), 0 );
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
		m_requested.push_back( m_cut.node[node] );
	}
}

void Levels::requestFinest( int node )
{
	requestSplit( node );
	requestUnder( m_cut.node[std::size_t( node )] );
}

void Levels::requestUnder( std::uint32_t node )
{
	std::vector<std::uint32_t> coarse = { node };
	while ( !coarse.empty() )
	{
		const std::uint32_t parent = coarse.back();
		coarse.pop_back();
		for ( std::uint32_t k = octree().childStart[parent]; k < octree().childStart[parent + 1]; ++k )
		{
			if ( octree().levelOf( octree().child[k] ) > m_finestLevel )
			{
				m_requested.push_back( octree().child[k] );
				coarse.push_back( octree().child[k] );
			}
		}
	}
}

void Levels::pin( int node )
{
	m_pinnedLevel.resize( std::size_t( m_lattice->cellCount() ), 0 );
	const std::uint32_t pinned = m_cut.node[node], first = octree().cellStart[pinned];
	for ( std::uint32_t k = first; k < first + octree().cellCount[pinned]; ++k )
	{
		m_pinnedLevel[octree().cells[k]] = std::uint8_t( levelOf( node ) );
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
	if ( !m_hasScratch )
	{
		prepareScratch();
	}
	Cut next = changeCut( octree(), m_cut, split, merge, std::move( m_scratch.cut ) );
	numberSources( next );
	m_change.splits = int( split.size() );
	m_change.merges = int( merge.size() );
	NodeState changed = changedNodes( nodes, matcher, next, material.density );

	m_scratch.matrix.rowBefore.clear();
	m_regions = updateLevelRegions(
		RegionInput{ *m_base, *m_lattice, material, m_settings, tasks, &m_scratch.matrix }, m_cut, m_regions, next );
	std::shared_ptr<const RegionTables> old = m_tables;
	const bool isKnown = !m_scratch.matrix.rowBefore.empty();
	const TablesBefore before{ old.get(), isKnown ? std::move( m_scratch.matrix.rowBefore ) : unchangedRows( *old->matrix, next ),
		std::move( m_scratch.tables ), Vec3d::Zero(), m_skipsRows };
	m_tables = buildLevelTables( *m_base, *m_lattice, next, m_regions, LevelSettings{ material, m_settings, *m_stiffness, tasks }, before );
	m_change.measured.clear();
	for ( std::uint32_t r = 0; r < std::uint32_t( next.count() ); ++r )
	{
		if ( before.region[r] == kNoNode )
		{
			m_change.measured.push_back( r );
		}
	}
	const bool isMeasured = measuresEnergy && !m_skipsRows;
	const RegionWork workBefore = isMeasured ? matcher.workOf( nodes, removedRegions( before.region, m_cut.count() ) ) : RegionWork{};
	m_skippedRows = m_skipsRows ? m_change.measured : std::vector<std::uint32_t>();
	m_skipsRows = false;
	m_scratch.quiet.assign( next.node.size(), 0.0f );
	for ( int i = 0; i < next.count(); ++i )
	{
		const std::uint32_t source = m_change.source[i];
		m_scratch.quiet[i] = m_cut.node[source] == next.node[i] ? m_quiet[source] : 0.0f;
	}
	m_quiet.swap( m_scratch.quiet );
	m_wasRequested.assign( next.node.size(), 0 );
	std::swap( m_cut, next );
	m_scratch.cut = std::move( next );
	countLevels();
	std::swap( nodes, changed );
	m_scratch.nodes = std::move( changed );
	matcher.setTables( m_tables, FlowSources{ m_change.source, m_change.nodeNow, m_scratch.nodes.mass } );
	settle( nodes, matcher, isMeasured ? &workBefore : nullptr );
	keepScratch( std::move( old ) );
	++m_version;
}

void Levels::planScratch()
{
	const int cells = m_lattice->cellCount(), count = m_cut.count();
	m_scratch.count = int( std::min<long long>( cells, count + static_cast<long long>( kScratchChanges ) * m_settings.nodesPerStep ) );
}

// A change must not wait for the system to allocate memory, which takes longer than the change: each reuses the memory of the one before
// the last. Capacity is reserved for several changes; unused capacity is not committed.
void Levels::prepareScratch()
{
	const int count = m_cut.count();
	m_hasScratch = true;
	const int touched = std::min( m_scratch.count, int( count * kScratchFraction ) );
	const std::size_t edge = 2 * std::size_t( m_tables->regions.halfWidth ) + 1,
					  entries = edge * edge * edge * std::size_t( m_scratch.count );
	RegionMatrix& matrix = *std::const_pointer_cast<RegionMatrix>( m_regions.matrix ); // it is owned here, and its contents stay the same
	const std::size_t touchedEntries = std::min( entries, std::size_t( double( matrix.member.size() ) * kScratchFraction ) );
	for ( std::vector<std::uint32_t> RegionMatrix::*array : { &RegionMatrix::member, &RegionMatrix::mass, &RegionMatrix::fraction } )
	{
		reserveScratch( matrix.*array, entries, 0 );
		reserveScratch( m_scratch.matrix.matrix.*array, entries, touchedEntries );
	}
	m_scratch.tables = std::make_shared<RegionTables>();
	makeLevelScratch( *std::const_pointer_cast<RegionTables>( m_tables ), *m_scratch.tables, m_scratch.count, touched );
	reserveScratch( m_scratch.cut.slotOfCell, m_cut.slotOfCell.size(), m_cut.slotOfCell.size() );
	for ( AlignedArray<float>* array : arraysOf( m_scratch.nodes ) )
	{
		reserveScratch( *array, std::size_t( m_scratch.count ), std::size_t( touched ) );
	}
}

/// Keeps the previous tables as scratch for the next change, unless they are still shared.
void Levels::keepScratch( std::shared_ptr<const RegionTables> old )
{
	std::shared_ptr<RegionTables> tables = std::const_pointer_cast<RegionTables>( std::move( old ) );
	if ( tables.use_count() != 1 )
	{
		return;
	}
	tables->plan.reset();
	if ( const auto matrix = std::const_pointer_cast<RegionMatrix>( std::move( tables->matrix ) ); matrix.use_count() == 1 )
	{
		m_scratch.matrix.matrix = std::move( *matrix );
	}
	tables->matrix.reset();
	m_scratch.tables = std::move( tables );
}

std::vector<std::uint32_t> Levels::unchangedRows( const RegionMatrix& old, const Cut& next ) const
{
	const RegionMatrix& now = matrix();
	// Masses must be the same too: in unions and intervals a member's fraction depends on regions farther away, which may have changed.
	const auto isSame = [&]( std::uint32_t r ) {
		const std::uint32_t source = m_change.source[r], size = now.start[r + 1] - now.start[r];
		bool same = old.start[source + 1] - old.start[source] == size;
		for ( std::uint32_t k = 0; same && k < size; ++k )
		{
			const std::uint32_t a = now.member[now.start[r] + k], before = old.member[old.start[source] + k];
			same = m_cut.node[before] == next.node[a] && now.mass[now.start[r] + k] == old.mass[old.start[source] + k] &&
				now.unit[a] == old.unit[before];
		}
		return same;
	};
	std::vector<std::uint32_t> before( next.node.size() );
	for ( std::uint32_t r = 0; r < std::uint32_t( next.count() ); ++r )
	{
		before[r] = m_cut.node[m_change.source[r]] == next.node[r] && isSame( r ) ? m_change.source[r] : kNoNode;
	}
	return before;
}

Status Levels::validate() const
{
	Status status = pliant::validate( octree(), *m_lattice );
	return status.ok() ? pliant::validate( m_cut, octree() ) : status;
}

} // namespace pliant
