#pragma once

// A body's share of the cracks of its family, as it is drawn. Ohta et al. 2009, "Fracturing".

#include "surface/crack_sides.h"
#include "surface/crack_surface.h"

namespace pliant {

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

/// Puts views together from the patches of a body's cells. It keeps the room it needs.
class CrackGatherer
{
public:
	/// What a body of these cells (ascending) shows. `shift`: its mass centre seen from the template's, m.
	void gather( const CrackSides& sides, const std::vector<std::uint32_t>& cells, const Vec3& shift, CrackView& view );

private:
	static constexpr std::uint32_t kNone = CrackSurface::kNone;

	/// A vertex of the body at hand.
	struct Made
	{
		std::uint32_t side, point, kind;
		std::uint32_t next;  ///< of the same side
		std::uint32_t carrier, normalGroup;
		float u, v;
	};
	/// What of a side the body at hand draws, if it is of this round.
	struct SideNow
	{
		std::uint32_t round = 0;
		std::uint32_t newest = kNone; ///< vertex
		std::uint32_t carrier = kNone;
		std::uint32_t outerNormals = kNone, innerNormals = kNone;
	};

	void takeCells( const std::vector<std::uint32_t>& cells, CrackView& view );
	void takePatch( std::uint32_t patch );
	std::uint32_t numberOf( const CrackPatches::Vertex& vertex, std::uint32_t side );
	std::uint32_t normalsOf( SideNow& side, bool isInside );
	void addAreas( std::uint32_t patch );
	void fill( const Vec3& shift, CrackView& view );
	void fetchAhead( std::size_t k ) const;
	void addRow( const Made& made );
	void fillNormals( CrackView& view ) const;

	const CrackSides* m_sides = nullptr;
	std::vector<std::uint32_t> m_cellNow; ///< by cell: its number in the body
	std::vector<SideNow> m_side;          ///< by a side's first slot
	std::uint32_t m_round = 0;
	std::vector<Made> m_made;
	std::uint32_t m_normalGroups = 0;
	std::vector<std::uint32_t> m_local;   ///< of the patch at hand: its vertices' numbers in the body
	std::vector<std::array<std::uint32_t, 3>> m_triangle;
	std::vector<std::uint32_t> m_node;
	std::vector<float> m_weight;
	std::vector<Vec3> m_area;             ///< by group of normals, where points are shaded anew: of the outer surface
};

} // namespace pliant
