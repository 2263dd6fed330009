#pragma once

// The surface and the inside of a body, taken apart along its cells: what every crack of every body of a template can show. Immutable.
// Ohta et al. 2009, "Fracturing", Fig. 4.
//
// Every cell's pieces of the surface and its faces form a closed surface together, and the cells' volumes sum to the mesh's: cell borders
// are the lattice's planes, bent by noise, cut exactly.

#include "lattice/lattice.h"
#include "pliant/body_template.h"
#include "pliant/crack.h"
#include "surface/crack_complex/panels.h"
#include "surface/crack_shapes/table.h"

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
	int adopted = 0;    ///< crumbs of material drawn with a neighbouring cell
	int emptyCells = 0; ///< cells that draw nothing, their material having gone with the noise
	double seconds = 0.0;
};

/// The material between two cells. It shows, once for each of them, when their link is broken.
struct CrackFace
{
	std::uint32_t cellA, cellB;  ///< A < B
	std::uint32_t firstTriangle; ///< in CellComplex::faceTriangle; each turned outwards seen from A
	std::uint32_t lastTriangle;
	float area;    ///< m^2
	bool isLinked; ///< in the lattice as it was built
};

class CellComplex
{
public:
	static constexpr std::uint32_t kNone = 0xffffffffu;

	/// `mesh`, `build`: those the lattice was made from. `skin`: the template's, so that nothing moves when the first crack opens.
	static Result<std::shared_ptr<const CellComplex>> build( const MeshView& mesh, const Lattice& lattice, const SkinBinding& skin,
		const LatticeSettings& build, const CrackSettings& settings );

	// === Points: places, whatever is drawn there ===

	std::vector<Vec3> pointRest;      ///< relative to the lattice's mass centre, m
	Table cellsOfPoint;               ///< cells that draw something there, ascending
	Table facesOfPoint;               ///< faces between them that pass there, ascending
	Table pointsOfCell, pointsOfFace; ///< the other way round
	Table boundPoints;                ///< by cell: points that it carries, ascending
	/// Which cells carry a point while nothing is broken, and how much. Empty rows with Skinning::None.
	Skinning skinning = Skinning::None;
	std::vector<std::uint32_t> bindStart, bindCell;
	std::vector<float> bindWeight;

	// === Vertices of the outer surface: a point with texture coordinates ===

	struct Origin
	{
		std::array<std::uint32_t, 3> vertex; ///< of the input; kNone where fewer will do
		std::array<float, 3> weight;
	};
	std::uint32_t inputVertices = 0; ///< vertex i of the input is vertex i
	std::vector<std::uint32_t> vertexPoint;
	std::vector<Origin> addedOrigin; ///< of vertex inputVertices + k
	std::vector<Vec3> vertexNormal;  ///< at rest, as the whole mesh is shaded; empty with Skinning::None

	// === What a cell draws ===

	std::vector<std::uint32_t> cellTriangleStart;       ///< by cell: its pieces of the outer surface
	std::vector<std::array<std::uint32_t, 3>> triangle; ///< vertices
	std::vector<std::uint32_t> triangleSource;          ///< the input's triangle
	Panels panels;                                      ///< none with Skinning::None

	std::vector<CrackFace> face;                            ///< by cellA, then cellB
	std::vector<std::array<std::uint32_t, 3>> faceTriangle; ///< points
	std::vector<std::uint8_t> faceAxis;                     ///< by face triangle: 2 x axis, plus 1 where A is on the upper side
	Table facesOfCell;
	/// Two cells may share a face and have no link: one of them took a crumb beyond its own position, or the lattice's samples saw no way.
	/// Such a face stands as long as linked ones lead from cell to cell round it. By face: threes of linked faces that lead so (of a
	/// shorter way the last one twice); and by linked face, whom it holds.
	Table holdersOfFace, heldByFace;

	CrackReport report;

	CrackSettings settings;
	float cellSize = 0.0f; ///< of the lattice, m

	std::size_t pointCount() const { return pointRest.size(); }
	std::size_t cellCount() const { return cellTriangleStart.size() - 1; }
	/// The face between two cells; kNone where no material joins them.
	std::uint32_t faceBetween( std::uint32_t a, std::uint32_t b ) const;
	std::size_t bytes() const;
};

/// The first knob out of its range, or Ok. Rejects NaN.
Status check( const CrackSettings& settings );

/// Every invariant of the tables. The sentence names the first one broken.
Status validate( const CellComplex& complex );
/// Each cell's pieces and faces together close: true of exact faces of a closed mesh.
Status validateClosed( const CellComplex& complex );

} // namespace pliant
