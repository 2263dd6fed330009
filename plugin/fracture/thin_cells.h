#pragma once

// Cells at the faces of parts that are a few cells thin: plates, rods and shells. Bending stretches the faces of such a part most, half a
// cell outside of the outermost centres, and the middle of it not at all.

#include "lattice/lattice.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pliant {

class Archive;

/// Where a cell lies within a thin part, at rest. A plate is thin along one normal, a rod along two, which are perpendicular.
struct ThinCell
{
	/// Two cells on opposite sides of this one, along the part.
	struct Pair
	{
		std::uint32_t a = 0, b = 0;
		float square = 0.0f; ///< of the sum of the links to them, m^2; 0 but for cells that are partly filled
		float scale = 0.0f;  ///< the bending strain at the face over the change of that sum, 1/m

		/// About the square of that strain, from the present sum. Without bending it is what it was at rest, rotated; where it is not 0 at
		/// rest its change is estimated from | s^2 - r^2 |, which is as a rule more.
		float bendingSquare( const Vec3& sum ) const { return scale * scale * std::fabs( sum.squaredNorm() - square ); }
	};

	std::uint32_t cell = 0;
	std::int32_t normals = 0;                        ///< 1 or 2
	Vec3 normal[2] = { Vec3::Zero(), Vec3::Zero() }; ///< of unit length
	float height[2] = { 0.0f, 0.0f };                ///< of the cell's centre above the middle of the part along the normal, m
	float half[2] = { 0.0f, 0.0f };                  ///< half the thickness along the normal, m
	std::int32_t pairs = 0;
	Pair pair[4];

	/// From the cell's centre to the nearer face along a normal, m.
	float outside( int k ) const { return half[k] - std::fabs( height[k] ); }
	void archive( Archive& archive );
};

/// Writes or reads those of a lattice of so many cells; refused unless they are ascending and in it.
void archiveThinCells( Archive& archive, std::vector<ThinCell>& thin, std::size_t cells );

/// Returns the cells at the faces of parts of at most kThinCells cells, ascending.
std::vector<ThinCell> findThinCells( const Lattice& lattice );

/// Returns those of a part of a lattice, some of its cells (ascending), with their new numbers and the pairs that are still linked.
std::vector<ThinCell> inheritThinCells( const std::vector<ThinCell>& before, const Lattice& part, const std::vector<std::uint32_t>& cells );

} // namespace pliant
