#pragma once

// Simplification of face borders: points that hardly bend the border are removed.

#include "surface/crack_shapes/crack_faces.h"

#include <cstdint>
#include <vector>

namespace pliant {

/// Returns for each point of a chain whether it is kept. The ends always are; every other point lies nearer than `tolerance` to the line
/// segment between the kept points around it (Douglas and Peucker 1973). With tolerance 0 all points are kept.
std::vector<std::uint8_t> keepBent( const std::vector<Vec3d>& chain, double tolerance );

/// Simplifies the cuts of the surface on the faces. Where a cut lies within one triangle of the input, its points exist only because the
/// surface was sampled for the noise: those that `keepBent` drops (`tolerance`: cells) are merged with the kept point before them. Such a
/// point lies on one face only, so that everything that shares it agrees. `merged`: by point, its representative.
void simplifyCuts(
	const ClippedSurface& surface, const std::vector<FaceEdge>& edges, double tolerance, std::vector<std::uint32_t>& merged );

} // namespace pliant
