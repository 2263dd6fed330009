#pragma once

// Plastic flow of rest shapes: each region's plastic stretch S_p, and the kernels' data that depends on it.
// Steinemann et al. 2008, section 7, eq. 9-10, after Müller et al. 2005, section 4.5.
//
//   A = A_pq S_p,  J' = S_p J S_p,  F_e = A J'^+,  S_e = sym( R^T F_e )
//   where | S_e - 1 | > yield:  S_p <- ( 1 + h creep ( S_e - 1 ) ) S_p, its rotation removed, det S_p = 1, | S_p - 1 | <= limit
//
// Flow never raises the region's elastic energy W = 1/2 tr( E B E^T ), E = R^T F_e - 1, B = S_p K S_p, K the moment that resists strain.
// The law alone does not ensure this: the projections to det = 1 and to the limit move S_p in directions in which a region of unequal
// moments may gain energy. Where it would, S_p flows along D = E - tr( E ) / tr( B^-1 ) B^-1 instead, the traceless D nearest to E in B, so
// that tr( D B E^T ) >= 0; the flow is halved, or skipped, where even that raises W.
//
// Norms are Frobenius norms: a bar under tension by e counts as e. The rotation removed from S_p goes into R, which is fitted in each
// substep; so S_p stays a pure stretch of the rest shape, which can be averaged, bounded and inherited.

#include "matching/kernels/kernels.h"
#include "matching/matcher.h"
#include "matching/regions/region_tables.h"

#include <Eigen/Core>

#include <cstdint>
#include <limits>
#include <vector>

namespace pliant {

/// A region that may flow, in cells and full cells.
struct FlowingRegion
{
	Eigen::Matrix3d total = Eigen::Matrix3d::Identity();    ///< F = F_e S_p
	Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity(); ///< R
	Eigen::Matrix3d moment = Eigen::Matrix3d::Identity();   ///< K: J, or J_fine where beta is a tensor
	Eigen::Matrix3d inverse = Eigen::Matrix3d::Identity();  ///< J^+
	Eigen::Matrix3d inPlane = Eigen::Matrix3d::Identity();  ///< J J^+
	double volumeKeeping = 0.0;                             ///< kappa; times 1 - beta where K includes that factor

	/// W for the rest shape `stretch` and the rotation `fitted`: an upper bound, exact for the best-fitting rotation.
	double energy( const Eigen::Matrix3d& fitted, const Eigen::Matrix3d& stretch ) const;
};

/// The law above. Returns false, and leaves `stretch` unchanged, where the region does not yield, or could not without gaining energy.
bool flowStretch( const PlasticLaw& law, float h, const FlowingRegion& region, Eigen::Matrix3d& stretch );

/// The stretch in M = Q U, the root of M^T M, scaled to det = 1 and moved towards 1 where its distance from 1 exceeds `limit`.
Eigen::Matrix3d unitStretch( const Eigen::Matrix3d& m, double limit = std::numeric_limits<double>::infinity() );

/// Sources of the plastic shapes after a change of levels. Nodes and regions have the same indices.
struct FlowSources
{
	const std::vector<std::uint32_t>& source; ///< for each region: a previous region
	/// For each previous region: its index now, its parent's where it was merged, kNoNode where it was split.
	const std::vector<std::uint32_t>& nodeNow;
	const AlignedArray<float>& massBefore;
};

/// S_p of all regions of a body, created when the first of them yields.
class PlasticFlow
{
public:
	explicit PlasticFlow( const RegionTables& tables );

	/// True where any region of the view strains beyond `yieldStrain`. Needs MatchView::strain.
	static bool yieldsAnywhere( const MatchView& view, float yieldStrain );

	/// Replaces the rest shapes in the view by the plastic shapes.
	void show( MatchView& view ) const;

	/// Applies flow to the yielding regions of [begin, end); begin a multiple of kLanes. The view must be as fitRegions left it. Regions
	/// are independent: ranges may run in parallel. Returns true when any has flowed.
	bool flow( const MatchView& view, const Kernels& kernels, const MatchStep& step, int begin, int end );

	/// Moves the shapes to other tables: children take their parent's, a parent the mass-weighted mean of its children's.
	void carryOver( const RegionTables& before, const RegionTables& now, const FlowSources& sources );

	/// Takes over the shapes of other tables' regions: region r from region `source[r]`.
	void inherit( const PlasticFlow& from, const std::vector<std::uint32_t>& source );

	Eigen::Matrix3d stretch( int region ) const;
	/// Writes or reads the shapes of tables that are as they were.
	void archive( Archive& archive );

private:
	void allocate( const RegionTables& tables );
	void store( int region, Eigen::Matrix3d stretch );
	/// The region as fitted in the view, without `total`.
	FlowingRegion regionOf( const MatchView& view, int region ) const;

	const RegionTables* m_tables = nullptr;
	AlignedArray<float> m_stretch[6]; ///< S_p - 1 as xx, yy, zz, yz, xz, xy
	AlignedArray<float> m_inverse[6]; ///< J'^+
	AlignedArray<float> m_blend[9];   ///< J'^+ J'_fine; empty where the tables have none
};

} // namespace pliant
