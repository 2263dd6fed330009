#pragma once

// Cut faces that lie where the blade went. Steinemann et al. 2008, section 7.
//
// What can be drawn of a cut is the faces between cells: stairs. A point of the complex near a cut is moved onto the surface that the cut's
// traces show: a point between the two sides always, one of a single side where it lies beyond. Both sides have the one point, so that
// faces stay closed, equal and opposite: treads of the stairs become the cut, risers shrink to nothing. A point of the outer surface slides
// along it, one of its creases along the crease. Not done: cutting the triangles themselves anew (it would make the complex a body's own,
// and each cut a piece of geometry to be kept sound).

#include "fracture/cut_links.h"
#include "surface/crack_complex/cell_complex.h"

#include <memory>
#include <vector>

namespace pliant {

class BladePath
{
public:
	explicit BladePath( std::shared_ptr<const CellComplex> complex );

	/// Cells and rest places of the template. Returns the points near them, ascending: whose places may be others now.
	std::vector<std::uint32_t> add( const std::vector<CutTrace>& traces );

	bool isEmpty() const { return m_trace.empty(); }
	/// Where a point is drawn, relative to the template's mass centre, m. It depends on the traces and their order alone.
	Vec3 placeOf( std::uint32_t point ) const;

	std::size_t bytes() const;

private:
	struct Near
	{
		std::uint32_t trace;
		float weight;
		float side;     ///< the point's distance from the trace's plane, positive on the side of the point's own cell; m
		bool isBetween; ///< both of the trace's cells meet at the point
	};

	std::vector<Near> nearTo( std::uint32_t point, const Vec3& at ) const;
	Vec3 moved( std::uint32_t point, const Vec3& at, std::vector<Near>& near ) const;
	Vec3 exitDisplacement( std::uint32_t point, const Vec3& normal ) const;

	std::shared_ptr<const CellComplex> m_complex;
	std::vector<CutTrace> m_trace;
	std::vector<std::uint32_t> m_start;               ///< by cell: its latest trace's entry, or kNone
	std::vector<std::array<std::uint32_t, 2>> m_next; ///< by trace: the entry before it of either cell; an entry is 2 x trace + which cell
	/// By point: sum over the outer surface's triangles there of area n n^T over their whole area: xx, yy, zz, yz, xz, xy; zero inside.
	std::vector<std::array<float, 6>> m_outward;
};

} // namespace pliant
