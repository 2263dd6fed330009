#include "world/rigid/rigid_shape.h"

#include "body/rigid_state.h"
#include "world/constants.h"
#include "world/shape/node_shape.h"

#include <BulletCollision/CollisionShapes/btCompoundShape.h>
#include <LinearMath/btConvexHullComputer.h>

#include <algorithm>
#include <cfloat>
#include <numeric>

namespace pliant {

namespace {

/// Directions in which hulls are supported: those to the points of a cube of 5 x 5 x 5 that lie on its surface.
std::vector<Vec3> supportDirections()
{
	constexpr int kHalf = 2;
	std::vector<Vec3> directions;
	for ( int x = -kHalf; x <= kHalf; ++x )
	{
		for ( int y = -kHalf; y <= kHalf; ++y )
		{
			for ( int z = -kHalf; z <= kHalf; ++z )
			{
				if ( std::max( { std::abs( x ), std::abs( y ), std::abs( z ) } ) == kHalf )
				{
					directions.push_back( Vec3( float( x ), float( y ), float( z ) ).normalized() );
				}
			}
		}
	}
	return directions;
}

struct Sphere
{
	Vec3 centre;
	float radius;
	float volume; ///< of the node's material, m^3
};

/// Returns the points whose hull, grown by `margin`, holds the spheres.
std::vector<btVector3> hullPoints( const std::vector<Sphere>& spheres, const std::vector<int>& part, float margin )
{
	static const std::vector<Vec3> kDirections = supportDirections();
	std::vector<btVector3> points;
	float largest = 0.0f;
	for ( const int k : part )
	{
		largest = std::max( largest, spheres[std::size_t( k )].radius );
	}
	for ( const Vec3& direction : kDirections )
	{
		float furthest = -FLT_MAX;
		Vec3 at = Vec3::Zero();
		for ( const int k : part )
		{
			const Sphere& sphere = spheres[std::size_t( k )];
			const float reach = sphere.centre.dot( direction ) + sphere.radius;
			if ( reach > furthest )
			{
				furthest = reach;
				at = sphere.centre + ( sphere.radius - margin ) * direction;
			}
		}
		const btVector3 along( direction.x(), direction.y(), direction.z() );
		const btScalar enough = btScalar( furthest - margin - kHullTolerance * largest );
		if ( std::none_of( points.begin(), points.end(), [&]( const btVector3& other ) { return other.dot( along ) >= enough; } ) )
		{
			points.push_back( btVector3( at.x(), at.y(), at.z() ) );
		}
	}
	return points;
}

/// In Bullet a contact lasts until it has parted or slid by a fraction of the shape's size. A small shape moves by more in a step: its
/// contacts are lost as soon as they are found, and it rolls from one to the next instead of resting on several.
template <class Shape>
class LastingContacts : public Shape
{
public:
	template <class... Arguments>
	explicit LastingContacts( btScalar least, Arguments... arguments ) : Shape( arguments... ), m_least( least )
	{}
	btScalar getContactBreakingThreshold( btScalar fraction ) const override
	{
		return btMax( m_least, Shape::getContactBreakingThreshold( fraction ) );
	}

private:
	btScalar m_least; // m
};

/// Returns the volume of the points' hull, m^3: of the pyramids from its first vertex to the triangles of its faces.
double hullVolume( const std::vector<btVector3>& points )
{
	btConvexHullComputer hull;
	hull.compute( &points[0].x(), int( sizeof( btVector3 ) ), int( points.size() ), btScalar( 0 ), btScalar( 0 ) );
	double volume = 0.0;
	for ( int f = 0; f < hull.faces.size(); ++f )
	{
		const btConvexHullComputer::Edge* const first = &hull.edges[hull.faces[f]];
		const btVector3 a = hull.vertices[first->getSourceVertex()] - hull.vertices[0];
		for ( const btConvexHullComputer::Edge* edge = first->getNextEdgeOfFace(); edge->getTargetVertex() != first->getSourceVertex();
			  edge = edge->getNextEdgeOfFace() )
		{
			const btVector3 b = hull.vertices[edge->getSourceVertex()] - hull.vertices[0];
			const btVector3 c = hull.vertices[edge->getTargetVertex()] - hull.vertices[0];
			volume += double( a.dot( b.cross( c ) ) ) / 6.0;
		}
	}
	return std::abs( volume );
}

/// Returns true if the hull of the part's spheres is hardly larger than their material.
bool isConvex( const std::vector<Sphere>& spheres, const std::vector<int>& part )
{
	double volume = 0.0;
	for ( const int k : part )
	{
		volume += double( spheres[std::size_t( k )].volume );
	}
	return hullVolume( hullPoints( spheres, part, 0.0f ) ) <= kConvexVolume * volume;
}

/// A box in the frame's axes around some nodes.
struct Box
{
	Vec3 low = Vec3::Constant( FLT_MAX ), high = Vec3::Constant( -FLT_MAX );
	float material = 0.0f; ///< m^3

	void include( const Sphere& sphere )
	{
		low = low.cwiseMin( sphere.centre - Vec3::Constant( sphere.radius ) );
		high = high.cwiseMax( sphere.centre + Vec3::Constant( sphere.radius ) );
		material += sphere.volume;
	}
	/// The material that a part may still have to be divided for: its volume times that of the box it leaves empty.
	float cost() const { return std::max( 0.0f, ( high - low ).prod() - material ) * material; }
};

/// Divides a part by the plane across an axis that leaves the least cost.
std::pair<std::vector<int>, std::vector<int>> divided( const std::vector<Sphere>& spheres, const std::vector<int>& part )
{
	std::vector<int> best, sorted = part;
	std::size_t bestSize = part.size() / 2;
	float least = FLT_MAX;
	std::vector<float> behind( part.size() );
	for ( int axis = 0; axis < 3; ++axis )
	{
		std::sort( sorted.begin(), sorted.end(), [&]( int a, int b ) {
			const float first = spheres[std::size_t( a )].centre[axis], second = spheres[std::size_t( b )].centre[axis];
			return first < second || ( first == second && a < b );
		} );
		Box box;
		for ( std::size_t k = sorted.size(); k-- > 0; )
		{
			box.include( spheres[std::size_t( sorted[k] )] );
			behind[k] = box.cost();
		}
		box = Box{};
		bool isBest = false;
		for ( std::size_t k = 0; k + 1 < sorted.size(); ++k )
		{
			box.include( spheres[std::size_t( sorted[k] )] );
			if ( const float sum = box.cost() + behind[k + 1]; sum < least )
			{
				least = sum;
				bestSize = k + 1;
				isBest = true;
			}
		}
		if ( isBest )
		{
			best = sorted;
		}
	}
	const auto middle = best.begin() + std::ptrdiff_t( bestSize );
	return { std::vector<int>( best.begin(), middle ), std::vector<int>( middle, best.end() ) };
}

/// Divides the nodes until each part is nearly convex, few nodes, or there are as many parts as allowed. The parts with most nodes first.
std::vector<std::vector<int>> convexParts( const std::vector<Sphere>& spheres )
{
	std::vector<int> all( spheres.size() );
	std::iota( all.begin(), all.end(), 0 );
	std::vector<std::vector<int>> done, open( 1, std::move( all ) );
	while ( !open.empty() )
	{
		const auto largest = std::max_element(
			open.begin(), open.end(), []( const auto& a, const auto& b ) { return a.size() < b.size(); } );
		std::vector<int> part = std::move( *largest );
		open.erase( largest );
		const bool isWhole = int( part.size() ) < kLeastHullNodes || int( done.size() + open.size() ) + 1 >= kMostHulls ||
			isConvex( spheres, part );
		if ( isWhole )
		{
			done.push_back( std::move( part ) );
			continue;
		}
		auto [first, second] = divided( spheres, part );
		open.push_back( std::move( first ) );
		open.push_back( std::move( second ) );
	}
	return done;
}

} // namespace

RigidShape::RigidShape( const Body& body, const NodeShape& nodes )
{
	const NodeState& state = body.nodes();
	std::vector<Sphere> spheres;
	for ( int i = 0; i < state.count; ++i )
	{
		spheres.push_back( Sphere{
			body.rigidState()->arm.get( i ), float( nodes.sphereOfNode( i )->getRadius() ), state.mass[i] / body.material().density } );
	}
	const float margin = float( nodes.smallestRadius() );
	const btScalar lasting = btMin( kLastingContact * btScalar( margin ), kLongestLasting );
	for ( const std::vector<int>& part : convexParts( spheres ) )
	{
		const std::vector<btVector3> points = hullPoints( spheres, part, margin );
		m_hulls.push_back( std::make_unique<LastingContacts<btConvexHullShape>>(
			lasting, &points[0].x(), int( points.size() ), int( sizeof( btVector3 ) ) ) );
		m_hulls.back()->setMargin( btScalar( margin ) );
		m_hulls.back()->recalcLocalAabb();
	}
	if ( m_hulls.size() > 1 )
	{
		auto compound = std::make_unique<LastingContacts<btCompoundShape>>( lasting, true, int( m_hulls.size() ) );
		for ( const auto& hull : m_hulls )
		{
			compound->addChildShape( btTransform::getIdentity(), hull.get() );
		}
		m_compound = std::move( compound );
	}
}

} // namespace pliant
