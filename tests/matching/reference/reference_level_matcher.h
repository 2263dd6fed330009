#pragma once

// The step over several levels directly from its formulas, region by region, in double precision: the reference implementation of
// LatticeMatcher on level tables. Ohta et al. 2009, eq. 1-6; regions with multiplicity use the same formulas with other weights.

#include "matching/matcher.h"
#include "matching/regions/level_tables.h"

#include <vector>

namespace pliant {

class ReferenceLevelMatcher : public Matcher
{
public:
	ReferenceLevelMatcher(
		const LevelBase& base, const Lattice& lattice, const Cut& cut, const Material& material, const Adaptivity& settings );

	void reset( const NodeState& nodes, const Eigen::Quaterniond& rotation ) override;
	void turn( const Eigen::Quaterniond& by ) override;
	void accelerate( NodeState& nodes, const MatchStep& step, TaskRunner* runner ) override;
	void nodeRotations( const NodeState& nodes, float* quaternions ) const override;
	/// S_p of a region.
	const Eigen::Matrix3d& plasticStretch( int region ) const { return m_region[std::size_t( region )].plastic; }

private:
	struct Region
	{
		RegionRest rest;
		double beta = 0.0, eta = 0.0;
		Eigen::Matrix3d blend = Eigen::Matrix3d::Identity(); ///< C
		Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
		Vec3d centre = Vec3d::Zero();
		Eigen::Matrix3d f = Eigen::Matrix3d::Identity(), l = Eigen::Matrix3d::Identity(); ///< F_e S_p and L S_p
		Eigen::Matrix3d plastic = Eigen::Matrix3d::Identity();                            ///< S_p
	};

	void tune( std::uint32_t r, Region& region ) const;
	void fit( const NodeState& nodes, const MatchStep& step, std::uint32_t r );
	Eigen::Quaterniond fitBody( const NodeState& nodes ) const;

	const LevelBase& m_base;
	const Lattice& m_lattice;
	Cut m_cut;
	Material m_material;
	bool m_hasFlowed = false; ///< whether a region flowed in the last substep
	Adaptivity m_settings;
	RegionMatrix m_matrix;
	std::vector<Region> m_region;
	std::vector<Vec3d> m_residual;
	Eigen::Quaterniond m_bodyRotation = Eigen::Quaterniond::Identity();
};

} // namespace pliant
