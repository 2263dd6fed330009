#include "world/game/solid_tree.h"

#include "world/query/sphere_sweep.h"

#include "world/game/constants.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace pliant {

namespace {

double squaredDistance( const Vec3d& low, const Vec3d& high, const Vec3d& to )
{
	return ( to - to.cwiseMax( low ).cwiseMin( high ) ).squaredNorm();
}

} // namespace

SolidTree::SolidTree( const std::vector<Vec3d>& position, const std::vector<Triangle>& triangles ) :
	m_position( position ), m_triangles( triangles ), m_order( triangles.size() )
{
	std::iota( m_order.begin(), m_order.end(), 0u );
	if ( !m_order.empty() )
	{
		build( 0, std::uint32_t( m_order.size() ) );
	}
}

void SolidTree::build( std::uint32_t first, std::uint32_t last )
{
	Node node{ Vec3d::Constant( std::numeric_limits<double>::infinity() ), Vec3d::Constant( -std::numeric_limits<double>::infinity() ) };
	for ( std::uint32_t k = first; k < last; ++k )
	{
		for ( const std::uint32_t vertex : m_triangles[m_order[k]] )
		{
			node.low = node.low.cwiseMin( m_position[vertex] );
			node.high = node.high.cwiseMax( m_position[vertex] );
		}
	}
	const std::size_t index = m_nodes.size();
	m_nodes.push_back( node );
	if ( last - first <= kTrianglesOfALeaf )
	{
		m_nodes[index].first = first;
		m_nodes[index].count = last - first;
		return;
	}
	int axis = 0;
	( node.high - node.low ).maxCoeff( &axis );
	const auto middleOf = [&]( std::uint32_t t ) {
		return m_position[m_triangles[t][0]][axis] + m_position[m_triangles[t][1]][axis] + m_position[m_triangles[t][2]][axis];
	};
	const std::uint32_t middle = ( first + last ) / 2;
	std::nth_element( m_order.begin() + first, m_order.begin() + middle, m_order.begin() + last,
		[&]( std::uint32_t a, std::uint32_t b ) { return middleOf( a ) < middleOf( b ); } );
	build( first, middle );
	m_nodes[index].first = std::uint32_t( m_nodes.size() );
	build( middle, last );
}

SolidTree::Nearest SolidTree::nearest( const Vec3d& to ) const
{
	Nearest best;
	best.squaredDistance = std::numeric_limits<double>::infinity();
	if ( !m_nodes.empty() )
	{
		visit( 0, to, best );
	}
	return best;
}

void SolidTree::visit( std::uint32_t at, const Vec3d& to, Nearest& best ) const
{
	const Node& node = m_nodes[at];
	for ( std::uint32_t k = node.first; k < node.first + node.count; ++k )
	{
		const Triangle& triangle = m_triangles[m_order[k]];
		const Vec3d corners[3] = { m_position[triangle[0]], m_position[triangle[1]], m_position[triangle[2]] };
		const Vec3d weight = nearestWeights( to, corners );
		const Vec3d point = weight[0] * corners[0] + weight[1] * corners[1] + weight[2] * corners[2];
		const double square = ( point - to ).squaredNorm();
		if ( square < best.squaredDistance )
		{
			best = Nearest{ int( m_order[k] ), point, square };
		}
	}
	if ( node.count > 0 )
	{
		return;
	}
	std::uint32_t children[2] = { at + 1, node.first };
	double distance[2];
	for ( int k = 0; k < 2; ++k )
	{
		distance[k] = squaredDistance( m_nodes[children[k]].low, m_nodes[children[k]].high, to );
	}
	const int nearer = distance[1] < distance[0] ? 1 : 0;
	for ( const int k : { nearer, 1 - nearer } )
	{
		if ( distance[k] < best.squaredDistance )
		{
			visit( children[k], to, best );
		}
	}
}

} // namespace pliant
