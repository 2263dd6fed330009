// Generalised winding numbers through a tree of dipoles. Barill et al. 2018, "Fast Winding Numbers for Soups and Clouds".

#include "lattice/mesh/winding_number.h"

#include "lattice/constants.h"

#include <algorithm>
#include <cmath>

namespace pliant {

namespace {

Vec3d middle( const std::array<Vec3d, 3>& corners )
{
	return ( corners[0] + corners[1] + corners[2] ) / 3.0;
}

} // namespace

WindingTree::WindingTree( const std::vector<Vec3d>& position, std::vector<Triangle> triangles )
{
	if ( triangles.empty() )
	{
		return;
	}
	m_corners.reserve( triangles.size() );
	for ( const Triangle& t : triangles )
	{
		m_corners.push_back( { position[t[0]], position[t[1]], position[t[2]] } );
	}
	std::vector<Triangle>().swap( triangles );
	m_nodes.reserve( 4 * m_corners.size() / kTrianglesPerLeaf + 1 );
	build( 0, std::uint32_t( m_corners.size() ) );
}

WindingTree::Node WindingTree::summarize( std::uint32_t first, std::uint32_t last ) const
{
	Node node;
	double area = 0.0;
	Vec3d plain = Vec3d::Zero();
	for ( std::uint32_t i = first; i < last; ++i )
	{
		const Corners& t = m_corners[i];
		const Vec3d a = 0.5 * ( t[1] - t[0] ).cross( t[2] - t[0] );
		const Vec3d m = middle( t );
		const double size = a.norm();
		area += size;
		node.dipole += a;
		node.centre += size * m;
		plain += m;
	}
	node.centre = area > 0.0 ? Vec3d( node.centre / area ) : Vec3d( plain / double( last - first ) );
	double radiusSquared = 0.0;
	for ( std::uint32_t i = first; i < last; ++i )
	{
		for ( const Vec3d& corner : m_corners[i] )
		{
			radiusSquared = std::max( radiusSquared, ( corner - node.centre ).squaredNorm() );
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
		m_nodes[here].end = std::uint32_t( m_nodes.size() );
		return;
	}
	Vec3d low = middle( m_corners[first] );
	Vec3d high = low;
	for ( std::uint32_t i = first; i < last; ++i )
	{
		low = low.cwiseMin( middle( m_corners[i] ) );
		high = high.cwiseMax( middle( m_corners[i] ) );
	}
	Eigen::Index axis = 0;
	( high - low ).maxCoeff( &axis );
	const std::uint32_t half = first + ( last - first ) / 2;
	std::nth_element(
		m_corners.begin() + first, m_corners.begin() + half, m_corners.begin() + last, [axis]( const Corners& a, const Corners& b ) {
			return a[0][axis] + a[1][axis] + a[2][axis] < b[0][axis] + b[1][axis] + b[2][axis];
		} );
	build( first, half );
	m_nodes[here].first = std::uint32_t( m_nodes.size() );
	build( half, last );
	m_nodes[here].end = std::uint32_t( m_nodes.size() );
}

namespace {

/// Adds angles by multiplying complex numbers, so that a sum costs one arc tangent. Turns beyond half a circle are counted.
class AngleSum
{
public:
	/// The angle of ( x, y ), in (-pi, pi).
	void add( double x, double y )
	{
		const double nextX = m_x * x - m_y * y;
		const double nextY = m_x * y + m_y * x;
		// Two angles of the same sign whose sum has the other sign have passed pi.
		m_turns += m_y >= 0.0 && y > 0.0 && nextY < 0.0 ? 1 : m_y < 0.0 && y < 0.0 && nextY >= 0.0 ? -1 : 0;
		// Dividing by the larger component keeps the product within range.
		const double scale = 1.0 / std::max( std::abs( nextX ), std::abs( nextY ) );
		m_x = nextX * scale;
		m_y = nextY * scale;
	}

	double angle() const { return std::atan2( m_y, m_x ) + 2.0 * std::numbers::pi * m_turns; }

private:
	double m_x = 1.0;
	double m_y = 0.0;
	int m_turns = 0;
};

/// tan( Omega / 2 ) = a . ( b x c ) / ( |a||b||c| + ( a . b ) |c| + ( b . c ) |a| + ( c . a ) |b| ): Van Oosterom and Strackee 1983.
void addHalfSolidAngle( const std::array<Vec3d, 3>& corner, const Vec3d& point, AngleSum& sum )
{
	const Vec3d a = corner[0] - point;
	const Vec3d b = corner[1] - point;
	const Vec3d c = corner[2] - point;
	const double la = a.norm();
	const double lb = b.norm();
	const double lc = c.norm();
	const double above = a.dot( b.cross( c ) );
	const double below = la * lb * lc + a.dot( b ) * lc + b.dot( c ) * la + c.dot( a ) * lb;
	// The solid angle is discontinuous in the triangle's own plane; its mean, zero, is used.
	if ( above != 0.0 )
	{
		sum.add( below, above );
	}
}

} // namespace

double WindingTree::at( const Vec3d& point ) const
{
	if ( m_nodes.empty() )
	{
		return 0.0;
	}
	std::uint32_t stack[kMaxWindingDepth];
	int depth = 0;
	stack[depth++] = 0;
	double angle = 0.0;
	AngleSum near;
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
			for ( std::uint32_t i = node.first; i < node.first + node.count; ++i )
			{
				addHalfSolidAngle( m_corners[i], point, near );
			}
		}
	}
	return ( angle + 2.0 * near.angle() ) / kWholeSphere;
}

double WindingTree::workAt( const Vec3d& point ) const
{
	double work = 0.0;
	for ( std::size_t here = 0; here < m_nodes.size(); )
	{
		// The first child follows its node: sequential traversal visits the nodes of the search; a far node's children are skipped.
		const Node& node = m_nodes[here];
		const bool isFar = ( node.centre - point ).squaredNorm() > node.farSquared;
		work += 1.0 + ( isFar ? 0.0 : double( node.count ) );
		here = isFar ? std::size_t( node.end ) : here + 1;
	}
	return work;
}

namespace {

/// Compares the signs of the volumes that the segment spans with the triangle's edges and that its ends span with the triangle.
bool intersects( const std::array<Vec3d, 3>& corner, const Vec3d& from, const Vec3d& to )
{
	const Vec3d segment = to - from;
	const Vec3d a = corner[0] - from;
	const Vec3d b = corner[1] - from;
	const Vec3d c = corner[2] - from;
	const Vec3d normal = ( b - a ).cross( c - a );
	if ( a.dot( normal ) * ( a - segment ).dot( normal ) > 0.0 )
	{
		return false;
	}
	const double ab = segment.dot( a.cross( b ) );
	const double bc = segment.dot( b.cross( c ) );
	const double ca = segment.dot( c.cross( a ) );
	return ( ab >= 0.0 && bc >= 0.0 && ca >= 0.0 ) || ( ab <= 0.0 && bc <= 0.0 && ca <= 0.0 );
}

} // namespace

bool WindingTree::isCrossed( const Vec3d& from, const Vec3d& to ) const
{
	const Vec3d segment = to - from;
	std::uint32_t stack[kMaxWindingDepth];
	int depth = 0;
	if ( !m_nodes.empty() )
	{
		stack[depth++] = 0;
	}
	while ( depth > 0 )
	{
		const std::uint32_t here = stack[--depth];
		const Node& node = m_nodes[here];
		const double along = std::clamp( ( node.centre - from ).dot( segment ) / segment.squaredNorm(), 0.0, 1.0 );
		if ( ( from + along * segment - node.centre ).squaredNorm() * kFarField * kFarField >
			node.farSquared * ( 1.0 + kRoundingFraction ) )
		{
			continue;
		}
		if ( node.count == 0 )
		{
			stack[depth++] = node.first;
			stack[depth++] = here + 1;
			continue;
		}
		for ( std::uint32_t i = node.first; i < node.first + node.count; ++i )
		{
			if ( intersects( m_corners[i], from, to ) )
			{
				return true;
			}
		}
	}
	return false;
}

} // namespace pliant
