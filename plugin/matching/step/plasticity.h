#pragma once

// Rest shapes that flow: each region's plastic stretch S_p, and what follows from it for the kernels.
// Steinemann et al. 2008, section 7, eq. 9-10, after Müller et al. 2005, section 4.5.
//
//   A = A_pq S_p,  J' = S_p J S_p,  F_e = A J'^+,  S_e = sym( R^T F_e )
//   where | S_e - 1 | > yield:  S_p <- ( 1 + h creep ( S_e - 1 ) ) S_p, its rotation taken out, det S_p = 1, | S_p - 1 | <= limit
//
// Flow never raises the region's elastic energy  W = 1/2 tr( E B E^T ),  E = R^T F_e - 1,  B = S_p K S_p,  K the moment that resists
// strain. The law by itself does not see to that: towards det = 1 and towards the limit it moves S_p in directions in which a region of
// unequal moments may gain. Where it would, S_p flows along  D = E - tr( E ) / tr( B^-1 ) B^-1  instead, of all D of no trace the nearest
// to E in B, so that tr( D B E^T ) >= 0; and by less, or not at all, where even that raises W.
//
// Norms are Frobenius': a bar pulled by the share e counts as e. The rotation taken out goes over into R, which is fitted anew in each
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
	double volumeKeeping = 0.0;                             ///< kappa, beside a K of which 1 - beta is no part

	/// W with the rest shape `stretch` and the rotation `fitted`, at least; with the rotation that fits best exactly.
	double energy( const Eigen::Matrix3d& fitted, const Eigen::Matrix3d& stretch ) const;
};

/// The law above. False where the region does not yield, or could not without gaining energy: `stretch` is then untouched.
bool flowStretch( const PlasticLaw& law, float h, const FlowingRegion& region, Eigen::Matrix3d& stretch );

/// The stretch in M = Q U, the root of M^T M, scaled to det = 1 and brought back towards 1 where it is further from it than `limit`.
Eigen::Matrix3d unitStretch( const Eigen::Matrix3d& m, double limit = std::numeric_limits<double>::infinity() );

/// Who takes over whose shape when levels change. Numbers of nodes and regions are the same.
struct FlowSources
{
	const std::vector<std::uint32_t>& source; ///< of each region now: a region before
	const std::vector<std::uint32_t>&
		nodeNow; ///< of each region before: its number now, its parent's where it was merged, kNoNode where split
	const AlignedArray<float>& massBefore;
};

/// S_p of all regions of a body, made when the first of them yields.
class PlasticFlow
{
public:
	explicit PlasticFlow( const RegionTables& tables );

	/// Whether any region of the view strains beyond `yieldStrain`. Needs MatchView::strain.
	static bool yieldsAnywhere( const MatchView& view, float yieldStrain );

	/// Puts the flowed shapes into the view in place of those at rest.
	void show( MatchView& view ) const;

	/// Lets the regions [begin, end) flow that yield; begin a multiple of kLanes. The view as fitRegions left it. Regions do not touch one
	/// another: ranges may run side by side. True when any has flowed.
	bool flow( const MatchView& view, const Kernels& kernels, const MatchStep& step, int begin, int end );

	/// The shapes under other tables: children take their parent's, a parent the mean of its children's by mass.
	void carryOver( const RegionTables& before, const RegionTables& now, const FlowSources& sources );

	/// The shapes of other tables' regions: region r takes that of `heir[r]`.
	void inherit( const PlasticFlow& from, const std::vector<std::uint32_t>& source );

	Eigen::Matrix3d stretch( int region ) const;
	std::size_t bytes() const;

private:
	void allocate( const RegionTables& tables );
	void store( int region, Eigen::Matrix3d stretch );
	/// As the view has fitted it; `total` is left out.
	FlowingRegion regionOf( const MatchView& view, int region ) const;

	const RegionTables* m_tables = nullptr;
	AlignedArray<float> m_stretch[6]; ///< S_p - 1 as xx, yy, zz, yz, xz, xy
	AlignedArray<float> m_inverse[6]; ///< J'^+
	AlignedArray<float> m_blend[9];   ///< J'^+ J'_fine; empty where the tables have none
};

} // namespace pliant
