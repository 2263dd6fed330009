#pragma once

// Cut faces that lie on the path of the blade. Steinemann et al. 2008, section 7.
//
// The drawable faces of a cut are faces between cells, which form stairs. A point of the complex near a cut is moved onto the surface shown
// by the cut's traces: always if it lies between the two sides; if it belongs to one side, only where it lies beyond the surface. Both
// sides share the point, so faces stay closed, equal and opposite: the treads of the stairs become the cut, the risers shrink to nothing.
// Points of the outer surface slide along it, points of its creases along the crease. The triangles themselves are not cut: each body would
// need a complex of its own, and each cut robust geometry.

#include "fracture/cut_links.h"
#include "surface/crack_complex/cell_complex.h"

#include <memory>
#include <vector>

namespace pliant {

class BladePath
{
public:
	explicit BladePath( std::shared_ptr<const CellComplex> complex );

	/// Adds traces, with cells and rest positions of the template. Returns the points near them, ascending; their positions may have
	/// changed.
	std::vector<std::uint32_t> add( const std::vector<CutTrace>& traces );

	bool isEmpty() const { return m_trace.empty(); }
	/// Where a point is drawn, relative to the template's mass centre, m. Depends only on the traces and their order.
	Vec3 positionOf( std::uint32_t point ) const;

private:
	struct Near
	{
		std::uint32_t trace;
		float weight;
		float side;     ///< distance of the point from the trace's plane, m, positive on the side of the point's own cell
		bool isBetween; ///< both of the trace's cells meet at the point
	};

	std::vector<Near> nearTo( std::uint32_t point, const Vec3& at ) const;
	Vec3 moved( std::uint32_t point, const Vec3& at, std::vector<Near>& near ) const;
	Vec3 exitDisplacement( std::uint32_t point, const Vec3& normal ) const;

	std::shared_ptr<const CellComplex> m_complex;
	std::vector<CutTrace> m_trace;
	std::vector<std::uint32_t> m_start; ///< by cell: the entry of its latest trace, or kNone
	std::vector<std::array<std::uint32_t, 2>>
		m_next; ///< by trace: the previous entry of each of its cells; an entry is 2 x trace + index of the cell
	/// By point: area-weighted mean of n n^T over the outer surface's triangles there: xx, yy, zz, yz, xz, xy; zero inside.
	std::vector<std::array<float, 6>> m_outward;
};

} // namespace pliant
