#pragma once

// The loops over a skin's vertices and triangles behind function pointers, one table per instruction set, as in matching/kernels. All
// tables give the same bits: four floats at a time, one order of each sum, no fused operation. Wider vectors bring no gain, because rows
// are short and scattered.

#include <cstddef>
#include <cstdint>

namespace pliant {

/// Floats of the affine map of a node, 16-byte aligned: rows of F | x - F x0.
inline constexpr int kSkinMapFloats = 12;

/// A vertex placed within a triangle; same layout as SkinBinding::Placed.
struct SkinPosition
{
	std::uint32_t vertex;
	std::uint32_t corner[3];
	float weight[3];
};

/// Everything that a kernel reads and writes, not owned: arrays of SkinBinding, SkinScratch and the drawn mesh.
struct SkinView
{
	const std::uint32_t* start = nullptr; ///< by vertex: its row
	const std::uint32_t* node = nullptr;
	const float* weight = nullptr;
	const std::uint32_t* slot = nullptr;    ///< SkinPose::slotOfCell; null: cells are nodes
	const float* map = nullptr;             ///< kSkinMapFloats per node, 16-byte aligned
	const std::uint32_t* carrier = nullptr; ///< null: each vertex has its own row
	const std::uint32_t* listed = nullptr;  ///< vertices that follow rows; null: all
	const SkinPosition* placed = nullptr;
	const float* restPosition = nullptr; ///< 3 per vertex, as in the next two
	const float* restNormal = nullptr;
	const float* normalShift = nullptr;
	std::size_t shifted = 0; ///< number of vertices that have a normalShift
	const std::uint32_t* normalGroup = nullptr;

	float* position4 = nullptr;   ///< 4 per vertex, 16-byte aligned, as in the next two
	float* turnedShift = nullptr; ///< of the first `shifted`
	float* groupNormal = nullptr; ///< 4 per group
	float* positions = nullptr;   ///< 3 per vertex
	float* normals = nullptr;
};

struct SkinKernels
{
	/// x = sum w ( x_n + R_n ( X - x0_n ) )   (Steinemann et al. 2008, section 7), and rotated normal shifts: for entries first to last - 1
	/// of the list.
	void ( *followRows )( const SkinView&, std::size_t first, std::size_t last );
	/// x = sum w_k x_k over the corners of the vertex's triangle, whose positions must be known: for entries of `placed`.
	void ( *placeFromCorners )( const SkinView&, std::size_t first, std::size_t last );
	/// Copies the positions of carriers to their vertices, for vertices first to last - 1.
	void ( *carry )( const SkinView&, std::size_t first, std::size_t last );
	/// Adds each triangle's normal times twice its area to the groups of its three corners, triangle by triangle.
	void ( *addAreas )( const SkinView&, const std::uint32_t* corners, int triangles );
	/// Normalises and shifts the groups' normals: for entries of the list.
	void ( *writeNormals )( const SkinView&, std::size_t first, std::size_t last );
	/// n = sum w_k n_k / | sum w_k n_k |, as a renderer interpolates in a triangle; n of the first corner where the sum is zero: for
	/// entries of `placed`.
	void ( *shadeFromCorners )( const SkinView&, std::size_t first, std::size_t last );

	const char* name;
};

/// The table with the widest instructions of this processor, and the one for every processor.
const SkinKernels& bestSkinKernels();
const SkinKernels& plainSkinKernels();

} // namespace pliant
