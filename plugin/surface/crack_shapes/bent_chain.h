#pragma once

// Borders with no more points than their bends ask for.

#include "surface/crack_shapes/crack_faces.h"

#include <cstdint>
#include <vector>

namespace pliant {

/// By point of a chain: whether it is kept. The ends are; between two that are kept each other one lies nearer than `tolerance` to the line
/// from one to the other (Douglas and Peucker 1973, the line cut off at its ends). All are kept at a tolerance of 0.
std::vector<std::uint8_t> keepBent( const std::vector<Vec3d>& chain, double tolerance );

/// Where the surface's cut on a face runs on within one triangle of the input, all its points are there because the surface was sampled for
/// the noise: those that `keepBent` does not keep, `tolerance` in cells, become one with the kept one before them. A point lies on one face
/// alone, and so all who share it see the same. `merged`: what each point became.
void leaveOutStraight(
	const ClippedSurface& surface, const std::vector<FaceEdge>& edges, double tolerance, std::vector<std::uint32_t>& merged );

} // namespace pliant
