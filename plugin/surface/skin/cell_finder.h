#pragma once

// Finds the cell that a point of the surface belongs to. Steinemann et al. 2008, section 7: the surface follows the material on its own
// side.

#include "lattice/inside/grid.h"
#include "lattice/lattice.h"

#include <cstdint>
#include <limits>
#include <vector>

namespace pliant {

/// Nearest cell to any point, at any distance. A balanced k-d tree over the rest centres, stored as a permutation of the cells.
class CellTree
{
public:
	explicit CellTree( const Lattice& lattice );

	/// `point` in mesh coordinates, m. Among equally near cells the first in the lattice's order.
	int nearest( const Vec3d& point ) const;

private:
	struct Best
	{
		std::uint32_t cell = 0;
		double distance = std::numeric_limits<double>::infinity(); ///< squared
	};

	Vec3d centre( std::uint32_t cell ) const { return m_lattice.restCentre[cell].cast<double>(); }
	void sort( std::size_t first, std::size_t last, int axis );
	void search( std::size_t first, std::size_t last, int axis, const Vec3d& point, Best& best ) const;

	const Lattice& m_lattice;
	std::vector<std::uint32_t> m_order; ///< the median of each range splits it, along x, y, z in turn
};

class CellFinder
{
public:
	explicit CellFinder( const Lattice& lattice );

	/// Lattice position that contains a point, clamped to the neighbourhood of the lattice.
	Eigen::Vector3i positionOf( const Vec3d& point ) const;

	/// All cells at the 27 positions around `position`, in the lattice's order.
	void cellsAround( const Eigen::Vector3i& position, std::vector<std::uint32_t>& cells ) const;

	/// The nearest of the cells `around` whose material lies behind the surface at `point`; the nearest of all of them where there is none
	/// or `outward` is zero (a vertex without triangles has no side); the nearest of all cells where `around` is empty.
	int owner( const Vec3d& point, const Vec3d& outward, const std::vector<std::uint32_t>& around ) const;

	/// Distance of a cell's material in front of the surface at `point`, cells; negative behind it.
	double inFront( int cell, const Vec3d& point, const Vec3d& outward ) const;

	/// Vector from a cell's centre to a point, cells.
	Vec3d fromMiddle( int cell, const Vec3d& point ) const;

private:
	const Lattice& m_lattice;
	Grid m_grid;
	std::vector<std::uint64_t> m_keys;
	PositionIndex m_index;
	CellTree m_tree;
};

} // namespace pliant
