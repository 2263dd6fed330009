#pragma once

// Far propagation: matching on blocks of cells beside the matching on cells, so that a force reaches farther in one substep. Off unless
// asked for. Neither paper has it; both name slow propagation as the limit of small regions (Steinemann et al. 2008, section 3.2).
//
// Level l has one node for each connected part of each block of 2^l cells an edge (octree.h), and one region a node: the blocks linked to
// it. A region is matched on all cells in it, not on the blocks' centres: its sums are those of its cells, and its goal is affine. Hence
// momentum, linear and angular, is exact on every level. Sums go up the tree and goals come down it: the finest nodes are touched once
// whatever the levels.
//
// Per level l, its blocks B and regions r, the arithmetic being that of the finest level (kernel_fit.h):
//   up:    S_B = sum of w_i m_i ( u, u q^T ) over the block's cells, w_i = 1, more where pinned
//   match: a_B = S_B / n_B, n_B regions hold the block;  c, A_pq, F from the sums over the region's blocks, R the turn of A_pq
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

class TaskRunner;

/// Levels that a body is long enough for, at most `wanted`.
int usefulFarLevels( const Lattice& lattice, int wanted );

class CoarseToFine
{
public:
	/// `tables`: those of the finest level, whose records the sums begin with. `stiffness`: share of each cell; empty: 1 everywhere.
	CoarseToFine( const Lattice& lattice, int levels, const RegionTables& tables, const std::vector<float>& stiffness );

	void reset();
	/// Matches all levels that have a share and shows the view what they ask of the nodes. The view's node records must be fresh.
	void match( MatchView& view, const FarFractions& fractions, const Kernels& kernels, TaskRunner* runner );
	int levels() const { return int( m_levels.size() ); }
	/// b and eta of region r, which is that of block r, on level 1, 2 ...
	double pull( int level, int r ) const { return m_levels[level - 1].weight[r]; }
	double eta( int level, int r ) const { return m_levels[level - 1].eta[r]; }
	std::size_t bytes() const;

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

	/// Of all nodes of one level.
	struct BlockMoments
	{
		std::vector<FarMoments> plain, heavy;
		std::vector<double> stiffness; ///< mean share; empty: 1 everywhere
	};

	static void buildLevel( Level& level, const std::vector<std::uint32_t>& parentOfChild, int count,
		const std::vector<std::pair<std::uint32_t, std::uint32_t>>& links );
	void weighCells( const float* freedom );
	static BlockMoments momentsAbove( const BlockMoments& below, const Level& level );
	void weighRegions( int number, const BlockMoments& blocks );
	double heldEta( int number, int r, const FarRegion& region, const FarMoments& plain ) const;
	void collectCells( int level, std::uint32_t block, const std::function<void( std::uint32_t )>& take ) const;
	static void storeRegion( Level& level, int r, const FarRegion& region );
	void weighPulls( const FarFractions& fractions );
	static void matchLevel( Level& level, const MatchView& view, const Kernels& kernels, TaskRunner* runner );

	const Lattice& m_lattice;
	std::vector<Level> m_levels;        ///< blocks of 2 cells an edge first
	std::vector<std::uint32_t> m_block; ///< of each cell
	std::vector<float> m_stiffness;
	std::vector<std::uint32_t> m_record; ///< beside the finest blocks' children: which record is theirs; empty: record i is cell i
	std::vector<std::uint32_t> m_slot;   ///< of each cell: its record; empty: its own number
	AlignedArray<float> m_perRecord;     ///< from a record of the finest level to w_i m_i ( u, u q^T )
	AlignedArray<float> m_nodeWeight;
	AlignedArray<float> m_nodePull; ///< P of each cell
	AlignedArray<float> m_freedom;  ///< as the moments know it
	FarFractions m_fractions = {};  ///< as m_nodePull knows them
};

} // namespace pliant
