#pragma once

// What the material covers of each cell's faces: where a crack shows when it opens. Ohta et al. 2009, "Fracturing".

#include "surface/crack_shapes/clip_surface.h"
#include "surface/crack_shapes/outline.h"

#include <cstdint>
#include <vector>

namespace pliant {

/// A directed edge of a face's border, material to its left seen from the upper side. Face 3 k + a stands above position k along axis a.
struct FaceEdge
{
	std::uint64_t face;
	std::uint32_t from, to;
};

std::uint64_t positionKey( const Eigen::Vector3i& extent, const Eigen::Vector3i& position );
Eigen::Vector3i positionOfKey( const Eigen::Vector3i& extent, std::uint64_t key );

/// The borders of all faces, sorted by face: the cuts of the surface and, between them, the parts of the lattice's lines that are inside.
/// Adds the lattice's corners and at most `subdivision` - 1 points a cell's edge to the surface's points, fewer where it bends by less than
/// `bendTolerance`.
std::vector<FaceEdge> makeFaceEdges( ClippedSurface& surface, const NoiseWarp& warp, const CrackSettings& settings );

/// Points nearer than `kMergeDistance` become one, the lower-numbered, but no two vertices of the input. By point: what it became.
std::vector<std::uint32_t> mergeClosePoints( const ClippedSurface& surface, const std::vector<FaceEdge>& edges );

/// A connected piece of a face: loops first .. last of FaceParts::loops, the outer one first.
struct FacePart
{
	std::uint64_t below; ///< key of the position under it
	int axis;
	std::uint32_t firstLoop, lastLoop;
	std::uint32_t firstCut = 0, lastCut = 0; ///< of FaceParts::cutPoint: more points that it parts
};

struct FaceParts
{
	Loops loops;
	std::vector<Vec2d> at; ///< by entry of loops.point: place along axis + 1 and axis + 2
	std::vector<FacePart> part;
	std::vector<std::uint32_t> cutPoint;
	std::vector<std::uint64_t> broken; ///< faces whose border does not close: the mesh has holes that were not closed
};

/// `merged`: what each point became.
FaceParts traceFaces( const ClippedSurface& surface, const std::vector<FaceEdge>& edges, const std::vector<std::uint32_t>& merged );

} // namespace pliant
