#pragma once

// The levels of one body: its current nodes, the regions over them, and their changes.
// Steinemann et al. 2008, section 5.2; Ohta et al. 2009, "Changing the Subdivision Level" and "Merging".

#include "adapt/constants.h"
#include "body/levels/level_energy.h"
#include "fracture/thin_cells.h"
#include "matching/node_state.h"
#include "matching/regions/level_update.h"

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

namespace pliant {

class Archive;
class LatticeMatcher;
struct RegionWork;

/// Effect of a change of levels on node indices.
struct LevelChange
{
	std::vector<std::uint32_t> source; ///< of each node: the previous node of its history (its parent or its first child)
	/// Of each previous node: its index now, its parent's where it was merged, kNoNode where it was split.
	std::vector<std::uint32_t> nodeNow;
	std::vector<std::uint32_t> keptAs;   ///< of each previous node: its index now where it is the same node, else kNoNode; ascending
	std::vector<std::uint32_t> measured; ///< nodes whose regions hold other nodes or masses than before, ascending
	LevelEnergy energy;                  ///< added by the change, if measured
	int splits = 0, merges = 0;          ///< nodes split, nodes that replaced their children
};

/// Data for the levels of a piece, or of the whole after links changed.
struct PieceOfLevels
{
	LevelBaseUpdate update;
	Cut cut;
	RelinkedNodes nodes;         ///< empty: regions are built from scratch
	Vec3d shift = Vec3d::Zero(); ///< of the mass centre, cells
};

class Levels
{
public:
	/// `stiffness`: see LevelSettings; must live as long.
	Levels( std::shared_ptr<const LevelBase> base, const Lattice& lattice, const Material& material, const Adaptivity& settings,
		const std::vector<float>& stiffness, Cut cut );

	const LevelBase& base() const { return *m_base; }
	const Octree& octree() const { return m_base->octree; }
	const Cut& cut() const { return m_cut; }
	const RegionMatrix& matrix() const { return *m_regions.matrix; }
	const Adaptivity& settings() const { return m_settings; }
	const std::shared_ptr<const RegionTables>& tables() const { return m_tables; }
	int levelOf( int node ) const { return m_base->octree.levelOf( m_cut.node[node] ); }
	/// Nodes on each level.
	const std::array<int, kMaxCoarseLevels + 1>& nodesOnLevel() const { return m_nodesOnLevel; }

	/// Incremented with each change; initially 0.
	unsigned version() const { return m_version; }
	const LevelChange& lastChange() const { return m_change; }

	/// Maximum number of nodes before the reserved arrays must grow.
	int scratchNodes() const { return m_scratch.count; }
	/// False for a piece whose levels have not changed yet: most never do.
	bool hasScratch() const { return m_hasScratch; }

	/// Fills in the nodes at rest: counts, rest positions, masses. `density` in kg/m^3.
	void fillNodes( NodeState& nodes, float density ) const;

	/// Whether regions and tables can be updated from the present ones: by multiplicity, where links changed only between finest cells.
	bool canReuse( const PieceOfLevels& piece ) const
	{
		return m_settings.regions == RegionRule::Multiplicity && !piece.nodes.before.empty();
	}
	/// The levels of a piece of a body that had these, made from the remainder of the whole's: equal to those built for its lattice.
	std::unique_ptr<Levels> ofPiece( PieceOfLevels piece, const LevelSettings& settings, const Lattice& lattice ) const;
	/// Whether the whole can be relinked where links of these cells changed.
	bool canRelink( const std::vector<std::uint32_t>& touched ) const;
	/// Makes a private copy of the base ahead of the first change of links.
	void ownBase();
	/// Scratch for a base that replaces this one immediately: its moments, where they are not shared, and other unused memory.
	LevelBaseScratch takeBaseScratch();
	/// The next change does not measure the rows of new nodes and their neighbours: links change right after it, and the affected rows are
	/// measured then (relink), or by measureSkippedRows. The tables must not be used before. By multiplicity only.
	void skipRows() { m_skipsRows = m_settings.regions == RegionRule::Multiplicity; }
	void measureSkippedRows( const Material& material );
	/// For a whole that stays one piece with changed links: updates in place, together with the data of each node.
	void relink( PieceOfLevels piece, const LevelSettings& settings, const Lattice& lattice, NodeState& nodes, LatticeMatcher& matcher );

	/// For a piece of a body that had these: takes over the whole's splitting settings and remaining budget, and the levels and delays of
	/// merging, however little of a block the piece has. `cellBefore`: of each finest cell.
	void inherit( const Levels& whole, const std::vector<std::uint32_t>& cellBefore );

	/// Requests a node to be split at the next change; a node on the finest level is not merged for Adaptivity::mergeDelay.
	void requestSplit( int node );
	/// The same down to the finest level, however many changes that takes.
	void requestFinest( int node );
	/// Keeps a node from being merged, as requestSplit does, without a split.
	void keep( int node )
	{
		m_quiet[std::size_t( node )] = 0.0f;
		m_wasRequested[std::size_t( node )] = 1;
	}
	/// Pins the node and its cells: where it is split its children are pinned, and may be merged up to it again.
	void pin( int node );
	/// Levels below this are merged away. Nodes merged only by this are split again when it allows them. 0: all levels are allowed.
	void setFinestLevel( int level ) { m_finestLevel = level; }
	int finestLevel() const { return m_finestLevel; }
	/// In addition to Adaptivity::refineStrain: splits nodes stretched by more in some direction, with little regard to compression.
	/// `together`: splits a node's neighbours in its regions too, and theirs in turn, if strained by this fraction of the threshold; 1:
	/// none.
	void setRefineStretch( float stretch, float together )
	{
		m_refineStretch = stretch;
		m_together = together;
	}
	bool followsStrain() const { return m_settings.refineStrain > 0.0f || m_refineStretch > 0.0f; }
	float together() const { return m_together; }

	/// From now until the next call, changes together add at most Adaptivity::nodesPerStep. Without a call, each change may.
	void openBudget() { m_budget = m_settings.nodesPerStep; }
	/// Whether changes are postponed because of the budget.
	bool hasBacklog() const { return m_hasBacklog; }
	/// Whether nodes that `requestFinest` splits wait for nothing but the next change.
	bool isRefining() const { return !m_requested.empty() && !m_hasBacklog; }

	/// Evaluates the strains and stretches last measured; `seconds` since the last review. `thin`: cells of a body that can break, of which
	/// bending counts as stretch. Returns true when there is something to change.
	bool review( const NodeState& nodes, const AlignedArray<float>& strain, const AlignedArray<float>& stretch,
		const std::vector<ThinCell>& thin, float seconds );
	/// Applies the changes selected by `review` and requests, within the budget. Conserves momentum and spin unless a node is pinned.
	/// `measuresEnergy`: fills in LevelChange::energy, except where rows are skipped.
	void apply(
		NodeState& nodes, LatticeMatcher& matcher, const Material& material, TaskRunner* tasks = nullptr, bool measuresEnergy = false );
	/// The same for given octree nodes, as in changeCut.
	void change( NodeState& nodes, LatticeMatcher& matcher, const Material& material, const std::vector<std::uint32_t>& split,
		const std::vector<std::uint32_t>& merge, TaskRunner* tasks = nullptr, bool measuresEnergy = false );

	/// Checks octree and cut; the message names the first violation.
	Status validate() const;
	/// The cut of nodes that were read; refused unless it is one.
	static Cut readCut( Archive& archive, const Octree& octree, std::vector<std::uint32_t> nodes );
	/// Writes or reads everything but the cut and what follows from it, for levels made with this cut.
	void archive( Archive& archive );
	/// Writes or reads the numbers of the tables; the base belongs to this body alone then.
	void archiveTables( Archive& archive );

private:
	static constexpr int kNoBudget = -1;

	/// `regions` and `tables` belong to the cut.
	Levels( std::shared_ptr<const LevelBase> base, const Lattice& lattice, const Adaptivity& settings, const std::vector<float>& stiffness,
		Cut cut, LevelRegions regions, std::shared_ptr<const RegionTables> tables );

	void measureLoads( const AlignedArray<float>& strain, const AlignedArray<float>& stretch );
	std::vector<std::uint8_t> strainedNodes() const;
	void collectSplits();
	void keepRequests( std::vector<std::uint32_t> current );
	void collectMerges( const NodeState& nodes );
	bool isPinnedAsOne( std::uint32_t node ) const;
	/// A change for a few nodes costs nearly as much as one for many, and bodies come to rest node by node: merges wait for more, for a
	/// fraction of the delay that each node has waited already.
	void gatherMerges( float seconds )
	{
		m_sinceMerge += seconds;
		if ( m_split.empty() && m_sinceMerge < kMergeTogether * m_settings.mergeDelay )
		{
			m_merge.clear();
		}
		m_sinceMerge = m_merge.empty() ? m_sinceMerge : 0.0f;
	}
	/// Data of the cut that reviews need.
	struct Reviewed
	{
		struct Coarse
		{
			std::uint32_t slot, node;
			int level;
			bool isTooCoarse;
		};
		/// Children of one node, all of which are in the cut.
		struct Siblings
		{
			std::uint32_t parent, first, count; ///< first: slot
			int parentLevel;
			bool isParentTooCoarse;
		};
		std::vector<Coarse> coarse; ///< not on the finest level; both ascending by slot
		std::vector<Siblings> siblings;
		unsigned version = 0;
		bool isKnown = false;
	};
	void findReviewed();
	/// Nodes of thin parts.
	struct Bends
	{
		struct Node
		{
			std::uint32_t node;
			int pairs = 0;
			ThinCell::Pair pair[4]; ///< nodes on opposite sides of it
		};
		std::vector<Node> node;
		std::size_t thinCells = 0; ///< of which they were found
		unsigned version = 0;
		bool isKnown = false;
	};
	void findBends( const NodeState& nodes, const std::vector<ThinCell>& thin );
	void addBending( const NodeState& nodes );
	bool mayMerge( const NodeState& nodes, const Reviewed::Siblings& siblings ) const;
	/// Requests all coarse nodes under a node of the octree.
	void requestUnder( std::uint32_t node );
	/// Of each node: 1 where a split was requested, 2 where those of the nodes under it were too.
	std::vector<std::uint8_t> requestedNodes() const;
	void planScratch();
	void prepareScratch();
	void keepScratch( std::shared_ptr<const RegionTables> old );
	NodeState changedNodes( const NodeState& before, LatticeMatcher& matcher, const Cut& next, float density );
	void splitInto( const NodeState& before, const std::vector<std::uint32_t>& parents, const std::vector<float>& gradients,
		const Cut& next, NodeState& now ) const;
	void easeParts( NodeState& nodes, LatticeMatcher& matcher );
	void findParts( const NodeState& nodes );
	void settle( NodeState& nodes, LatticeMatcher& matcher, const RegionWork* before );
	std::vector<std::uint32_t> removedRegions( const std::vector<std::uint32_t>& regionBefore, int countBefore ) const;
	std::vector<std::uint32_t> splitNodes( const Cut& next ) const;
	void numberSources( const Cut& next );
	void countLevels();
	/// Whether the node is coarser than the first cut of the whole body there. Merging back to that cut includes nodes that keepMass would
	/// not select: a piece's part of a block may weigh too little for keepMass although the whole block was merged.
	bool isTooCoarse( std::uint32_t node ) const
	{
		return octree().levelOf( node ) > int( m_coarsest[octree().cells[octree().cellStart[node]]] );
	}
	std::vector<std::uint32_t> unchangedRows( const RegionMatrix& old, const Cut& next ) const;
	bool isKept( const Cut& next, int node ) const { return m_cut.node[m_change.source[node]] == next.node[node]; }
	void mergeInto( const NodeState& before, int first, NodeState& now, int slot ) const;
	Eigen::Matrix3d velocityGradient( const NodeState& nodes, int node ) const;

	std::shared_ptr<const LevelBase> m_base;
	bool m_ownsBase = false; ///< false: it belongs to the template and may be shared
	const Lattice* m_lattice;
	Adaptivity m_settings;
	const std::vector<float>* m_stiffness;
	Cut m_cut;
	LevelRegions m_regions;
	std::shared_ptr<const RegionTables> m_tables;
	unsigned m_version = 0;
	LevelChange m_change;
	int m_finestLevel = 0;
	float m_refineStretch = 0.0f, m_together = 1.0f;
	std::array<int, kMaxCoarseLevels + 1> m_nodesOnLevel{};

	/// Memory of the change before the last, reused by the next.
	struct Scratch
	{
		int count = 0; ///< capacity, in nodes
		Cut cut;
		MatrixScratch matrix;
		std::shared_ptr<RegionTables> tables;
		FineRegions fine;
		NodeState nodes;
		std::vector<float> quiet;
	};
	Scratch m_scratch;
	bool m_hasScratch = false;

	std::vector<std::uint8_t> m_coarsest;    ///< of each finest cell: level of its node in the first cut of the whole body
	std::vector<std::uint8_t> m_pinnedLevel; ///< of each finest cell: level of the node through which it was last pinned; empty: none was
	std::vector<float> m_load;  ///< of each node: strain relative to the splitting threshold at the last review; empty: unknown
	std::vector<float> m_quiet; ///< of each node: seconds since it was last requested or strained above the merging threshold
	float m_sinceMerge = std::numeric_limits<float>::max(); ///< s
	std::vector<std::uint8_t> m_wasRequested;               ///< of each node: 1 where it was requested since the last review
	Reviewed m_reviewed;
	Bends m_bends;
	std::vector<std::uint32_t> m_split, m_merge; ///< octree nodes, found by the last review
	std::vector<std::uint32_t> m_requested;      ///< octree nodes, of the cut or under requested ones
	int m_budget = kNoBudget;                    ///< number of nodes that changes may still add
	bool m_hasBacklog = false;
	bool m_skipsRows = false;
	std::vector<std::uint32_t> m_parts; ///< movable nodes that the change created by splitting, ascending
	std::vector<float> m_partDisplacement;
	std::vector<std::uint32_t> m_skippedRows; ///< rows that were not measured, ascending
};

} // namespace pliant
