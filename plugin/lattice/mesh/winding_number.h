#pragma once

// The number of times a surface winds around a point: 1 inside a closed mesh, 0 outside, in between near the holes of an open one.
// Jacobson et al. 2013; the far field by dipoles after Barill et al. 2018.

#include "lattice/mesh/weld.h"

#include <cstdint>
#include <vector>

namespace pliant {

/// A tree of triangle clusters.
class WindingTree
{
public:
	WindingTree( const std::vector<Vec3d>& position, std::vector<Triangle> triangles );

	/// Error below 0.05, from the far field. Thread-safe.
	double at( const Vec3d& point ) const;

	/// Number of triangles and clusters that at() visits.
	double workAt( const Vec3d& point ) const;

	/// True where any triangle meets the segment between two points.
	bool isCrossed( const Vec3d& from, const Vec3d& to ) const;

private:
	using Corners = std::array<Vec3d, 3>;

	struct Node
	{
		Vec3d centre = Vec3d::Zero(); ///< area-weighted
		Vec3d dipole = Vec3d::Zero(); ///< sum of the triangles' area vectors
		double farSquared = 0.0;      ///< squared distance from which the dipole is accurate enough, m^2
		std::uint32_t first = 0;      ///< first triangle of a leaf; second child of an inner node, whose first child follows it
		std::uint32_t count = 0;      ///< 0 for an inner node
		std::uint32_t end = 0;        ///< the first node outside this subtree
	};

	void build( std::uint32_t first, std::uint32_t last );
	Node summarize( std::uint32_t first, std::uint32_t last ) const;

	std::vector<Corners> m_corners; ///< of the triangles, leaf by leaf
	std::vector<Node> m_nodes;
};

} // namespace pliant
