#pragma once

// The surface and the inside of a body, divided along its cells: everything that cracks in bodies of one template can show. Immutable. Ohta
// et al. 2009, "Fracturing", Fig. 4.
//
// The surface pieces and faces of each cell form a closed surface together, and the cells' volumes sum to the mesh's: cell borders are the
// lattice's planes, bent by noise and cut exactly.

#include "lattice/lattice.h"
#include "lattice/table.h"
#include "pliant/body_template.h"
#include "pliant/crack.h"
#include "surface/crack_complex/panels.h"

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

namespace pliant {

struct SkinBinding;

struct CrackReport
{
	int faces = 0;      ///< pairs of cells with material between them
	int fallbacks = 0;  ///< lattice squares where the surface's cut does not close, drawn by Marching Squares
	int adopted = 0;    ///< fragments of material drawn with a neighbouring cell
	int emptyCells = 0; ///< cells that draw nothing, because the noise moved their material to neighbours
	double seconds = 0.0;
};

/// The material face between two cells. It is drawn twice, once for each cell, when their link is broken.
struct CrackFace
{
	std::uint32_t cellA, cellB;  ///< A < B
	std::uint32_t firstTriangle; ///< in CellComplex::faceTriangle; oriented outwards as seen from A
	std::uint32_t lastTriangle;
	float area;    ///< m^2
	bool isLinked; ///< in the lattice as built
};

class CellComplex
{
public:
	static constexpr std::uint32_t kNone = 0xffffffffu;

	/// Builds the complex. `mesh`, `build`: those the lattice was built from. `skin`: the template's, so that no vertex moves when the
	/// first crack opens. Errors: those of `check`, of the mesh, and OutOfMemory.
	static Result<std::shared_ptr<const CellComplex>> build( const MeshView& mesh, const Lattice& lattice, const SkinBinding& skin,
		const LatticeSettings& build, const CrackSettings& settings );

	// === Points: positions, independent of the drawing at them ===

	std::vector<Vec3> pointRest;      ///< relative to the lattice's mass centre, m
	Table cellsOfPoint;               ///< cells that draw something there, ascending
	Table facesOfPoint;               ///< faces between these that contain the point, ascending
	Table pointsOfCell, pointsOfFace; ///< the inverse tables
	Table boundPoints;                ///< by cell: points whose position it determines, ascending
	/// Cells that determine a point's position while nothing is broken, and their weights. Empty rows with Skinning::None.
	Skinning skinning = Skinning::None;
	std::vector<std::uint32_t> bindStart, bindCell;
	std::vector<float> bindWeight;

	// === Vertices of the outer surface: a point with texture coordinates ===

	struct Origin
	{
		std::array<std::uint32_t, 3> vertex; ///< of the input; unused entries are kNone
		std::array<float, 3> weight;
	};
	std::uint32_t inputVertices = 0; ///< vertex i of the input is vertex i
	std::vector<std::uint32_t> vertexPoint;
	std::vector<Origin> addedOrigin; ///< of vertex inputVertices + k
	std::vector<Vec3> vertexNormal;  ///< at rest, interpolated as the renderer does; empty with Skinning::None

	// === The drawing of a cell ===

	std::vector<std::uint32_t> cellTriangleStart;       ///< by cell: its pieces of the outer surface
	std::vector<std::array<std::uint32_t, 3>> triangle; ///< vertices
	std::vector<std::uint32_t> triangleSource;          ///< the input's triangle
	Panels panels;                                      ///< none with Skinning::None

	std::vector<CrackFace> face;                            ///< by cellA, then cellB
	std::vector<std::array<std::uint32_t, 3>> faceTriangle; ///< points
	std::vector<std::uint8_t> faceAxis;                     ///< by face triangle: 2 x axis, plus 1 where A is on the upper side
	Table facesOfCell;
	/// Two cells may share a face without a link: one of them took a fragment beyond its own position, or the lattice's samples missed
	/// their connection. Such a face stays closed as long as a chain of linked faces leads from one cell to the other. By face: chains of
	/// three linked faces (of a shorter chain the last one twice); and by linked face: the faces that it holds.
	Table holdersOfFace, heldByFace;

	CrackReport report;

	CrackSettings settings;
	float cellSize = 0.0f; ///< of the lattice, m

	std::size_t pointCount() const { return pointRest.size(); }
	std::size_t cellCount() const { return cellTriangleStart.size() - 1; }
	/// The face between two cells; kNone where no material connects them.
	std::uint32_t faceBetween( std::uint32_t a, std::uint32_t b ) const;
};

/// Returns Ok, or BadSettings with a sentence about the first value that is out of its range (NaN included).
Status check( const CrackSettings& settings );

} // namespace pliant
