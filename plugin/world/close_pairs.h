#pragma once

// Pairs of spheres that come near one another, found by spatial hashing. Steinemann et al. 2008, section 7: "spatial hashing" of the leaf cells.

#include "lattice/lattice.h"

#include <cstdint>
#include <vector>

namespace pliant {

/// Sizes of spheres differ by powers of two (the levels of an octree): each size has a grid of its own, and a sphere asks its own size's and
/// those of all smaller ones.
class ClosePairs
{
public:
	struct Sphere
	{
		Vec3 place;
		float radius;
		std::uint32_t number;
	};

	/// All pairs with | x_a - x_b | <= ( r_a + r_b ) ( 1 + slop ) + margin, as lower number << 32 | higher; each once, in an order that follows from
	/// the spheres alone. `spheres` is put into another order.
	void find( std::vector<Sphere>& spheres, float slop, float margin, std::vector<std::uint64_t>& pairs );

private:
	struct Grid
	{
		std::size_t first, last; ///< spheres of this size
		float largest;           ///< radius
		float edge;              ///< of a cell, m
		Vec3 low;
		Eigen::Vector3i count;
		std::vector<std::uint32_t> start; ///< by cell, x fastest, and one past the last
		/// As far as one outside of the grid.
		Eigen::Vector3i cellAt( const Vec3& place ) const;
	};

	void makeGrid( std::vector<Sphere>& spheres, std::size_t first, std::size_t last, float slop, float margin );
	void ask( const std::vector<Sphere>& spheres, std::size_t k, const Grid& grid, std::vector<std::uint64_t>& pairs ) const;

	float m_slop = 0.0f, m_margin = 0.0f;
	std::vector<Grid> m_grid; ///< smallest spheres first

	// Room kept between calls.
	std::vector<Sphere> m_sorted;
	std::vector<std::uint32_t> m_cell, m_next;
};

} // namespace pliant
