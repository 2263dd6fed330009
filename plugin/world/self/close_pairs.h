#pragma once

// Pairs of spheres that come near one another, found by spatial hashing. Steinemann et al. 2008, section 7: "spatial hashing" of the leaf
// cells.

#include "lattice/lattice.h"

#include <cstdint>
#include <vector>

namespace pliant {

/// Sizes of spheres differ by powers of two (the levels of an octree): each size has a grid of its own, and a cell asks its own size's and
/// those of all smaller ones. What lies about a cell is laid side by side once for all its spheres, and asked eight at a time without a
/// branch: a body's surface has three spheres a cell, and what was guessed wrong of so short rows took ten times as long as the arithmetic.
/// Keeps its scratch between calls.
class ClosePairs
{
public:
	struct Sphere
	{
		Vec3 place;
		float radius;
		std::uint32_t number;
	};
	/// What is held together anyhow, by the spheres' numbers: i and `to[start[i]]` to `to[start[i + 1] - 1]`, both ways.
	struct Held
	{
		const std::vector<std::uint32_t>& start;
		const std::vector<std::uint32_t>& to;
	};

	/// All pairs with | x_a - x_b | <= ( r_a + r_b ) ( 1 + slop ) + margin, as lower number << 32 | higher; each once, in an order that
	/// follows from the spheres alone. Left out are those that are held together, or both with the same third; `held` may be null.
	void find( const std::vector<Sphere>& spheres, float slop, float margin, const Held* held, std::vector<std::uint64_t>& pairs );
	/// The same of those pairs of which at least one stands in `isOf`, not 0 by number: each of these asks all spheres, and no grid is
	/// made.
	void findOf( const std::vector<Sphere>& spheres, const std::vector<std::uint8_t>& isOf, float slop, float margin, const Held* held,
		std::vector<std::uint64_t>& pairs );

private:
	/// Spheres component by component.
	struct Lot
	{
		std::vector<float> x, y, z, radius;
		std::vector<std::uint32_t> number;

		void resize( std::size_t count );
		void set( std::size_t at, const Sphere& sphere );
		void copy( const Lot& from, std::size_t first, std::size_t last, std::size_t to );
	};
	struct Grid
	{
		std::size_t first, last; ///< spheres of this size
		std::size_t cells;       ///< where its own begin in m_start
		float largest;           ///< radius
		float edge, perMetre;    ///< of a cell, m, and one over it
		Vec3 low;
		Eigen::Vector3i count;
		/// As far as one outside of the grid.
		Eigen::Vector3i cellAt( const Vec3& place ) const;
	};

	void sortSizes( const std::vector<Sphere>& spheres );
	void makeGrid( const std::vector<Sphere>& spheres, const std::vector<std::uint32_t>& which );
	void askCell( const Grid& own, const Eigen::Vector3i& cell, const Held* held, std::vector<std::uint64_t>& pairs );
	void layAside( const Grid& grid, const Eigen::Vector3i& least, const Eigen::Vector3i& most, std::size_t from );
	void begin( std::size_t count, float slop, float margin, const Held* held );
	void ask( const Vec3& place, float radius, std::size_t from );
	void keepFree( std::uint32_t a, const Held* held, std::vector<std::uint64_t>& pairs );

	float m_slop = 0.0f, m_margin = 0.0f;
	std::vector<float> m_size;                        // the largest radius of each, ascending
	std::vector<std::vector<std::uint32_t>> m_ofSize; // spheres
	std::vector<Grid> m_grid;                         // of each size that there are spheres of
	std::vector<std::uint32_t> m_start;               // of each grid: by cell, x fastest, the first sphere, and one past the last
	Lot m_sorted;                                     // in the order of grids and cells
	Lot m_aside;                                      // what lies about a cell
	std::size_t m_asideCount = 0;
	std::vector<std::uint32_t> m_near; // what one sphere has come near, by number; room for all that lies about it
	std::size_t m_nearCount = 0;
	std::vector<std::uint32_t> m_owner; // the last in whose row each number stood
	std::vector<std::uint32_t> m_cell, m_next;
};

} // namespace pliant
