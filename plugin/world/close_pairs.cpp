#include "world/close_pairs.h"

#include <algorithm>
#include <cmath>

namespace pliant {

namespace {

/// Spheres up to this much larger than the smallest of a grid go into it: those of cells that are not full, and not the next level's.
constexpr float kOneSize = 1.9f;

/// No more cells than this many a sphere: a body that is long and thin, or has flown apart, gets larger ones.
constexpr double kMostCells = 8.0;

/// Cells of a grid along each axis.
Vec3 countOf( const Vec3& low, const Vec3& high, float edge )
{
	const Vec3 span = ( high - low ) / edge;
	return Vec3( std::floor( span.x() ), std::floor( span.y() ), std::floor( span.z() ) ) + Vec3::Ones();
}

} // namespace

Eigen::Vector3i ClosePairs::Grid::cellAt( const Vec3& place ) const
{
	const Vec3 at = ( place - low ) / edge;
	const auto along = [this, &at]( int axis ) { return int( std::clamp( std::floor( at[axis] ), -1.0f, float( count[axis] ) ) ); };
	return Eigen::Vector3i( along( 0 ), along( 1 ), along( 2 ) );
}

void ClosePairs::find( std::vector<Sphere>& spheres, float slop, float margin, std::vector<std::uint64_t>& pairs )
{
	m_slop = slop;
	m_margin = margin;
	m_grid.clear();
	std::sort( spheres.begin(), spheres.end(), []( const Sphere& a, const Sphere& b ) { return a.radius != b.radius ? a.radius < b.radius : a.number < b.number; } );
	for ( std::size_t first = 0; first < spheres.size(); )
	{
		std::size_t last = first;
		while ( last < spheres.size() && spheres[last].radius <= kOneSize * spheres[first].radius )
		{
			++last;
		}
		makeGrid( spheres, first, last, slop, margin );
		first = last;
	}
	for ( const Grid& own : m_grid )
	{
		for ( std::size_t k = own.first; k < own.last; ++k )
		{
			for ( const Grid& grid : m_grid )
			{
				if ( grid.first <= own.first )
				{
					ask( spheres, k, grid, pairs );
				}
			}
		}
	}
}

/// Puts the spheres into the order of their cells.
void ClosePairs::makeGrid( std::vector<Sphere>& spheres, std::size_t first, std::size_t last, float slop, float margin )
{
	Grid grid;
	grid.first = first;
	grid.last = last;
	grid.largest = spheres[last - 1].radius;
	grid.low = spheres[first].place;
	Vec3 high = grid.low;
	for ( std::size_t k = first; k < last; ++k )
	{
		grid.low = grid.low.cwiseMin( spheres[k].place );
		high = high.cwiseMax( spheres[k].place );
	}
	grid.edge = 2.0f * grid.largest * ( 1.0f + slop ) + margin;
	Vec3 cells = countOf( grid.low, high, grid.edge );
	while ( double( cells.x() ) * double( cells.y() ) * double( cells.z() ) > kMostCells * double( last - first ) )
	{
		grid.edge *= 2.0f;
		cells = countOf( grid.low, high, grid.edge );
	}
	grid.count = cells.cast<int>();
	grid.start.assign( std::size_t( grid.count.prod() ) + 1, 0 );
	m_cell.clear();
	for ( std::size_t k = first; k < last; ++k )
	{
		const Eigen::Vector3i at = grid.cellAt( spheres[k].place );
		m_cell.push_back( std::uint32_t( ( at.z() * grid.count.y() + at.y() ) * grid.count.x() + at.x() ) );
		++grid.start[m_cell.back() + 1];
	}
	for ( std::size_t c = 0; c + 1 < grid.start.size(); ++c )
	{
		grid.start[c + 1] += grid.start[c];
	}
	m_next.assign( grid.start.begin(), grid.start.end() - 1 );
	m_sorted.resize( last - first );
	for ( std::size_t k = first; k < last; ++k )
	{
		m_sorted[m_next[m_cell[k - first]]++] = spheres[k];
	}
	std::copy( m_sorted.begin(), m_sorted.end(), spheres.begin() + std::ptrdiff_t( first ) );
	m_grid.push_back( std::move( grid ) );
}

/// Cells side by side along x lie one after the other: a row of them is one stretch of spheres. Of its own grid a sphere asks those behind it alone.
void ClosePairs::ask( const std::vector<Sphere>& spheres, std::size_t k, const Grid& grid, std::vector<std::uint64_t>& pairs ) const
{
	const Sphere one = spheres[k];
	const bool isOwn = grid.first <= k && k < grid.last;
	const Vec3 reach = Vec3::Constant( ( one.radius + grid.largest ) * ( 1.0f + m_slop ) + m_margin );
	const Eigen::Vector3i least = grid.cellAt( one.place - reach ).cwiseMax( 0 ), most = grid.cellAt( one.place + reach ).cwiseMin( grid.count - Eigen::Vector3i::Ones() );
	for ( int z = least.z(); z <= most.z(); ++z )
	{
		for ( int y = least.y(); y <= most.y() && least.x() <= most.x(); ++y )
		{
			const std::size_t row = std::size_t( ( z * grid.count.y() + y ) * grid.count.x() );
			std::size_t i = grid.first + grid.start[row + std::size_t( least.x() )];
			const std::size_t end = grid.first + grid.start[row + std::size_t( most.x() ) + 1];
			for ( i = isOwn ? std::max( i, k + 1 ) : i; i < end; ++i )
			{
				const Sphere& other = spheres[i];
				const float far = ( one.radius + other.radius ) * ( 1.0f + m_slop ) + m_margin;
				if ( ( one.place - other.place ).squaredNorm() <= far * far )
				{
					pairs.push_back( std::uint64_t( std::min( one.number, other.number ) ) << 32 | std::max( one.number, other.number ) );
				}
			}
		}
	}
}

} // namespace pliant
