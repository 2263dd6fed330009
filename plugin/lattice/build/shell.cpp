// Finds the surface that no cell of the inside covers, measures it in those positions, then links its cells.

#include "lattice/build/shell.h"

#include "lattice/build/shell_links.h"
#include "lattice/build/surface_points.h"
#include "lattice/constants.h"

#include <algorithm>
#include <cmath>

namespace pliant {

namespace {

using Keys = std::vector<std::uint64_t>;

void sortOnce( Keys& keys )
{
	std::sort( keys.begin(), keys.end() );
	keys.erase( std::unique( keys.begin(), keys.end() ), keys.end() );
}

std::uint64_t keyOf( const Grid& grid, const Eigen::Vector3i& at )
{
	return grid.key( at.x(), at.y(), at.z() );
}

template <class F>
void forNeighbours( const Grid& grid, std::uint64_t key, F&& visit )
{
	const Eigen::Vector3i at = grid.at( key );
	for ( int code = 0; code < 27; ++code )
	{
		const Eigen::Vector3i to = at + Eigen::Vector3i( code % 3 - 1, code / 3 % 3 - 1, code / 9 - 1 );
		if ( code != 13 && grid.holds( to ) )
		{
			visit( keyOf( grid, to ) );
		}
	}
}

Keys keysOf( const std::vector<CellDraft>& cells )
{
	Keys keys;
	keys.reserve( cells.size() );
	for ( const CellDraft& cell : cells )
	{
		keys.push_back( cell.key );
	}
	return keys;
}

/// Collects keys that often repeat in sequence.
class KeySet
{
public:
	void add( std::uint64_t key )
	{
		if ( m_keys.empty() || m_keys.back() != key )
		{
			m_keys.push_back( key );
			if ( m_keys.size() >= m_next )
			{
				sortOnce( m_keys );
				m_next = std::max( kLeastSortedKeys, 2 * m_keys.size() );
			}
		}
	}

	Keys take()
	{
		sortOnce( m_keys );
		return std::move( m_keys );
	}

	std::size_t size() const { return m_keys.size(); }

private:
	Keys m_keys;
	std::size_t m_next = kLeastSortedKeys;
};

/// Determines which points of the surface are covered by the inside's cells.
class Cover
{
public:
	Cover( const Grid& grid, const std::vector<CellDraft>& cells, const Keys& keys ) :
		m_grid( grid ), m_cells( cells ), m_keys( keys ), m_index( grid, keys )
	{
		m_reach.reserve( cells.size() );
		for ( const CellDraft& cell : cells )
		{
			const double reach = kShellReach + 0.5 * std::cbrt( double( cell.fill ) ); // collision radius: world/shape/node_colliders.h
			m_reach.push_back( reach * reach );
		}
	}

	/// True where the point is in a position without a cell and not just across the border of one with a cell, where the inside's own
	/// surface protrudes.
	bool isBeyond( std::uint64_t key, const Vec3d& point ) const
	{
		bool isOut = !hasCell( key );
		forNeighbours( m_grid, key, [&]( std::uint64_t to ) {
			if ( isOut && hasCell( to ) )
			{
				const Vec3d fromMiddle = ( point - m_grid.at( to ).cast<double>() - Vec3d::Constant( 0.5 ) ).cwiseAbs();
				isOut = fromMiddle.maxCoeff() > 0.5 + kShellOverhang;
			}
		} );
		return isOut;
	}

	bool holds( std::uint64_t key, const Vec3d& point ) const
	{
		bool isHeld = isNear( key, point );
		if ( !isHeld )
		{
			forNeighbours( m_grid, key, [&]( std::uint64_t to ) { isHeld = isHeld || isNear( to, point ); } );
		}
		return isHeld;
	}

private:
	bool hasCell( std::uint64_t key ) const { return m_index.find( key ) != PositionIndex::kNone; }

	bool isNear( std::uint64_t key, const Vec3d& point ) const
	{
		const std::int32_t first = m_index.find( key );
		for ( std::size_t i = std::size_t( first ); first >= 0 && i < m_keys.size() && m_keys[i] == key; ++i )
		{
			if ( ( m_cells[i].centre - point ).squaredNorm() <= m_reach[i] )
			{
				return true;
			}
		}
		return false;
	}

	const Grid& m_grid;
	const std::vector<CellDraft>& m_cells;
	const Keys& m_keys;
	PositionIndex m_index;
	std::vector<double> m_reach; ///< squared, cells
};

/// Estimates the number of positions that the surface passes through from few points; too high by a bounded factor at most. Where the
/// points fall into fewer positions than a quarter of their number, the surface is folded repeatedly into the same ones.
double positionsPassed( const WeldedMesh& mesh, const Grid& grid, double area )
{
	if ( double( mesh.triangle.size() + mesh.leftOut.size() ) > kMaxSurveyPoints )
	{
		return area; // each triangle has at least one point
	}
	KeySet passed;
	double points = 0.0;
	visitSurface( mesh, grid, std::min( 1.0, std::sqrt( kMaxSurveyPoints / area ) ), [&]( const Vec3d& point, double ) {
		passed.add( keyOf( grid, positionOfPoint( grid, point ) ) );
		points += 1.0;
	} );
	const double count = double( passed.take().size() );
	return kFoldedFraction * points > count ? count / kFoldedFraction : std::max( count, area );
}

/// Points per cell edge: dense enough that no part of the surface is missed. A surface folded many times into its cells passes through all
/// of them anyway and is sampled more coarsely.
double densityOf( const ShellOptions& options, double positions )
{
	constexpr double kDensity = kAreaDensity * kShellSamples;
	const double maxPoints = std::max( kShellPoints, kDensity * kDensity * std::min( { options.area, options.maxCells, positions } ) );
	return kDensity * std::min( 1.0, std::sqrt( maxPoints / ( kDensity * kDensity * options.area ) ) );
}

/// Returns the positions that need a cell of the shell.
Keys findNeeded( const WeldedMesh& mesh, const Grid& grid, double density, const std::vector<CellDraft>& cells, const Keys& keys )
{
	KeySet needed, passed;
	if ( cells.empty() )
	{
		visitSurface(
			mesh, grid, density, [&]( const Vec3d& point, double ) { needed.add( keyOf( grid, positionOfPoint( grid, point ) ) ); } );
		return needed.take();
	}
	const Cover cover( grid, cells, keys );
	visitSurface( mesh, grid, density, [&]( const Vec3d& point, double ) {
		const std::uint64_t key = keyOf( grid, positionOfPoint( grid, point ) );
		if ( !cover.holds( key, point ) )
		{
			needed.add( key );
		}
	} );
	Keys out = needed.take();
	if ( out.empty() )
	{
		return out;
	}
	// Positions between these and the inside may be covered by its outermost cells. They need cells too, otherwise the shell would be
	// disconnected from the inside.
	visitSurface( mesh, grid, density, [&]( const Vec3d& point, double ) {
		const std::uint64_t key = keyOf( grid, positionOfPoint( grid, point ) );
		if ( cover.isBeyond( key, point ) )
		{
			passed.add( key );
		}
	} );
	const Keys surface = passed.take();
	Keys between;
	for ( const std::uint64_t key : out )
	{
		forNeighbours( grid, key, [&]( std::uint64_t to ) {
			if ( std::binary_search( surface.begin(), surface.end(), to ) )
			{
				between.push_back( to );
			}
		} );
	}
	out.insert( out.end(), between.begin(), between.end() );
	sortOnce( out );
	return out;
}

/// Measures the surface in the needed positions, and in adjacent positions with cells of the inside.
std::vector<SurfacePatch> measure( const WeldedMesh& mesh, const Grid& grid, double density, const Keys& needed, const Keys& inside )
{
	Keys keys = needed;
	for ( const std::uint64_t key : needed )
	{
		forNeighbours( grid, key, [&]( std::uint64_t to ) {
			if ( std::binary_search( inside.begin(), inside.end(), to ) )
			{
				keys.push_back( to );
			}
		} );
	}
	sortOnce( keys );
	std::vector<SurfacePatch> patches( keys.size() );
	for ( std::size_t k = 0; k < keys.size(); ++k )
	{
		patches[k].key = keys[k];
		patches[k].isShell = std::binary_search( needed.begin(), needed.end(), keys[k] );
	}
	const PositionIndex index( grid, keys );
	visitSurface( mesh, grid, density, [&]( const Vec3d& point, double area ) {
		const Eigen::Vector3i at = positionOfPoint( grid, point );
		const std::int32_t found = index.find( keyOf( grid, at ) );
		if ( found == PositionIndex::kNone )
		{
			return;
		}
		SurfacePatch& patch = patches[std::size_t( found )];
		const Vec3d within = ( kShellSamples * ( point - at.cast<double>() ) ).cwiseMax( 0.0 ).cwiseMin( kShellSamples - 1.0 );
		const Eigen::Vector3i part = within.cast<int>();
		patch.passed |= std::uint64_t( 1 ) << ( ( part.z() * kShellSamples + part.y() ) * kShellSamples + part.x() );
		patch.area += area;
		patch.moment += area * point;
		patch.low = patch.low.cwiseMin( point );
		patch.high = patch.high.cwiseMax( point );
	} );
	return patches;
}

CellDraft makeCell( const Grid& grid, const SurfacePatch& patch, const ShellOptions& options )
{
	// Points outside the grid are rounding errors.
	const Vec3d low = grid.at( patch.key ).cast<double>(), high = low + Vec3d::Ones();
	const Vec3d middle = 0.5 * ( patch.low + patch.high );
	Vec3d centre = patch.area > 0.0 ? Vec3d( patch.moment / patch.area ) : middle;
	// If the surface is concentrated at one end of the position, the cell's centre is the centre of its box, which is near all of it.
	const Vec3d farthest = ( patch.high - centre ).cwiseMax( centre - patch.low );
	if ( farthest.squaredNorm() > kShellReach * kShellReach )
	{
		centre = middle;
	}
	const double fill = options.hasKnownInside ? 0.0 : std::min( 1.0, patch.area * options.thickness );
	return { patch.key, Parts::kNone, float( std::max( fill, kMinShellFill ) ), centre.cwiseMax( low ).cwiseMin( high ) };
}

} // namespace

int addShell( const WeldedMesh& mesh, const Grid& grid, const ShellOptions& options, std::vector<CellDraft>& cells, Lattice& lattice )
{
	const Keys inside = keysOf( cells );
	const double positions = positionsPassed( mesh, grid, options.area );
	if ( cells.empty() && positions > kMaxOvercount * options.maxCells )
	{
		return -1;
	}
	const double density = densityOf( options, positions );
	const Keys needed = findNeeded( mesh, grid, density, cells, inside );
	if ( double( needed.size() + cells.size() ) > options.maxCells )
	{
		return -1;
	}
	if ( needed.empty() )
	{
		return 0;
	}
	const std::vector<SurfacePatch> patches = measure( mesh, grid, density, needed, inside );
	std::vector<CellDraft> shell;
	for ( const SurfacePatch& patch : patches )
	{
		if ( patch.isShell )
		{
			shell.push_back( makeCell( grid, patch, options ) );
		}
	}
	mergeShell( grid, patches, shell, cells, lattice );
	return int( shell.size() );
}

} // namespace pliant
