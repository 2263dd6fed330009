#pragma once

// Meshless shape matching of Müller et al. 2005: one cluster for the whole body, or several overlapping boxes; rigid, linear and quadratic
// modes (sections 3.3, 4.2, 4.3). The simplest method, and the cheapest level of detail.

#include "lattice/lattice.h"
#include "matching/clusters/cluster_set.h"
#include "matching/matcher.h"
#include "pliant/material.h"

#include <memory>
#include <vector>

namespace pliant {

/// Uses double precision throughout: a cluster may span the whole body, and there are few of them.
class ClusterMatcher : public Matcher
{
public:
	ClusterMatcher( ClusterSet clusters, const Material& material, const NodeState& nodes );

	void reset( const NodeState& nodes, const Eigen::Quaterniond& rotation ) override;
	void turn( const Eigen::Quaterniond& by ) override;
	void accelerate( NodeState& nodes, const MatchStep& step, TaskRunner* runner ) override;
	void nodeRotations( const NodeState& nodes, float* quaternions ) const override;
	void archive( Archive& archive ) override;

	const ClusterSet& clusters() const { return m_clusters; }
	/// Goal of each node minus its position, m, in world axes, as of the last `accelerate`.
	Vec3d residual( int node ) const { return m_frame * m_residual[node]; }

private:
	/// Terms of the quadratic mode: x, y, z, xx, yy, zz, xy, yz, zx   (Müller et al. 2005, section 4.3)
	static constexpr int kTerms = 9;
	using Terms = Eigen::Matrix<double, kTerms, 1>;
	using TermMap = Eigen::Matrix<double, 3, kTerms>;
	using TermMoment = Eigen::Matrix<double, kTerms, kTerms>;

	/// Lengths within a cluster are in units of `size`, masses relative to the cluster's mass, so that all moments are about 1.
	struct Cluster
	{
		Vec3d restCentre = Vec3d::Zero();                 ///< m
		double size = 1.0;                                ///< root mean square distance from the rest centre, m
		double inverseMass = 0.0;                         ///< 1 / sum of the members' shared masses
		Eigen::Matrix3d moment = Eigen::Matrix3d::Zero(); ///< sum of q q^T; its inverse is Müller's A_qq
		Eigen::Matrix3d inverseMoment = Eigen::Matrix3d::Zero();
		Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
		Eigen::Matrix3d linear = Eigen::Matrix3d::Identity(); ///< goal = centre + size * linear * q (+ quadratic terms)
		Vec3d centre = Vec3d::Zero();                         ///< m

		void archive( Archive& archive );
	};

	/// Additional data of the quadratic mode. Absent in the other modes.
	struct Quadratic
	{
		Terms mean = Terms::Zero(); ///< of the terms over the cluster at rest; zero for the linear ones
		Eigen::Matrix<double, 3, kTerms> moment = Eigen::Matrix<double, 3, kTerms>::Zero(); ///< first three rows of the 9 x 9 moment
		TermMoment inverseMoment = TermMoment::Zero();
		Eigen::Matrix<double, 3, kTerms - 3> map = Eigen::Matrix<double, 3, kTerms - 3>::Zero();

		void archive( Archive& archive );
	};

	/// A range of members that one task sums. Boundaries depend on the counts only, so that sums do not depend on the threads.
	struct Piece
	{
		int cluster;
		std::uint32_t first, last;
	};
	struct PieceSum
	{
		Vec3d position = Vec3d::Zero();
		TermMap moment = TermMap::Zero();
	};

	/// Sums over a chunk of nodes, about the body's centre.
	struct ImpulseSum
	{
		Vec3d impulse = Vec3d::Zero(), turn = Vec3d::Zero();  ///< of the internal velocity change
		Vec3d momentum = Vec3d::Zero(), spin = Vec3d::Zero(); ///< of the velocities before it
		Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
	};
	struct BodySum
	{
		double mass = 0.0;
		Vec3d first = Vec3d::Zero(), rest = Vec3d::Zero();
		Eigen::Matrix3d moment = Eigen::Matrix3d::Zero();
	};
	/// A velocity field of a rigid motion about the body's centre.
	struct Motion
	{
		Vec3d shift = Vec3d::Zero(), turn = Vec3d::Zero();
		Vec3d at( const Vec3d& arm ) const { return shift + turn.cross( arm ); }
	};

	bool isQuadratic() const { return !m_quadratic.empty(); }
	Terms terms( int cluster, const Vec3d& rest ) const;
	void measureRest( int cluster, const NodeState& nodes );
	void measureQuadraticRest( int cluster, const NodeState& nodes );
	void measureBody( const NodeState& nodes, TaskRunner* runner );
	void gather( const NodeState& nodes, TaskRunner* runner );
	void sumPiece( const NodeState& nodes, int piece );
	void fit( int cluster );
	void fitLinear( Cluster& cluster, const Eigen::Matrix3d& apq ) const;
	void fitQuadratic( Cluster& cluster, Quadratic& quadratic, const TermMap& apq ) const;
	Vec3d goal( int node, const Vec3d& rest ) const;
	ImpulseSum findChanges( const NodeState& nodes, const MatchStep& step, int first, int last );
	ImpulseSum foldImpulses() const;
	Motion unwantedMotion( double wobbleFraction ) const;

	ClusterSet m_clusters;
	ClusterMode m_mode;
	double m_beta;
	bool m_rotationFromF;
	bool m_isConserving;
	std::vector<double> m_weight; ///< a_i: the node's mass, divided among its clusters
	std::vector<Cluster> m_cluster;
	std::vector<Quadratic> m_quadratic;
	std::vector<Piece> m_pieces;
	std::vector<std::uint32_t> m_pieceStart; ///< of each cluster
	std::vector<PieceSum> m_pieceSum;
	std::vector<Vec3d> m_residual; ///< in the body's frame, m, so that it rotates with the body
	std::vector<Vec3d> m_change;   ///< of velocity, m/s
	std::vector<ImpulseSum> m_impulseSum;
	std::vector<BodySum> m_bodySum;
	Eigen::Quaterniond m_frame = Eigen::Quaterniond::Identity();
	Vec3d m_centre = Vec3d::Zero();
	Vec3d m_restCentre = Vec3d::Zero();
	double m_mass = 0.0;
};

/// For Method::SingleCluster and Method::Clusters.
std::unique_ptr<Matcher> makeClusterMatcher( const Lattice& lattice, const Material& material, const NodeState& nodes );

} // namespace pliant
