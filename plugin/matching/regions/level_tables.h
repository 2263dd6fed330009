#pragma once

// Tables of a body with nodes on several levels: the region matrix, its moments, and the softening of each region.
// Ohta et al. 2009, "Stiffness Consistency when The Subdivision Level of Nodes are Changed".

#include "adapt/moments/energy_match.h"
#include "adapt/octree/visibility_graph.h"
#include "adapt/regions/interval_regions.h"
#include "adapt/regions/region_matrix.h"
#include "matching/regions/region_tables.h"
#include "pliant/adaptivity.h"
#include "pliant/task_runner.h"

#include <memory>

namespace pliant {

/// Data shared by bodies of one template, number of levels and half-width.
struct LevelBase
{
	Octree octree;
	FineRegions fine;
	FineMoments moments; ///< empty unless the settings require energies

	/// As RegionTables::archiveNumbers.
	void archiveNumbers( Archive& archive );
};

std::shared_ptr<const LevelBase> buildLevelBase( const Lattice& lattice, const Material& material, const Adaptivity& settings );

/// One base for each setting in use, built once and kept for as long as a body holds it. Thread-safe.
class LevelCache
{
public:
	std::shared_ptr<const LevelBase> find( const Lattice& lattice, const Material& material, const Adaptivity& settings );

private:
	struct Entry
	{
		int coarseLevels, halfWidth;
		bool withMoments;
		std::weak_ptr<const LevelBase> base;
	};

	std::mutex m_mutex;
	std::vector<Entry> m_entries;
};

/// Data, besides the lattice, shared by all bodies of one template.
struct TemplateCache
{
	RegionCache regions;
	LevelCache levels;
};

/// The initial cut of a body.
Cut firstCut( const Octree& octree, const Adaptivity& settings );

/// Regions in the form that the tables use.
struct LevelRegions
{
	std::shared_ptr<const RegionMatrix> matrix;
	std::shared_ptr<const SumPlan> plan; ///< null: the matrix is summed
};

/// Input of building the regions of a cut.
struct RegionInput
{
	const LevelBase& base;
	const Lattice& lattice;
	const Material& material;
	const Adaptivity& settings;
	TaskRunner* tasks = nullptr;
	MatrixScratch* scratch = nullptr; ///< for RegionRule::Multiplicity; may be null
};

/// Builds the regions of a cut from scratch.
LevelRegions buildLevelRegions( const RegionInput& input, const Cut& cut );

/// Returns the regions of cut `to`, given those of cut `from`: equal to a build from scratch, which other rules than multiplicity do.
LevelRegions updateLevelRegions( const RegionInput& input, const Cut& from, const LevelRegions& regions, const Cut& to );

/// The tables before a change of levels: unchanged rows need not be measured again.
struct TablesBefore
{
	const RegionTables* tables = nullptr;
	std::vector<std::uint32_t> region;       ///< previous index of each region whose row holds the same nodes and masses, else kNoNode
	std::shared_ptr<RegionTables> scratch{}; ///< unused tables of the same settings to overwrite; may be null
	Vec3d shift = Vec3d::Zero();             ///< of the rest positions, cells: the new mass centre of a piece relative to the previous one
	bool skipsOthers = false;                ///< changed rows are left to fillSkippedRows, or to the next tables
};

/// Inputs of a region besides its row. `stiffness`: factor on the material's stiffness for each finest cell; empty: 1 everywhere. A region
/// takes the mass-weighted mean over its node, since energies add up.
struct LevelSettings
{
	const Material& material;
	const Adaptivity& adaptivity;
	const std::vector<float>& stiffness;
	TaskRunner* tasks = nullptr; ///< threads that measure the rows, with bitwise equal results; null: the calling thread
};

/// Reserves capacity for `reserved` nodes in `tables` and in the empty `others`, where the memory of `touched` of them is also touched.
void makeLevelScratch( RegionTables& tables, RegionTables& others, int reserved, int touched );

/// Builds tables for the step from a region matrix. With `before` the result is bitwise the same, and faster.
std::shared_ptr<const RegionTables> buildLevelTables( const LevelBase& base, const Lattice& lattice, const Cut& cut,
	const LevelRegions& regions, const LevelSettings& settings, const TablesBefore& before = {} );

/// Fills the rows that TablesBefore::skipsOthers skipped (RegionRule::Multiplicity), with bitwise the same result as without skipping.
void fillSkippedRows( const LevelBase& base, const Lattice& lattice, const Cut& cut, const LevelSettings& settings,
	const std::vector<std::uint32_t>& rows, RegionTables& tables );

} // namespace pliant
