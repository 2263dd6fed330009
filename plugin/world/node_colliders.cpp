#include "world/node_colliders.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pliant {

namespace {

/// Links from each cell to the nearest surface cell, counted up to `most`, at least 1; `most` + 1 beyond. What lies below the surface asks it, and not the
/// other way round: of a cut body most cells are surface.
std::vector<int> depthBelowSurface( const Lattice& lattice, int most )
{
	std::vector<int> depth( std::size_t( lattice.cellCount() ), most + 1 );
	std::vector<std::uint32_t> ring, next;
	for ( std::uint32_t i = 0; i < std::uint32_t( lattice.cellCount() ); ++i )
	{
		const auto first = lattice.linkTo.begin() + lattice.linkStart[i], last = lattice.linkTo.begin() + lattice.linkStart[i + 1];
		if ( lattice.isSurface[i] != 0 )
		{
			depth[i] = 0;
		}
		else if ( std::any_of( first, last, [&lattice]( std::uint32_t to ) { return lattice.isSurface[to] != 0; } ) )
		{
			depth[i] = 1;
			ring.push_back( i );
		}
	}
	for ( int layer = 2; layer <= most; ++layer )
	{
		next.clear();
		for ( const std::uint32_t i : ring )
		{
			for ( std::uint32_t k = lattice.linkStart[i]; k < lattice.linkStart[i + 1]; ++k )
			{
				const std::uint32_t j = lattice.linkTo[k];
				if ( depth[j] > layer )
				{
					depth[j] = layer;
					next.push_back( j );
				}
			}
		}
		ring.swap( next );
	}
	return depth;
}

/// Bit 2a: the face towards lower coordinates along axis a lies open; bit 2a + 1: the one towards higher.
unsigned openFaces( const Lattice& lattice, std::uint32_t cell )
{
	unsigned open = 63u;
	for ( std::uint32_t k = lattice.linkStart[cell]; k < lattice.linkStart[cell + 1]; ++k )
	{
		const Eigen::Vector3i step = lattice.coordinate[lattice.linkTo[k]].cast<int>() - lattice.coordinate[cell].cast<int>();
		for ( int axis = 0; axis < 3 && step.cwiseAbs().sum() == 1; ++axis )
		{
			open &= step[axis] < 0 ? ~( 1u << 2 * axis ) : step[axis] > 0 ? ~( 2u << 2 * axis ) : ~0u;
		}
	}
	return open;
}

/// What nodes of all levels ask of their cells, once for each that is asked for.
class CellReaches
{
public:
	explicit CellReaches( const Lattice& lattice ) : m_lattice( lattice ), m_radius( lattice.fill.size(), -1.0 ), m_open( lattice.fill.size(), kUnknown ) {}

	double radiusOf( std::uint32_t cell )
	{
		if ( m_radius[cell] < 0.0 )
		{
			const double fill = double( m_lattice.fill[cell] );
			m_radius[cell] = 0.5 * double( m_lattice.cellSize ) * ( fill == 1.0 ? 1.0 : std::cbrt( fill ) );
		}
		return m_radius[cell];
	}

	/// How far the cell's sphere reaches from `centre` through each of its open faces, m.
	void addTo( std::vector<double>& reaches, std::uint32_t cell, const Vec3& centre )
	{
		m_open[cell] = m_open[cell] == kUnknown ? std::uint8_t( openFaces( m_lattice, cell ) ) : m_open[cell];
		const Vec3d arm = ( m_lattice.restCentre[cell] - centre ).cast<double>();
		for ( int face = 0; face < 6; ++face )
		{
			if ( ( m_open[cell] >> face & 1u ) != 0 )
			{
				reaches.push_back( radiusOf( cell ) + ( face % 2 == 0 ? -arm[face / 2] : arm[face / 2] ) );
			}
		}
	}

private:
	static constexpr std::uint8_t kUnknown = 0xff;

	const Lattice& m_lattice;
	std::vector<double> m_radius;     ///< negative: not asked for
	std::vector<std::uint8_t> m_open; ///< openFaces, or kUnknown
};

/// The median of what its cells reach, or the ball of its volume.
float radiusOf( const Lattice& lattice, const Octree& octree, std::uint32_t node, CellReaches& cells, std::vector<double>& reaches )
{
	reaches.clear();
	double largestCell = 0.0;
	for ( std::uint32_t k = octree.cellStart[node]; k < octree.cellStart[node] + octree.cellCount[node]; ++k )
	{
		const std::uint32_t cell = octree.cells[k];
		largestCell = std::max( largestCell, cells.radiusOf( cell ) );
		if ( lattice.isSurface[cell] != 0 && octree.cellCount[node] > 1 )
		{
			cells.addTo( reaches, cell, octree.restCentre[node] );
		}
	}
	double radius = 0.5 * double( lattice.cellSize ) * std::cbrt( octree.mass[node] );
	if ( !reaches.empty() )
	{
		const auto middle = reaches.begin() + std::ptrdiff_t( ( reaches.size() - 1 ) / 2 );
		std::nth_element( reaches.begin(), middle, reaches.end() );
		radius = std::min( radius, std::max( *middle, largestCell ) );
	}
	return float( radius );
}

} // namespace

NodeColliders measureColliders( const Lattice& lattice, const Octree& octree, const NodeColliders* before, const std::vector<std::uint32_t>& nodeBefore )
{
	NodeColliders colliders;
	colliders.radius.reserve( std::size_t( octree.nodeCount() ) );
	colliders.collides.reserve( std::size_t( octree.nodeCount() ) );
	const std::vector<int> depth = depthBelowSurface( lattice, 1 << ( octree.levels - 1 ) );
	std::vector<int> nearest( std::size_t( octree.nodeCount() ), std::numeric_limits<int>::max() );
	std::copy( depth.begin(), depth.end(), nearest.begin() );
	std::vector<double> reaches;
	CellReaches cells( lattice );
	int level = 0;
	for ( std::uint32_t node = 0; node < std::uint32_t( octree.nodeCount() ); ++node ) // level by level: children stand before their parents
	{
		level += node == octree.levelStart[std::size_t( level ) + 1] ? 1 : 0;
		const std::uint32_t old = before ? nodeBefore[node] : kNoNode;
		colliders.radius.push_back( old == kNoNode ? radiusOf( lattice, octree, node, cells, reaches ) : before->radius[old] );
		colliders.collides.push_back( nearest[node] <= 1 << level );
		if ( const std::uint32_t parent = octree.parent[node]; parent != kNoNode )
		{
			nearest[parent] = std::min( nearest[parent], nearest[node] );
		}
	}
	return colliders;
}

} // namespace pliant
