#pragma once

// Data for renderers that skin bodies themselves: records in the layout of a shader's storage buffer (std430) or texel buffer.

#include <cstdint>

namespace pliant {

/// Entries `first` to `first + count - 1` of an array.
struct SkinRange
{
	std::uint32_t first = 0; ///< index of the first entry
	std::uint32_t count = 0; ///< above 0
};

/// An array to be copied into a buffer of the GPU. It changes only with an event: a crack, a fracture, a change of levels. A renderer that
/// holds version `changedSince` needs the entries of `changed` alone; with any other version but `version` it needs all entries.
template <class T>
struct SkinArray
{
	const T* data = nullptr;            ///< `count` entries; null for none
	int count = 0;                      ///< entries
	unsigned version = 0;               ///< changes when an entry or the count does
	unsigned changedSince = 0;          ///< see above; equal to `version` where all is new
	const SkinRange* changed = nullptr; ///< ascending, apart from each other
	int changedCount = 0;               ///< ranges in `changed`
};

/// Marks the end of a list, and a vertex without triangles.
inline constexpr std::uint32_t kSkinNone = 0xffffffffu;

/// A drawn vertex.
struct SkinVertex
{
	float rest[3];        ///< position in the undeformed shape, m, in the frame that the node transforms map from
	std::uint32_t first;  ///< its first SkinInfluence; where `count` is 0, the index of its SkinMix instead
	float restNormal[3];  ///< unit; the normal where the vertex's triangles have no area
	std::uint32_t count;  ///< number of its influences; 0: it lies within a triangle, as its SkinMix states
	float normalShift[3]; ///< difference of the drawn normal from the mean of the triangles', at rest; mostly zero
	std::uint32_t corner; ///< the first SkinCorner of the triangles that its normal is the mean of; kSkinNone: none
};

/// One cell that moves a vertex. Weights of a vertex sum to 1.
struct SkinInfluence
{
	std::uint32_t cell; ///< whose node moves the vertex: GpuSurfaceView::nodeOfCell
	float weight;       ///< 0 to 1
};

/// A vertex on the triangle of three others, which are no such vertices themselves: position and normal are their weighted means.
struct SkinMix
{
	std::uint32_t vertex[3]; ///< the corners
	std::uint32_t unused0;   ///< 0
	float weight[3];         ///< of the corners; sums to 1
	float unused1;           ///< 0
};

/// A corner of a triangle that counts for normals. Corners 3 t, 3 t + 1 and 3 t + 2 are those of triangle t.
struct SkinCorner
{
	std::uint32_t vertex; ///< kSkinNone: the triangle is not in use, and in no list
	std::uint32_t next;   ///< the next corner that the same normal is the mean of; kSkinNone: none
};

/// Displacement of a vertex, in the body's frame.
struct SkinOffset
{
	float offset[3]; ///< m
	float unused;    ///< 0
};

} // namespace pliant
