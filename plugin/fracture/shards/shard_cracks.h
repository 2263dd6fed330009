#pragma once

// Cracks between shards: BreakRule::Shards. A body's cells are divided into shards ahead. A crack has a plane, across the largest stretch
// where it starts; shards are above or below it by their centres, and the crack opens the borders between the two, one after the other, as
// long as each is stretched across the plane and the two shards hold the energy that it takes. An extension of Ohta et al. 2009,
// "Fracturing"; the energy balance is Griffith's (1921).

#include "fracture/cell_positions.h"
#include "fracture/cut_links.h"
#include "fracture/face_stretch.h"
#include "fracture/link_limits.h"
#include "fracture/shards/shard_centres.h"
#include "fracture/shards/shard_event.h"
#include "pliant/fracture.h"

#include <functional>
#include <memory>
#include <vector>

namespace pliant {

/// ShardCentres as given by a game.
struct GivenCentres
{
	std::vector<Vec3d> position;      ///< mesh coordinates, m
	std::vector<std::uint32_t> shard; ///< of each centre
};

class ShardCracks
{
public:
	/// Divides the cells into shards. `given`: may be empty; the settings then say where they are.
	ShardCracks( const Lattice& lattice, const Fracture& settings, const GivenCentres& given );
	/// The same shards for a piece: some cells of the lattice, ascending. `fraction`: of the whole's mass, which divides what may become
	/// crumbs.
	ShardCracks( const ShardCracks& whole, const Lattice& piece, const std::vector<std::uint32_t>& cells, double fraction );

	/// Sets the breaking strain and Young's modulus, Pa, of the material. To be called before the body is tested.
	void setLaw( float breakStrain, double youngsModulus );
	/// Strain for limitLinks that finds candidates.
	float candidateStrain() const;

	/// Finds where the material is stretched beyond its strength. `limits` made for candidateStrain().
	void findOverloads( const Lattice& lattice, const LinkLimits& limits, const CellPositions& positions );
	/// Updated by findOverloads.
	FaceStretch& faces() { return m_faces; }
	/// Adds a cell under a coarse node to the overloaded cells if its F exceeds the strength. Call after findOverloads.
	void noteOverload( const Lattice& lattice, const LinkLimits& limits, std::uint32_t cell, const Eigen::Matrix3d& deformation );
	/// Runs cracks from the overloaded cells and adds the links that break, ascending. Returns false if none is overloaded. `positions` is
	/// called where there are: of each cell, relative to any origin.
	bool run( const Lattice& lattice, const LinkLimits& limits, const std::function<std::vector<Vec3d>()>& positions,
		std::vector<CellLink>& broken );

	/// The borders of shards on broken links between cells that share a face: where cracks are drawn. Cells
	/// of `lattice`; mesh coordinates.
	std::vector<CutTrace> tracesOf( const Lattice& lattice, const std::vector<CellLink>& broken ) const;

	/// Shard of each cell. Numbers are those of the first body of the family.
	const std::vector<std::uint32_t>& shards() const { return m_shard; }
	/// False where the body is one shard and no crumbs may come off it.
	bool canBreak() const { return !m_isOne || m_crumbMass > 0.0; }
	/// True where all cells are of one shard: no crack runs through it.
	bool isOne() const { return m_isOne; }
	const ShardLaw& law() const { return m_law; }

	/// For a body of this many cells.
	void archive( Archive& archive, std::size_t cells );
	static std::unique_ptr<ShardCracks> blank() { return std::unique_ptr<ShardCracks>( new ShardCracks ); }

private:
	ShardCracks() = default;
	void divide( const Lattice& lattice, const Vec3d& impact, const std::vector<std::uint32_t>& shardOfCentre );
	void findOne();

	Fracture m_settings;
	ShardLaw m_law;
	std::shared_ptr<const ShardCentreSet> m_centres, m_crumbCentres;
	std::vector<std::uint32_t> m_shard; ///< by cell
	std::vector<std::uint32_t> m_crumb; ///< by cell; empty: there are no crumbs
	double m_crumbMass = 0.0;           ///< that may still become crumbs, cells' fill
	bool m_isOne = false;               ///< all cells are of one shard
	bool m_awaitsImpact = false;        ///< ShardPattern::Rings before the first break
	FaceStretch m_faces;
	std::vector<ShardOverload> m_overloads;
};

} // namespace pliant
