#pragma once

// The surface cut along the planes of the lattice: each piece lies in one lattice position, and pieces that meet share their points.
// The exact counterpart of the Marching Squares of Ohta et al. 2009, "Fracturing".
//
// All in cells from the lattice's low corner. Nothing is decided twice: a point is on one side of a plane or on the other, never on it; an
// edge is cut once, for all that share it. So what is closed stays closed, whatever the rounding.

#include "lattice/mesh/weld.h"
#include "pliant/crack.h"
#include "surface/crack_shapes/gradient_noise.h"

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

namespace pliant {

/// Where on the welded mesh a point lies: up to three of its vertices, ascending, with weights that sum to 1.
struct SurfaceOrigin
{
	static constexpr std::uint32_t kNone = 0xffffffffu;

	std::array<std::uint32_t, 3> vertex{ kNone, kNone, kNone };
	std::array<double, 3> weight{ 0.0, 0.0, 0.0 };

	bool isInterior() const { return vertex[0] == kNone; }
	bool isInput() const { return vertex[0] != kNone && vertex[1] == kNone; }
};

struct ClipPoint
{
	Vec3d place; ///< in bent space, where the planes are flat
	Vec3d rest;  ///< where it is
	SurfaceOrigin origin;
};

/// Polygon p has the corners start[p] .. start[p + 1).
struct ClipPolygons
{
	std::vector<std::uint32_t> start{ 0 };
	std::vector<std::uint32_t> point; ///< by corner
	std::vector<std::uint8_t> plane;  ///< by corner: what the edge to the next corner lies on, a plane tag or kNoPlane
	std::vector<Eigen::Vector3i> position;
	std::vector<std::uint32_t> triangle; ///< the welded triangle it is a piece of

	std::size_t count() const { return position.size(); }
};

inline constexpr std::uint8_t kNoPlane = 0;
/// The plane that bounds a position along an axis, below or above.
constexpr std::uint8_t planeTag( int axis, bool isAbove )
{
	return std::uint8_t( 1 + 2 * axis + ( isAbove ? 1 : 0 ) );
}

/// Where the surface crosses a line of the lattice: the line along `axis` on the planes `first` (of axis + 1) and `second` (of axis + 2).
struct Pierce
{
	std::uint32_t point;
	std::int8_t axis;
	std::int8_t sign; ///< 1: material begins here, going up the line; -1: it ends
	int first, second;
	int at; ///< position along the line
};

struct ClippedSurface
{
	Eigen::Vector3i extent = Eigen::Vector3i::Ones(); ///< positions along each axis; what sticks out belongs to the outermost
	std::vector<ClipPoint> point;                     ///< vertex i of the welded mesh is point i
	ClipPolygons polygons;
	std::vector<Pierce> pierce;
	std::vector<std::pair<Eigen::Vector3i, std::uint32_t>> insideCorner; ///< by planes; from makeFaceEdges

	int positionOf( std::uint32_t p, int axis ) const;
};

/// `triangles`: of the welded mesh and its caps. `toCells`: place of a welded vertex in cells.
struct ClipInput
{
	const std::vector<Vec3d>& position; ///< of the welded vertices, cells
	const std::vector<Triangle>& triangles;
	Eigen::Vector3i extent;
	const NoiseWarp& warp;
	double longestEdge; ///< cells; with noise, longer ones are halved first
};

/// With noise planes are straight in bent space only as finely as the surface is sampled there. Cells.
double longestBentEdge( const CrackSettings& settings );

ClippedSurface clipSurface( const ClipInput& input );

} // namespace pliant
