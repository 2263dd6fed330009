#include "world/self/close_pairs.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pliant {

namespace {

/// Ratio of radii within one size class: partly filled cells share a grid with full ones, which spans at most two levels of an octree.
constexpr float kSizeRatio = 2.6f;

/// Largest number of cells per sphere: a long thin or scattered body gets larger cells.
constexpr double kMostCells = 8.0;

/// Spheres tested at once; and the coordinate of padding, m: far from all spheres, with a finite square.
constexpr std::size_t kWide = 8;
constexpr float kFarAway = 1e18f;

/// Slack of a cell's box in searches of other grids, as a fraction of its edge: more than the rounding error of positions.
constexpr float kBoxSlack = 1e-3f;

constexpr std::uint32_t kNoOwner = std::numeric_limits<std::uint32_t>::max();

/// Number of cells of a grid along each axis.
Vec3 countOf( const Vec3& low, const Vec3& high, float edge )
{
	const Vec3 span = ( high - low ) / edge;
	return Vec3( std::floor( span.x() ), std::floor( span.y() ), std::floor( span.z() ) ) + Vec3::Ones();
}

} // namespace

void ClosePairs::SphereList::resize( std::size_t count )
{
	for ( std::vector<float>* const each : { &x, &y, &z, &radius } )
	{
		each->resize( count );
	}
	number.resize( count );
}

void ClosePairs::SphereList::set( std::size_t at, const Sphere& sphere )
{
	x[at] = sphere.position.x();
	y[at] = sphere.position.y();
	z[at] = sphere.position.z();
	radius[at] = sphere.radius;
	number[at] = sphere.number;
}

void ClosePairs::SphereList::copy( const SphereList& from, std::size_t first, std::size_t last, std::size_t to )
{
	for ( std::size_t i = first; i < last; ++i, ++to )
	{
		x[to] = from.x[i];
		y[to] = from.y[i];
		z[to] = from.z[i];
		radius[to] = from.radius[i];
		number[to] = from.number[i];
	}
}

Eigen::Vector3i ClosePairs::Grid::cellAt( const Vec3& position ) const
{
	const Vec3 at = ( position - low ) * perMetre;
	// One is added before the fraction is truncated, since truncation rounds towards zero.
	const auto along = [this, &at]( int axis ) { return int( std::clamp( at[axis] + 1.0f, 0.0f, float( count[axis] + 1 ) ) ) - 1; };
	return Eigen::Vector3i( along( 0 ), along( 1 ), along( 2 ) );
}

void ClosePairs::begin( std::size_t count, float slop, float margin, const Held* held )
{
	m_slop = slop;
	m_margin = margin;
	m_owner.assign( held ? held->start.size() - 1 : 0, kNoOwner );
	m_gathered.resize( count + kWide );
	m_near.resize( count + kWide );
}

void ClosePairs::findOf( const std::vector<Sphere>& spheres, const std::vector<std::uint8_t>& isSelected, float slop, float margin,
	const Held* held, std::vector<std::uint64_t>& pairs )
{
	begin( spheres.size(), slop, margin, held );
	m_grid.clear();
	m_gatheredCount = spheres.size();
	for ( std::size_t i = 0; i < spheres.size(); ++i )
	{
		m_gathered.set( i, spheres[i] );
	}
	std::fill_n( m_gathered.x.begin() + std::ptrdiff_t( m_gatheredCount ), kWide, kFarAway );
	for ( const Sphere& sphere : spheres )
	{
		if ( isSelected[sphere.number] == 0 )
		{
			continue;
		}
		findNear( sphere.position, sphere.radius, 0 );
		std::size_t kept = 0;
		for ( std::size_t k = 0; k < m_nearCount; ++k )
		{
			const std::uint32_t other = m_near[k];
			m_near[kept] = other;
			kept += other != sphere.number && ( isSelected[other] == 0 || other > sphere.number )
				? 1
				: 0; // of two selected spheres the lower one has found the pair
		}
		m_nearCount = kept;
		appendFree( sphere.number, held, pairs );
	}
}

void ClosePairs::find( const std::vector<Sphere>& spheres, float slop, float margin, const Held* held, std::vector<std::uint64_t>& pairs )
{
	if ( spheres.empty() )
	{
		return;
	}
	begin( spheres.size(), slop, margin, held );
	m_sorted.resize( spheres.size() );
	m_grid.clear();
	m_start.clear();
	sortSizes( spheres );
	for ( const std::vector<std::uint32_t>& which : m_ofSize )
	{
		if ( !which.empty() )
		{
			makeGrid( spheres, which );
		}
	}
	for ( const Grid& grid : m_grid )
	{
		Eigen::Vector3i cell;
		for ( cell.z() = 0; cell.z() < grid.count.z(); ++cell.z() )
		{
			for ( cell.y() = 0; cell.y() < grid.count.y(); ++cell.y() )
			{
				for ( cell.x() = 0; cell.x() < grid.count.x(); ++cell.x() )
				{
					searchCell( grid, cell, held, pairs );
				}
			}
		}
	}
}

void ClosePairs::sortSizes( const std::vector<Sphere>& spheres )
{
	const auto isSmaller = []( const Sphere& a, const Sphere& b ) { return a.radius < b.radius; };
	const auto [smallest, largest] = std::minmax_element( spheres.begin(), spheres.end(), isSmaller );
	m_size.clear();
	for ( float most = smallest->radius; m_size.empty() || m_size.back() < largest->radius; )
	{
		most *= kSizeRatio;
		m_size.push_back( most );
	}
	m_ofSize.resize( std::max( m_ofSize.size(), m_size.size() ) );
	for ( std::vector<std::uint32_t>& each : m_ofSize )
	{
		each.clear();
	}
	for ( std::size_t i = 0; i < spheres.size(); ++i )
	{
		std::size_t size = 0;
		while ( m_size[size] < spheres[i].radius )
		{
			++size;
		}
		m_ofSize[size].push_back( std::uint32_t( i ) );
	}
}

/// Sorts the spheres of one size into the order of their cells.
void ClosePairs::makeGrid( const std::vector<Sphere>& spheres, const std::vector<std::uint32_t>& which )
{
	Grid grid;
	grid.first = m_grid.empty() ? 0 : m_grid.back().last;
	grid.last = grid.first + which.size();
	grid.largest = 0.0f;
	grid.low = spheres[which[0]].position;
	Vec3 high = grid.low;
	for ( const std::uint32_t i : which )
	{
		grid.largest = std::max( grid.largest, spheres[i].radius );
		grid.low = grid.low.cwiseMin( spheres[i].position );
		high = high.cwiseMax( spheres[i].position );
	}
	grid.edge = 2.0f * grid.largest * ( 1.0f + m_slop ) + m_margin;
	Vec3 cells = countOf( grid.low, high, grid.edge );
	while ( double( cells.x() ) * double( cells.y() ) * double( cells.z() ) > kMostCells * double( which.size() ) )
	{
		grid.edge *= 2.0f;
		cells = countOf( grid.low, high, grid.edge );
	}
	grid.perMetre = 1.0f / grid.edge;
	grid.count = cells.cast<int>();
	grid.cells = m_start.size();
	const int count = grid.count.prod();
	m_start.resize( grid.cells + std::size_t( count ) + 1, 0 );
	std::uint32_t* const start = m_start.data() + grid.cells;
	m_cell.clear();
	for ( const std::uint32_t i : which )
	{
		const Eigen::Vector3i at = grid.cellAt( spheres[i].position ).cwiseMin( grid.count - Eigen::Vector3i::Ones() );
		m_cell.push_back( std::uint32_t( ( at.z() * grid.count.y() + at.y() ) * grid.count.x() + at.x() ) );
		++start[m_cell.back() + 1];
	}
	start[0] = std::uint32_t( grid.first );
	for ( int c = 0; c < count; ++c )
	{
		start[c + 1] += start[c];
	}
	m_next.assign( start, start + count );
	for ( std::size_t k = 0; k < which.size(); ++k )
	{
		m_sorted.set( m_next[m_cell[k]]++, spheres[which[k]] );
	}
	m_grid.push_back( grid );
}

/// In its own grid a cell pairs only with spheres after it.
void ClosePairs::searchCell( const Grid& own, const Eigen::Vector3i& cell, const Held* held, std::vector<std::uint64_t>& pairs )
{
	const std::uint32_t* const at = m_start.data() + own.cells + ( cell.z() * own.count.y() + cell.y() ) * own.count.x() + cell.x();
	const std::size_t first = at[0], last = at[1];
	if ( first == last )
	{
		return;
	}
	const Vec3 low = own.low + own.edge * cell.cast<float>();
	for ( const Grid& grid : m_grid )
	{
		const bool isOwn = &grid == &own;
		if ( grid.first > own.first )
		{
			break;
		}
		const float reach = ( own.largest + grid.largest ) * ( 1.0f + m_slop ) + m_margin + kBoxSlack * own.edge;
		gatherCells( grid, isOwn ? Eigen::Vector3i( cell - Eigen::Vector3i::Ones() ) : grid.cellAt( low - Vec3::Constant( reach ) ),
			isOwn ? Eigen::Vector3i( cell + Eigen::Vector3i::Ones() ) : grid.cellAt( low + Vec3::Constant( own.edge + reach ) ),
			isOwn ? first : grid.first );
		for ( std::size_t k = first; k < last && m_gatheredCount > 0; ++k )
		{
			findNear( Vec3( m_sorted.x[k], m_sorted.y[k], m_sorted.z[k] ), m_sorted.radius[k], isOwn ? k - first + 1 : 0 );
			appendFree( m_sorted.number[k], held, pairs );
		}
	}
}

/// Cells adjacent along x are contiguous: a row of them is one range of spheres. Omits spheres before `from`.
void ClosePairs::gatherCells( const Grid& grid, const Eigen::Vector3i& least, const Eigen::Vector3i& most, std::size_t from )
{
	m_gatheredCount = 0;
	const Eigen::Vector3i low = least.cwiseMax( 0 ), high = most.cwiseMin( grid.count - Eigen::Vector3i::Ones() );
	for ( int z = low.z(); z <= high.z() && low.x() <= high.x(); ++z )
	{
		for ( int y = low.y(); y <= high.y(); ++y )
		{
			const std::uint32_t* const row = m_start.data() + grid.cells + ( z * grid.count.y() + y ) * grid.count.x();
			const std::size_t first = std::max( from, std::size_t( row[low.x()] ) ), last = row[high.x() + 1];
			if ( first < last )
			{
				m_gathered.copy( m_sorted, first, last, m_gatheredCount );
				m_gatheredCount += last - first;
			}
		}
	}
	std::fill_n( m_gathered.x.begin() + std::ptrdiff_t( m_gatheredCount ), kWide, kFarAway );
}

/// Collects in m_near the gathered spheres, from the `from`-th on, with   | x_i - x |^2 <= ( ( r_i + r ) ( 1 + slop ) + margin )^2
void ClosePairs::findNear( const Vec3& position, float radius, std::size_t from )
{
	using Lanes = Eigen::Array<float, int( kWide ), 1>;
	const auto lanes = []( const std::vector<float>& of, std::size_t at ) { return Eigen::Map<const Lanes>( of.data() + at ); };
	const bool isRare = m_grid.empty(); // without a grid all spheres are tested: most groups of eight have no hit, which is predicted well
	std::size_t count = 0;
	std::uint32_t* const near = m_near.data();
	for ( std::size_t i = from; i < m_gatheredCount; i += kWide )
	{
		const Lanes dx = lanes( m_gathered.x, i ) - position.x(), dy = lanes( m_gathered.y, i ) - position.y(),
					dz = lanes( m_gathered.z, i ) - position.z();
		const Lanes far = ( lanes( m_gathered.radius, i ) + radius ) * ( 1.0f + m_slop ) + m_margin;
		const Lanes excess = dx * dx + dy * dy + dz * dz - far * far;
		if ( isRare && excess.minCoeff() > 0.0f )
		{
			continue;
		}
		for ( std::size_t lane = 0; lane < kWide; ++lane )
		{
			near[count] = m_gathered.number[i + lane];
			count += excess[std::ptrdiff_t( lane )] <= 0.0f ? 1 : 0;
		}
	}
	m_nearCount = count;
}

/// Appends the spheres near `a` that are linked neither to it nor to a common third. Links are symmetric, so that a third is in both rows.
void ClosePairs::appendFree( std::uint32_t a, const Held* held, std::vector<std::uint64_t>& pairs )
{
	if ( held && m_nearCount > 0 )
	{
		std::for_each( held->to.begin() + held->start[a], held->to.begin() + held->start[a + 1],
			[this, a]( std::uint32_t other ) { m_owner[other] = a; } );
	}
	const auto isOwn = [this, a]( std::uint32_t other ) { return m_owner[other] == a; };
	for ( std::size_t k = 0; k < m_nearCount; ++k )
	{
		const std::uint32_t b = m_near[k];
		if ( !held || ( !isOwn( b ) && std::none_of( held->to.begin() + held->start[b], held->to.begin() + held->start[b + 1], isOwn ) ) )
		{
			pairs.push_back( std::uint64_t( std::min( a, b ) ) << 32 | std::max( a, b ) );
		}
	}
}

} // namespace pliant
