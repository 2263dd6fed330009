#pragma once

// A mesh converted into finest cells, links and skin weights: immutable, built once, shared by any number of bodies.

#include "pliant/crack.h"
#include "pliant/export.h"
#include "pliant/mesh.h"
#include "pliant/result.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace pliant {

class Archive;
class TaskRunner;
struct Lattice;
struct SkinBinding;
struct SkinTables;
struct TemplateCache;
class CellComplex;
class CrackPatches;

/// How the render mesh follows the nodes.
enum class Skinning : int
{
	NearbyNodes, ///< weighted transforms of nearby nodes on the vertex's side of the material (Steinemann et al. 2008, section 7). Default.
	Trilinear,   ///< trilinear embedding in the lattice (Rivers and James 2007)
	None         ///< no render mesh: simulation and collision only
};

/// When the surface of a mesh itself becomes material, as one layer of cells that contains it. Sheets, leaves, ribbons and open meshes have
/// no inside to fill, and parts of a solid may be too thin for cells of their own.
enum class Shell : int
{
	WhereNeeded, ///< where no inside is found, and where the surface is further than a cell from every collision sphere. Default.
	Never,       ///< a mesh without an inside is refused (ZeroVolume); thin parts of a solid are drawn, but do not collide
	Always       ///< the whole surface, and only the surface: closed meshes become hollow
};

/// Settings of BodyTemplate::build. Values out of range are refused (BadSettings).
struct LatticeSettings
{
	/// Edge length of a finest cell, m, finite. 0: chosen so that about `targetCells` cells are filled, in a box along the axes full ones.
	float cellSize = 0.0f;

	/// Desired number of cells, 1 to maxCells; used when cellSize is 0.
	int targetCells = 1000;

	/// Largest number of cells, 1 to 10 000 000; more are refused (TooManyCells).
	int maxCells = 200000;

	/// Largest number of triangles, 1 to 100 000 000; more are refused (TooManyTriangles).
	int maxTriangles = 5000000;

	/// Number of inside samples along a cell's edge, 1 to 8: the mass and rest centre of a surface cell come from the cube of this many
	/// points. Open meshes with many holes may get fewer, to bound the time (BuildReport::samplesPerEdge).
	int samplesPerEdge = 4;

	/// Distance below which vertices are merged, as a fraction of the diagonal of the mesh's bounding box, [0, 0.01].
	float weldTolerance = 1e-6f;

	/// Cells that are filled with material to less than this fraction are dropped with their material, [0, 0.5].
	float minimumFill = 0.03f;

	/// When the surface of the mesh itself becomes material.
	Shell shell = Shell::WhereNeeded;

	/// Thickness of a shell's material, m, 0 to 1e7. 0: the edge of a cell. The mass of a shell cell is density x thickness x the surface
	/// area in it, limited to 0.03 to 1 times that of a full cell; where both sides of a leaf are drawn, both count. Cells on thin parts of
	/// a closed solid always have 0.03 of a full cell's mass, since their true mass is less. Bending and collision depend on the cell size,
	/// not on the thickness.
	float shellThickness = 0.0f;

	/// How the render mesh follows the nodes. A build without Feature::Surface takes Skinning::None alone (BadArgument).
	Skinning skinning = Skinning::NearbyNodes;

	/// Rigid objects that move, static and kinematic ones smaller than 3 cells, and, where both step implicitly and are unbroken, other
	/// soft bodies collide with the drawn surface of the body where it is smooth; all others with one sphere per cell, or, where this is
	/// true, with the drawn surface too: what carries the body, and all soft bodies (docs/design/contacts.md). Crack faces are flat as the
	/// cells are. Large objects meet edges, and all objects meet shells and rods one cell thick, in the spheres. The surface takes 28 bytes
	/// per cell, and at edges and in thin parts up to 96 more.
	bool contactSurface = false;

	/// Shape of the crack faces. They are computed when the first body of the template may break or is cut.
	CrackSettings cracks;

	/// Threads for building, used only during the build; null: the calling thread alone. The result does not depend on it.
	TaskRunner* runner = nullptr;

	/// Called from the building thread from time to time with the fraction done, [0, 1]; returns false to cancel (Cancelled). May be null.
	bool ( *progress )( float fractionDone, void* context ) = nullptr;
	void* progressContext = nullptr; ///< passed to `progress`
};

/// Findings and corrections of the build, for a log or a warning to an artist.
struct BuildReport
{
	int weldedVertices = 0;   ///< vertices merged into another
	int flippedTriangles = 0; ///< triangles whose orientation was reversed to agree with their neighbours or with the outside
	int droppedTriangles = 0; ///< zero-area or duplicate triangles left out
	int openEdges = 0;        ///< edges with one triangle: the mesh is not closed, and the winding number defines the inside
	int nonManifoldEdges = 0; ///< edges with three or more triangles
	int shells = 0;           ///< connected parts of the mesh
	int cells = 0;            ///< finest cells that were filled
	int shellCells = 0;       ///< those of `cells` that contain surface and no inside (LatticeSettings::shell)
	int samplesPerEdge = 0;   ///< as used; fewer than set where inside tests of an open mesh are expensive; 0: no inside was sampled
	int splitCells = 0;       ///< lattice positions that hold more than one material part
	int cutLinks = 0;         ///< links left out because the surface separates the material
	int components = 0;       ///< connected parts of the lattice
	double volume = 0.0;      ///< volume of the material in the cells, m^3
	double seconds = 0.0;     ///< duration of the build, s
};

/// The immutable data that bodies of one mesh share. Reference-counted: each body holds a std::shared_ptr to it.
class PLIANT_API BodyTemplate
{
public:
	/// Converts a mesh into cells. Errors: all mesh and settings codes of ResultCode, Cancelled, OutOfMemory; BadArgument for null arrays,
	/// a stride below 3, or a skin where the build lacks Feature::Surface.
	static Result<std::shared_ptr<const BodyTemplate>> build( const MeshView& mesh, const LatticeSettings& settings = {} );

	/// The same template of another size, `factor` times as large along each axis; much faster than to build it again. Crack settings that
	/// are lengths stay as they are. Errors: BadArgument for a factor that is not within 1e-6 to 1e6; OutOfMemory.
	[[nodiscard]] Result<std::shared_ptr<const BodyTemplate>> scaled( float factor ) const;

	~BodyTemplate();
	BodyTemplate( const BodyTemplate& ) = delete;
	BodyTemplate& operator=( const BodyTemplate& ) = delete;

	/// Number of finest cells.
	[[nodiscard]] int cellCount() const;
	/// Number of links between cells, each counted once.
	[[nodiscard]] int linkCount() const;
	/// Edge length of a cell, m.
	[[nodiscard]] float cellSize() const;
	/// Centre of mass in mesh coordinates, m: 3 doubles.
	[[nodiscard]] const double* massCentre() const;
	/// Findings and corrections of the build. Valid as long as the template.
	[[nodiscard]] const BuildReport& report() const;

	// The render mesh: vertex i is the input's vertex i. Arrays are valid as long as the template. With Skinning::None counts are 0 and
	// arrays null.
	/// Number of vertices of the render mesh, as in the input.
	[[nodiscard]] int vertexCount() const;
	/// Number of triangles of the render mesh, as in the input.
	[[nodiscard]] int triangleCount() const;
	/// 3 vertex indices per triangle.
	[[nodiscard]] const std::uint32_t* indices() const;
	/// 2 floats per vertex; null where the input had none.
	[[nodiscard]] const float* textureCoordinates() const;
	/// The submesh number of each triangle; null where the input had none.
	[[nodiscard]] const std::uint32_t* submeshOfTriangle() const;

	/// @cond INTERNAL
	/// For Pliant's own sources only (the types are not public).
	const Lattice& lattice() const;
	std::shared_ptr<const Lattice> sharedLattice() const;
	std::shared_ptr<TemplateCache> cache() const;
	const SkinBinding& skin() const;
	/// Tangents at rest, 4 floats per vertex: the input's, or made of the texture coordinates at the first call; callable from several
	/// threads. Null where the input had neither.
	std::shared_ptr<const std::vector<float>> restTangents() const;
	/// As the template was built, without pointers of the game.
	const LatticeSettings& settings() const;
	/// The skin's tables for the GPU, made at the first call; callable from several threads.
	std::shared_ptr<const SkinTables> skinTables() const;
	/// Everything that cracks can show, computed at the first call; callable from several threads. Null with Skinning::None or when memory
	/// does not suffice: cracks are then not drawn.
	std::shared_ptr<const CellComplex> crackComplex() const;
	/// Its drawing, computed together with it.
	std::shared_ptr<const CrackPatches> crackPatches() const;
	/// Writes or reads everything (io/snapshot.h); reading needs a blank one.
	void archive( Archive& archive );
	static std::shared_ptr<BodyTemplate> blank();
	/// A hash of everything but the report: equal templates have equal ones.
	std::uint64_t fingerprint() const;
	/// @endcond

private:
	BodyTemplate();
	struct Data;
	std::unique_ptr<Data> m_data;
};

} // namespace pliant
