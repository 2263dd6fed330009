#pragma once

// The render mesh follows the nodes. Steinemann et al. 2008, section 7; trilinear embedding: Rivers and James 2007.

#include "lattice/lattice.h"
#include "matching/node_state.h"
#include "pliant/body_template.h"
#include "pliant/mesh.h"
#include "surface/kernels/skin_kernels.h"

#include <array>
#include <cstdint>
#include <vector>

namespace pliant {

class SkinFade;
class TaskRunner;

/// Which nodes move a vertex, and how much: built once with the template.
/// Flat arrays; vertex i uses entries start[i] .. start[i + 1).
struct SkinBinding
{
	Skinning kind = Skinning::None;
	std::vector<std::uint32_t> start;
	std::vector<std::uint32_t> node;
	std::vector<float> weight;      ///< sums to 1 a vertex
	std::vector<Vec3> restPosition; ///< per vertex, relative to the lattice's mass centre, m
	std::vector<Vec3>
		restNormal; ///< per vertex, area-weighted over its triangles (welded vertices share theirs), unit; any, of no triangle
	std::vector<std::uint32_t> normalGroup; ///< per vertex: vertices with one number share one normal (unwelded seams)
	int normalGroups = 0;
	/// Of the first so many vertices: by how much their normals at rest are to differ from what their triangles give. It turns along.
	/// Others' do not.
	std::vector<Vec3> normalShift;
	/// Per vertex: the one it stands where and goes with, to the bit (sides of a crack that meet in an edge, seams). Only that one has a
	/// row. Empty: each has its own.
	std::vector<std::uint32_t> carrier;
	/// Per vertex: the point of the CellComplex where it stands. Empty: of none.
	std::vector<std::uint32_t> point;

	/// Stands in a triangle of the input that no crack parts (Panels): place and normal are those of the triangle's corners, in these
	/// shares. Its row is kept, but not asked.
	struct Placed
	{
		std::uint32_t vertex;
		std::array<std::uint32_t, 3> corner; ///< vertices that carry others, or go alone, and are not placed themselves
		std::array<float, 3> weight;
		bool operator==( const Placed& ) const = default;
	};
	std::vector<Placed> placed;         ///< ascending
	std::vector<std::uint32_t> blended; ///< all others, ascending; empty where none is placed
	/// What adds to normals in place of the first so many drawn triangles: the same with their pieces put together again.
	std::vector<std::array<std::uint32_t, 3>> shading;
	std::uint32_t shadedTriangles = 0;

	/// All vertices that are not placed; none where none is.
	void listBlended();
	Vec3 normalShiftOf( std::size_t vertex ) const { return vertex < normalShift.size() ? normalShift[vertex] : Vec3( Vec3::Zero() ); }
	std::uint32_t carrierOf( std::size_t vertex ) const { return carrier.empty() ? std::uint32_t( vertex ) : carrier[vertex]; }
};

/// `weldedVertex`: for each vertex the number of the vertex it was welded to (itself when alone); empty: none were.
/// The input gives no normals, so nothing tells a hard edge from a seam of texture coordinates: vertices at one place share one normal.
///
/// NearbyNodes: the cells whose middles are within 1.4 edges of the vertex, weights falling smoothly to zero there.
/// Trilinear: the eight cells whose middles make the cube around the vertex. Rivers and James embed in a grid whose corners are nodes;
/// our nodes are the cells, so the grid is that of their middles, and half a cell at the surface is carried by the nodes' rotations.
/// Both: only cells that two links join to the cell whose material lies behind the vertex. A vertex out of reach follows that one alone.
SkinBinding bindSkin( const MeshView& mesh, const Lattice& lattice, const std::vector<std::uint32_t>& weldedVertex, Skinning kind );

/// The render mesh's triangles, three vertex numbers each.
struct SkinTriangles
{
	const std::uint32_t* indices = nullptr;
	int count = 0;
};

/// Room that `skin` needs and keeps between calls, so that only the first call allocates. Bodies may take turns with one, which is then
/// still in the processor's cache: only `nodeMap` says anything after a call.
struct SkinScratch
{
	AlignedArray<float> nodeMap;
	AlignedArray<float> position;    ///< four floats a vertex
	AlignedArray<float> turnedShift; ///< the same; of vertices whose normals are shifted
	AlignedArray<float> groupNormal;
};

/// Writes positions (relative to `state.origin`) and unit normals, 3 floats a vertex.
/// `rotations`: one unit quaternion (x, y, z, w) a node, the rotation of the node's own region relative to rest.
/// `triangles`: those of the mesh that was bound. The same bits on any thread count.
void skin( const SkinBinding& binding, const NodeState& state, const float* rotations, const SkinTriangles& triangles, SkinScratch& scratch,
	float* positions, float* normals, TaskRunner* runner = nullptr );

/// How the nodes of a body with levels of detail carry what is around them.
struct SkinPose
{
	const float* rotations = nullptr;          ///< as above
	const float* flow = nullptr;               ///< S_p of each node, 9 floats, row by row: its rest shape has flowed. Null: none has
	const float* gradients = nullptr;          ///< F of each node, 9 floats, row by row: big nodes carry stretch too. Null: rotations alone
	const std::uint32_t* slotOfCell = nullptr; ///< the node that holds a cell; null where cells are nodes
	const SkinFade* fade = nullptr;            ///< what changes of levels have left on the surface; null: nothing
	Eigen::Quaternionf body = Eigen::Quaternionf::Identity(); ///< for `fade`: the body's rotation
};

/// The map of each node, kSkinMapFloats floats.
void skinMaps( const NodeState& state, const SkinPose& pose, float* maps );
/// Of nodes first to last - 1 alone, each at its own place in `maps`; SkinPose::fade is left out.
void skinMaps( const NodeState& state, const SkinPose& pose, float* maps, int first, int last );

/// `kernels`: any table gives the same bits.
void skin( const SkinBinding& binding, const NodeState& state, const SkinPose& pose, const SkinTriangles& triangles, SkinScratch& scratch,
	float* positions, float* normals, TaskRunner* runner = nullptr, const SkinKernels& kernels = bestSkinKernels() );

} // namespace pliant
