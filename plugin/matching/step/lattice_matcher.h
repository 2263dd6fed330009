#pragma once

// Uniform lattice shape matching (Rivers and James 2007; Steinemann et al. 2008, section 3.2) on the 16-lane kernels. ReferenceMatcher is
// its reference implementation.

#include "matching/kernels/kernels.h"
#include "matching/matcher.h"
#include "matching/regions/connected_parts.h"
#include "matching/regions/region_tables.h"
#include "matching/step/coarse_to_fine.h"
#include "matching/step/plasticity.h"

#include <array>
#include <memory>
#include <vector>

namespace pliant {

/// For alpha / h^2 = 1 and full cells of 1 kg; for a material, multiply by alpha / h^2 and the mass of a full cell.
struct RegionWork
{
	/// Half the work of the pulls along the displacement to zero strain, m^2: U = 1/2 sum over r and a of u_ar b_r ( x_a - c_r - R_r S_r
	/// q_a ).( x_a - g_ra ).
	double springs = 0.0;
	/// Current power of the pulls, m^2/s: sum of u_ar b_r v_a.( g_ra - x_a ).
	double power = 0.0;
};

class LatticeMatcher : public Matcher
{
public:
	LatticeMatcher( const Lattice& lattice, const Material& material, std::shared_ptr<const RegionTables> tables,
		const Kernels& kernels = bestKernels() );
	LatticeMatcher( const Lattice& lattice, const Material& material, Summation summation = Summation::Automatic,
		const Kernels& kernels = bestKernels() );

	void reset( const NodeState& nodes, const Eigen::Quaterniond& rotation ) override;
	void turn( const Eigen::Quaterniond& by ) override;
	void accelerate( NodeState& nodes, const MatchStep& step, TaskRunner* runner ) override;
	void nodeRotations( const NodeState& nodes, float* quaternions ) const override;
	void archive( Archive& archive ) override;
	const RegionTables& tables() const { return *m_tables; }
	/// Incremented whenever the tables are replaced.
	unsigned tablesVersion() const { return m_tablesVersion; }
	const Kernels& kernels() const { return m_kernels; }
	/// Connected parts of the nodes, as of the last substep.
	const ConnectedParts& parts() const { return m_parts; }
	/// Length of each of the two record arrays in `view`.
	std::size_t recordFloats() const { return m_nodeRecord.size(); }

	/// Replaces the regions after a change of nodes: node i takes over the history of its source, and plastic flow according to `sources`.
	void setTables( std::shared_ptr<const RegionTables> tables, const FlowSources& sources );
	/// Takes over the history and plastic flow of another body's regions: region i from region `source[i]`.
	void inherit( const LatticeMatcher& from, const std::vector<std::uint32_t>& source );
	/// For the same nodes, previously in the order `before`, on a lattice with other links, which must outlive this object; on levels.
	/// Equivalent to `inherit` for a new matcher, but reuses this one's memory.
	void relink( const Lattice& lattice, std::shared_ptr<const RegionTables> tables, const std::vector<std::uint32_t>& before );
	/// Nodes must be the lattice's cells. `stiffness`: factor of each cell; empty: 1 everywhere. 0 levels: none.
	void setFarLevels( int levels, const std::vector<float>& stiffness = {} );
	const CoarseToFine* farLevels() const { return m_far.get(); }
	/// Null until a region yields.
	const PlasticFlow* plasticFlow() const { return m_plastic.get(); }
	void forgetFlow() override { m_plastic.reset(); }
	bool hasFlowed() const override { return m_plastic != nullptr; }
	bool nodeFlow( int count, float* stretches ) const override;
	/// For each region, the sum over the singular values s of F of ( s - 1 )^2, as last measured (MatchStep::measuresStrain).
	const AlignedArray<float>& strain() const { return m_strain; }
	/// Of each region: m of kernels/kernel_volume.h at the last `accelerate` that stored gradients; empty if none did.
	const AlignedArray<float>& volumeSize() const { return m_volumeSize; }
	/// The largest change of volume of a region, | m | of kernels/kernel_volume.h up to 1, at the last `accelerate` that stored its
	/// gradients; 0 if none did.
	float mostVolumeChange() const;
	/// The same for the upper bound of the largest s - 1, in which compression counts little.
	const AlignedArray<float>& stretch() const { return m_stretch; }
	/// The body's own rotation, as of the last substep.
	const Eigen::Quaterniond& frame() const { return m_frame; }
	/// F of every region in world axes, from the current nodes, 9 floats per region, row-major. The tables must hold J^+.
	void deformations( NodeState& nodes, float* gradients );
	/// The same, bitwise, for some regions: 9 floats each. Any order, ascending is fastest.
	void deformationsOf( NodeState& nodes, const std::vector<std::uint32_t>& which, float* gradients );
	/// Offsets of some nodes, ascending, to the positions their regions predict: mean over the regions of c + F q, less x. 3 floats each,
	/// m, world axes. Zero where all regions are deformed alike. Valid only between setTables and the next substep; advances the rotations.
	void offsetsOf( NodeState& nodes, const std::vector<std::uint32_t>& which, float* offsets );
	/// Work of some regions, ascending, on the current nodes. Advances the rotations as above.
	RegionWork workOf( NodeState& nodes, const std::vector<std::uint32_t>& regions );
	/// Reserves capacity for `count` nodes, so that setTables does not allocate up to that number.
	void reserveNodes( int count );

	/// The kernels' view with body frame and step at their defaults; for benchmarks of single kernels.
	MatchView view( NodeState& nodes );
	bool usesBoxSums() const { return m_tables->usesGrid; }

private:
	void measureFrame( const NodeState& nodes, MatchView& view, TaskRunner* runner );
	void gatherAndFit( MatchView& view, const MatchStep& step, TaskRunner* runner );
	void setFrame( MatchView& view, const Vec3d& centre ) const;
	void sumNodeRecords( const MatchView& view, TaskRunner* runner );
	void boxSums( const MatchView& view, float* records, TaskRunner* runner );
	void settleOpenRegions( const MatchView& view );
	void correctRigidMotion( MatchView& view, float h ) const;
	void updateParts( const MatchView& view, bool isOnePart );
	void applyToParts( const MatchView& view, const MatchStep& step, TaskRunner* runner );
	void applyToPart( const MatchView& view, const MatchStep& step, int part );
	void flow( const MatchView& view, const MatchStep& step, TaskRunner* runner );
	void allocate();
	void allocateScratch();
	std::array<AlignedArray<float>*, 7> history();
	MatchView currentView( NodeState& nodes );
	void markTiles( const MatchView& view, const std::vector<std::uint32_t>& which );
	void fitTiles( const MatchView& view );
	RegionWork workOf( const MatchView& view, std::uint32_t region ) const;
	void viewLevels( MatchView& view ) const;
	void viewBlend( MatchView& view ) const;
	void viewVolume( MatchView& v );

	const Kernels& m_kernels;
	const Lattice* m_lattice;
	std::shared_ptr<const RegionTables> m_tables;
	unsigned m_tablesVersion = 0;
	float m_cellSize = 0.0f;
	float m_beta = 0.0f;
	float m_volumeFraction = 0.0f; ///< kappa
	bool m_rotationFromF = false;
	bool m_keepsMomentum = true; ///< conserving weights and rotations from A_pq: rounding errors of momentum are removed

	// State between substeps.
	Eigen::Quaterniond m_frame = Eigen::Quaterniond::Identity();
	AlignedArray<float> m_quaternion[4];
	AlignedArray<float> m_residual[3];
	AlignedArray<float> m_historyScratch; ///< for a change of levels

	ConnectedParts m_parts;
	unsigned m_partsVersion = 0;     ///< of the tables in which they were found
	std::vector<float> m_partLength; ///< of each part at rest, longest edge of its box, m

	std::unique_ptr<PlasticFlow> m_plastic;
	std::unique_ptr<CoarseToFine> m_far; ///< null where there are no far levels

	// Scratch of one substep.
	double m_mass = 0.0; ///< kg
	AlignedArray<float> m_change[3];
	AlignedArray<float> m_strain, m_stretch;               ///< empty until first measured
	AlignedArray<float> m_volumeGradient[9], m_volumeSize; ///< empty until an implicit step conserves volume
	AlignedArray<float> m_nodeRecord, m_regionRecord;
	std::vector<std::uint32_t> m_open;
	std::vector<int> m_openCount;
	/// Rest position and displacement, cells, and velocity, m/s, in the body's frame.
	struct NodeMotion
	{
		Eigen::Vector3d q, u, v;
	};
	std::vector<NodeMotion> m_nodeMotion;                             ///< scratch of workOf
	std::vector<std::uint8_t> m_neededNodeTiles, m_neededRegionTiles; ///< of each tile; scratch of offsetsOf and workOf
	std::vector<std::array<float, kImpulseSums>> m_partial;           ///< one set of sums per chunk
	bool m_isHistoryForeign = false;                                  ///< the last residuals are those of other regions: no damping by them
};

} // namespace pliant
