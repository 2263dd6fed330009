#pragma once

// The outer surface, cell by cell: what a cell has of each triangle of the input, with vertices that remember where on it they lie.

#include "lattice/mesh/weld.h"
#include "surface/crack_complex/cell_complex.h"
#include "surface/crack_shapes/clip_surface.h"

#include <array>
#include <cstdint>
#include <vector>

namespace pliant {

struct SurfacePieces
{
	std::vector<std::uint32_t> vertexPoint; ///< the input's vertices first; points of the clipped surface
	std::vector<CellComplex::Origin> addedOrigin;
	std::vector<std::uint32_t> cellStart;
	std::vector<std::array<std::uint32_t, 3>> triangle; ///< vertices, turned as in the input
	std::vector<std::uint32_t> source;
};

struct PieceInput
{
	const MeshView& mesh;
	const WeldedMesh& welded;
	const Lattice& lattice;
	/// Edges of faces between points of the surface, lower point first, sorted: no piece draws them within itself if it can help it, for
	/// then four triangles would meet there.
	std::vector<std::pair<std::uint32_t, std::uint32_t>> faceEdges;
};

/// `owner`: the cell of each polygon. `merged`: what each point became.
SurfacePieces drawPieces( const PieceInput& input, const ClippedSurface& surface, const std::vector<std::uint32_t>& owner,
	const std::vector<std::uint32_t>& merged );

} // namespace pliant
