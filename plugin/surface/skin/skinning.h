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

class Archive;
class SkinFade;
class TaskRunner;

/// The nodes that move a vertex and their weights; built once with the template. Row of vertex i: start[i] to start[i + 1] - 1.
struct SkinBinding
{
	Skinning kind = Skinning::None;
	std::vector<std::uint32_t> start;
	std::vector<std::uint32_t> node;
	std::vector<float> weight;      ///< sums to 1 per vertex
	std::vector<Vec3> restPosition; ///< per vertex, relative to the lattice's mass centre, m
	std::vector<Vec3> restNormal;   ///< per vertex, area-weighted over its triangles (shared by welded vertices), unit; arbitrary for
									///< vertices without triangles
	std::vector<std::uint32_t> normalGroup; ///< per vertex: vertices of one group share one normal (unwelded seams)
	int normalGroups = 0;
	/// Of the first vertices, one each: difference of the rest normal from the normal of their triangles. It rotates with the nodes. The
	/// other vertices have none.
	std::vector<Vec3> normalShift;
	/// Per vertex: its carrier, the vertex whose position it copies (sides of a crack that meet in an edge, seams). Only carriers have a
	/// row. Empty: each vertex is its own carrier.
	std::vector<std::uint32_t> carrier;
	/// Per vertex: its point of the CellComplex. Empty: no complex.
	std::vector<std::uint32_t> point;

	/// A vertex in a triangle of the input that no crack separates (Panels): position and normal are interpolated from the triangle's
	/// corners with these weights. Its row is kept, but unused.
	struct Placed
	{
		std::uint32_t vertex;
		std::array<std::uint32_t, 3> corner; ///< carriers that are not placed themselves
		std::array<float, 3> weight;
		bool operator==( const Placed& ) const = default;
	};
	std::vector<Placed> placed;         ///< ascending
	std::vector<std::uint32_t> blended; ///< all other vertices, ascending; empty where none is placed
	/// Replaces the first shadedTriangles drawn triangles in the sums of normals: the same, with pieces of intact panels merged.
	std::vector<std::array<std::uint32_t, 3>> shading;
	std::uint32_t shadedTriangles = 0;

	/// Fills `blended`.
	void listBlended();
	/// Writes or reads a template's binding to `cells` cells; data for cracks only is not stored.
	void archive( Archive& archive, std::size_t vertices, std::size_t cells );
	Vec3 normalShiftOf( std::size_t vertex ) const { return vertex < normalShift.size() ? normalShift[vertex] : Vec3( Vec3::Zero() ); }
	std::uint32_t carrierOf( std::size_t vertex ) const { return carrier.empty() ? std::uint32_t( vertex ) : carrier[vertex]; }
};

/// Binds a mesh to a lattice. `weldedVertex`: by vertex, the vertex that it was welded to (itself if none); empty: none were. The input has
/// no normals, so hard edges cannot be distinguished from seams of texture coordinates: coincident vertices share one normal.
///
/// NearbyNodes: cells whose centres are within 1.4 edges of the vertex, with weights that fall smoothly to zero there.
/// Trilinear: the eight cells whose centres form the cube around the vertex. Rivers and James embed in a grid whose corners are nodes; here
/// the nodes are cells, so the grid is that of their centres, and half a cell at the surface follows by the nodes' rotations.
///
/// Both use only cells within two links of the cell whose material lies behind the vertex. A vertex out of reach follows that cell alone.
SkinBinding bindSkin( const MeshView& mesh, const Lattice& lattice, const std::vector<std::uint32_t>& weldedVertex, Skinning kind );

/// The render mesh's triangles, three vertex indices each.
struct SkinTriangles
{
	const std::uint32_t* indices = nullptr;
	int count = 0;
};

/// Scratch of `skin`, kept between calls so that only the first call allocates. Several bodies may share one, which then stays in the
/// processor's cache: only `nodeMap` holds a result after a call.
struct SkinScratch
{
	AlignedArray<float> nodeMap;
	AlignedArray<float> position;    ///< four floats per vertex
	AlignedArray<float> turnedShift; ///< four floats per vertex with a shifted normal
	AlignedArray<float> groupNormal;
};

/// Everything but positions that determines how the nodes of a body move the skin.
struct SkinPose
{
	const float* rotations = nullptr; ///< of each node's region relative to rest, a unit quaternion (x, y, z, w)
	const float* flow = nullptr;      ///< S_p of each node, 9 floats, row-major: its plastic deformation. Null: none
	const float* gradients = nullptr; ///< F of each node, 9 floats, row-major: coarse nodes stretch the skin too. Null: rotations only
	const float* maps = nullptr;      ///< kSkinMapFloats per node, eased: used instead of all above and the nodes. Null: to be computed
	const std::uint32_t* slotOfCell = nullptr;                ///< by cell, the node that holds it; null where cells are nodes
	const SkinFade* fade = nullptr;                           ///< offsets left by changes of levels; null: none
	Eigen::Quaternionf body = Eigen::Quaternionf::Identity(); ///< the body's rotation, for `fade`
};

/// Computes the map of each node, kSkinMapFloats floats.
void skinMaps( const NodeState& state, const SkinPose& pose, float* maps );
/// The same for nodes first to last - 1, each at its own index in `maps`; ignores SkinPose::fade.
void skinMaps( const NodeState& state, const SkinPose& pose, float* maps, int first, int last );

/// The maps of all nodes, eased by SkinPose::fade, on the runner's threads.
void allSkinMaps( const NodeState& state, const SkinPose& pose, AlignedArray<float>& maps, TaskRunner* runner = nullptr );

/// Computes positions (relative to `state.origin`, m) and unit normals, 3 floats per vertex. `triangles`: those of the bound mesh. The same
/// bits for any number of threads and with all tables of `kernels`.
void skin( const SkinBinding& binding, const NodeState& state, const SkinPose& pose, const SkinTriangles& triangles, SkinScratch& scratch,
	float* positions, float* normals, TaskRunner* runner = nullptr, const SkinKernels& kernels = bestSkinKernels() );

} // namespace pliant
