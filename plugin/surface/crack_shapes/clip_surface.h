#pragma once

// The surface cut along the planes of the lattice: each piece lies in one lattice position, and pieces that meet share their points. The
// exact counterpart of the Marching Squares of Ohta et al. 2009, "Fracturing".
//
// All lengths in cells from the lattice's low corner. Every decision is made once: a point is on one side of a plane or the other, never on
// it, and an edge is cut once for all pieces that share it. So closed surfaces stay closed regardless of rounding.

#include "lattice/mesh/weld.h"
#include "pliant/crack.h"
#include "surface/crack_shapes/gradient_noise.h"

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

namespace pliant {

/// Position on the welded mesh: up to three of its vertices, ascending, with weights that sum to 1.
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
	Vec3d bent; ///< position in bent space, where the planes are flat, cells
	Vec3d rest; ///< position in the rest shape, cells
	SurfaceOrigin origin;
};

/// Polygon p has the corners start[p] .. start[p + 1] - 1.
struct ClipPolygons
{
	std::vector<std::uint32_t> start{ 0 };
	std::vector<std::uint32_t> point; ///< by corner
	std::vector<std::uint8_t> plane;  ///< by corner: the plane of the edge to the next corner, a plane tag or kNoPlane
	std::vector<Eigen::Vector3i> position;
	std::vector<std::uint32_t> triangle; ///< the welded triangle that it is a piece of

	std::size_t count() const { return position.size(); }
};

inline constexpr std::uint8_t kNoPlane = 0;
/// Tag of the plane that bounds a position along an axis, below or above.
constexpr std::uint8_t planeTag( int axis, bool isAbove )
{
	return std::uint8_t( 1 + 2 * axis + ( isAbove ? 1 : 0 ) );
}

/// A point where the surface crosses a line of the lattice: the line along `axis` on the planes `first` (of axis + 1) and `second` (of axis
/// + 2).
struct LineCrossing
{
	std::uint32_t point;
	std::int8_t axis;
	std::int8_t sign; ///< 1: the material begins here in the direction of the line; -1: it ends
	int first, second;
	int at; ///< index of the cell along the line
};

struct ClippedSurface
{
	Eigen::Vector3i extent =
		Eigen::Vector3i::Ones();  ///< number of positions along each axis; points outside belong to the outermost position
	std::vector<ClipPoint> point; ///< vertex i of the welded mesh is point i
	ClipPolygons polygons;
	std::vector<LineCrossing> lineCrossing;
	std::vector<std::pair<Eigen::Vector3i, std::uint32_t>> insideCorner; ///< indices of its planes, and its point; from makeFaceEdges

	int positionOf( std::uint32_t p, int axis ) const;
};

/// `triangles`: of the welded mesh and its caps.
struct ClipInput
{
	const std::vector<Vec3d>& position; ///< of the welded vertices, cells
	const std::vector<Triangle>& triangles;
	Eigen::Vector3i extent;
	const NoiseWarp& warp;
	double longestEdge; ///< cells; with noise, longer edges are bisected first
};

/// Longest edge, cells, that samples the noise finely enough: planes are straight in bent space only up to the sampling of the surface.
double longestBentEdge( const CrackSettings& settings );

ClippedSurface clipSurface( const ClipInput& input );

} // namespace pliant
