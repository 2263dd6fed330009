// Generalised winding numbers through a tree of dipoles. Barill et al. 2018, "Fast Winding Numbers for Soups and Clouds".

#include "lattice/winding_number.h"

#include "lattice/constants.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace pliant {

namespace {

/// Halving at the median keeps the depth below log2 of the triangles that 32 bits can count.
constexpr int kMostDepth = 64;

constexpr double kWholeSphere = 4.0 * std::numbers::pi;

} // namespace

WindingTree::WindingTree( const std::vector<Vec3d>& position, std::vector<Triangle> triangles )
	: m_position( position ), m_triangles( std::move( triangles ) )
{
	if ( !m_triangles.empty() )
	{
		m_nodes.reserve( 4 * m_triangles.size() / kTrianglesPerLeaf + 1 );
		build( 0, std::uint32_t( m_triangles.size() ) );
	}
}

Vec3d WindingTree::middle( const Triangle& t ) const
{
	return ( m_position[t[0]] + m_position[t[1]] + m_position[t[2]] ) / 3.0;
}

WindingTree::Node WindingTree::summarize( std::uint32_t first, std::uint32_t last ) const
{
	Node node;
	double area = 0.0;
	Vec3d plain = Vec3d::Zero();
	for ( std::uint32_t i = first; i < last; ++i )
	{
		const Triangle& t = m_triangles[i];
		const Vec3d a = 0.5 * ( m_position[t[1]] - m_position[t[0]] ).cross( m_position[t[2]] - m_position[t[0]] );
		const Vec3d m = middle( t );
		area += a.norm();
		node.dipole += a;
		node.centre += a.norm() * m;
		plain += m;
	}
	node.centre = area > 0.0 ? Vec3d( node.centre / area ) : Vec3d( plain / double( last - first ) );
	double radiusSquared = 0.0;
	for ( std::uint32_t i = first; i < last; ++i )
	{
		for ( const std::uint32_t v : m_triangles[i] )
		{
			radiusSquared = std::max( radiusSquared, ( m_position[v] - node.centre ).squaredNorm() );
		}
	}
	node.farSquared = kFarField * kFarField * radiusSquared;
	return node;
}

void WindingTree::build( std::uint32_t first, std::uint32_t last )
{
	const std::size_t here = m_nodes.size();
	m_nodes.push_back( summarize( first, last ) );
	if ( last - first <= std::uint32_t( kTrianglesPerLeaf ) )
	{
		m_nodes[here].first = first;
		m_nodes[here].count = last - first;
		return;
	}
	Vec3d low = middle( m_triangles[first] );
	Vec3d high = low;
	for ( std::uint32_t i = first; i < last; ++i )
	{
		low = low.cwiseMin( middle( m_triangles[i] ) );
		high = high.cwiseMax( middle( m_triangles[i] ) );
	}
	Eigen::Index axis = 0;
	( high - low ).maxCoeff( &axis );
	// Triangles are all different, so that the order is total and the tree the same whatever the library's algorithm.
	const auto isBefore = [&]( const Triangle& a, const Triangle& b ) {
		const double ma = middle( a )[axis];
		const double mb = middle( b )[axis];
		return ma != mb ? ma < mb : a < b;
	};
	const std::uint32_t half = first + ( last - first ) / 2;
	std::nth_element( m_triangles.begin() + first, m_triangles.begin() + half, m_triangles.begin() + last, isBefore );
	build( first, half );
	m_nodes[here].first = std::uint32_t( m_nodes.size() );
	build( half, last );
}

double WindingTree::solidAngle( const Triangle& t, const Vec3d& point ) const
{
	// tan( Omega / 2 ) = a . ( b x c ) / ( |a||b||c| + ( a . b ) |c| + ( b . c ) |a| + ( c . a ) |b| ): Van Oosterom and Strackee 1983.
	const Vec3d a = m_position[t[0]] - point;
	const Vec3d b = m_position[t[1]] - point;
	const Vec3d c = m_position[t[2]] - point;
	const double la = a.norm();
	const double lb = b.norm();
	const double lc = c.norm();
	const double above = a.dot( b.cross( c ) );
	const double below = la * lb * lc + a.dot( b ) * lc + b.dot( c ) * la + c.dot( a ) * lb;
	// In the triangle's own plane it covers nothing from one side and everything from the other: call it nothing.
	return above == 0.0 ? 0.0 : 2.0 * std::atan2( above, below );
}

double WindingTree::at( const Vec3d& point ) const
{
	if ( m_nodes.empty() )
	{
		return 0.0;
	}
	std::uint32_t stack[kMostDepth];
	int depth = 0;
	stack[depth++] = 0;
	double angle = 0.0;
	while ( depth > 0 )
	{
		const std::uint32_t here = stack[--depth];
		const Node& node = m_nodes[here];
		const Vec3d r = node.centre - point;
		const double distanceSquared = r.squaredNorm();
		if ( distanceSquared > node.farSquared )
		{
			// Omega = n A . r / |r|^3
			angle += node.dipole.dot( r ) / ( distanceSquared * std::sqrt( distanceSquared ) );
		}
		else if ( node.count == 0 )
		{
			stack[depth++] = node.first;
			stack[depth++] = here + 1;
		}
		else
		{
			for ( std::uint32_t i = 0; i < node.count; ++i )
			{
				angle += solidAngle( m_triangles[node.first + i], point );
			}
		}
	}
	return angle / kWholeSphere;
}

double WindingTree::exactlyAt( const Vec3d& point ) const
{
	double angle = 0.0;
	for ( const Triangle& t : m_triangles )
	{
		angle += solidAngle( t, point );
	}
	return angle / kWholeSphere;
}

} // namespace pliant
