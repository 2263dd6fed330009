#pragma once

// One picture as plain data: what is drawn, where the light and the eye are. Needs no graphics library, so that a scene can also be
// written to a model file.

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace pliant_glue {

using Vec3 = std::array<float, 3>;

/// Linear RGB, 0 to 1.
using Colour = std::array<float, 3>;

/// Entries of a table that have changed.
struct DrawRange
{
	std::uint32_t first = 0, count = 0;
};

/// A table for the GPU, borrowed until the picture is drawn.
struct DrawTable
{
	const void* data = nullptr;
	std::size_t entries = 0, entryBytes = 0;
	/// A buffer of version `changedSince` needs the entries of `changed` only, one of another version but this all.
	unsigned version = 0, changedSince = 0;
	std::vector<DrawRange> changed;
};

/// What a mesh that is skinned on the GPU is skinned with: the arrays of the plugin's pliant/render/gpu_surface.h.
struct DrawSkin
{
	DrawTable vertices, influences, mixes, corners, nodeOfCell, offsets;
	const float* nodeTransforms = nullptr; ///< 12 floats per node: three rows
	int nodeCount = 0;
	std::array<float, 9> offsetTurn{};
};

/// A triangle mesh, borrowed until the picture is drawn.
struct DrawMesh
{
	/// The same number names the same mesh in the next picture, whose indices need not be sent again while `topologyVersion` stays.
	std::uint64_t id = 0;
	unsigned topologyVersion = 0;
	const float* positions = nullptr; ///< null: as `skin` has it
	const float* normals = nullptr;
	std::shared_ptr<const DrawSkin> skin; ///< null: skinned already
	const std::uint32_t* indices = nullptr;
	int vertexCount = 0;
	int triangleCount = 0;
	float cellSize = 1;        ///< of the lattice that moves it, m
	Vec3 origin = { 0, 0, 0 }; ///< added to every position
	Colour colour = { 0.8f, 0.8f, 0.8f };
	const float* vertexColours = nullptr; ///< 3 floats a vertex, linear RGB; null: `colour` all over
};

/// A unit shape (edge 1, or diameter 1) put in place: columns of a 3x3 matrix with the size in it, then the position.
struct DrawInstance
{
	Vec3 axisX = { 1, 0, 0 }, axisY = { 0, 1, 0 }, axisZ = { 0, 0, 1 };
	Vec3 position = { 0, 0, 0 };
	Colour colour = { 0.8f, 0.8f, 0.8f };
};

struct DrawLine
{
	Vec3 from, to;
	Colour colour;
};

struct DrawCamera
{
	Vec3 eye = { 3, 2, 5 };
	Vec3 target = { 0, 0.5f, 0 };
	float fieldOfView = 40.0f; ///< degrees, bottom to top
};

struct DrawLight
{
	Vec3 toSun = { -0.55f, 0.75f, 0.35f };
	Vec3 shadowCentre = { 0, 0.5f, 0 }; ///< shadows are drawn within a ball
	float shadowRadius = 4.0f;
};

/// y is up.
struct DrawList
{
	std::vector<DrawMesh> meshes;
	std::vector<DrawInstance> boxes;   ///< unit cubes
	std::vector<DrawInstance> spheres; ///< diameter 1
	std::vector<DrawLine> lines;
	bool hasGround = true;
	float groundHeight = 0.0f;
	DrawCamera camera;
	DrawLight light;

	void clear()
	{
		meshes.clear();
		boxes.clear();
		spheres.clear();
		lines.clear();
	}
};

} // namespace pliant_glue
