#pragma once

// Rows of samples and their crossings with the surface: exact in integers, so that a row crosses a closed surface equally often in both
// directions, also at edges and corners.

#include "lattice/inside/grid.h"
#include "lattice/inside/inside_field.h"

namespace pliant {

class TaskRunner;

/// One crossing. Rows along axis a are numbered by their samples u along axis a + 1 and v along axis a + 2 (mod 3).
struct Crossing
{
	std::uint64_t packed; ///< v, u, whether it is a cap, whether the winding number increases
	double at;            ///< quanta along the row

	static std::uint64_t packRow( int u, int v ) { return ( std::uint64_t( v ) << 26 ) | ( std::uint64_t( u ) << 2 ); }
	std::uint64_t row() const { return packed & ~std::uint64_t( 3 ); }
	int u() const { return int( ( packed >> 2 ) & 0xffffff ); }
	int v() const { return int( packed >> 26 ); }
	bool isCap() const { return ( packed & 2 ) != 0; }
	int jump() const { return ( packed & 1 ) != 0 ? 1 : -1; }
};

/// All crossings of the rows along one axis, by v, then u, then position. Slab k holds the rows of cell layer k along v's axis.
struct RowSet
{
	int axis = 0;
	std::vector<Crossing> crossing;
	std::vector<std::uint32_t> slabStart;

	int slabs() const { return int( slabStart.size() ) - 1; }
	/// The crossings of a row, [first, last).
	std::pair<const Crossing*, const Crossing*> row( int u, int v, int samples ) const;
};

/// The surface and its caps in a grid's integer coordinates.
class SnappedSurface
{
public:
	SnappedSurface( const WeldedMesh& mesh, const InsideField& field, const Grid& grid );

	const Grid& grid() const { return m_grid; }
	const InsideField& field() const { return m_field; }

	/// Approximate number of crossings of the rows of all axes.
	double expectedCrossings() const;

	RowSet makeRows( int axis, TaskRunner* runner ) const;

	/// Change of the count along rows at a crossing.
	int counted( const Crossing& c ) const { return m_field.isSoup() ? 0 : c.jump(); }

	/// A point on a row, in the mesh's coordinates.
	Vec3d pointOn( int axis, const Crossing& row, double at ) const;

private:
	using Point = std::array<std::int32_t, 3>;

	void cross( const Triangle& triangle, bool isCap, int axis, std::vector<Crossing>& out ) const;

	const WeldedMesh& m_mesh;
	const InsideField& m_field;
	Grid m_grid;
	std::vector<Point> m_point;
};

/// A segment of a row inside the material, in the mesh's coordinates along the row.
struct InsideRun
{
	int u;
	int v;
	double from;
	double to;
};

std::vector<InsideRun> insideRuns( const SnappedSurface& surface, const RowSet& rows );

} // namespace pliant
