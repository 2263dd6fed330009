#pragma once

// Finds pairs of spheres near one another by spatial hashing. Steinemann et al. 2008, section 7: "spatial hashing" of the leaf cells.

#include "lattice/lattice.h"

#include <cstdint>
#include <vector>

namespace pliant {

/// Sizes of spheres differ by powers of two (the levels of an octree): each size has a grid of its own, and a cell searches the grids of
/// its own and of all smaller sizes. The spheres around a cell are gathered once for all spheres in it, and tested eight at a time without
/// branches: with three spheres per cell of a body's surface, mispredicted branches over such short rows would take ten times as long as
/// the arithmetic. Keeps its scratch between calls.
class ClosePairs
{
public:
	struct Sphere
	{
		Vec3 position;
		float radius;
		std::uint32_t number;
	};
	/// Spheres held together by a region, by their numbers: i and `to[start[i]]` to `to[start[i + 1] - 1]`, in both directions.
	struct Held
	{
		const std::vector<std::uint32_t>& start;
		const std::vector<std::uint32_t>& to;
	};

	/// Appends all pairs with | x_a - x_b | <= ( r_a + r_b ) ( 1 + slop ) + margin, as lower number << 32 | higher; each once, in an order
	/// that follows from the spheres alone. Omits pairs that are held together, or both held with the same third sphere; `held` may be
	/// null.
	void find( const std::vector<Sphere>& spheres, float slop, float margin, const Held* held, std::vector<std::uint64_t>& pairs );
	/// Appends only pairs with a sphere whose `isSelected` is not 0, by number: these are tested against all others, without a grid.
	void findOf( const std::vector<Sphere>& spheres, const std::vector<std::uint8_t>& isSelected, float slop, float margin,
		const Held* held, std::vector<std::uint64_t>& pairs );

private:
	/// Spheres as arrays of components.
	struct SphereList
	{
		std::vector<float> x, y, z, radius;
		std::vector<std::uint32_t> number;

		void resize( std::size_t count );
		void set( std::size_t at, const Sphere& sphere );
		void copy( const SphereList& from, std::size_t first, std::size_t last, std::size_t to );
	};
	struct Grid
	{
		std::size_t first, last; ///< spheres of this size
		std::size_t cells;       ///< index of its first cell in m_start
		float largest;           ///< largest radius
		float edge, perMetre;    ///< of a cell, m, and its reciprocal
		Vec3 low;
		Eigen::Vector3i count;
		/// The cell of a position, clamped to one cell outside the grid.
		Eigen::Vector3i cellAt( const Vec3& position ) const;
	};

	void sortSizes( const std::vector<Sphere>& spheres );
	void makeGrid( const std::vector<Sphere>& spheres, const std::vector<std::uint32_t>& which );
	void searchCell( const Grid& own, const Eigen::Vector3i& cell, const Held* held, std::vector<std::uint64_t>& pairs );
	void gatherCells( const Grid& grid, const Eigen::Vector3i& least, const Eigen::Vector3i& most, std::size_t from );
	void begin( std::size_t count, float slop, float margin, const Held* held );
	void findNear( const Vec3& position, float radius, std::size_t from );
	void appendFree( std::uint32_t a, const Held* held, std::vector<std::uint64_t>& pairs );

	float m_slop = 0.0f, m_margin = 0.0f;
	std::vector<float> m_size;                        // largest radius of each size class, ascending
	std::vector<std::vector<std::uint32_t>> m_ofSize; // spheres of each size class
	std::vector<Grid> m_grid;                         // one per size class that has spheres
	std::vector<std::uint32_t> m_start;               // of each grid: by cell, x fastest, the first sphere, and one past the last
	SphereList m_sorted;                              // in the order of grids and cells
	SphereList m_gathered;                            // the spheres around a cell
	std::size_t m_gatheredCount = 0;
	std::vector<std::uint32_t> m_near; // numbers of spheres near one sphere; capacity for all gathered ones
	std::size_t m_nearCount = 0;
	std::vector<std::uint32_t> m_owner; // by number: the last sphere whose row contains it
	std::vector<std::uint32_t> m_cell, m_next;
};

} // namespace pliant
