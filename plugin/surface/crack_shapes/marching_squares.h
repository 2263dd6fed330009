#pragma once

// A face's border from its corners alone. Ohta et al. 2009, "Fracturing": Marching Squares; "the boundary is determined [by] whether each
// vertex [...] is inside or outside of the object and displaced according to the distance to the object's surface".
//
// Kept for comparison, and for meshes with so many holes that the surface's cuts do not close.

#include "surface/crack_shapes/crack_faces.h"

#include <cstdint>
#include <functional>
#include <unordered_map>
#include <vector>

namespace pliant {

class MarchingSquares
{
public:
	/// Whether a place is inside, in cells. Empty: as the lines of the lattice say.
	using InsideTest = std::function<bool( const Vec3d& rest )>;

	/// Adds points to the surface. `merged` grows with them.
	MarchingSquares( ClippedSurface& surface, const NoiseWarp& warp, std::vector<std::uint32_t>& merged, InsideTest isInside = {} );

	/// The outline of a face's inside, counter-clockwise from above: fewer than three points when there is none.
	void outline( const Eigen::Vector3i& below, int axis, std::vector<std::uint32_t>& points );
	/// All of the face: four corners.
	void square( const Eigen::Vector3i& below, int axis, std::vector<std::uint32_t>& points );

private:
	/// A side of a face, on a line of the lattice: `at` is the position along it.
	struct Side
	{
		int axis, first, second, at;
	};

	bool isCornerInside( const Eigen::Vector3i& plane );
	std::uint32_t cornerPoint( const Eigen::Vector3i& plane );
	std::uint32_t crossing( const Side& side, bool isLowInside );
	std::uint32_t addPoint( const Vec3d& place );
	double halve( const Side& side, bool isLowInside ) const;
	Vec3d placeOn( const Side& side, double at ) const;
	std::uint64_t cornerKey( const Eigen::Vector3i& plane ) const;

	ClippedSurface& m_surface;
	const NoiseWarp& m_warp;
	std::vector<std::uint32_t>& m_merged;
	InsideTest m_isInside;
	std::unordered_map<std::uint64_t, std::uint32_t> m_corner; ///< points; looked up only
	std::unordered_map<std::uint64_t, bool> m_isCornerInside;
	std::unordered_map<std::uint64_t, std::uint32_t> m_crossing; ///< by side, where the surface has no point of its own
};

/// Parts for the faces whose border did not close, appended to `parts`.
void closeByMarchingSquares( FaceParts& parts, const std::vector<FaceEdge>& edges, const ClippedSurface& surface, MarchingSquares& squares,
	const std::vector<std::uint32_t>& merged );

} // namespace pliant
