#pragma once

// The drawn surface of a body that has cracks. Ohta et al. 2009, "Fracturing"; cut surfaces: Steinemann et al. 2008, section 7.
//
// Its triangles are the pieces of the outer surface that its cells have, and both sides of every broken face. A point of the complex is
// drawn once for each side: the cells that meet there fall into groups that standing faces join, and each group has copies of its own.
// Where a crack ends all cells are one group: the sides stay joined. Breaking only ever splits groups, so that vertices are added, never
// moved.

#include "lattice/pieces.h"
#include "surface/crack_complex/cell_complex.h"
#include "surface/skin/skinning.h"

#include <array>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

namespace pliant {

class BladePath;
struct CrackView;

/// Where an ascending list holds `wanted`; CellComplex::kNone: nowhere.
std::uint32_t numberIn( const std::vector<std::uint32_t>& list, std::uint32_t wanted );

class CrackSurface
{
public:
	static constexpr std::uint32_t kNone = CellComplex::kNone;
	/// Kinds of copies of a point: vertices of the complex, or kInside + 2 x axis + side for a face.
	static constexpr std::uint32_t kInside = 0xfffffff0u;
	static Vec3 insideNormal( std::uint32_t kind )
	{
		return ( ( kind & 1u ) != 0 ? -1.0f : 1.0f ) * Vec3::Unit( int( ( kind - kInside ) / 2 ) );
	}

	/// A body of all cells of a template, faces without a link broken. Vertex i of the input is vertex i.
	explicit CrackSurface( std::shared_ptr<const CellComplex> complex );
	/// A body of some of them, ascending. `isBroken`: by face of the complex; faces to other cells count as broken. `shift`: the body's
	/// mass centre seen from the template's, m; rest places are relative to it.
	CrackSurface( std::shared_ptr<const CellComplex> complex, std::vector<std::uint32_t> cells, const std::vector<std::uint8_t>& isBroken,
		const Vec3& shift );

	/// The same, broken where `body`, the body's own lattice, has no link any more (its cell k is cells[k]).
	CrackSurface( std::shared_ptr<const CellComplex> complex, std::vector<std::uint32_t> cells, const Lattice& body, const Vec3& shift );

	/// A piece of this body: its own vertices and triangles, the cracks as they are. Cells by the template's numbers, ascending.
	CrackSurface piece( std::vector<std::uint32_t> cells, const Vec3& shift = Vec3::Zero() ) const;

	/// Numbers of the complex; those broken before or not of this body are passed over. Appends vertices and triangles, and redirects those
	/// of cells along the crack.
	void breakFaces( const std::vector<std::uint32_t>& faces );
	/// The faces between cells whose links broke, by the body's own numbers; pairs that no face joins are passed over.
	void breakLinks( const std::vector<CellLink>& links );

	/// Binds anew what the cracks since the last time cut off: once a picture is enough, before the binding is used.
	void settle();
	bool isSettled() const { return m_unsettled.empty(); }
	/// The slow twin of settle(): from cell to cell, for each side by itself.
	void bindPlainly() { m_bindsPlainly = true; }

	bool isBroken( std::uint32_t face ) const;

	/// Draws points of the complex (others than the body's are passed over) where a blade's path has them.
	void follow( const BladePath& path, const std::vector<std::uint32_t>& points );

	// === What is drawn ===

	/// How vertices follow the body's cells, numbered as in cells(), once settled. Weights sum to 1; entries that weigh nothing fill rows
	/// up.
	const SkinBinding& binding() const { return m_binding; }
	const std::vector<std::array<std::uint32_t, 3>>& triangles() const { return m_triangle; }
	/// By triangle: the input's, or kNone for the inside.
	const std::vector<std::uint32_t>& sources() const { return m_source; }
	/// By vertex: the input's vertex, or kNone for one that was added.
	std::uint32_t inputVertexOf( std::uint32_t vertex ) const;
	/// Vertices with one answer are at one place on one side, whatever their normals and texture coordinates: a point of the complex and
	/// which of its sides.
	std::pair<std::uint32_t, std::uint32_t> sideOf( std::uint32_t vertex ) const;
	/// u, v of the vertices from `first` on. Outside as in the input (0 where it has none); inside by place, once every
	/// CrackSettings::textureTile.
	void textureCoordinates( const float* input, std::uint32_t first, float* out ) const;
	/// The same of one copy of a point.
	static void textureOf( const CellComplex& complex, std::uint32_t point, std::uint32_t kind, const float* input, float* out );

	/// The same once settled, but panels that are one as the input has them, without what is drawn by nothing then. `texture`: u, v of all
	/// vertices.
	void showPanelsAsOne( const float* texture, CrackView& view ) const;

	/// SkinBinding::normalShift of a vertex that is to have `normal` where its triangles' areas sum to `area`.
	static Vec3 normalShift( const Vec3& normal, const Vec3& area );

	std::uint32_t vertexCount() const { return std::uint32_t( m_vertex.size() ); }
	/// The body's cells by the template's numbers, ascending.
	const std::vector<std::uint32_t>& cells() const { return m_cell; }
	const CellComplex& complex() const { return *m_complex; }

	/// Grows with every change.
	std::uint64_t topologyVersion() const { return m_version; }
	/// What the latest change touched: upload new vertices and triangles, triangles changed.first .. changed.last again.
	struct Change
	{
		std::uint32_t firstNewVertex = 0;
		std::uint32_t firstNewTriangle = 0;
		std::uint32_t firstChanged = 0; ///< of the triangles before; equal to lastChanged: none
		std::uint32_t lastChanged = 0;
	};
	const Change& latestChange() const { return m_change; }

	std::size_t bytes() const;

	/// Room for half of all faces, so that what breaks next need not move what is there.
	void reserveScratch();

private:
	friend Status validate( const CrackSurface& surface );
	friend class SharedCrackState;
	friend class CrackPatches;
	friend class CrackSides;

	/// A copy of a point.
	struct Vertex
	{
		std::uint32_t point; ///< local
		std::uint32_t kind;
		std::uint32_t next; ///< of the same side
		std::uint16_t group;
	};
	/// The copies of a point that one group of its cells has, once something is drawn with them.
	struct Side
	{
		std::uint32_t carrier;                                    ///< the copy that has the row
		std::uint32_t newest;                                     ///< copy
		std::uint32_t next;                                       ///< side of the same point
		std::uint32_t outerNormals = kNone, innerNormals = kNone; ///< SkinBinding::normalGroup of all copies that share one
		std::uint16_t group;
	};

	/// The copy of a point that the side at hand is drawn with, as far as it is of this round.
	struct SideVertex
	{
		std::uint32_t round = 0, vertex = kNone;
	};

	struct Tie
	{
		std::uint32_t face; ///< local
		std::uint16_t a, b; ///< slots of its cells, from the point's first
	};
	struct Face
	{
		std::uint32_t number;         ///< in the complex
		std::uint32_t cellA, cellB;   ///< local; kNone: of another body
		std::uint32_t firstA, firstB; ///< triangles of either side; kNone: not drawn
		bool isBroken;
	};

	void takeFaces( const std::vector<std::uint8_t>& isBroken );
	bool isHeld( std::uint32_t face ) const;
	void takePoints();
	void drawAll();

	std::uint32_t localCell( std::uint32_t cell ) const { return m_localCell.empty() ? numberIn( m_cell, cell ) : m_localCell[cell]; }
	std::uint32_t localPoint( std::uint32_t point ) const
	{
		return m_localPoint.empty() ? numberIn( m_point, point ) : m_localPoint[point];
	}
	std::uint32_t localFace( std::uint32_t face ) const;
	/// A local point's place at rest, relative to the template's mass centre.
	const Vec3& restOf( std::uint32_t point ) const
	{
		return m_position.empty() ? m_complex->pointRest[m_point[point]] : m_position[point];
	}

	bool regroup( std::uint32_t point );
	std::uint16_t groupOf( std::uint32_t point, std::uint32_t cell ) const;
	std::uint32_t vertexFor( std::uint32_t point, std::uint32_t kind, std::uint16_t group );
	std::uint32_t sideAt( std::uint32_t point, std::uint16_t group ) const;
	std::uint32_t addVertex( std::uint32_t point, std::uint32_t kind, std::uint16_t group, std::uint32_t side );
	void addRow( std::uint32_t point );
	std::uint32_t normalGroupFor( Side& side, bool isInside );
	void drawSide( Face& face, bool isA );
	void matchNormals();
	void matchNormals( std::vector<std::uint32_t>& points );
	void addAreas( std::uint32_t cell );
	void addArea( const std::array<std::uint32_t, 3>& corner );
	void shadeLikeTheMesh( std::uint32_t vertex, const Vec3& area );

	void part( std::uint32_t point, bool isByBlade = false );
	void placeWhatIsWhole();
	SkinBinding::Placed placedFrom( const CellComplex::Origin& origin, std::uint32_t vertex ) const;
	std::vector<std::uint32_t> wholePanels() const;
	void addPanelsAt( std::uint32_t point, std::vector<std::uint32_t>& panels ) const;
	bool isPlaced( const Vertex& vertex ) const { return vertex.kind < kInside && m_panels.isPlaced( m_point[vertex.point] ); }
	std::uint32_t carrierAt( std::uint32_t input ) const;
	/// Triangles of a cell's outer surface that are pieces by themselves: of no panel that is one.
	template <class Take>
	void forPiecesAlone( std::uint32_t cell, Take&& take ) const
	{
		const std::uint32_t known = m_complex->cellTriangleStart[m_cell[cell]] - m_cellTriangle[cell];
		for ( std::uint32_t t = m_cellTriangle[cell]; t < m_cellTriangle[cell + 1]; ++t )
		{
			m_panels.isOfOne( known + t ) ? void() : take( t );
		}
	}
	void listPlaced();
	void listShading();
	std::uint32_t vertexOf( std::uint32_t kind ) const;
	void drawAsOne( CrackView& view ) const;

	void addUnheld( std::vector<std::uint32_t>& fresh );
	void splitGroups( const std::vector<std::uint32_t>& fresh );
	void redirect( std::uint32_t cell );
	void redirectTriangles( std::uint32_t cell, std::uint32_t first, std::uint32_t last );
	void collect( std::uint32_t item, std::vector<std::uint32_t>& list );
	void clearMarks( const std::vector<std::uint32_t>& list );

	void rebind( std::uint32_t point );
	bool askCarriers( std::uint32_t point );
	std::uint64_t carriersBeside( std::uint32_t cell ) const;
	void forgetCarriers();
	void reachInWords( std::uint32_t point, const Side& side );
	void reach( std::uint32_t point, const Side& side );
	void writeRow( std::uint32_t point, const Side& side, std::uint32_t home );
	void shut( std::uint32_t face );

	Status validateTriangles() const;
	Status validateGroups() const;
	Status validateBinding() const;
	Status validatePanels() const;
	Status validatePlaced() const;
	Status validateShading() const;

	std::shared_ptr<const CellComplex> m_complex;
	Vec3 m_shift;
	std::vector<std::uint32_t> m_cell, m_point;                        ///< of the complex, ascending
	std::vector<Vec3> m_position;                                      ///< by point; empty: those of the complex
	std::vector<std::uint32_t> m_localCell, m_localPoint, m_localFace; ///< the other way round; empty for small pieces, which search
	std::vector<Face> m_face;                                          ///< ascending
	std::vector<std::uint32_t> m_cellFaceStart, m_cellFace;            ///< local faces by local cell
	std::vector<std::uint32_t> m_neighbour;    ///< by entry of m_cellFace: the cell beyond while the face stands, or the number of cells
	std::vector<std::uint32_t> m_cellTriangle; ///< by local cell, and one past the last: its pieces of the outer surface

	std::vector<std::uint32_t> m_slotStart, m_slotCell; ///< cells of each point, local
	std::vector<std::uint16_t> m_slotGroup, m_groups;   ///< by slot; how many, by point
	std::vector<std::uint32_t> m_tieStart;
	std::vector<Tie> m_tie;

	std::vector<Vertex> m_vertex;
	std::vector<Side> m_side;
	std::vector<std::uint32_t> m_firstSide; ///< by point
	std::vector<std::array<std::uint32_t, 3>> m_triangle;
	std::vector<std::uint32_t> m_source;
	SkinBinding m_binding;
	std::vector<std::uint32_t> m_unsettled; ///< faces that broke since, local
	std::vector<std::uint32_t> m_split;     ///< points that have more groups since, or panels around that are parted, local; some twice
	IntactPanels m_panels;                  ///< of the template; those that none of the cells draws are not asked for
	std::vector<std::array<std::uint32_t, 3>> m_panelCorner; ///< by panel that was one when all was drawn: vertices
	std::uint64_t m_version = 1, m_listedVersion = 0;        ///< since when it is, and when it was listed what is placed
	Change m_change;

	// Room kept between calls.
	std::vector<SideVertex> m_sideVertex; ///< by point
	std::uint32_t m_sideRound = 0;
	std::vector<std::uint32_t> m_mark, m_open; ///< by local cell, and one for none; local cells
	std::uint32_t m_round = 0;
	std::vector<std::uint32_t> m_asked, m_reached; ///< cells; entries of those
	std::vector<std::uint64_t> m_bitOf;            ///< by local cell, and one for none: which of those asked it is, else 0
	std::vector<std::uint64_t> m_beside;           ///< by cell asked
	bool m_bindsPlainly = false;
	std::vector<std::uint16_t> m_root;    ///< by slot of the point at hand
	std::vector<std::uint8_t> m_isMarked; ///< by point or cell
	std::vector<std::uint32_t> m_strange; ///< points that cells of other bodies carried
	std::vector<std::uint32_t> m_parted;  ///< of the template
	std::vector<Vec3> m_area;             ///< by group of normals
};

/// Every invariant: copies belong to groups, groups to standing faces, rows of the binding to the vertex's own side.
Status validate( const CrackSurface& surface );

} // namespace pliant
