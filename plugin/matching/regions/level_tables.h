#pragma once

// The tables of a body whose nodes stand on several levels: the region matrix, its moments, and how soft each region is.
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

/// What bodies of one template, one number of levels and one half-width share.
struct LevelBase
{
	Octree octree;
	FineRegions fine;
	FineMoments moments; ///< empty unless the settings ask for energies
};

std::shared_ptr<const LevelBase> buildLevelBase( const Lattice& lattice, const Material& material, const Adaptivity& settings );

/// A base for each setting in use, built once for as long as a body holds it. Safe to call from several threads.
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

/// What bodies of one template share beside the lattice.
struct TemplateCache
{
	RegionCache regions;
	LevelCache levels;
};

/// The cut a body begins with.
Cut firstCut( const Octree& octree, const Adaptivity& settings );

/// Regions as the tables take them.
struct LevelRegions
{
	std::shared_ptr<const RegionMatrix> matrix;
	std::shared_ptr<const SumPlan> plan; ///< null: the matrix is summed
	// Of RegionRule::Interval only: what the next cut's regions are made from.
	std::shared_ptr<const VisibilityGraph> graph{};
	std::shared_ptr<const IntervalRegions> intervals{};
};

/// The regions of a cut from nothing.
LevelRegions buildLevelRegions(
	const LevelBase& base, const Lattice& lattice, const Cut& cut, const Material& material, const Adaptivity& settings );

/// What the regions of a cut are built for.
struct RegionInput
{
	const LevelBase& base;
	const Lattice& lattice;
	const Material& material;
	const Adaptivity& settings;
	TaskRunner* tasks = nullptr;
	MatrixScratch* scratch = nullptr; ///< for RegionRule::Multiplicity; may be null
};

/// The regions of cut `to`, given those of cut `from`: equal to those from nothing. Unions alone are built from nothing.
LevelRegions updateLevelRegions( const RegionInput& input, const Cut& from, const LevelRegions& regions, const Cut& to );

/// What is left of the tables before a change of levels: rows that are what they were need not be measured again.
struct TablesBefore
{
	const RegionTables* tables = nullptr;
	std::vector<std::uint32_t> region; ///< of each region now: its number then, where its row holds the same nodes and masses; else kNoNode
	std::shared_ptr<RegionTables> scratch{}; ///< tables of the same settings that nobody uses any more, to be written over; null: none
	Vec3d shift = Vec3d::Zero();             ///< from the rest places before to those now, cells: of the mass centre of a piece
	bool leavesOthers =
		false; ///< rows that are not taken over are not measured: fillLeftRows does that, or the next tables are made without them
};

/// What a region needs beside its row. `stiffness`: share of the material's for each finest cell; empty: 1 everywhere. A region takes the
/// mean over its node's mass: energies add up.
struct LevelSettings
{
	const Material& material;
	const Adaptivity& adaptivity;
	const std::vector<float>& stiffness;
	TaskRunner* tasks = nullptr; ///< rows are measured on its threads, to the same bits; null: on the calling one
};

/// Room for `reserved` nodes in tables and in others of the same kind, which are empty; for `touched` of them in memory that is there.
void makeLevelScratch( RegionTables& tables, RegionTables& others, int reserved, int touched );

/// Tables for the step out of a region matrix. With `before` the result is the same to the bit, sooner.
std::shared_ptr<const RegionTables> buildLevelTables( const LevelBase& base, const Lattice& lattice, const Cut& cut,
	const LevelRegions& regions, const LevelSettings& settings, const TablesBefore& before = {} );

/// What TablesBefore::leavesOthers left of tables by RegionRule::Multiplicity: the same to the bit as had it not been.
void fillLeftRows( const LevelBase& base, const Lattice& lattice, const Cut& cut, const LevelSettings& settings,
	const std::vector<std::uint32_t>& rows, RegionTables& tables );

} // namespace pliant
