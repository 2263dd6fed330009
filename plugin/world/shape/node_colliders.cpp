#include "world/shape/node_colliders.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pliant {

namespace {

/// Largest depth below the surface that is counted, in links.
int largestDepth( const Octree& octree )
{
	return 1 << ( octree.levels - 1 );
}

/// Lowers the depths of cells nearer to the cells of `front`, all of depth `layer`, than recorded, and calls `lowered` for each.
template <class Lowered>
void flood(
	const Lattice& lattice, std::vector<std::uint32_t> front, int layer, int most, std::vector<std::uint8_t>& depth, Lowered&& lowered )
{
	std::vector<std::uint32_t> next;
	while ( ++layer <= most && !front.empty() )
	{
		next.clear();
		for ( const std::uint32_t i : front )
		{
			for ( std::uint32_t k = lattice.linkStart[i]; k < lattice.linkStart[i + 1]; ++k )
			{
				const std::uint32_t j = lattice.linkTo[k];
				if ( int( depth[j] ) > layer )
				{
					depth[j] = std::uint8_t( layer );
					lowered( j );
					next.push_back( j );
				}
			}
		}
		front.swap( next );
	}
}

/// NodeColliders::depth. Inner cells look for the surface, not the reverse: most cells of a cut body are surface.
std::vector<std::uint8_t> depthBelowSurface( const Lattice& lattice, int most )
{
	std::vector<std::uint8_t> depth( std::size_t( lattice.cellCount() ), std::uint8_t( most + 1 ) );
	std::vector<std::uint32_t> front;
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
			front.push_back( i );
		}
	}
	flood( lattice, std::move( front ), 1, most, depth, []( std::uint32_t ) {} );
	return depth;
}

/// Bit 2a: the face towards lower coordinates along axis a is open; bit 2a + 1: the one towards higher.
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

/// Reaches of cells, computed once for nodes of all levels.
class CellReaches
{
public:
	explicit CellReaches( const Lattice& lattice ) :
		m_lattice( lattice ), m_radius( lattice.fill.size(), -1.0 ), m_open( lattice.fill.size(), kUnknown )
	{}

	double radiusOf( std::uint32_t cell )
	{
		if ( m_radius[cell] < 0.0 )
		{
			const double fill = double( m_lattice.fill[cell] );
			m_radius[cell] = 0.5 * double( m_lattice.cellSize ) * ( fill == 1.0 ? 1.0 : std::cbrt( fill ) );
		}
		return m_radius[cell];
	}

	/// Appends the reach of the cell's sphere from `centre` through each of its open faces, m.
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
	std::vector<double> m_radius;     ///< negative: not yet computed
	std::vector<std::uint8_t> m_open; ///< openFaces, or kUnknown
};

/// The median of its cells' reaches, or the radius of the sphere of its volume.
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

NodeColliders measureColliders( const Lattice& lattice, const Octree& octree )
{
	NodeColliders colliders;
	colliders.radius.reserve( std::size_t( octree.nodeCount() ) );
	colliders.collides.reserve( std::size_t( octree.nodeCount() ) );
	colliders.depth = depthBelowSurface( lattice, largestDepth( octree ) );
	std::vector<int> nearest( std::size_t( octree.nodeCount() ), std::numeric_limits<int>::max() );
	std::copy( colliders.depth.begin(), colliders.depth.end(), nearest.begin() );
	std::vector<double> reaches;
	CellReaches cells( lattice );
	int level = 0;
	for ( std::uint32_t node = 0; node < std::uint32_t( octree.nodeCount() ); ++node ) // level by level: children precede their parents
	{
		level += node == octree.levelStart[std::size_t( level ) + 1] ? 1 : 0;
		colliders.radius.push_back( radiusOf( lattice, octree, node, cells, reaches ) );
		colliders.collides.push_back( nearest[node] <= 1 << level );
		if ( const std::uint32_t parent = octree.parent[node]; parent != kNoNode )
		{
			nearest[parent] = std::min( nearest[parent], nearest[node] );
		}
	}
	return colliders;
}

namespace {

/// Whether a node has a cell whose depth does not exceed the node's width in cells.
bool isNearSurface( const Octree& octree, const std::vector<std::uint8_t>& depth, std::uint32_t node, int level )
{
	const auto first = octree.cells.begin() + octree.cellStart[node];
	return std::any_of(
		first, first + octree.cellCount[node], [&depth, level]( std::uint32_t cell ) { return int( depth[cell] ) <= 1 << level; } );
}

} // namespace

// Cells at removed links are surface now: cells can only have come nearer to the surface, through one of them. Where links are restored and
// a cell is no longer surface, everything is measured again.
NodeColliders followColliders( const Lattice& lattice, const Octree& octree, const NodeColliders& before, const CollidersChange& change )
{
	const auto isInside = [&lattice]( std::uint32_t cell ) { return lattice.isSurface[cell] == 0; };
	if ( std::any_of( change.touched.begin(), change.touched.end(), isInside ) )
	{
		return measureColliders( lattice, octree );
	}
	NodeColliders colliders;
	const std::uint32_t nodes = std::uint32_t( octree.nodeCount() );
	colliders.radius.resize( nodes );
	colliders.collides.resize( nodes );
	colliders.depth.reserve( change.cellBefore.size() );
	for ( const std::uint32_t old : change.cellBefore )
	{
		colliders.depth.push_back( before.depth[old] );
	}
	std::vector<std::uint32_t> lowered = change.touched;
	for ( const std::uint32_t cell : change.touched )
	{
		colliders.depth[cell] = 0;
	}
	flood( lattice, change.touched, 0, largestDepth( octree ), colliders.depth,
		[&lowered]( std::uint32_t cell ) { lowered.push_back( cell ); } );
	std::vector<double> reaches;
	CellReaches cells( lattice );
	for ( std::uint32_t node = 0, level = 0; node < nodes; ++node )
	{
		level += node == octree.levelStart[level + 1] ? 1 : 0;
		const std::uint32_t old = change.nodeBefore[node];
		colliders.radius[node] = old == kNoNode ? radiusOf( lattice, octree, node, cells, reaches ) : before.radius[old];
		colliders.collides[node] = old == kNoNode ? isNearSurface( octree, colliders.depth, node, int( level ) ) : before.collides[old];
	}
	for ( const std::uint32_t cell : lowered )
	{
		int width = 1;
		for ( std::uint32_t node = cell; node != kNoNode; node = octree.parent[node], width *= 2 )
		{
			colliders.collides[node] |= std::uint8_t( int( colliders.depth[cell] ) <= width );
		}
	}
	return colliders;
}

} // namespace pliant
