#pragma once

// The part of each cell face that is covered by material: the crack face that is drawn when it opens. Ohta et al. 2009, "Fracturing".

#include "surface/crack_shapes/clip_surface.h"
#include "surface/crack_shapes/outline.h"

#include <cstdint>
#include <vector>

namespace pliant {

/// A directed edge of a face's border; seen from the upper side the material is on its left. Face 3 k + a is the upper face of position k
/// along axis a.
struct FaceEdge
{
	std::uint64_t face;
	std::uint32_t from, to;
};

std::uint64_t positionKey( const Eigen::Vector3i& extent, const Eigen::Vector3i& position );
Eigen::Vector3i positionOfKey( const Eigen::Vector3i& extent, std::uint64_t key );

/// Returns the borders of all faces, sorted by face: the cuts of the surface and, between them, the inside parts of the lattice's lines.
/// Adds to the surface's points the lattice's corners and at most `subdivision` - 1 points per cell edge, fewer where the edge bends by
/// less than `bendTolerance`.
std::vector<FaceEdge> makeFaceEdges( ClippedSurface& surface, const NoiseWarp& warp, const CrackSettings& settings );

/// Merges points nearer than `kCrackMergeDistance` into the one with the lowest index, but never two vertices of the input. Returns each
/// point's representative.
std::vector<std::uint32_t> mergeClosePoints( const ClippedSurface& surface, const std::vector<FaceEdge>& edges );

/// A connected piece of a face: loops firstLoop .. lastLoop - 1 of FaceParts::loops, the outer one first.
struct FacePart
{
	std::uint64_t below; ///< key of the position below it
	int axis;
	std::uint32_t firstLoop, lastLoop;
	std::uint32_t firstCut = 0, lastCut = 0; ///< range in FaceParts::cutPoint: further points that it separates
};

struct FaceParts
{
	Loops loops;
	std::vector<Vec2d> at; ///< by entry of loops.point: coordinates along axis + 1 and axis + 2, cells
	std::vector<FacePart> part;
	std::vector<std::uint32_t> cutPoint;
	std::vector<std::uint64_t> broken; ///< faces whose border does not close, because the mesh has unclosed holes
};

/// `merged`: by point, its representative.
FaceParts traceFaces( const ClippedSurface& surface, const std::vector<FaceEdge>& edges, const std::vector<std::uint32_t>& merged );

} // namespace pliant
