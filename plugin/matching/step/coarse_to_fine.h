#pragma once

// Far propagation: matching on blocks of cells in addition to cells, so that a force reaches farther in one substep. Optional. An extension
// beyond the papers, which name slow propagation as the limit of small regions (Steinemann et al. 2008, section 3.2).
//
// Level l has one node for each connected part of each block of 2^l cells along an edge (octree.h), and one region per node: the blocks
// linked to it. A region is matched on all its cells, not on the blocks' centres: its sums are those of its cells, and its goal is affine.
// Hence linear and angular momentum is exact on every level. Sums are propagated up the tree and goals down: the finest nodes are visited
// once for any number of levels.
//
// For a level l with blocks B and regions r, in the arithmetic of the finest level (kernel_fit.h):
//   up:    S_B = sum of w_i m_i ( u, u q^T ) over the block's cells, w_i = 1, larger where pinned
//   match: a_B = S_B / n_B, n_B regions hold the block;  c, A_pq, F from the sums over the region's blocks, R the rotation of A_pq
//   down:  G_B = alpha_l / n_B sum of b_r ( D_r, ( 1 - eta_r ) uc_r - D_r c0_r ) + G_parent,   D_r = R_r - 1 - eta_r ( F_r - 1 )
//   node:  y += w_i ( G ( q, 1 ) - P u ),   P = sum over levels of alpha_l / n_B sum of b_r ( 1 - eta_r )

#include "adapt/octree/octree.h"
#include "matching/kernels/kernels.h"
#include "matching/node_state.h"
#include "matching/regions/region_tables.h"
#include "matching/step/far_region.h"
#include "matching/stiffness.h"

#include <functional>
#include <utility>
#include <vector>

namespace pliant {

class Archive;
class TaskRunner;

/// Number of levels that the body is long enough for, at most `wanted`.
int usefulFarLevels( const Lattice& lattice, int wanted );

class CoarseToFine
{
public:
	/// `tables`: those of the finest level, whose records the sums start from. `stiffness`: factor of each cell; empty: 1 everywhere.
	CoarseToFine( const Lattice& lattice, int levels, const RegionTables& tables, const std::vector<float>& stiffness );

	void reset();
	/// Matches all levels with a nonzero alpha and adds their goals to the view. The view's node records must be up to date.
	void match( MatchView& view, const FarFractions& fractions, const Kernels& kernels, TaskRunner* runner );
	int levels() const { return int( m_levels.size() ); }
	/// b and eta of region r, the region of block r, on level 1, 2 ...
	double pull( int level, int r ) const { return m_levels[level - 1].weight[r]; }
	double eta( int level, int r ) const { return m_levels[level - 1].eta[r]; }
	/// Writes or reads the data that one substep passes to the next.
	void archive( Archive& archive );

private:
	struct Level
	{
		int count = 0, padded = 0;
		std::vector<std::uint32_t> childStart, child;   ///< in the level below
		std::vector<std::uint32_t> parent;              ///< in the level above
		std::vector<std::uint32_t> regionStart, region; ///< blocks of each block's region
		AlignedArray<float> inverseCover;               ///< 1 / n_B
		AlignedArray<float> inverseMass, centre[3], moment[6], inverseMoment[6], outOfPlane[6], weight, eta;
		AlignedArray<float> quaternion[4];
		AlignedArray<float> pull; ///< of each block
		AlignedArray<float> sums, blockRecord, regionRecord, goal;
		std::vector<std::uint32_t> open;
		std::vector<int> openCount;
	};

	/// Moments of all nodes of one level.
	struct BlockMoments
	{
		std::vector<FarMoments> plain, weighted;
		std::vector<double> stiffness; ///< mean factor; empty: 1 everywhere
	};

	static void buildLevel( Level& level, const std::vector<std::uint32_t>& parentOfChild, int count,
		const std::vector<std::pair<std::uint32_t, std::uint32_t>>& links );
	void weighCells( const float* freedom );
	static BlockMoments momentsAbove( const BlockMoments& below, const Level& level );
	void weighRegions( int number, const BlockMoments& blocks );
	double pinnedEta( int number, int r, const FarRegion& region, const FarMoments& plain ) const;
	void collectCells( int level, std::uint32_t block, const std::function<void( std::uint32_t )>& visit ) const;
	static void storeRegion( Level& level, int r, const FarRegion& region );
	void weighPulls( const FarFractions& fractions );
	static void matchLevel( Level& level, const MatchView& view, const Kernels& kernels, TaskRunner* runner );

	const Lattice& m_lattice;
	std::vector<Level> m_levels;        ///< blocks of 2 cells along an edge first
	std::vector<std::uint32_t> m_block; ///< of each cell
	std::vector<float> m_stiffness;
	std::vector<std::uint32_t> m_record; ///< record index of each child of the finest blocks; empty: record i is cell i
	std::vector<std::uint32_t> m_slot;   ///< record index of each cell; empty: its own index
	AlignedArray<float> m_perRecord;     ///< from a record of the finest level to w_i m_i ( u, u q^T )
	AlignedArray<float> m_nodeWeight;
	AlignedArray<float> m_nodePull; ///< P of each cell
	AlignedArray<float> m_freedom;  ///< that the moments were computed with
	FarFractions m_fractions = {};  ///< that m_nodePull was computed with
};

} // namespace pliant
