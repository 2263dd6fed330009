#pragma once

// The outer surface divided by cells: the part of each input triangle in each cell. Each vertex knows its position on the input's triangle.

#include "lattice/mesh/weld.h"
#include "surface/crack_complex/cell_complex.h"
#include "surface/crack_shapes/clip_surface.h"

#include <array>
#include <cstdint>
#include <vector>

namespace pliant {

struct SurfacePieces
{
	std::vector<std::uint32_t> vertexPoint; ///< points of the clipped surface; the input's vertices first
	std::vector<CellComplex::Origin> addedOrigin;
	std::vector<std::uint32_t> cellStart;
	std::vector<std::array<std::uint32_t, 3>> triangle; ///< vertices, oriented as in the input
	std::vector<std::uint32_t> source;
};

struct PieceInput
{
	const MeshView& mesh;
	const WeldedMesh& welded;
	const Lattice& lattice;
	/// Edges of faces between points of the surface, lower index first, sorted: pieces avoid them as inner edges, since four triangles
	/// would meet there.
	std::vector<std::pair<std::uint32_t, std::uint32_t>> faceEdges;
};

/// `owner`: by polygon, its cell. `merged`: by point, its representative.
SurfacePieces drawPieces( const PieceInput& input, const ClippedSurface& surface, const std::vector<std::uint32_t>& owner,
	const std::vector<std::uint32_t>& merged );

} // namespace pliant
