#pragma once

// The drawn mesh of a cracked body, a part of its family's cracks. Ohta et al. 2009, "Fracturing".

#include "surface/crack_state/crack_sides.h"
#include "surface/skin/skinning.h"

#include <memory>

namespace pliant {

class TaskRunner;

/// The drawn mesh of a cracked body.
struct CrackView
{
	SkinBinding binding; ///< its nodes are the body's cells
	std::vector<std::array<std::uint32_t, 3>> triangles;
	std::vector<std::uint32_t> sources; ///< by triangle: the input's triangle, or CellComplex::kNone for the inside
	std::vector<float> texture;         ///< u, v of each vertex
	std::vector<std::uint32_t> kinds;   ///< by vertex: CrackPatches::Appearance::kind

	SkinTriangles shown() const { return { triangles.empty() ? nullptr : triangles[0].data(), int( triangles.size() ) }; }
};

/// Assembles views from the patches of a body's cells, with intact panels as one triangle. Keeps its scratch between calls.
class CrackGatherer
{
public:
	/// Makes the view of a body of these cells (ascending). `shift`: its mass centre relative to the template's, m. With several threads
	/// the inside is numbered in parallel with the outer surface, and writing is divided among the threads; the serial path is the
	/// reference implementation.
	void gather( const CrackSides& sides, const std::vector<std::uint32_t>& cells, const Vec3& shift, CrackView& view,
		TaskRunner* runner = nullptr );

private:
	static constexpr std::uint32_t kNone = CellComplex::kNone;

	struct Made
	{
		std::uint32_t vertex; ///< index in the patches
		std::uint32_t carrier, normalGroup;
	};
	/// A side that the current body draws; its first vertex is the carrier of the others.
	struct Row
	{
		std::uint32_t vertex; ///< index in the body
		std::uint32_t side;
		std::uint64_t carriers;
	};
	/// The numbers of a side that precede those of its kinds (CrackPatches::numbersOfSlot).
	enum Number : std::uint32_t
	{
		Carrier,
		OuterNormals,
		InnerNormals
	};

	/// Sides of the inside, numbered separately, and where their numbers are stored: the outer surface may contain them too.
	struct SharedRow
	{
		std::uint32_t row, number;
	};

	void reserveScratch( const std::vector<std::uint32_t>& cells, CrackView& view );
	void begin( std::size_t vertices );
	std::uint32_t verticesOf( std::uint32_t patch ) const
	{
		return m_sides->patches().patch[patch + 1].firstVertex - m_sides->patches().patch[patch].firstVertex;
	}
	bool isOuter( std::size_t patch ) const { return patch < m_cells; } ///< `patch`: index in m_patch
	/// Returns the end of the triangles drawn.
	std::array<std::uint32_t, 3>* number( std::size_t first, std::size_t last, std::array<std::uint32_t, 3>* triangles );
	void numberTogether( CrackView& view, TaskRunner* runner );
	void append( std::array<std::uint32_t, 3>* triangles, std::size_t count, TaskRunner* runner );
	void lookUpSides( std::size_t patch );
	std::array<std::uint32_t, 3>* takePatch( std::uint32_t patch, std::uint32_t* local, std::array<std::uint32_t, 3>* triangles );
	std::uint32_t numberOf( std::uint32_t vertex, std::uint32_t* known );
	std::uint32_t addVertex( std::uint32_t vertex, std::uint32_t carrier, std::uint32_t normalGroup );
	void addAreas( std::uint32_t patch, const std::uint32_t* local );
	void takeOuter( std::uint32_t patch, const std::uint32_t* local, std::uint32_t firstNew );
	void addArea( const std::array<std::uint32_t, 3>& points, const std::array<std::uint32_t, 3>& normalGroups );
	std::array<std::uint32_t, 3>* takePanels( std::array<std::uint32_t, 3>* triangles );
	void takePanel( std::uint32_t panel );
	/// A number of each corner of an intact panel.
	std::array<std::uint32_t, 3> ofCorners( std::uint32_t panel, std::uint32_t number ) const;
	void write( const std::vector<std::uint32_t>& cells, const Vec3& shift, CrackView& view, TaskRunner* runner );
	void makeArrays( CrackView& view ) const;
	void takeSources( const std::vector<std::uint32_t>& cells, CrackView& view ) const;
	std::uint32_t takeCarriers( std::size_t first, std::size_t last );
	void writeVertices( const Vec3& shift, CrackView& view, std::size_t first, std::size_t last ) const;
	void writeNormals( SkinBinding& to, std::size_t first, std::size_t last ) const;
	void writeRows( SkinBinding& to, std::size_t first, std::size_t last, std::uint32_t entries ) const;
	void writeRow( const Row& row, std::uint32_t* node, float* weight ) const;
	void listPlaced( SkinBinding& to, TaskRunner* runner ) const;
	SkinBinding::Placed placedAt( std::uint32_t vertex ) const;

	const CrackSides* m_sides = nullptr;
	std::vector<std::uint32_t> m_cellInBody; ///< by cell: its index in the body
	std::vector<std::uint32_t> m_patch;      ///< of the body: its cells, then their sides of broken faces
	std::vector<std::uint32_t> m_number;     ///< as in CrackPatches::numbersOfSlot; values below m_first are of an earlier body
	std::uint32_t m_first = 1;
	std::vector<Made> m_made;                                        ///< capacity for all; m_count are in use
	std::size_t m_cells = 0;                                         ///< of the body
	std::uint32_t m_count = 0, m_outerCount = 0, m_normalGroups = 0; ///< vertices, the outer surface's first
	std::uint32_t m_outerTriangles = 0;
	std::vector<Row> m_row;                 ///< by vertex
	std::vector<std::uint32_t> m_local;     ///< of the current patch: indices of its vertices in the body
	std::vector<SharedRow> m_sharedRow;     ///< while the inside is numbered separately
	std::unique_ptr<CrackGatherer> m_inner; ///< numbers the inside in parallel
	std::vector<Vec3> m_area;               ///< by group of normals, where points are reshaded: of the outer surface
	/// Of the outer surface: vertices within intact panels; SkinBinding::shading, if there are any. Capacity for all and one more,
	/// uninitialised.
	std::unique_ptr<std::uint32_t[]> m_placed;
	std::unique_ptr<std::array<std::uint32_t, 3>[]> m_shading;
	std::size_t m_placedCount = 0, m_shadingCount = 0, m_outerCapacity = 0, m_shadingCapacity = 0;
	std::vector<std::array<std::uint32_t, 3>> m_panelTriangle; ///< triangles of intact panels
	std::vector<std::uint32_t> m_panelSource, m_around;        ///< by such triangle; the drawn part of a panel's border
};

} // namespace pliant
