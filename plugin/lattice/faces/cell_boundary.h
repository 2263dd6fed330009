#pragma once

// The surface of a lattice: the faces of cells that have no link to a cell behind them, as closed surfaces of quadrilaterals. A body has an
// outer surface for each of its parts, and one around each cavity, seen from the material.

#include "lattice/lattice.h"

#include <array>
#include <cstdint>
#include <vector>

namespace pliant {

/// Points are corners of cells. A corner where two surfaces meet without being joined is a point of each. Immutable once built.
struct CellBoundary
{
	std::vector<Vec3> restPosition;                  ///< of each point, relative to Lattice::massCentre, m
	std::vector<std::uint32_t> cellStart;            ///< point p is carried by the cells cell[ cellStart[p] .. cellStart[p + 1] )
	std::vector<std::uint32_t> cell;                 ///< ascending for each point; up to 8
	std::vector<std::uint32_t> surface;              ///< of each point: 0 to surfaceCount - 1
	std::vector<std::array<std::uint32_t, 4>> quads; ///< points, counter-clockwise seen from outside the material
	std::vector<double> restVolume;                  ///< inside of each surface, m^3: negative for a cavity
	/// The volume displaced by the outer surfaces, as a fraction of the volume that they enclose: cells at the surface are not full. With
	/// cavities, half of the missing fill is attributed to them.
	double displaced = 1.0;

	int pointCount() const { return int( restPosition.size() ); }
	int surfaceCount() const { return int( restVolume.size() ); }
};

CellBoundary findBoundary( const Lattice& lattice );

} // namespace pliant
