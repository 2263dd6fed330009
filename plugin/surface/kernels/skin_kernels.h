#pragma once

// The loops over a skin's vertices and triangles behind plain function pointers, one table per instruction set, as matching/kernels has
// them. Every table gives the same bits: four floats at a time, one order of every sum, no fused operation. Wider vectors were tried: rows
// are short and lie apart, and gave nothing back.

#include <cstddef>
#include <cstdint>

namespace pliant {

/// The affine map by which a node carries what is around it, on 16 bytes: rows of F | x - F x0.
inline constexpr int kSkinMapFloats = 12;

/// A vertex that stands within a triangle: SkinBinding::Placed, word by word.
struct SkinPosition
{
	std::uint32_t vertex;
	std::uint32_t corner[3];
	float weight[3];
};

/// Everything a kernel reads and writes, borrowed: SkinBinding's arrays, SkinScratch's, and what is drawn.
struct SkinView
{
	const std::uint32_t* start = nullptr; ///< row of each vertex
	const std::uint32_t* node = nullptr;
	const float* weight = nullptr;
	const std::uint32_t* slot = nullptr;    ///< SkinPose::slotOfCell; null: cells are nodes
	const float* map = nullptr;             ///< kSkinMapFloats a node, on 16 bytes
	const std::uint32_t* carrier = nullptr; ///< null: each vertex has its own row
	const std::uint32_t* listed = nullptr;  ///< vertices that follow rows; null: all
	const SkinPosition* placed = nullptr;
	const float* restPosition = nullptr; ///< 3 a vertex, and so are the next two
	const float* restNormal = nullptr;
	const float* normalShift = nullptr;
	std::size_t shifted = 0; ///< vertices that have a normalShift
	const std::uint32_t* normalGroup = nullptr;

	float* place = nullptr;       ///< 4 a vertex, on 16 bytes, and so are the next two
	float* turnedShift = nullptr; ///< of the first `shifted`
	float* groupNormal = nullptr; ///< a group
	float* positions = nullptr;   ///< 3 a vertex
	float* normals = nullptr;
};

struct SkinKernels
{
	/// x = sum w ( x_n + R_n ( X - x0_n ) )   (Steinemann et al. 2008, section 7), and shifts turned along: entries first to last - 1 of
	/// the list.
	void ( *followRows )( const SkinView&, std::size_t first, std::size_t last );
	/// x = sum w_k x_k over the corners of the triangle it lies in, once they have their places: entries of `placed`.
	void ( *placeFromCorners )( const SkinView&, std::size_t first, std::size_t last );
	/// Vertices first to last - 1 that are carried go where their carriers are.
	void ( *carry )( const SkinView&, std::size_t first, std::size_t last );
	/// Each triangle's normal times twice its area goes to its three corners' groups, triangle by triangle.
	void ( *addAreas )( const SkinView&, const std::uint32_t* corners, int triangles );
	/// Groups' normals, shifted where they are to be: entries of the list.
	void ( *writeNormals )( const SkinView&, std::size_t first, std::size_t last );
	/// n = sum w_k n_k / | sum w_k n_k |, as a renderer shades between the corners of a triangle; the first one's, where they cancel:
	/// entries of `placed`.
	void ( *shadeFromCorners )( const SkinView&, std::size_t first, std::size_t last );

	const char* name;
};

/// The widest table that this processor runs, and the one that every processor does.
const SkinKernels& bestSkinKernels();
const SkinKernels& plainSkinKernels();

} // namespace pliant
