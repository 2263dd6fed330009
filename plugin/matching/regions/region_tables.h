#pragma once

// Data shared by all bodies of one template and setting: regions, their weights and moments, and the summation method.

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

class Archive;

/// How sums over regions are computed.
enum class Summation : int
{
	Automatic, ///< box sums where regions are full cubes and the grid is well filled, else the table
	Table,     ///< one term per member of the region (flat compressed rows)
	BoxSums    ///< separable sums over the grid; falls back to the table where regions are not full cubes
};

/// Immutable once built.
struct RegionTables
{
	RegionSet regions;
	RegionMoments moments;

	bool usesGrid = false;  ///< box sums; the member table is then dropped
	bool usesLinks = false; ///< w = 1: a region is its owner and the owner's links, so the lattice's link table is used
	bool gridHasHoles = false;
	Eigen::Vector3i grid = Eigen::Vector3i::Zero();
	std::vector<std::uint32_t> slot; ///< lattice position of each cell; empty without holes

	AlignedArray<float> pull;          ///< of each node, MatchView::pull; empty where all are 1
	AlignedArray<float> outOfPlane[6]; ///< 1 - J J^+; empty where every region is solid or J^+ is not needed
	AlignedArray<float> blend[9];      ///< C of each region (level_tables.h, link_moments.h); empty where beta is a scalar
	float largestRateFraction = 1.0f;
	// Replace b_r and `pull` in the implicit step's operator (link_moments.h); empty: not replaced.
	AlignedArray<float> rateFraction, ratePull;

	// For nodes on several levels only (level_tables.h); empty on a uniform lattice. The matrix then replaces `regions`.
	std::shared_ptr<const RegionMatrix> matrix;
	std::shared_ptr<const SumPlan> plan; ///< sums over the octree instead of the matrix; null: none
	AlignedArray<float> beta, eta;       ///< of each region; empty where all are 0

	/// Writes or reads all numbers, which depend on how the tables came about in their last bits; the rest follows from the lattice.
	void archiveNumbers( Archive& archive );
};

/// True where any of the material's settings needs J^+.
bool needsInverse( const Material& material );

/// `stiffness`: factor on the material's stiffness for each cell; empty: 1 everywhere. A region takes the factor of its owner, so that
/// action and reaction stay equal.
std::shared_ptr<const RegionTables> buildRegionTables( const Lattice& lattice, const Material& material, Summation summation,
	const std::vector<float>& stiffness = {}, const MomentsBefore* before = nullptr );

/// Returns tables by setting, each built once and kept for as long as a body holds it. Thread-safe.
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
		float linkBeta; ///< beta of tables with link moments, which depend on it; -1: no link moments
		std::weak_ptr<const RegionTables> tables;
	};

	std::mutex m_mutex;
	std::vector<Entry> m_entries;
};

} // namespace pliant
