#include "adapt/octree/octree.h"

#include "adapt/constants.h"
#include "adapt/octree/octree_steps.h"
#include "lattice/table.h"

#include <algorithm>
#include <numeric>

namespace pliant {

namespace {

using Coordinate = Eigen::Matrix<std::int16_t, 3, 1>;

/// The block of the next coarser level that holds a block.
Coordinate blockAbove( const Coordinate& c )
{
	return { std::int16_t( c.x() >> 1 ), std::int16_t( c.y() >> 1 ), std::int16_t( c.z() >> 1 ) };
}

/// The order of z, then y, then x.
bool isBefore( const Coordinate& a, const Coordinate& b )
{
	return a.z() != b.z() ? a.z() < b.z() : a.y() != b.y() ? a.y() < b.y() : a.x() < b.x();
}

void addLevel( Octree& octree, std::vector<std::uint32_t>& nodeOfCell, const JoinNodes& join )
{
	const std::uint32_t first = octree.levelStart[octree.levels - 1], count = std::uint32_t( octree.parent.size() ) - first;
	UnionFind parts( count );
	join( octree, nodeOfCell, parts );

	// One node per part, by block, then by lowest child.
	std::vector<std::uint32_t> lowest;
	for ( std::uint32_t i = 0; i < count; ++i )
	{
		if ( parts.find( i ) == i )
		{
			lowest.push_back( i );
		}
	}
	std::stable_sort( lowest.begin(), lowest.end(), [&]( std::uint32_t a, std::uint32_t b ) {
		return isBefore( blockAbove( octree.coordinate[first + a] ), blockAbove( octree.coordinate[first + b] ) );
	} );
	std::vector<std::uint32_t> nodeOfPart( count, kNoNode );
	for ( std::uint32_t k = 0; k < std::uint32_t( lowest.size() ); ++k )
	{
		nodeOfPart[lowest[k]] = first + count + k;
		octree.coordinate.push_back( blockAbove( octree.coordinate[first + lowest[k]] ) );
	}
	octree.parent.resize( octree.coordinate.size(), kNoNode );
	for ( std::uint32_t i = 0; i < count; ++i )
	{
		octree.parent[first + i] = nodeOfPart[parts.find( i )];
	}
	for ( std::uint32_t& node : nodeOfCell )
	{
		node = octree.parent[node];
	}
	octree.levelStart.push_back( std::uint32_t( octree.parent.size() ) );
	++octree.levels;
}

void listChildren( Octree& octree )
{
	const auto forNodes = [&octree]( auto&& visit ) {
		for ( std::uint32_t i = 0; i < std::uint32_t( octree.parent.size() ); ++i )
		{
			octree.parent[i] != kNoNode ? visit( octree.parent[i], i ) : void();
		}
	};
	sortIntoRows( octree.parent.size(), forNodes, octree.childStart, octree.child );
}

void orderCells( Octree& octree )
{
	octree.cellStart.assign( octree.parent.size(), 0 );
	octree.cellCount.assign( octree.parent.size(), 0 );
	octree.cells.reserve( octree.levelStart[1] );
	std::vector<std::uint32_t> stack;
	for ( std::uint32_t top = octree.levelStart[octree.levels]; top-- > octree.levelStart[octree.levels - 1]; )
	{
		stack.push_back( top );
	}
	while ( !stack.empty() )
	{
		const std::uint32_t node = stack.back();
		stack.pop_back();
		octree.cellStart[node] = std::uint32_t( octree.cells.size() );
		if ( node < octree.levelStart[1] )
		{
			octree.cells.push_back( node );
			octree.cellCount[node] = 1;
		}
		for ( std::uint32_t k = octree.childStart[node + 1]; k-- > octree.childStart[node]; )
		{
			stack.push_back( octree.child[k] );
		}
	}
	for ( std::uint32_t i = 0; i < std::uint32_t( octree.parent.size() ); ++i ) // children precede their parents
	{
		if ( octree.parent[i] != kNoNode )
		{
			octree.cellCount[octree.parent[i]] += octree.cellCount[i];
		}
	}
}

Status broken( const char* sentence )
{
	return Status{ ResultCode::BadArgument, sentence };
}

Status validateCells( const Octree& octree, const Lattice& lattice )
{
	std::vector<std::uint8_t> seen( lattice.cellCount(), 0 );
	for ( const std::uint32_t cell : octree.cells )
	{
		if ( cell >= seen.size() || seen[cell]++ != 0 )
		{
			return broken( "Octree: its depth-first order does not hold every cell once." );
		}
	}
	for ( std::uint32_t n = 0; n < std::uint32_t( octree.nodeCount() ); ++n )
	{
		std::uint32_t next = octree.cellStart[n];
		for ( std::uint32_t k = octree.childStart[n]; k < octree.childStart[n + 1]; ++k )
		{
			const std::uint32_t c = octree.child[k];
			if ( octree.parent[c] != n || octree.cellStart[c] != next )
			{
				return broken( "Octree: a node's cells are not those of its children in their order." );
			}
			next += octree.cellCount[c];
		}
		if ( n >= octree.levelStart[1] && next != octree.cellStart[n] + octree.cellCount[n] )
		{
			return broken( "Octree: a node's cells are not those of its children." );
		}
	}
	return {};
}

} // namespace

void joinByLinks(
	const Octree& octree, const Lattice& lattice, const std::vector<std::uint32_t>& nodeOfCell, std::uint32_t cell, UnionFind& parts )
{
	const std::uint32_t node = nodeOfCell[cell], first = octree.levelStart[octree.levels - 1];
	for ( std::uint32_t k = lattice.linkStart[cell]; k < lattice.linkStart[cell + 1]; ++k )
	{
		const std::uint32_t other = nodeOfCell[lattice.linkTo[k]];
		if ( other > node && blockAbove( octree.coordinate[node] ) == blockAbove( octree.coordinate[other] ) )
		{
			parts.join( node - first, other - first );
		}
	}
}

// m = sum m_c, x0 = sum m_c x0_c / m (Ohta et al. 2009, "Preprocessing").
void measureNode( Octree& octree, const Lattice& lattice, std::uint32_t n )
{
	const std::uint32_t* const first = octree.cells.data() + octree.cellStart[n];
	const std::uint32_t* const last = first + octree.cellCount[n];
	double mass = 0.0;
	Vec3d centre = Vec3d::Zero();
	octree.isSurface[n] = 0;
	for ( const std::uint32_t* c = first; c != last; ++c )
	{
		mass += lattice.fill[*c];
		centre += double( lattice.fill[*c] ) * lattice.restCentre[*c].cast<double>();
		octree.isSurface[n] |= lattice.isSurface[*c];
	}
	centre /= mass;
	Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
	for ( const std::uint32_t* c = first; c != last; ++c )
	{
		const Vec3d arm = ( lattice.restCentre[*c].cast<double>() - centre ) / double( lattice.cellSize );
		spread += double( lattice.fill[*c] ) / mass * arm * arm.transpose();
	}
	octree.mass[n] = mass;
	octree.restCentre[n] = octree.cellCount[n] == 1 ? lattice.restCentre[*first] : Vec3( centre.cast<float>() );
	octree.spread[n] = { float( spread( 0, 0 ) ), float( spread( 1, 1 ) ), float( spread( 2, 2 ) ), float( spread( 1, 2 ) ),
		float( spread( 0, 2 ) ), float( spread( 0, 1 ) ) };
}

Octree assembleOctree( const Lattice& lattice, int coarseLevels, const JoinNodes& join )
{
	Octree octree;
	const std::uint32_t cells = std::uint32_t( lattice.cellCount() );
	octree.levelStart = { 0, cells };
	octree.coordinate = lattice.coordinate;
	octree.parent.assign( cells, kNoNode );
	std::vector<std::uint32_t> nodeOfCell( cells );
	std::iota( nodeOfCell.begin(), nodeOfCell.end(), 0u );
	for ( int level = 0; level < std::min( coarseLevels, kMaxCoarseLevels ); ++level )
	{
		addLevel( octree, nodeOfCell, join );
	}
	listChildren( octree );
	orderCells( octree );
	const std::size_t nodes = octree.parent.size();
	octree.mass.resize( nodes );
	octree.restCentre.resize( nodes );
	octree.spread.resize( nodes );
	octree.isSurface.resize( nodes );
	return octree;
}

Octree buildOctree( const Lattice& lattice, int coarseLevels )
{
	const auto join = [&lattice]( const Octree& octree, const std::vector<std::uint32_t>& nodeOfCell, UnionFind& parts ) {
		for ( std::uint32_t cell = 0; cell < std::uint32_t( lattice.cellCount() ); ++cell )
		{
			joinByLinks( octree, lattice, nodeOfCell, cell, parts );
		}
	};
	Octree octree = assembleOctree( lattice, coarseLevels, join );
	for ( std::uint32_t n = 0; n < std::uint32_t( octree.nodeCount() ); ++n )
	{
		measureNode( octree, lattice, n );
	}
	return octree;
}

Status validate( const Octree& octree, const Lattice& lattice )
{
	const std::size_t nodes = octree.parent.size();
	if ( octree.levelStart.size() != std::size_t( octree.levels ) + 1 || octree.levelStart.back() != nodes ||
		octree.levelStart[1] != std::uint32_t( lattice.cellCount() ) || octree.childStart.size() != nodes + 1 ||
		octree.cells.size() != lattice.fill.size() || octree.mass.size() != nodes || octree.restCentre.size() != nodes )
	{
		return broken( "Octree: its arrays disagree in size." );
	}
	if ( Status cells = validateCells( octree, lattice ); !cells.ok() )
	{
		return cells;
	}
	for ( std::uint32_t n = 0; n < nodes; ++n )
	{
		const std::uint32_t parent = octree.parent[n];
		const bool isTop = octree.levelOf( n ) == octree.levels - 1;
		if ( isTop != ( parent == kNoNode ) || ( !isTop && octree.coordinate[parent] != blockAbove( octree.coordinate[n] ) ) )
		{
			return broken( "Octree: a parent is not one level above its child's block." );
		}
	}
	return {};
}

} // namespace pliant
