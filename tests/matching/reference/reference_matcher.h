#pragma once

// Lattice shape matching as the papers define it: world coordinates, double precision, sums in sequence. Reference implementation of
// LatticeMatcher; also the only implementation of FastLSM's original region damping.

#include "lattice/region.h"
#include "matching/matcher.h"
#include "matching/regions/region_moments.h"

#include <vector>

namespace pliant {

enum class DampingForm : int
{
	GoalRate,      ///< k times the change of goal - position since the last substep (what the kernels do)
	RegionVelocity ///< k times the difference to the mean rigid motion of the covering regions (Rivers and James 2007, section 5)
};

class ReferenceMatcher : public Matcher
{
public:
	ReferenceMatcher( const Lattice& lattice, const Material& material, DampingForm dampingForm = DampingForm::GoalRate );

	void reset( const NodeState& nodes, const Eigen::Quaterniond& rotation ) override;
	void turn( const Eigen::Quaterniond& by ) override;
	void accelerate( NodeState& nodes, const MatchStep& step, TaskRunner* runner ) override;
	void nodeRotations( const NodeState& nodes, float* quaternions ) const override;
	void forgetFlow() override;

	/// Goal of each node minus its position, m, in world axes, as of the last `accelerate`.
	const std::vector<Vec3d>& residual() const { return m_residual; }
	/// S_p of a region.
	const Eigen::Matrix3d& plasticStretch( int region ) const { return m_fits[std::size_t( region )].plastic; }

private:
	struct Fit
	{
		Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
		Eigen::Matrix3d linear = Eigen::Matrix3d::Identity();  ///< ( R + beta (F - R) ) S_p
		Eigen::Matrix3d plastic = Eigen::Matrix3d::Identity(); ///< S_p
		Vec3d centre = Vec3d::Zero();                          ///< c_r, m
		Vec3d restCentre = Vec3d::Zero();                      ///< c0_r, m
		Vec3d velocity = Vec3d::Zero();
		Vec3d spin = Vec3d::Zero(); ///< angular velocity, rad/s
	};

	Eigen::Quaterniond fitBody( const NodeState& nodes );
	void fitRegions( const NodeState& nodes, const MatchStep& step );
	void fitMotion( const NodeState& nodes, int region, Fit& fit ) const;

	const Lattice& m_lattice;
	Material m_material;
	bool m_hasFlowed = false; ///< whether a region flowed in the last substep
	DampingForm m_dampingForm;
	RegionSet m_regions;
	RegionMoments m_moments;
	std::vector<Fit> m_fits;
	Eigen::Quaterniond m_bodyRotation = Eigen::Quaterniond::Identity();
	Vec3d m_bodyCentre = Vec3d::Zero();
	std::vector<Vec3d> m_residual;
	std::vector<Vec3d> m_residualBefore;
};

} // namespace pliant
