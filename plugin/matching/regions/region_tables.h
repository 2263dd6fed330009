#pragma once

// What all bodies of one template and one setting share: regions, their weights and moments, and the way their sums are made.
// Fifteen elephants hold it once.

#include "adapt/regions/hierarchical_sum.h"
#include "adapt/regions/region_matrix.h"
#include "lattice/region.h"
#include "matching/regions/region_moments.h"
#include "pliant/material.h"

#include <Eigen/Core>

#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

namespace pliant {

/// How the sums over regions are made.
enum class Summation : int
{
	Automatic, ///< box sums where regions are full cubes and the grid is well filled, else the table
	Table,     ///< one term a member of the region (flat compressed rows)
	BoxSums    ///< separable sums over the grid; falls back to the table where regions are not full cubes
};

/// Immutable once built.
struct RegionTables
{
	RegionSet regions;
	RegionMoments moments;

	bool usesGrid = false;  ///< box sums; the table of members is then not kept
	bool usesLinks = false; ///< w = 1: a region is its owner and the owner's links; the lattice's table serves
	bool gridHasHoles = false;
	Eigen::Vector3i grid = Eigen::Vector3i::Zero();
	std::vector<std::uint32_t> slot; ///< lattice position of each cell; empty without holes

	AlignedArray<float> pull;          ///< of each node, MatchView::pull; empty where all are 1
	AlignedArray<float> outOfPlane[6]; ///< 1 - J J^+; empty where every region is solid or J^+ is not needed
	AlignedArray<float> blend[9];      ///< C of each region (level_tables.h, link_moments.h); empty where beta is a number
	float largestRateFraction = 1.0f;
	AlignedArray<float> rateFraction,
		ratePull; ///< what the implicit step's operator takes for b_r and `pull` (link_moments.h); empty: those

	// Of nodes on several levels only (level_tables.h); empty on a uniform lattice. The matrix then takes the place of `regions`.
	std::shared_ptr<const RegionMatrix> matrix;
	std::shared_ptr<const SumPlan> plan; ///< sums by way of the octree instead of the matrix; null: no
	AlignedArray<float> beta, eta;       ///< of each region; empty where all are 0

	std::size_t bytes() const;
};

/// Whether any of the material's settings needs J^+.
bool needsInverse( const Material& material );

/// `stiffness`: share of the material's for each cell; empty: 1 everywhere. A region takes the share of its owner, so that what it pulls
/// and what pulls back stay equal.
std::shared_ptr<const RegionTables> buildRegionTables( const Lattice& lattice, const Material& material, Summation summation,
	const std::vector<float>& stiffness = {}, const MomentsBefore* before = nullptr );

/// Hands out tables by setting, each built once for as long as a body holds it. Safe to call from several threads.
class RegionCache
{
public:
	std::shared_ptr<const RegionTables> find( const Lattice& lattice, const Material& material );

private:
	struct Entry
	{
		int halfWidth;
		Weights weights;
		bool withInverse;
		float linkBeta; ///< of tables with link moments, which know it; -1: they have none
		std::weak_ptr<const RegionTables> tables;
	};

	std::mutex m_mutex;
	std::vector<Entry> m_entries;
};

} // namespace pliant
