#pragma once

// The border of a face from its corners alone. Ohta et al. 2009, "Fracturing": Marching Squares; "the boundary is determined [by] whether
// each vertex [...] is inside or outside of the object and displaced according to the distance to the object's surface".
//
// Used for comparison, and for meshes with so many holes that the cuts of the surface do not close.

#include "surface/crack_shapes/crack_faces.h"

#include <cstdint>
#include <functional>
#include <unordered_map>
#include <vector>

namespace pliant {

class MarchingSquares
{
public:
	/// True for a position inside the material, cells. Empty: decided by the crossings of the lattice's lines.
	using InsideTest = std::function<bool( const Vec3d& rest )>;

	/// Adds points to `surface` and, for each, an entry to `merged`.
	MarchingSquares( ClippedSurface& surface, const NoiseWarp& warp, std::vector<std::uint32_t>& merged, InsideTest isInside = {} );

	/// Computes the outline of a face's inside, counter-clockwise from above; fewer than three points where there is none.
	void outline( const Eigen::Vector3i& below, int axis, std::vector<std::uint32_t>& points );
	void square( const Eigen::Vector3i& below, int axis, std::vector<std::uint32_t>& points );

private:
	/// A side of a face, on a line of the lattice; `at`: index of the cell along the line.
	struct Side
	{
		int axis, first, second, at;
	};

	bool isCornerInside( const Eigen::Vector3i& plane );
	std::uint32_t cornerPoint( const Eigen::Vector3i& plane );
	std::uint32_t crossing( const Side& side, bool isLowInside );
	std::uint32_t addPoint( const Vec3d& bent );
	double bisect( const Side& side, bool isLowInside ) const;
	Vec3d bentPositionOn( const Side& side, double at ) const;
	std::uint64_t cornerKey( const Eigen::Vector3i& plane ) const;

	ClippedSurface& m_surface;
	const NoiseWarp& m_warp;
	std::vector<std::uint32_t>& m_merged;
	InsideTest m_isInside;
	std::unordered_map<std::uint64_t, std::uint32_t> m_corner; ///< points; for lookup only
	std::unordered_map<std::uint64_t, bool> m_isCornerInside;
	std::unordered_map<std::uint64_t, std::uint32_t> m_crossing; ///< by side, where the surface has no point of its own
};

/// Appends to `parts` the parts of the faces whose border did not close.
void closeByMarchingSquares( FaceParts& parts, const std::vector<FaceEdge>& edges, const ClippedSurface& surface, MarchingSquares& squares,
	const std::vector<std::uint32_t>& merged );

} // namespace pliant
