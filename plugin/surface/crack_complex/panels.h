#pragma once

// Panels: triangles of the input that cells cut into pieces. What cuts a panel lies in its plane for as long as no crack parts it, so that
// such points are placed from its corners, and it adds to normals as the one triangle it is. Where they meet nothing but each other, panels
// are drawn as the input has them. Beyond Ohta et al. 2009, "Fracturing".
//
// The surface around is then what it was before the first crack, and costs little more.

#include "pliant/mesh.h"
#include "pliant/result.h"
#include "surface/crack_shapes/table.h"

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

namespace pliant {

class CellComplex;

/// Immutable, part of the complex. Panels are numbered as their first pieces are.
struct Panels
{
	static constexpr std::uint32_t kNone = 0xffffffffu;

	std::vector<std::array<std::uint32_t, 3>> corner; ///< by panel: vertices of the input, turned as there
	std::vector<std::uint32_t> source;                ///< by panel: the input's triangle
	std::vector<std::uint32_t> ofPiece;               ///< by CellComplex::triangle; kNone: it is of none
	std::vector<std::uint32_t> firstOfCell;           ///< by cell, and one past the last: of the panels whose first piece it draws
	Table points;                                     ///< by panel: where its corners and cuts are
	Table atPoint;                                    ///< the other way round
	std::vector<std::uint8_t> isPlaceable; ///< by point: all that is drawn of the outer surface there is of panels, and no corner
	std::vector<std::uint8_t> isPlane;     ///< by panel: where it is cut it is placed, as long as it is whole
	/// By panel: vertices of the complex round it, as it is turned, its first corner first. Empty where its pieces have no such border; it
	/// is no plane then.
	Table border;
	std::vector<std::uint8_t> isSpared; ///< by point: all panels there are planes
	std::vector<std::uint8_t> isPlain;  ///< by panel: a plane whose cuts are all spared

	std::size_t count() const { return corner.size(); }
};

/// All that cells cut and that are small enough. The complex's tables of points and pieces are to be there.
Panels findPanels( const MeshView& mesh, const CellComplex& complex );

/// A panel as triangles between those of its border's vertices that are drawn: `around`, as it is turned, its corners at `cornerAt`, the
/// first one first. One triangle more than there are vertices besides corners. None of them is flat where vertices between corners lie in a
/// straight line.
void drawPanel( const std::vector<std::uint32_t>& around, const std::array<std::size_t, 3>& cornerAt,
	std::vector<std::array<std::uint32_t, 3>>& triangles );
/// The same by its border. `numberAt`: what is drawn there, of an entry of Panels::border; kNone: nothing. `around`: room.
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

/// Which of them are whole, as cracks open. They never become whole again.
class WholePanels
{
public:
	explicit WholePanels( const Panels& panels );

	/// More than one side of a crack meets at a point. Appends points that are shaded in another way now, some of them twice.
	void part( std::uint32_t point, std::vector<std::uint32_t>& anew );
	/// A blade has come by, which moves points: the same.
	void touch( std::uint32_t point, std::vector<std::uint32_t>& anew );
	/// A broken face passes at a point: it is drawn, whether or not anything is parted there.
	void uncover( std::uint32_t point );

	/// Whether any point is placed at all; if not, no panel is one.
	bool arePlaced() const { return m_placed > 0; }
	/// Placed from the corners of the panels it lies in, all of which are whole.
	bool isPlaced( std::uint32_t point ) const { return arePlaced() && m_isPlaced[point] != 0; }
	/// Whether a panel adds to normals as one triangle: all where it is cut is placed.
	bool isOne( std::uint32_t panel ) const { return arePlaced() && m_isOne[panel] != 0; }
	/// The same of the panel that a triangle of the complex is a piece of.
	bool isOfOne( std::uint32_t piece ) const
	{
		return arePlaced() && m_panels->ofPiece[piece] != Panels::kNone && m_isOne[m_panels->ofPiece[piece]] != 0;
	}

	/// Placed, and drawn by nothing, where panels that are one are drawn as one: all panels there are, and no broken face passes.
	bool isSpared( std::uint32_t point ) const { return arePlaced() && m_isSpared[point] != 0; }
	/// One, and all where it is cut is spared: it is drawn as the input has it.
	bool isPlain( std::uint32_t panel ) const { return arePlaced() && m_isPlain[panel] != 0; }

	std::size_t bytes() const
	{
		return m_isWhole.size() + m_isOne.size() + m_isPlaced.size() + m_isTouched.size() + m_isSpared.size() + m_isPlain.size();
	}

	/// Whether all is as it follows from the points at which more than one side meets, and from those at which broken faces pass.
	Status validate( const std::function<bool( std::uint32_t )>& isParted, const std::function<bool( std::uint32_t )>& isPassed ) const;

private:
	Status validateSpared( const std::function<bool( std::uint32_t )>& isPassed ) const;

	const Panels* m_panels;
	std::vector<std::uint8_t> m_isWhole, m_isOne, m_isPlain; ///< by panel
	std::vector<std::uint8_t> m_isPlaced, m_isSpared;        ///< by point
	std::vector<std::uint8_t> m_isTouched;                   ///< by point; empty: no blade has come by
	std::size_t m_placed = 0;
};

} // namespace pliant
