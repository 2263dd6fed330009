#pragma once

// Panels: triangles of the input that are cut into pieces by cells. As long as no crack separates a panel, its cuts lie in its plane, so
// their positions are interpolated from its corners, and it contributes to normals as one triangle. Where panels meet only each other, they
// are drawn as the input's triangles. Not in Ohta et al. 2009.
//
// So the surface away from cracks looks as it does uncracked, and costs little more.

#include "lattice/table.h"
#include "pliant/mesh.h"
#include "pliant/result.h"

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

namespace pliant {

class CellComplex;

/// Immutable, part of the complex. Panels are ordered by their first pieces.
struct Panels
{
	static constexpr std::uint32_t kNone = 0xffffffffu;

	std::vector<std::array<std::uint32_t, 3>> corner; ///< by panel: vertices of the input, in the input's order
	std::vector<std::uint32_t> source;                ///< by panel: the input's triangle
	std::vector<std::uint32_t> ofPiece;               ///< by CellComplex::triangle; kNone: part of no panel
	std::vector<std::uint32_t> firstOfCell; ///< by cell, and one past the last: the first of the panels whose first piece it draws
	Table points;                           ///< by panel: points of its corners and cuts
	Table atPoint;                          ///< the inverse table
	std::vector<std::uint8_t> isPlaceable;  ///< by point: only panels draw the outer surface there, and it is no corner
	std::vector<std::uint8_t> isPlane;      ///< by panel: all its cuts are placeable, and it has a border
	/// By panel: vertices of the complex along its border in its orientation, starting at its first corner. Empty where its pieces have no
	/// simple border; isPlane is then false.
	Table border;
	std::vector<std::uint8_t> isSpared; ///< by point: all panels there are planes
	std::vector<std::uint8_t> isPlain;  ///< by panel: a plane whose cuts are all spared

	std::size_t count() const { return corner.size(); }
};

/// Finds the triangles that are cut by cells and small enough. Needs the complex's tables of points and pieces.
Panels findPanels( const MeshView& mesh, const CellComplex& complex );

/// Triangulates a panel between the drawn vertices of its border: `around` in its orientation, with its corners at `cornerAt`, the first
/// corner first. Makes one triangle more than there are vertices besides corners; none is flat where the vertices between two corners are
/// collinear.
void drawPanel( const std::vector<std::uint32_t>& around, const std::array<std::size_t, 3>& cornerAt,
	std::vector<std::array<std::uint32_t, 3>>& triangles );
/// The same for a panel's border. `numberAt`: index of the vertex drawn at an entry of Panels::border, or kNone. `around`: scratch.
template <class NumberAt>
void drawPanel( const Panels& panels, std::uint32_t panel, NumberAt&& numberAt, std::vector<std::uint32_t>& around,
	std::vector<std::array<std::uint32_t, 3>>& triangles )
{
	std::array<std::size_t, 3> cornerAt{};
	around.clear();
	for ( std::uint32_t entry = panels.border.start[panel]; entry < panels.border.start[panel + 1]; ++entry )
	{
		for ( std::size_t k = 0; k < 3; ++k )
		{
			cornerAt[k] = panels.corner[panel][k] == panels.border.entry[entry] ? around.size() : cornerAt[k];
		}
		if ( const std::uint32_t number = numberAt( entry ); number != Panels::kNone )
		{
			around.push_back( number );
		}
	}
	drawPanel( around, cornerAt, triangles );
}

/// Which panels are still intact while cracks open. They never become intact again.
class IntactPanels
{
public:
	explicit IntactPanels( const Panels& panels );

	/// More than one side of a crack meets at a point. Appends the points whose shading changes, some of them twice.
	void separate( std::uint32_t point, std::vector<std::uint32_t>& reshaded );
	/// A cut by a blade moves a point. Otherwise the same.
	void touch( std::uint32_t point, std::vector<std::uint32_t>& reshaded );
	/// A broken face contains a point, which must then be drawn, even if nothing is separated there.
	void uncover( std::uint32_t point );

	/// True where at least one point is placed; otherwise no panel is one triangle.
	bool arePlaced() const { return m_placed > 0; }
	/// True for a point interpolated from the corners of its panels, all of which are intact.
	bool isPlaced( std::uint32_t point ) const { return arePlaced() && m_isPlaced[point] != 0; }
	/// True for a panel that contributes to normals as one triangle: all its cuts are placed.
	bool isOne( std::uint32_t panel ) const { return arePlaced() && m_isOne[panel] != 0; }
	/// The same for the panel that a triangle of the complex belongs to.
	bool isOfOne( std::uint32_t piece ) const
	{
		return arePlaced() && m_panels->ofPiece[piece] != Panels::kNone && m_isOne[m_panels->ofPiece[piece]] != 0;
	}

	/// True for a placed point that nothing draws where panels are drawn as one: all panels there are one triangle, and no broken face
	/// contains it.
	bool isSpared( std::uint32_t point ) const { return arePlaced() && m_isSpared[point] != 0; }
	/// True for a panel drawn as the input's triangle: it is one triangle, and all its cuts are spared.
	bool isPlain( std::uint32_t panel ) const { return arePlaced() && m_isPlain[panel] != 0; }

	/// Checks the flags against the points at which more than one side meets and those that broken faces contain.
	Status validate( const std::function<bool( std::uint32_t )>& isSeparated, const std::function<bool( std::uint32_t )>& isPassed ) const;

private:
	Status validateSpared( const std::function<bool( std::uint32_t )>& isPassed ) const;

	const Panels* m_panels;
	std::vector<std::uint8_t> m_isIntact, m_isOne, m_isPlain; ///< by panel
	std::vector<std::uint8_t> m_isPlaced, m_isSpared;         ///< by point
	std::vector<std::uint8_t> m_isTouched;                    ///< by point; empty: no blade has moved a point
	std::size_t m_placed = 0;
};

} // namespace pliant
