#pragma once

// Cuts: the links that a plane, a sphere or the path of a blade crosses. Steinemann et al. 2008, section 5.1. A link is the straight line
// between the current centres of its two cells.

#include "lattice/pieces.h"

#include <Eigen/Geometry>

#include <limits>
#include <vector>

namespace pliant {

/// A plane, or a disc in it. A centre in the plane belongs to the side that the normal points to.
struct PlaneCut
{
	Vec3d point = Vec3d::Zero();
	Vec3d normal = Vec3d::UnitX();                           ///< of any length but 0
	double radius = std::numeric_limits<double>::infinity(); ///< about `point`, m
};

/// The surface of a sphere. A centre on it is outside.
struct SphereCut
{
	Vec3d centre = Vec3d::Zero();
	double radius = 0.0; ///< m
};

/// The surface swept by a straight edge from p0 p1 to q0 q1: the triangles p0 p1 q0 and q0 p1 q1. A link through their common line is cut
/// by at least one of them, as is one through the common line of two consecutive sweeps.
struct BladeCut
{
	Vec3d p0 = Vec3d::Zero(), p1 = Vec3d::Zero(), q0 = Vec3d::Zero(), q1 = Vec3d::Zero();
};

/// Returns the cut links of the lattice, ascending, each once; `positions`: of each cell. Empty where the cut is invalid.
std::vector<CellLink> linksCut( const Lattice& lattice, const std::vector<Vec3d>& positions, const PlaneCut& cut );
std::vector<CellLink> linksCut( const Lattice& lattice, const std::vector<Vec3d>& positions, const SphereCut& cut );
std::vector<CellLink> linksCut( const Lattice& lattice, const std::vector<Vec3d>& positions, const BladeCut& cut );

/// The intersection of a cut with a link, in the rest shape.
struct CutTrace
{
	CellLink link;
	Vec3 point = Vec3::Zero();  ///< on the line between the rest positions of the two centres, m
	Vec3 normal = Vec3::Zero(); ///< of the cut's surface, length 1, from the side of cell a to that of b
};

/// Returns the cut's trace on each of the links it crosses. `rotations`: of each cell, from rest to the current state.
std::vector<CutTrace> tracesOf( const Lattice& lattice, const std::vector<Vec3d>& positions, const std::vector<CellLink>& links,
	const PlaneCut& cut, const std::vector<Eigen::Quaternionf>& rotations );
std::vector<CutTrace> tracesOf( const Lattice& lattice, const std::vector<Vec3d>& positions, const std::vector<CellLink>& links,
	const SphereCut& cut, const std::vector<Eigen::Quaternionf>& rotations );
std::vector<CutTrace> tracesOf( const Lattice& lattice, const std::vector<Vec3d>& positions, const std::vector<CellLink>& links,
	const BladeCut& cut, const std::vector<Eigen::Quaternionf>& rotations );

/// Returns the links of `whole` that are missing in `part`, between cells of `part` whose distance is at most `maxStretch` times their rest
/// length: these may heal. `cellInWhole`: of each cell of the part, ascending; empty: identical. Ascending, each once.
std::vector<CellLink> linksToHeal( const Lattice& whole, const Lattice& part, const std::vector<std::uint32_t>& cellInWhole,
	const std::vector<Vec3d>& positions, double maxStretch );

} // namespace pliant
