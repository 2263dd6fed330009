#pragma once

// The levels of one body: which nodes it has now, the regions over them, and when that changes.
// Steinemann et al. 2008, section 5.2; Ohta et al. 2009, "Changing the Subdivision Level" and "Merging".

#include "body/levels/level_energy.h"
#include "matching/node_state.h"
#include "matching/regions/level_update.h"

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

namespace pliant {

class LatticeMatcher;
struct RegionWork;

/// What a change of levels did to the nodes' numbers.
struct LevelChange
{
	std::vector<std::uint32_t>
		source; ///< of each node now: the node before whose history it took over (its parent's, or its first child's)
	std::vector<std::uint32_t>
		nodeNow; ///< of each node before: its number now, its parent's where it was merged, kNoNode where it was split
	std::vector<std::uint32_t> keptAs;   ///< of each node before: its number now where it is still the same node, else kNoNode; ascending
	std::vector<std::uint32_t> measured; ///< nodes now whose regions hold other nodes or masses than before, ascending
	LevelEnergy energy;                  ///< what it has brought, where that is measured
	int splits = 0, merges = 0;          ///< nodes split, nodes that took the place of their children
};

/// What a piece takes over, or the whole after links have changed.
struct PieceOfLevels
{
	LevelBaseUpdate update;
	Cut cut;
	RelinkedNodes nodes;         ///< empty: regions are made from nothing
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

	/// Goes up by one with each change; 0 as made.
	unsigned version() const { return m_version; }
	const LevelChange& lastChange() const { return m_change; }

	/// As many nodes as there may be before arrays that were made for them outgrow their room.
	int scratchNodes() const { return m_scratch.count; }
	/// False of a piece that has not changed its levels yet: most never do.
	bool hasScratch() const { return m_hasScratch; }

	/// The nodes at rest: counts, rest positions, masses. kg per cubic metre.
	void fillNodes( NodeState& nodes, float density ) const;

	/// Whether regions and tables can be made from those that are there: by multiplicity, where links changed between finest cells alone.
	bool canTakeOver( const PieceOfLevels& piece ) const
	{
		return m_settings.regions == RegionRule::Multiplicity && !piece.nodes.before.empty();
	}
	/// The levels of a piece of a body that had these: as made from nothing for its lattice, from what is left of the whole's.
	std::unique_ptr<Levels> ofPiece( PieceOfLevels piece, const LevelSettings& settings, const Lattice& lattice ) const;
	/// Whether the whole can be relinked where links of these cells changed.
	bool canRelink( const std::vector<std::uint32_t>& touched ) const;
	/// The base becomes these levels' own, with which a first change of links then need not begin.
	void ownBase();
	/// For a base that takes the place of this one at once: its moments, where it is these levels' own and nobody else looks at it, and
	/// what else there is.
	LevelBaseScratch takeBaseScratch();
	/// The next change leaves the rows of new nodes, and of those beside them, as they lie: links change at once after it, and what is near
	/// those is measured then (relink), or by measureLeftRows. Until then nobody may ask the tables. By multiplicity alone.
	void leaveRows() { m_leavesRows = m_settings.regions == RegionRule::Multiplicity; }
	void measureLeftRows( const Material& material );
	/// The whole is one piece still, some of its links are others: the same in place, and what is kept of each node with it.
	void relink( PieceOfLevels piece, const LevelSettings& settings, const Lattice& lattice, NodeState& nodes, LatticeMatcher& matcher );

	/// Of a piece of a body that had these: what is split together and what is left of the budget are the whole's; material is merged as
	/// far as it was there, however little of a block the piece has, and as soon. `cellBefore`: of each finest cell.
	void inherit( const Levels& whole, const std::vector<std::uint32_t>& cellBefore );

	/// Asks for a node to be split at the next change; a node on the finest level is kept from being merged, now and for
	/// Adaptivity::mergeDelay.
	void requestSplit( int node );
	/// Keeps a node from being merged, as requestSplit does, and no more.
	void keep( int node )
	{
		m_quiet[std::size_t( node )] = 0.0f;
		m_isWanted[std::size_t( node )] = 1;
	}
	/// A pin holds the node as it is now, and what that is made of: where it is split its parts are held, which may be merged up to it
	/// again.
	void hold( int node );
	/// Levels below this are not used, and merged away. Nodes that only this had merged are split again when it lets them. 0: all may be.
	void setFinestLevel( int level ) { m_finestLevel = level; }
	int finestLevel() const { return m_finestLevel; }
	/// Beside Adaptivity::refineStrain: nodes are split that are stretched by more in some direction, however little they are squeezed.
	/// `together`: where a node is split, so are those its regions reach that are strained by this share of the threshold, and those theirs
	/// reach; 1: none.
	void setRefineStretch( float stretch, float together )
	{
		m_refineStretch = stretch;
		m_together = together;
	}
	bool followsStrain() const { return m_settings.refineStrain > 0.0f || m_refineStretch > 0.0f; }
	float together() const { return m_together; }

	/// From now on, until it is said again, changes together bring no more than Adaptivity::nodesPerStep. Unsaid: each change may.
	void openBudget() { m_budget = m_settings.nodesPerStep; }
	/// Whether something waits that the budget had no room for.
	bool hasBacklog() const { return m_hasBacklog; }

	/// Reads the strains and stretches last measured; `seconds` since the last reading. True when there is something to change.
	bool review( const NodeState& nodes, const AlignedArray<float>& strain, const AlignedArray<float>& stretch, float seconds );
	/// Makes the changes that `review` and requests asked for, within the budget. Momentum and spin of the nodes stay what they were where
	/// no node is held. `measuresEnergy`: whether LevelChange::energy is wanted; where rows are left there is none.
	void apply(
		NodeState& nodes, LatticeMatcher& matcher, const Material& material, TaskRunner* tasks = nullptr, bool measuresEnergy = false );
	/// The same for a list of one's own: octree nodes, as in changeCut.
	void change( NodeState& nodes, LatticeMatcher& matcher, const Material& material, const std::vector<std::uint32_t>& split,
		const std::vector<std::uint32_t>& merge, TaskRunner* tasks = nullptr, bool measuresEnergy = false );

	std::size_t bytes() const;

private:
	static constexpr int kNoBudget = -1;
	static constexpr float kMergeTogether = 0.5f; ///< share of Adaptivity::mergeDelay between one merging and the next

	/// `regions` and `tables` are the cut's.
	Levels( std::shared_ptr<const LevelBase> base, const Lattice& lattice, const Adaptivity& settings, const std::vector<float>& stiffness,
		Cut cut, LevelRegions regions, std::shared_ptr<const RegionTables> tables );

	void measureLoads( const AlignedArray<float>& strain, const AlignedArray<float>& stretch );
	std::vector<std::uint8_t> strainedNodes() const;
	void collectSplits();
	void collectMerges( const NodeState& nodes );
	bool isHeldAsOne( std::uint32_t node ) const;
	/// A change for a few nodes costs nearly as much as one for many, and what comes to rest does so node by node: what is to be merged
	/// waits for more of it, for a share of the delay that each node has waited for already.
	void gatherMerges( float seconds )
	{
		m_sinceMerge += seconds;
		if ( m_split.empty() && m_sinceMerge < kMergeTogether * m_settings.mergeDelay )
		{
			m_merge.clear();
		}
		m_sinceMerge = m_merge.empty() ? m_sinceMerge : 0.0f;
	}
	/// What of the cut a review asks about.
	struct Reviewed
	{
		struct Coarse
		{
			std::uint32_t slot, node;
			int level;
			bool isTooBig;
		};
		/// Children of one node, all of which are in the cut.
		struct Siblings
		{
			std::uint32_t parent, first, count; ///< first: slot
			int parentLevel;
			bool isParentTooBig;
		};
		std::vector<Coarse> coarse; ///< not on the finest level; both ascending by slot
		std::vector<Siblings> siblings;
		unsigned version = 0;
		bool isKnown = false;
	};
	void findReviewed();
	bool mayMerge( const NodeState& nodes, const Reviewed::Siblings& of ) const;
	/// Of each node: 1 where it was asked to be split.
	std::vector<std::uint8_t> askedNodes() const;
	void planScratch();
	void prepareScratch();
	void keepScratch( std::shared_ptr<const RegionTables> old );
	NodeState changedNodes( const NodeState& before, LatticeMatcher& matcher, const Cut& next, float density );
	void splitInto( const NodeState& before, const std::vector<std::uint32_t>& parents, const std::vector<float>& gradients,
		const Cut& next, NodeState& now ) const;
	void easeParts( NodeState& nodes, LatticeMatcher& matcher );
	void findParts( const NodeState& nodes );
	void settle( NodeState& nodes, LatticeMatcher& matcher, const RegionWork* before );
	std::vector<std::uint32_t> regionsGone( const std::vector<std::uint32_t>& regionBefore, int countBefore ) const;
	std::vector<std::uint32_t> splitNodes( const Cut& next ) const;
	void numberSources( const Cut& next );
	void countLevels();
	/// Whether the first cut of the whole body has smaller nodes there: on the way back to one of its nodes, nodes are merged that it would
	/// not choose by themselves. What a piece has of a block may weigh too little for keepMass: it was one node with the rest, and may be
	/// one without.
	bool isTooBig( std::uint32_t node ) const
	{
		return octree().levelOf( node ) > int( m_coarsest[octree().cells[octree().cellStart[node]]] );
	}
	std::vector<std::uint32_t> unchangedRows( const RegionMatrix& old, const Cut& next ) const;
	bool isKept( const Cut& next, int node ) const { return m_cut.node[m_change.source[node]] == next.node[node]; }
	void mergeInto( const NodeState& before, int first, NodeState& now, int slot ) const;
	Eigen::Matrix3d velocityGradient( const NodeState& nodes, int node ) const;

	std::shared_ptr<const LevelBase> m_base;
	bool m_ownsBase = false; ///< else it is the template's, and others may ask for it
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

	/// What the change before the last left, for the next to be built in.
	struct Scratch
	{
		int count = 0; ///< nodes there is room for
		Cut cut;
		MatrixScratch matrix;
		std::shared_ptr<RegionTables> tables;
		FineRegions fine;
		NodeState nodes;
		std::vector<float> quiet;
	};
	Scratch m_scratch;
	bool m_hasScratch = false;

	std::vector<std::uint8_t> m_coarsest; ///< of each finest cell: the level of the node that the first cut of the whole body has there
	std::vector<std::uint8_t> m_heldOn;   ///< of each finest cell: the level of the node that was held above it last; empty: none ever was
	std::vector<float> m_load;            ///< of each node: its strain over what splits it, as last reviewed; empty: not known
	std::vector<float>
		m_quiet; ///< of each node: seconds since its strain was last above the merging threshold, or it was asked for; 0 while it is
	float m_sinceMerge = std::numeric_limits<float>::max(); ///< s
	std::vector<std::uint8_t> m_isWanted;                   ///< of each node: 1 where it was asked for since the last review
	Reviewed m_reviewed;
	std::vector<std::uint32_t> m_split, m_merge; ///< octree nodes, found by the last review
	std::vector<std::uint32_t> m_asked;          ///< octree nodes
	int m_budget = kNoBudget;                    ///< new nodes that changes may still bring
	bool m_hasBacklog = false;
	bool m_leavesRows = false;
	std::vector<std::uint32_t> m_parts; ///< nodes that the change has made by splitting and that may move, ascending
	std::vector<float> m_partDisplacement;
	std::vector<std::uint32_t> m_left; ///< rows that are not measured, ascending
};

} // namespace pliant
