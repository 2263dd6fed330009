// Levels of a body whose links have changed, and of pieces that came off: data above unchanged links is reused. Steinemann et al. 2008,
// section 5.1; Ohta et al. 2009, "Fracturing".

#include "body/levels/level_nodes.h"

#include "body/body.h"
#include "body/breaking.h"
#include "body/implicit/implicit_motion.h"
#include "body/levels/levels.h"
#include "matching/step/lattice_matcher.h"

#include <algorithm>
#include <utility>

namespace pliant {

namespace {

void permute( AlignedArray<float>& array, const std::vector<std::uint32_t>& before, AlignedArray<float>& scratch )
{
	scratch = array; // keeps the padding
	for ( std::size_t i = 0; i < before.size(); ++i )
	{
		scratch[i] = array[before[i]];
	}
	array.swap( scratch );
}

/// `before`: previous index of each node.
void reorderNodes( NodeState& nodes, const std::vector<std::uint32_t>& before )
{
	if ( std::is_sorted( before.begin(), before.end() ) )
	{
		return;
	}
	AlignedArray<float> scratch;
	for ( AlignedArray<float>* array : arraysOf( nodes ) )
	{
		permute( *array, before, scratch );
	}
	for ( AlignedArray<float>* array : { &nodes.force.x, &nodes.force.y, &nodes.force.z } )
	{
		if ( !array->empty() )
		{
			permute( *array, before, scratch );
		}
	}
}

/// Groups the cells under the same nodes as in `whole`, as far as they are still connected; blocks do not move.
Cut cutOfPiece( const Levels& whole, const Octree& tree, const std::vector<std::uint32_t>& cellBefore )
{
	return selectCut( tree, [&]( std::uint32_t node ) {
		return tree.levelOf( node ) == whole.levelOf( int( whole.cut().slotOfCell[cellBefore[tree.cells[tree.cellStart[node]]]] ) );
	} );
}

} // namespace

std::unique_ptr<Levels> Levels::ofPiece( PieceOfLevels piece, const LevelSettings& settings, const Lattice& lattice ) const
{
	std::unique_ptr<Levels> levels;
	if ( canReuse( piece ) )
	{
		MatrixScratch scratch;
		LevelRegions regions{ std::make_shared<RegionMatrix>( updateRelinkedRegions(
								  piece.update.base->octree, piece.cut, piece.update.base->fine, matrix(), piece.nodes, &scratch ) ),
			nullptr };
		std::shared_ptr<const RegionTables> tables = buildLevelTables( *piece.update.base, lattice, piece.cut, regions, settings,
			TablesBefore{ m_tables.get(), std::move( scratch.rowBefore ), nullptr, piece.shift } );
		levels.reset( new Levels( piece.update.base, lattice, m_settings, settings.stiffness, std::move( piece.cut ), std::move( regions ),
			std::move( tables ) ) );
	}
	else
	{
		levels = std::make_unique<Levels>(
			piece.update.base, lattice, settings.material, m_settings, settings.stiffness, std::move( piece.cut ) );
	}
	levels->m_ownsBase = true;
	return levels;
}

// A node in the cut above a touched cell may hold other cells than before.
bool Levels::canRelink( const std::vector<std::uint32_t>& touched ) const
{
	return m_settings.regions == RegionRule::Multiplicity &&
		std::all_of( touched.begin(), touched.end(), [this]( std::uint32_t cell ) { return m_cut.node[m_cut.slotOfCell[cell]] == cell; } );
}

void Levels::ownBase()
{
	if ( !m_ownsBase )
	{
		m_base = std::make_shared<const LevelBase>( *m_base );
		m_ownsBase = true;
	}
}

// A template's base must not be modified, even where this body is the last to hold it: a body created in another thread may obtain it.
LevelBaseScratch Levels::takeBaseScratch()
{
	LevelBaseScratch scratch;
	if ( m_ownsBase && m_base.use_count() == 1 )
	{
		scratch.moments = std::move( std::const_pointer_cast<LevelBase>( m_base )->moments );
	}
	scratch.fine = std::move( m_scratch.fine );
	return scratch;
}

void Levels::inherit( const Levels& whole, const std::vector<std::uint32_t>& cellBefore )
{
	m_sinceMerge = whole.m_sinceMerge;
	m_refineStretch = whole.m_refineStretch;
	m_together = whole.m_together;
	m_budget = whole.m_budget;
	for ( std::size_t cell = 0; cell < cellBefore.size(); ++cell )
	{
		m_coarsest[cell] = whole.m_coarsest[cellBefore[cell]];
	}
	const std::vector<std::uint8_t> isRequested = whole.requestedNodes();
	for ( std::size_t i = 0; i < m_quiet.size(); ++i )
	{
		const std::uint32_t cell = octree().cells[octree().cellStart[m_cut.node[i]]];
		const std::uint32_t before = whole.m_cut.slotOfCell[cellBefore[cell]];
		m_quiet[i] = whole.m_quiet[before];
		m_wasRequested[i] = whole.m_wasRequested[before];
		if ( isRequested[before] != 0 )
		{
			m_requested.push_back( m_cut.node[i] );
			isRequested[before] > 1 ? requestUnder( m_cut.node[i] ) : void();
		}
	}
	if ( !whole.m_pinnedLevel.empty() )
	{
		m_pinnedLevel.reserve( cellBefore.size() );
		for ( const std::uint32_t cell : cellBefore )
		{
			m_pinnedLevel.push_back( whole.m_pinnedLevel[cell] );
		}
	}
}

std::vector<std::uint8_t> Levels::requestedNodes() const
{
	std::vector<std::uint32_t> requested( m_requested );
	std::sort( requested.begin(), requested.end() );
	const auto contains = [&requested]( std::uint32_t node ) { return std::binary_search( requested.begin(), requested.end(), node ); };
	std::vector<std::uint8_t> isRequested;
	for ( const std::uint32_t node : m_cut.node )
	{
		const auto first = octree().child.begin() + octree().childStart[node], end = octree().child.begin() + octree().childStart[node + 1];
		isRequested.push_back( !contains( node ) ? 0 : std::any_of( first, end, contains ) ? 2 : 1 );
	}
	return isRequested;
}

void Levels::measureSkippedRows( const Material& material )
{
	if ( !m_skippedRows.empty() )
	{
		RegionTables& tables = *std::const_pointer_cast<RegionTables>( m_tables ); // created by the last change, for these levels
		fillSkippedRows( *m_base, *m_lattice, m_cut, LevelSettings{ material, m_settings, *m_stiffness }, m_skippedRows, tables );
		m_skippedRows.clear();
	}
}

// Like Levels::change, in the scratch memory of the change before the last.
void Levels::relink( PieceOfLevels piece, const LevelSettings& settings, const Lattice& lattice, NodeState& nodes, LatticeMatcher& matcher )
{
	m_scratch.matrix.rowBefore.clear();
	LevelRegions regions{ std::make_shared<RegionMatrix>( updateRelinkedRegions(
							  piece.update.base->octree, piece.cut, piece.update.base->fine, matrix(), piece.nodes, &m_scratch.matrix ) ),
		nullptr };
	std::vector<std::uint32_t>& rows = m_scratch.matrix.rowBefore;
	std::replace_if(
		rows.begin(), rows.end(),
		[this]( std::uint32_t row ) { return std::binary_search( m_skippedRows.begin(), m_skippedRows.end(), row ); }, kNoNode );
	m_skippedRows.clear();
	std::shared_ptr<const RegionTables> old = m_tables;
	m_tables = buildLevelTables( *piece.update.base, lattice, piece.cut, regions, settings,
		TablesBefore{ old.get(), std::move( m_scratch.matrix.rowBefore ), std::move( m_scratch.tables ) } );
	matcher.relink( lattice, m_tables, piece.nodes.before );
	m_regions = std::move( regions );
	keepScratch( std::move( old ) );
	reorderNodes( nodes, piece.nodes.before );
	m_scratch.quiet.clear();
	const std::vector<std::uint8_t> isRequested = requestedNodes();
	std::vector<std::uint8_t> wasRequested;
	std::vector<std::uint32_t> requested, deeper;
	for ( std::size_t i = 0; i < piece.nodes.before.size(); ++i )
	{
		const std::uint32_t before = piece.nodes.before[i];
		m_scratch.quiet.push_back( m_quiet[before] );
		wasRequested.push_back( m_wasRequested[before] );
		if ( isRequested[before] != 0 )
		{
			requested.push_back( piece.cut.node[i] );
			isRequested[before] > 1 ? deeper.push_back( piece.cut.node[i] ) : void();
		}
	}
	m_quiet.swap( m_scratch.quiet );
	m_wasRequested.swap( wasRequested );
	m_requested.swap( requested );
	const std::shared_ptr<const LevelBase> baseBefore = std::exchange( m_base, piece.update.base );
	if ( m_ownsBase && baseBefore.use_count() == 1 )
	{
		m_scratch.fine = std::move( std::const_pointer_cast<LevelBase>( baseBefore )->fine );
	}
	m_ownsBase = true;
	m_lattice = &lattice;
	m_stiffness = &settings.stiffness;
	m_cut = std::move( piece.cut );
	countLevels();
	std::for_each( deeper.begin(), deeper.end(), [this]( std::uint32_t node ) { requestUnder( node ); } );
	// Pending changes refer to nodes of the previous octree; the next review finds them again.
	m_change = {};
	m_split.clear();
	m_merge.clear();
	m_hasBacklog = false;
	++m_version;
}

void Body::prepareToBreak()
{
	if ( m_levels )
	{
		m_levels->ownBase();
	}
}

PieceOfLevels Body::pieceOfLevels( const Body& from, const BodyPiece& piece, PieceBuild build ) const
{
	const Levels& before = *from.m_levels;
	PieceOfLevels made;
	if ( build == PieceBuild::FromScratch )
	{
		made.update.base = buildLevelBase( *m_lattice, m_material, before.settings() );
		made.cut = cutOfPiece( before, made.update.base->octree, piece.cellBefore );
		return made;
	}
	LevelBaseScratch scratch = piece.isLast ? from.m_levels->takeBaseScratch() : LevelBaseScratch{};
	made.update = updateLevelBase(
		before.base(), std::move( scratch ), CellChange{ *from.m_lattice, *m_lattice, piece.cellBefore, piece.touched } );
	made.cut = cutOfPiece( before, made.update.base->octree, piece.cellBefore );
	made.nodes = relinkNodes( before.cut(), made.cut, made.update, piece.cellBefore );
	made.shift = ( m_lattice->massCentre - from.m_lattice->massCentre ) / double( m_lattice->cellSize );
	return made;
}

void Body::inheritLevels( const Body& from, BodyPiece& piece, PieceBuild build )
{
	const Levels& before = *from.m_levels;
	PieceOfLevels made = pieceOfLevels( from, piece, build );
	piece.treeBefore = made.update.nodeBefore;
	for ( const std::uint32_t node : made.cut.node )
	{
		const Octree& tree = made.update.base->octree;
		piece.nodeBefore.push_back( before.cut().slotOfCell[piece.cellBefore[tree.cells[tree.cellStart[node]]]] );
	}
	m_levels = before.ofPiece( std::move( made ), LevelSettings{ m_material, before.settings(), m_stiffness }, *m_lattice );
	m_levels->inherit( before, piece.cellBefore );
	m_levels->setFinestLevel( before.finestLevel() );
	m_levels->fillNodes( m_nodes, m_material.density );
}

// Nothing came off: the body's data moves to a new body, and only the surroundings of the changed links are rebuilt.
std::unique_ptr<Body> Body::relinkWhole( const std::shared_ptr<const Lattice>& lattice, BodyPiece& piece )
{
	const std::shared_ptr<const Lattice> before = m_lattice;
	if ( !m_levels->canRelink( piece.touched ) )
	{
		return nullptr;
	}
	PieceOfLevels made;
	made.update = updateLevelBase(
		m_levels->base(), m_levels->takeBaseScratch(), CellChange{ *before, *lattice, piece.cellBefore, piece.touched } );
	made.cut = cutOfPiece( *m_levels, made.update.base->octree, piece.cellBefore );
	made.nodes = relinkNodes( m_levels->cut(), made.cut, made.update, piece.cellBefore );
	piece.nodeBefore = made.nodes.before;
	piece.treeBefore = made.update.nodeBefore;
	const std::vector<std::uint32_t> firstCells = m_firstCell;
	std::unique_ptr<Body> body( new Body( std::move( *this ) ) );
	m_firstCell = firstCells; // the report uses the previous body's indices
	body->m_lattice = lattice;
	body->m_isOnePart = piece.isOnePart;
	body->m_cache.reset();    // it belongs to the previous lattice
	body->m_implicit.reset(); // it refers to this body; rebuilt on demand
	if ( body->m_firstCell.empty() )
	{
		body->m_firstCell = piece.cellBefore;
	}
	body->m_levels->relink( std::move( made ), LevelSettings{ body->m_material, body->m_levels->settings(), body->m_stiffness }, *lattice,
		body->m_nodes, *body->m_levelMatcher );
	if ( body->m_breaking )
	{
		body->m_breaking->limits = body->limitsOf( *body->m_breaking, piece );
		body->m_breaking->refinementStates.forget();
	}
	body->keepFiniteState();
	return body;
}

} // namespace pliant
