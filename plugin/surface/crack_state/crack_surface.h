#pragma once

// The drawn surface of a cracked body. Ohta et al. 2009, "Fracturing"; cut surfaces: Steinemann et al. 2008, section 7.
//
// Its triangles are its cells' pieces of the outer surface and both sides of every broken face. A point of the complex is drawn once for
// each side: the cells that meet there form groups connected by unbroken faces, and each group has its own copies. Where a crack ends there
// is one group, and the sides stay joined. Breaking only splits groups, so vertices are added, never moved.

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

/// Index of `wanted` in an ascending list, or CellComplex::kNone.
std::uint32_t numberIn( const std::vector<std::uint32_t>& list, std::uint32_t wanted );

class CrackSurface
{
public:
	static constexpr std::uint32_t kNone = CellComplex::kNone;
	/// Kinds of copies of a point: a vertex of the complex, or kInside + 2 x axis + side for a face.
	static constexpr std::uint32_t kInside = 0xfffffff0u;
	static Vec3 insideNormal( std::uint32_t kind )
	{
		return ( ( kind & 1u ) != 0 ? -1.0f : 1.0f ) * Vec3::Unit( int( ( kind - kInside ) / 2 ) );
	}

	/// A body of all cells of a template, without broken faces. Vertex i of the input is vertex i.
	explicit CrackSurface( std::shared_ptr<const CellComplex> complex );
	/// A body of some of the cells, ascending. `isBroken`: by face of the complex; faces to other cells count as broken. `shift`: the
	/// body's mass centre relative to the template's, m; rest positions are relative to it.
	CrackSurface( std::shared_ptr<const CellComplex> complex, std::vector<std::uint32_t> cells, const std::vector<std::uint8_t>& isBroken,
		const Vec3& shift );

	/// The same with the links that `body`, the body's own lattice, lacks as broken faces (its cell k is cells[k]).
	CrackSurface( std::shared_ptr<const CellComplex> complex, std::vector<std::uint32_t> cells, const Lattice& body, const Vec3& shift );

	/// Breaks faces of the complex; ignores those already broken or not of this body. Appends vertices and triangles, and redirects
	/// triangles of cells along the crack.
	void breakFaces( const std::vector<std::uint32_t>& faces );

	/// Updates the binding for all cracks since the last call. Required before the binding is used.
	void updateBinding();
	bool isBindingCurrent() const { return m_newlyBroken.empty(); }

	bool isBroken( std::uint32_t face ) const;

	/// Moves points of the complex (ignores those of other bodies) to their positions on a blade's path.
	void follow( const BladePath& path, const std::vector<std::uint32_t>& points );

	// === The drawn surface ===

	/// How vertices follow the body's cells, which are numbered as in cells(). Valid after updateBinding(). Weights sum to 1; unused
	/// entries of a row have weight 0.
	const SkinBinding& binding() const { return m_binding; }
	const std::vector<std::array<std::uint32_t, 3>>& triangles() const { return m_triangle; }
	/// By triangle: the input's triangle, or kNone for the inside.
	const std::vector<std::uint32_t>& sources() const { return m_source; }
	/// A vertex of the complex; kInside and above for a vertex of a crack face.
	std::uint32_t kindOf( std::uint32_t vertex ) const { return m_vertex[vertex].kind; }
	/// A point of the complex and one of its sides. Vertices of equal result coincide, although their normals and texture coordinates may
	/// differ.
	std::pair<std::uint32_t, std::uint32_t> sideOf( std::uint32_t vertex ) const;
	/// Writes u, v of the vertices from `first` on. Outside as in the input (0 where it has none); inside by position, with period
	/// CrackSettings::textureTile.
	void textureCoordinates( const float* input, std::uint32_t first, float* out ) const;
	/// The same for one copy of a point.
	static void textureOf( const CellComplex& complex, std::uint32_t point, std::uint32_t kind, const float* input, float* out );

	/// Writes the drawn surface with intact panels as the input's triangles, without the vertices that become unused. Needs
	/// updateBinding(). `texture`: u, v of all vertices.
	void showPanelsAsOne( const float* texture, CrackView& view ) const;

	/// SkinBinding::normalShift of a vertex with the normal `normal` whose triangles' areas sum to `area`.
	static Vec3 normalShift( const Vec3& normal, const Vec3& area );

	std::uint32_t vertexCount() const { return std::uint32_t( m_vertex.size() ); }
	/// The body's cells as indices of the template, ascending.
	const std::vector<std::uint32_t>& cells() const { return m_cell; }
	const CellComplex& complex() const { return *m_complex; }

	/// Increases with every change.
	std::uint64_t topologyVersion() const { return m_version; }
	/// Result of the latest change: new vertices and triangles, and the triangles firstChanged .. lastChanged - 1.
	struct Change
	{
		std::uint32_t firstNewVertex = 0;
		std::uint32_t firstNewTriangle = 0;
		std::uint32_t firstChanged = 0; ///< among the earlier triangles; equal to lastChanged: none
		std::uint32_t lastChanged = 0;
	};
	const Change& latestChange() const { return m_change; }

	/// Reserves memory for half of all faces, so that later breaks need no reallocation.
	void reserveScratch();

private:
	friend Status validate( const CrackSurface& surface );
	friend class SharedCrackState;
	friend class CrackPatches;
	friend class CrackSides;

	struct Vertex
	{
		std::uint32_t point; ///< local index
		std::uint32_t kind;
		std::uint32_t next; ///< next copy of the same side
		std::uint16_t group;
	};
	/// The copies of a point that belong to one group of its cells; created when something is drawn with them.
	struct Side
	{
		std::uint32_t carrier;                                    ///< the copy that has the row of weights
		std::uint32_t newest;                                     ///< latest copy
		std::uint32_t next;                                       ///< next side of the same point
		std::uint32_t outerNormals = kNone, innerNormals = kNone; ///< SkinBinding::normalGroup shared by the outer and the inner copies
		std::uint16_t group;
	};

	/// The copy of a point used by the side being drawn, valid in the given round.
	struct SideVertex
	{
		std::uint32_t round = 0, vertex = kNone;
	};

	struct Tie
	{
		std::uint32_t face; ///< local index
		std::uint16_t a, b; ///< slots of its cells, counted from the point's first
	};
	struct Face
	{
		std::uint32_t number;         ///< index in the complex
		std::uint32_t cellA, cellB;   ///< local indices; kNone: of another body
		std::uint32_t firstA, firstB; ///< first triangles of the two sides; kNone: not drawn
		bool isBroken;
	};

	void selectFaces( const std::vector<std::uint8_t>& isBroken );
	bool isHeld( std::uint32_t face ) const;
	void selectPoints();
	void drawAll();

	std::uint32_t localCell( std::uint32_t cell ) const { return m_localCell.empty() ? numberIn( m_cell, cell ) : m_localCell[cell]; }
	std::uint32_t localPoint( std::uint32_t point ) const
	{
		return m_localPoint.empty() ? numberIn( m_point, point ) : m_localPoint[point];
	}
	std::uint32_t localFace( std::uint32_t face ) const;
	/// Rest position of a local point relative to the template's mass centre.
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
	void shadeAsMesh( std::uint32_t vertex, const Vec3& area );

	void separate( std::uint32_t point, bool isByBlade = false );
	void placeIntactPanels();
	SkinBinding::Placed placedFrom( const CellComplex::Origin& origin, std::uint32_t vertex ) const;
	std::vector<std::uint32_t> intactPanels() const;
	void addPanelsAt( std::uint32_t point, std::vector<std::uint32_t>& panels ) const;
	bool isPlaced( const Vertex& vertex ) const { return vertex.kind < kInside && m_panels.isPlaced( m_point[vertex.point] ); }
	std::uint32_t carrierAt( std::uint32_t input ) const;
	/// Calls take for each triangle of a cell's outer surface that is in no panel shaded as one.
	template <class Take>
	void forSeparatePieces( std::uint32_t cell, Take&& take ) const
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
	void drawIntactPanels( CrackView& view ) const;

	void addUnheld( std::vector<std::uint32_t>& added );
	void splitGroups( const std::vector<std::uint32_t>& added );
	void redirect( std::uint32_t cell );
	void redirectTriangles( std::uint32_t cell, std::uint32_t first, std::uint32_t last );
	void collect( std::uint32_t item, std::vector<std::uint32_t>& list );
	void clearMarks( const std::vector<std::uint32_t>& list );

	void rebind( std::uint32_t point );
	void reach( std::uint32_t point, const Side& side );
	void writeRow( std::uint32_t point, const Side& side, std::uint32_t firstCell );
	void markBroken( std::uint32_t face );

	Status validateTriangles() const;
	Status validateGroups() const;
	Status validateBinding() const;
	Status validatePanels() const;
	Status validatePlaced() const;
	Status validateShading() const;

	std::shared_ptr<const CellComplex> m_complex;
	Vec3 m_shift;
	std::vector<std::uint32_t> m_cell, m_point;                        ///< indices in the complex, ascending
	std::vector<Vec3> m_position;                                      ///< by point; empty: as in the complex
	std::vector<std::uint32_t> m_localCell, m_localPoint, m_localFace; ///< the inverse tables; empty for small pieces, which search instead
	std::vector<Face> m_face;                                          ///< ascending
	std::vector<std::uint32_t> m_cellFaceStart, m_cellFace;            ///< local faces by local cell
	std::vector<std::uint32_t> m_neighbour;    ///< by entry of m_cellFace: the cell behind an unbroken face, or the number of cells
	std::vector<std::uint32_t> m_cellTriangle; ///< by local cell, and one past the last: its pieces of the outer surface

	std::vector<std::uint32_t> m_slotStart, m_slotCell; ///< cells of each point, local
	std::vector<std::uint16_t> m_slotGroup, m_groups;   ///< group by slot; number of groups by point
	std::vector<std::uint32_t> m_tieStart;
	std::vector<Tie> m_tie;

	std::vector<Vertex> m_vertex;
	std::vector<Side> m_side;
	std::vector<std::uint32_t> m_firstSide; ///< by point
	std::vector<std::array<std::uint32_t, 3>> m_triangle;
	std::vector<std::uint32_t> m_source;
	SkinBinding m_binding;
	std::vector<std::uint32_t> m_newlyBroken;                ///< faces broken since the last updateBinding(), local
	std::vector<std::uint32_t> m_split;                      ///< local points with new groups or separated panels since then, some twice
	IntactPanels m_panels;                                   ///< of the template; panels that none of the cells draws are not used
	std::vector<std::array<std::uint32_t, 3>> m_panelCorner; ///< by panel that is intact when all is drawn: vertices
	std::uint64_t m_version = 1, m_listedVersion = 0; ///< version of the cracks, and version for which the placed vertices were listed
	Change m_change;

	// Scratch kept between calls.
	std::vector<SideVertex> m_sideVertex; ///< by point
	std::uint32_t m_sideRound = 0;
	std::vector<std::uint32_t> m_mark, m_frontier; ///< by local cell, and one for none; local cells
	std::uint32_t m_round = 0;
	std::vector<std::uint32_t> m_candidate, m_reached; ///< cells; indices into them
	std::vector<std::uint16_t> m_root;                 ///< by slot of the current point
	std::vector<std::uint8_t> m_isMarked;              ///< by point or cell
	std::vector<std::uint32_t> m_foreign;              ///< points with carriers in other bodies
	std::vector<std::uint32_t> m_reshaded;             ///< of the template
	std::vector<Vec3> m_area;                          ///< by group of normals
};

/// Checks all invariants: copies belong to groups, groups to unbroken faces, rows of the binding to the vertex's own side.
Status validate( const CrackSurface& surface );

} // namespace pliant
