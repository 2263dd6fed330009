#pragma once

// Cuts: the links that a plane, a sphere or the path of a blade goes through. Steinemann et al. 2008, section 5.1.
// A link is the straight line between the middles of its two cells, where they are now.

#include "lattice/pieces.h"

#include <Eigen/Geometry>

#include <limits>
#include <vector>

namespace pliant {

/// A plane, or a disc of it. A middle that lies in the plane counts to the side its normal points to.
struct PlaneCut
{
	Vec3d point = Vec3d::Zero();
	Vec3d normal = Vec3d::UnitX();                           ///< of any length but 0
	double radius = std::numeric_limits<double>::infinity(); ///< about `point`, m
};

/// The surface of a sphere. A middle that lies in it counts to the outside.
struct SphereCut
{
	Vec3d centre = Vec3d::Zero();
	double radius = 0.0; ///< m
};

/// What a straight edge sweeps over as it goes from p0 p1 to q0 q1: the triangles p0 p1 q0 and q0 p1 q1. Whatever goes through the line
/// they share is cut by at least one of them, and so is what goes through the line that two sweeps in a row share.
struct BladeCut
{
	Vec3d p0 = Vec3d::Zero(), p1 = Vec3d::Zero(), q0 = Vec3d::Zero(), q1 = Vec3d::Zero();
};

/// The links of the lattice that are cut, ascending, each once; `places`: of each cell. None where the cut is nothing, or not finite.
std::vector<CellLink> linksCut( const Lattice& lattice, const std::vector<Vec3d>& positions, const PlaneCut& cut );
std::vector<CellLink> linksCut( const Lattice& lattice, const std::vector<Vec3d>& positions, const SphereCut& cut );
std::vector<CellLink> linksCut( const Lattice& lattice, const std::vector<Vec3d>& positions, const BladeCut& cut );

/// Where a cut goes through a link, in the rest shape.
struct CutTrace
{
	CellLink link;
	Vec3 point = Vec3::Zero();  ///< on the line between the rest places of the two middles, m
	Vec3 normal = Vec3::Zero(); ///< of the cut's surface, length 1, from the side of cell a to that of b
};

/// What the cut left on each of the links it goes through. `rotations`: x y z w of each cell: what lay at rest is turned so now.
std::vector<CutTrace> tracesOf( const Lattice& lattice, const std::vector<Vec3d>& positions, const std::vector<CellLink>& links,
	const PlaneCut& cut, const std::vector<Eigen::Quaternionf>& rotations );
std::vector<CutTrace> tracesOf( const Lattice& lattice, const std::vector<Vec3d>& positions, const std::vector<CellLink>& links,
	const SphereCut& cut, const std::vector<Eigen::Quaternionf>& rotations );
std::vector<CutTrace> tracesOf( const Lattice& lattice, const std::vector<Vec3d>& positions, const std::vector<CellLink>& links,
	const BladeCut& cut, const std::vector<Eigen::Quaternionf>& rotations );

/// The links that `whole` has and `part` has not, between cells of `part` that are not further apart than `most` times their rest length:
/// what may grow together again. `cellInWhole`: of each cell of the part, ascending; empty: the same. Ascending, each once.
std::vector<CellLink> linksToHeal( const Lattice& whole, const Lattice& part, const std::vector<std::uint32_t>& cellInWhole,
	const std::vector<Vec3d>& positions, double most );

} // namespace pliant
