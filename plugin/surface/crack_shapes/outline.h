#pragma once

// Flat outlines with holes, from unordered edges to triangles. For any input the border of the triangles is the outline: where the outline
// overlaps itself the triangles are badly shaped, but a closed surface stays closed.

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

namespace pliant {

using Vec2d = Eigen::Vector2d;
using OutlineEdge = std::pair<std::uint32_t, std::uint32_t>; ///< from, to

/// Loops of points; no loop contains a point twice. Counter-clockwise around material.
struct Loops
{
	std::vector<std::uint32_t> start{ 0 };
	std::vector<std::uint32_t> point;

	std::size_t count() const { return start.size() - 1; }
	std::size_t size( std::size_t loop ) const { return start[loop + 1] - start[loop]; }
	void clear();
	void close() { start.push_back( std::uint32_t( point.size() ) ); }
};

/// Cancels opposite edges and joins the rest to loops. Returns false where more edges enter some point than leave it: the edges are then no
/// outline, and `out` has the loops that could be found. Sorts the edges.
bool traceLoops( std::vector<OutlineEdge>& edges, Loops& out );

/// One outer loop and the holes in it.
struct OutlinePart
{
	std::uint32_t outer;
	std::vector<std::uint32_t> holes;
};

/// `at`: by entry of loops.point.
std::vector<OutlinePart> groupLoops( const Loops& loops, const std::vector<Vec2d>& at );

/// True where an edge between two entries of loops.point should be avoided.
using EdgeTest = std::function<bool( std::uint32_t, std::uint32_t )>;

/// Triangulates by ear clipping, best-shaped ears first. Appends triangles of entries of loops.point.
void triangulate( const Loops& loops, const std::vector<Vec2d>& at, const OutlinePart& part, std::vector<std::array<std::uint32_t, 3>>& out,
	const EdgeTest& isUnwanted = {} );

/// Twice the area of a triangle, positive when counter-clockwise.
inline double doubleArea( const Vec2d& a, const Vec2d& b, const Vec2d& c )
{
	return ( b.x() - a.x() ) * ( c.y() - a.y() ) - ( b.y() - a.y() ) * ( c.x() - a.x() );
}

double loopArea( const Loops& loops, const std::vector<Vec2d>& at, std::size_t loop );

} // namespace pliant
