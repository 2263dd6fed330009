#pragma once

// A tree of boxes over triangles, for the triangle nearest to a point.

#include "lattice/mesh/weld.h"

#include <cstdint>
#include <vector>

namespace pliant {

class SolidTree
{
public:
	/// Keeps references to both.
	SolidTree( const std::vector<Vec3d>& position, const std::vector<Triangle>& triangles );

	struct Nearest
	{
		int triangle = -1; ///< -1: there are no triangles
		Vec3d point = Vec3d::Zero();
		double squaredDistance = 0.0; ///< m^2
	};
	Nearest nearest( const Vec3d& to ) const;

private:
	struct Node
	{
		Vec3d low, high;
		std::uint32_t first = 0; ///< first triangle of a leaf in m_order; second child of an inner node, whose first child follows it
		std::uint32_t count = 0; ///< 0 for an inner node
	};
	void build( std::uint32_t first, std::uint32_t last );
	void visit( std::uint32_t node, const Vec3d& to, Nearest& best ) const;

	const std::vector<Vec3d>& m_position;
	const std::vector<Triangle>& m_triangles;
	std::vector<std::uint32_t> m_order;
	std::vector<Node> m_nodes;
};

} // namespace pliant
