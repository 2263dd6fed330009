// Crossings of axis-parallel rows with triangles. A row that meets an edge or a corner is displaced by an infinitesimal step, the same for
// every triangle (simulation of simplicity, Edelsbrunner and Mücke 1990), and all signs are those of exact integers.

#include "lattice/inside/rows.h"

#include "lattice/constants.h"
#include "lattice/guarded_tasks.h"

#include <algorithm>

namespace pliant {

namespace {

/// The position of a row, or of a corner projected along the row, in the two other axes.
struct Flat
{
	std::int64_t u;
	std::int64_t v;
};

int signOf( std::int64_t x )
{
	return x > 0 ? 1 : x < 0 ? -1 : 0;
}

/// The side of the line from `low` to `high` on which the row passes; 0 only for a line parallel to the row. sign of (high - low) x (row -
/// low), the row displaced by (e, e^2).
int sideOf( const Flat& low, const Flat& high, const Flat& row )
{
	const std::int64_t du = high.u - low.u;
	const std::int64_t dv = high.v - low.v;
	const std::int64_t cross = du * ( row.v - low.v ) - dv * ( row.u - low.u );
	return cross != 0 ? signOf( cross ) : dv != 0 ? -signOf( dv ) : signOf( du );
}

struct Span
{
	double low;
	double high;
};

/// The range in which a triangle meets the line v, widened by a quantum for rounding. The exact test follows.
Span spanAt( const std::array<Flat, 3>& corner, std::int64_t v )
{
	Span span{ 1e300, -1e300 };
	const auto add = [&span]( double u ) {
		span.low = std::min( span.low, u - 1.0 );
		span.high = std::max( span.high, u + 1.0 );
	};
	for ( std::size_t k = 0; k < 3; ++k )
	{
		const Flat& a = corner[k];
		const Flat& b = corner[( k + 1 ) % 3];
		if ( std::min( a.v, b.v ) > v || std::max( a.v, b.v ) < v )
		{
			continue;
		}
		if ( a.v == b.v )
		{
			add( double( a.u ) );
			add( double( b.u ) );
		}
		else
		{
			add( double( a.u ) + double( b.u - a.u ) * ( double( v - a.v ) / double( b.v - a.v ) ) );
		}
	}
	return span;
}

/// A triangle projected along a row, with corners by ascending vertex index so that its neighbours have the same edges.
struct View
{
	std::array<Flat, 3> corner;
	std::array<std::int64_t, 3> depth;
	int orientation;   ///< -1 when sorting the corners reversed the orientation
	double nu, nv, na; ///< normal

	/// +1 or -1: the row passes through, along or against the normal; 0: the row misses the triangle.
	int hit( const Flat& row ) const
	{
		const int ab = sideOf( corner[0], corner[1], row );
		const int bc = sideOf( corner[1], corner[2], row );
		const int ca = -sideOf( corner[0], corner[2], row );
		return ab == bc && bc == ca ? ab * orientation : 0;
	}

	double coordinateOn( const Flat& row ) const
	{
		// n . ( p - a ) = 0
		const double coordinate = double( depth[0] ) - ( nu * double( row.u - corner[0].u ) + nv * double( row.v - corner[0].v ) ) / na;
		const auto [low, high] = std::minmax( { depth[0], depth[1], depth[2] } );
		return std::clamp( coordinate, double( low ), double( high ) );
	}
};

} // namespace

std::pair<const Crossing*, const Crossing*> RowSet::row( int u, int v, int samples ) const
{
	const std::size_t slab = std::size_t( v / samples );
	const Crossing* begin = crossing.data() + slabStart[slab];
	const Crossing* end = crossing.data() + slabStart[slab + 1];
	const std::uint64_t wanted = Crossing::packRow( u, v );
	const Crossing* first = std::lower_bound( begin, end, wanted, []( const Crossing& c, std::uint64_t w ) { return c.row() < w; } );
	const Crossing* last = first;
	while ( last != end && last->row() == wanted )
	{
		++last;
	}
	return { first, last };
}

SnappedSurface::SnappedSurface( const WeldedMesh& mesh, const InsideField& field, const Grid& grid ) :
	m_mesh( mesh ), m_field( field ), m_grid( grid )
{
	const double perQuantum = 1.0 / grid.quantum();
	m_point.resize( mesh.position.size() );
	const double limit = double( std::int64_t( 1 ) << kCoordinateBits );
	for ( std::size_t i = 0; i < mesh.position.size(); ++i )
	{
		// Vertices that no triangle uses may lie anywhere; clamping makes them harmless.
		const Vec3d p = ( ( mesh.position[i] - grid.corner ) * perQuantum ).array().round().max( -limit ).min( limit );
		m_point[i] = { std::int32_t( p.x() ), std::int32_t( p.y() ), std::int32_t( p.z() ) };
	}
}

double SnappedSurface::expectedCrossings() const
{
	double projected = 0.0;
	for ( const std::vector<Triangle>* triangles : { &m_mesh.triangle, &m_field.caps() } )
	{
		for ( const Triangle& t : *triangles )
		{
			const Vec3d a = m_mesh.position[t[1]] - m_mesh.position[t[0]];
			const Vec3d b = m_mesh.position[t[2]] - m_mesh.position[t[0]];
			projected += 0.5 * a.cross( b ).cwiseAbs().sum();
		}
	}
	const double spacing = m_grid.cellSize / m_grid.samples;
	return projected / ( spacing * spacing );
}

Vec3d SnappedSurface::pointOn( int axis, const Crossing& row, double at ) const
{
	Vec3d p;
	p[axis] = at;
	p[( axis + 1 ) % 3] = m_grid.sampleAt( row.u() );
	p[( axis + 2 ) % 3] = m_grid.sampleAt( row.v() );
	return m_grid.corner + m_grid.quantum() * p;
}

void SnappedSurface::cross( const Triangle& triangle, bool isCap, int axis, std::vector<Crossing>& out ) const
{
	const std::size_t uAxis = std::size_t( axis + 1 ) % 3;
	const std::size_t vAxis = std::size_t( axis + 2 ) % 3;
	const auto [lowV, highV] = std::minmax( { m_point[triangle[0]][vAxis], m_point[triangle[1]][vAxis], m_point[triangle[2]][vAxis] } );
	const int firstV = m_grid.firstAbove( int( vAxis ), std::int64_t( lowV ) - 1 );
	const int lastV = m_grid.firstAbove( int( vAxis ), std::int64_t( highV ) );
	if ( firstV >= lastV ) // most triangles of a fine mesh
	{
		return;
	}
	Triangle sorted = triangle;
	View view;
	view.orientation = 1;
	for ( const auto& [a, b] : { std::pair{ 0, 1 }, std::pair{ 1, 2 }, std::pair{ 0, 1 } } )
	{
		if ( sorted[std::size_t( a )] > sorted[std::size_t( b )] )
		{
			std::swap( sorted[std::size_t( a )], sorted[std::size_t( b )] );
			view.orientation = -view.orientation;
		}
	}
	for ( std::size_t k = 0; k < 3; ++k )
	{
		const Point& p = m_point[sorted[k]];
		view.corner[k] = { p[uAxis], p[vAxis] };
		view.depth[k] = p[std::size_t( axis )];
	}
	const Eigen::Matrix<std::int64_t, 3, 1> e(
		view.corner[1].u - view.corner[0].u, view.corner[1].v - view.corner[0].v, view.depth[1] - view.depth[0] );
	const Eigen::Matrix<std::int64_t, 3, 1> f(
		view.corner[2].u - view.corner[0].u, view.corner[2].v - view.corner[0].v, view.depth[2] - view.depth[0] );
	view.nu = double( e.y() * f.z() - e.z() * f.y() );
	view.nv = double( e.z() * f.x() - e.x() * f.z() );
	view.na = double( e.x() * f.y() - e.y() * f.x() );
	for ( int v = firstV; v < lastV; ++v )
	{
		const std::int64_t rowV = m_grid.sampleAt( v );
		const Span span = spanAt( view.corner, rowV );
		const int lastU = m_grid.firstAbove( int( uAxis ), span.high );
		for ( int u = m_grid.firstAbove( int( uAxis ), span.low - 1.0 ); u < lastU; ++u )
		{
			const Flat row{ m_grid.sampleAt( u ), rowV };
			if ( const int hit = view.hit( row ); hit != 0 )
			{
				// Crossing along the outward normal leaves the material: the winding number decreases.
				const std::uint64_t flags = ( isCap ? 2u : 0u ) | ( hit < 0 ? 1u : 0u );
				out.push_back( { Crossing::packRow( u, v ) | flags, view.coordinateOn( row ) } );
			}
		}
	}
}

RowSet SnappedSurface::makeRows( int axis, TaskRunner* runner ) const
{
	const std::vector<Triangle>& caps = m_field.caps();
	const std::size_t triangles = m_mesh.triangle.size() + caps.size();
	const std::size_t tasks = std::min( kMaxTasks, triangles );
	std::vector<std::vector<Crossing>> found( tasks );
	auto crossSome = [&]( int task ) {
		const std::size_t last = triangles * std::size_t( task + 1 ) / tasks;
		for ( std::size_t t = triangles * std::size_t( task ) / tasks; t < last; ++t )
		{
			const bool isCap = t >= m_mesh.triangle.size();
			cross( isCap ? caps[t - m_mesh.triangle.size()] : m_mesh.triangle[t], isCap, axis, found[std::size_t( task )] );
		}
	};
	runGuarded( runner, int( tasks ), crossSome );

	RowSet rows;
	rows.axis = axis;
	rows.slabStart.assign( std::size_t( m_grid.extent[( axis + 2 ) % 3] ) + 1, 0 );
	for ( const auto& some : found )
	{
		for ( const Crossing& c : some )
		{
			++rows.slabStart[std::size_t( c.v() / m_grid.samples ) + 1];
		}
	}
	for ( std::size_t k = 1; k < rows.slabStart.size(); ++k )
	{
		rows.slabStart[k] += rows.slabStart[k - 1];
	}
	rows.crossing.resize( rows.slabStart.back() );
	std::vector<std::uint32_t> next( rows.slabStart.begin(), rows.slabStart.end() - 1 );
	for ( auto& some : found )
	{
		for ( const Crossing& c : some )
		{
			rows.crossing[next[std::size_t( c.v() / m_grid.samples )]++] = c;
		}
		std::vector<Crossing>().swap( some );
	}
	auto sortSlab = [&rows]( int slab ) {
		const auto begin = rows.crossing.begin();
		std::sort( begin + rows.slabStart[std::size_t( slab )], begin + rows.slabStart[std::size_t( slab ) + 1],
			[]( const Crossing& a, const Crossing& b ) {
				return a.row() != b.row() ? a.row() < b.row() : a.at != b.at ? a.at < b.at : a.packed < b.packed;
			} );
	};
	runGuarded( runner, rows.slabs(), sortSlab );
	return rows;
}

std::vector<InsideRun> insideRuns( const SnappedSurface& surface, const RowSet& rows )
{
	const Grid& grid = surface.grid();
	std::vector<InsideRun> runs;
	int count = 0;
	for ( std::size_t k = 0; k + 1 < rows.crossing.size(); ++k )
	{
		const Crossing& c = rows.crossing[k];
		const Crossing& next = rows.crossing[k + 1];
		count += surface.counted( c );
		if ( next.row() != c.row() )
		{
			count = 0;
		}
		else if ( next.at > c.at && surface.field().isInside( count, surface.pointOn( rows.axis, c, 0.5 * ( c.at + next.at ) ) ) )
		{
			const double low = grid.corner[rows.axis];
			runs.push_back( { c.u(), c.v(), low + grid.quantum() * c.at, low + grid.quantum() * next.at } );
		}
	}
	return runs;
}

} // namespace pliant
