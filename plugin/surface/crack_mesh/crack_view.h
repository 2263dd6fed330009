#pragma once

// A body's share of the cracks of its family, as it is drawn. Ohta et al. 2009, "Fracturing".

#include "surface/crack_state/crack_sides.h"
#include "surface/crack_state/crack_surface.h"

#include <memory>

namespace pliant {

class TaskRunner;

/// What a body shows. Borrowed from the family while the body is all of it; then its own.
struct CrackView
{
	const SkinBinding* binding = nullptr; ///< nodes: the body's cells
	const std::array<std::uint32_t, 3>* triangles = nullptr;
	const std::uint32_t* sources = nullptr; ///< CrackSurface::sources
	const float* texture = nullptr;         ///< u, v of each vertex
	int triangleCount = 0;
	CrackSurface::Change change; ///< since the view was last asked for; all of it, where that was of other cells

	SkinBinding ownBinding;
	std::vector<std::array<std::uint32_t, 3>> ownTriangles;
	std::vector<std::uint32_t> ownSources;
	std::vector<float> ownTexture;
};

/// Puts views together from the patches of a body's cells: panels that are one are drawn as one. It keeps the room it needs.
class CrackGatherer
{
public:
	/// What a body of these cells (ascending) shows. `shift`: its mass centre seen from the template's, m. Its inside is numbered beside
	/// its outer surface, and what is written is shared out, on the runner's threads; with one or none, one after the other, which is the
	/// slow twin.
	void gather( const CrackSides& sides, const std::vector<std::uint32_t>& cells, const Vec3& shift, CrackView& view,
		TaskRunner* runner = nullptr );

private:
	static constexpr std::uint32_t kNone = CrackSurface::kNone;

	/// A vertex of the body at hand.
	struct Made
	{
		std::uint32_t vertex; ///< of the patches
		std::uint32_t carrier, normalGroup;
	};
	/// A side that the body at hand draws: its first vertex carries the others.
	struct Row
	{
		std::uint32_t vertex; ///< of the body
		std::uint32_t side;
		std::uint64_t carriers;
	};
	/// What a side keeps numbers for, before those of its kinds (CrackPatches::numbersOfSlot).
	enum Number : std::uint32_t
	{
		Carrier,
		OuterNormals,
		InnerNormals
	};

	/// Sides of the inside that are numbered by themselves, and where their numbers are: the outer surface may have them too.
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
	bool isOuter( std::size_t patch ) const { return patch < m_cells; } ///< by place in m_patch
	/// The end of what they draw.
	std::array<std::uint32_t, 3>* number( std::size_t first, std::size_t last, std::array<std::uint32_t, 3>* triangles );
	void numberTogether( CrackView& view, TaskRunner* runner );
	void append( std::array<std::uint32_t, 3>* triangles, std::size_t count, TaskRunner* runner );
	std::size_t lookAhead( std::size_t first, std::size_t last );
	std::array<std::uint32_t, 3>* takePatch( std::uint32_t patch, std::uint32_t* local, std::array<std::uint32_t, 3>* triangles );
	std::uint32_t numberOf( std::uint32_t vertex, std::uint32_t* known );
	std::uint32_t addVertex( std::uint32_t vertex, std::uint32_t carrier, std::uint32_t normalGroup );
	void addAreas( std::uint32_t patch, const std::uint32_t* local );
	void takeOuter( std::uint32_t patch, const std::uint32_t* local, std::uint32_t fresh );
	void addArea( const std::array<std::uint32_t, 3>& points, const std::array<std::uint32_t, 3>& normalGroups );
	std::array<std::uint32_t, 3>* takePanels( std::array<std::uint32_t, 3>* triangles );
	void takePanel( std::uint32_t panel );
	/// Of a panel that is one: each corner's.
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
	std::vector<std::uint32_t> m_cellNow; ///< by cell: its number in the body
	std::vector<std::uint32_t> m_patch;   ///< of the body: its cells, then their sides of broken faces
	std::vector<std::uint32_t> m_number;  ///< as CrackPatches::numbersOfSlot says; below m_first: of an earlier body
	std::uint32_t m_first = 1;
	std::vector<Made> m_made;                                        ///< room for all; m_count are
	std::size_t m_cells = 0;                                         ///< of the body
	std::uint32_t m_count = 0, m_outerCount = 0, m_normalGroups = 0; ///< vertices, those of the outer surface first
	std::uint32_t m_outerTriangles = 0;
	std::vector<Row> m_row;                 ///< by vertex
	std::vector<std::uint32_t> m_vertex;    ///< of the patches at hand; kNone: spared
	std::vector<std::uint32_t> m_local;     ///< of the patches at hand: their vertices' numbers in the body
	std::vector<SharedRow> m_sharedRow;     ///< while the inside is numbered by itself
	std::unique_ptr<CrackGatherer> m_inner; ///< numbers the inside meanwhile
	std::vector<Vec3> m_area;               ///< by group of normals, where points are shaded anew: of the outer surface
	/// Of the outer surface: vertices within whole panels; SkinBinding::shading, if any are. Room for all and one, not written before.
	std::unique_ptr<std::uint32_t[]> m_placed;
	std::unique_ptr<std::array<std::uint32_t, 3>[]> m_shading;
	std::size_t m_placedCount = 0, m_shadingCount = 0, m_outerCapacity = 0, m_shadingCapacity = 0;
	std::vector<std::array<std::uint32_t, 3>> m_panelTriangle; ///< what panels that are one are drawn as
	std::vector<std::uint32_t> m_panelSource, m_around;        ///< of each of those; a panel's border, as far as it is drawn
};

} // namespace pliant
