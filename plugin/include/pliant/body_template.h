#pragma once

// A mesh turned into finest cells, links and skin weights: immutable, built once, shared by any number of bodies.

#include "pliant/crack.h"
#include "pliant/export.h"
#include "pliant/mesh.h"
#include "pliant/result.h"

#include <cstdint>
#include <memory>

namespace pliant {

class TaskRunner;
struct Lattice;
struct SkinBinding;
struct TemplateCache;
class CellComplex;
class CrackPatches;
class CrackSurface;

/// How the render mesh follows the nodes.
enum class Skinning : int
{
	NearbyNodes, ///< weighted transforms of nearby nodes on the vertex's own side of the material (Steinemann et al. 2008, section 7)
	Trilinear,   ///< trilinear embedding in the lattice (Rivers and James 2007)
	None         ///< no surface: collision and physics only
};

/// When the surface of a mesh itself becomes material: one layer of cells that carries it. Sheets, leaves, ribbons and open models have no
/// inside to be filled; and parts of a solid may be too thin for cells of their own.
enum class Shell : int
{
	WhereNeeded, ///< where no inside is found, and where the surface would be further than a cell from all that collides
	Never,       ///< a mesh without an inside is refused; thin parts of a solid are drawn, but nothing of them collides
	Always       ///< everywhere, and nothing else: closed meshes are hollow
};

struct LatticeSettings
{
	/// Edge of a finest cell, m. 0: chosen so that about `targetCells` cells are filled.
	float cellSize = 0.0f;

	/// Used when cellSize is 0. 1 to maxCells.
	int targetCells = 1000;

	/// More cells than this are refused (ResultCode::TooManyCells). 1 to 10 000 000.
	int maxCells = 200000;

	/// More triangles than this are refused. 1 to 100 000 000.
	int maxTriangles = 5000000;

	/// Inside samples along a cell's edge, 1 to 8: a surface cell's mass and rest centre come from the cube of this many. Open meshes of
	/// many holes may get fewer (BuildReport::samplesPerEdge): what inside costs is bounded.
	int samplesPerEdge = 4;

	/// Vertices nearer than this share of the mesh's bounding-box diagonal are one, [0, 0.01].
	float weldTolerance = 1e-6f;

	/// Cells with less material than this share of a full cell are dropped (their material is left out), [0, 0.5].
	float minimumFill = 0.03f;

	Shell shell = Shell::WhereNeeded;

	/// Thickness of a shell's material, m, 0 to 1e7. 0: a cell's edge. A shell's cell weighs density x thickness x the area of surface in
	/// it, at most a full cell and at least 0.03 of one; both sides of a leaf count where both are drawn. Thin parts of a closed solid
	/// weigh 0.03 of a full cell each, whatever is set here: what material they have is known, and is less. How a shell looks and bends
	/// goes by its cells.
	float shellThickness = 0.0f;

	Skinning skinning = Skinning::NearbyNodes;

	/// What touches a body that steps implicitly meets the drawn surface instead of one ball a cell, where that is smooth: small things lie
	/// on it, a ball rolls (docs/design/contacts.md). Bodies that step explicitly, levels of detail, edges, thin parts and crack faces keep
	/// the balls. Costs 24 bytes a cell.
	bool contactSurface = false;

	/// The faces that cracks show. They are made when the first body of the template is allowed to break, or is cut, and not before.
	CrackSettings cracks;

	/// Threads for building; null: the calling thread alone. The result does not depend on it.
	TaskRunner* runner = nullptr;

	/// Called now and then with the share done, [0, 1]; return false to cancel. Called from the building thread.
	bool ( *progress )( float fractionDone, void* context ) = nullptr;
	void* progressContext = nullptr;
};

/// What was found and done while building, for a log or a warning to an artist.
struct BuildReport
{
	int weldedVertices = 0;   ///< vertices merged into another
	int flippedTriangles = 0; ///< triangles turned to agree with their neighbours or with the outside
	int droppedTriangles = 0; ///< zero-area or duplicate triangles left out
	int openEdges = 0;        ///< edges with one triangle: the mesh is not closed; inside comes from the winding number
	int nonManifoldEdges = 0; ///< edges with three or more triangles
	int shells = 0;           ///< connected parts of the mesh
	int cells = 0;
	int shellCells = 0;     ///< of them, those that carry surface and hold no inside (LatticeSettings::shell)
	int samplesPerEdge = 0; ///< used: fewer than asked for where the mesh is open and inside is dear to tell; 0: it was not asked
	int splitCells = 0;     ///< lattice positions that hold more than one material part
	int cutLinks = 0;       ///< links left out because the surface separates the material
	int components = 0;     ///< connected parts of the lattice
	double volume = 0.0;    ///< m^3, of the material in the cells
	double seconds = 0.0;
};

/// Immutable and reference-counted. Hold it with std::shared_ptr; bodies hold it too.
class PLIANT_API BodyTemplate
{
public:
	/// Turn a mesh into cells. On refusal the result says why and nothing is kept.
	static Result<std::shared_ptr<const BodyTemplate>> build( const MeshView& mesh, const LatticeSettings& settings = {} );

	~BodyTemplate();
	BodyTemplate( const BodyTemplate& ) = delete;
	BodyTemplate& operator=( const BodyTemplate& ) = delete;

	int cellCount() const;
	/// Links between cells, each counted once.
	int linkCount() const;
	/// Edge of a cell, m.
	float cellSize() const;
	/// Centre of mass in the mesh's own coordinates, m: 3 doubles.
	const double* massCentre() const;
	const BuildReport& report() const;

	/// The render mesh: vertex i is the input's vertex i. Null arrays where the input gave none.
	int vertexCount() const;
	int triangleCount() const;
	const std::uint32_t* indices() const;
	const float* textureCoordinates() const;
	const std::uint32_t* submeshOfTriangle() const;

	/// Private to Pliant's own sources (the types are not public).
	const Lattice& lattice() const;
	std::shared_ptr<const Lattice> sharedLattice() const;
	std::shared_ptr<TemplateCache> cache() const;
	const SkinBinding& skin() const;
	/// What cracks can show, made at the first call; safe from several threads. Null with Skinning::None, or when there is no memory for
	/// it: cracks are then not drawn.
	std::shared_ptr<const CellComplex> crackComplex() const;
	/// The surface of a whole body, ready to crack; made with it.
	std::shared_ptr<const CrackSurface> crackSurface() const;
	std::shared_ptr<const CrackPatches> crackPatches() const;

private:
	BodyTemplate();
	struct Data;
	std::unique_ptr<Data> m_data;
};

} // namespace pliant
