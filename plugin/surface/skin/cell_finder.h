#pragma once

// Which cell a point of the surface belongs to. Steinemann et al. 2008, section 7: the surface follows the material on its own side.

#include "lattice/inside/grid.h"
#include "lattice/lattice.h"

#include <cstdint>
#include <limits>
#include <vector>

namespace pliant {

/// Nearest cell to any point, however far off. A balanced tree over the rest centres, kept as an order of the cells.
class CellTree
{
public:
	explicit CellTree( const Lattice& lattice );

	/// `point` in the mesh's coordinates, m. Of equally near cells the first in the lattice's order.
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
	std::vector<std::uint32_t> m_order; ///< the middle of each range splits it, along x, y, z by turns
};

class CellFinder
{
public:
	explicit CellFinder( const Lattice& lattice );

	/// Lattice position that a point lies in, kept near the lattice.
	Eigen::Vector3i positionOf( const Vec3d& point ) const;

	/// All cells at the 27 positions around `home`, in the lattice's order.
	void cellsAround( const Eigen::Vector3i& home, std::vector<std::uint32_t>& cells ) const;

	/// The nearest of `around` whose material lies behind the surface there, or the nearest at all where none does (or `outward` is zero:
	/// a vertex of no triangle has no side). Of all cells when `around` is empty.
	int owner( const Vec3d& point, const Vec3d& outward, const std::vector<std::uint32_t>& around ) const;

	/// How far a cell's material stands out in front of the surface there, cells; negative behind it.
	double inFront( int cell, const Vec3d& point, const Vec3d& outward ) const;

	/// From a cell's middle to a point, cells.
	Vec3d fromMiddle( int cell, const Vec3d& point ) const;

private:
	const Lattice& m_lattice;
	Grid m_grid;
	std::vector<std::uint64_t> m_keys;
	PositionIndex m_index;
	CellTree m_tree;
};

} // namespace pliant
