#include "world/rigid/rigid_shape.h"

#include "body/rigid_state.h"
#include "world/rigid/rigid_constants.h"
#include "world/shape/node_shape.h"

#include <BulletCollision/CollisionShapes/btCompoundShape.h>

#include <algorithm>
#include <array>
#include <cfloat>
#include <numeric>

namespace pliant {

namespace {

/// Directions in which hulls are supported: those to the points of a cube of 5 x 5 x 5 that lie on its surface, which its squares, halved,
/// make a closed surface of triangles. Direction k is opposite to the k-th from the end.
struct Directions
{
	static constexpr int kSide = 5;
	std::vector<Vec3> all;
	std::vector<std::array<int, 3>> triangles; ///< counterclockwise from outside

	Directions()
	{
		std::array<int, kSide * kSide * kSide> number{};
		for ( int k = 0; k < int( number.size() ); ++k )
		{
			const Eigen::Vector3i at = Eigen::Vector3i( k / ( kSide * kSide ), k / kSide % kSide, k % kSide ).array() - kSide / 2;
			if ( at.cwiseAbs().maxCoeff() == kSide / 2 )
			{
				number[std::size_t( k )] = int( all.size() );
				all.push_back( at.cast<float>().normalized() );
			}
		}
		constexpr std::array<int, 3> kStep = { kSide * kSide, kSide, 1 };
		for ( std::size_t axis = 0; axis < 3; ++axis )
		{
			const int u = kStep[( axis + 1 ) % 3], v = kStep[( axis + 2 ) % 3];
			for ( int square = 0; square < ( kSide - 1 ) * ( kSide - 1 ); ++square )
			{
				const int low = square / ( kSide - 1 ) * u + square % ( kSide - 1 ) * v, high = low + ( kSide - 1 ) * kStep[axis];
				const auto at = [&number]( int k ) { return number[std::size_t( k )]; };
				triangles.push_back( { at( high ), at( high + u ), at( high + u + v ) } );
				triangles.push_back( { at( high ), at( high + u + v ), at( high + v ) } );
				triangles.push_back( { at( low ), at( low + u + v ), at( low + u ) } );
				triangles.push_back( { at( low ), at( low + v ), at( low + u + v ) } );
			}
		}
	}
};

const Directions& directions()
{
	static const Directions kDirections;
	return kDirections;
}

struct Sphere
{
	Vec3 centre;
	float radius;
	float volume; ///< of the node's material, m^3
};

/// The sphere that reaches furthest in a direction, and how far, m.
struct Support
{
	float reach = 0.0f;
	Vec3 centre = Vec3::Zero();
	float radius = 0.0f;
};

/// Some of a body's spheres.
struct Part
{
	std::array<std::vector<int>, 3> sorted; ///< ascending along each axis
	std::vector<int> order;
	std::vector<Support> supports; ///< by direction
	float largest = 0.0f;          ///< radius, m
	double volume = 0.0;           ///< of the material, m^3

	Part( const std::vector<Sphere>& spheres, std::vector<int> numbers );
};

Part::Part( const std::vector<Sphere>& spheres, std::vector<int> numbers ) : order( std::move( numbers ) )
{
	const Eigen::Index count = Eigen::Index( order.size() );
	Eigen::ArrayXf x( count ), y( count ), z( count ), radius( count ), along( count ), reach( count );
	for ( Eigen::Index i = 0; i < count; ++i )
	{
		const Sphere& sphere = spheres[std::size_t( order[std::size_t( i )] )];
		x[i] = sphere.centre.x();
		y[i] = sphere.centre.y();
		z[i] = sphere.centre.z();
		radius[i] = sphere.radius;
		largest = std::max( largest, sphere.radius );
		volume += double( sphere.volume );
	}
	const std::vector<Vec3>& all = directions().all;
	supports.resize( all.size() );
	const auto furthest = [&]() {
		const float most = reach.maxCoeff();
		const Eigen::Index k = Eigen::Index( std::find( reach.data(), reach.data() + count, most ) - reach.data() );
		return Support{ most, Vec3( x[k], y[k], z[k] ), radius[k] };
	};
	for ( std::size_t k = 0; 2 * k < all.size(); ++k )
	{
		along = x * all[k].x() + ( y * all[k].y() + z * all[k].z() );
		reach = along + radius;
		supports[k] = furthest();
		reach = radius - along;
		supports[all.size() - 1 - k] = furthest();
	}
}

/// Returns the points whose hull, grown by `margin`, holds the spheres.
std::vector<btVector3> hullPoints( const Part& part, float margin )
{
	std::vector<btVector3> points;
	for ( std::size_t k = 0; k < part.supports.size(); ++k )
	{
		const Vec3& direction = directions().all[k];
		const Support& support = part.supports[k];
		const btVector3 along( direction.x(), direction.y(), direction.z() );
		const btScalar enough = btScalar( support.reach - margin - kHullTolerance * part.largest );
		if ( std::none_of( points.begin(), points.end(), [&]( const btVector3& other ) { return other.dot( along ) >= enough; } ) )
		{
			const Vec3 at = support.centre + ( support.radius - margin ) * direction;
			points.push_back( btVector3( at.x(), at.y(), at.z() ) );
		}
	}
	return points;
}

/// Returns the volume of the hull of a part's spheres, m^3: of the pyramids from one point to the triangles between supports in
/// neighbouring directions.
double hullVolume( const Part& part )
{
	const auto corner = [&part]( int k ) {
		const Support& support = part.supports[std::size_t( k )];
		return ( support.centre + support.radius * directions().all[std::size_t( k )] ).cast<double>();
	};
	const Vec3d top = corner( 0 );
	double volume = 0.0;
	for ( const std::array<int, 3>& triangle : directions().triangles )
	{
		const Vec3d a = corner( triangle[0] ) - top, b = corner( triangle[1] ) - top, c = corner( triangle[2] ) - top;
		volume += a.dot( b.cross( c ) ) / 6.0;
	}
	return volume;
}

/// Returns true if the hull of the part's spheres is hardly larger than their material.
bool isConvex( const Part& part )
{
	return hullVolume( part ) <= kConvexVolume * part.volume;
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

/// Where a part is divided: after so many of its spheres along an axis.
struct Division
{
	int axis = 0;
	std::size_t count = 0;
};

/// Returns the plane across an axis that leaves the least cost.
Division bestDivision( const std::vector<Sphere>& spheres, const Part& part )
{
	Division best{ 0, part.order.size() / 2 };
	float least = FLT_MAX;
	std::vector<float> behind( part.order.size() );
	for ( int axis = 0; axis < 3; ++axis )
	{
		const std::vector<int>& sorted = part.sorted[std::size_t( axis )];
		Box box;
		for ( std::size_t k = sorted.size(); k-- > 0; )
		{
			box.include( spheres[std::size_t( sorted[k] )] );
			behind[k] = box.cost();
		}
		box = Box{};
		for ( std::size_t k = 0; k + 1 < sorted.size(); ++k )
		{
			box.include( spheres[std::size_t( sorted[k] )] );
			if ( const float sum = box.cost() + behind[k + 1]; sum < least )
			{
				least = sum;
				best = Division{ axis, k + 1 };
			}
		}
	}
	return best;
}

/// All spheres as one part, sorted once: the orders of its parts follow from its own.
Part wholePart( const std::vector<Sphere>& spheres )
{
	std::vector<int> all( spheres.size() );
	std::iota( all.begin(), all.end(), 0 );
	Part whole( spheres, all );
	for ( int axis = 0; axis < 3; ++axis )
	{
		std::vector<int>& sorted = whole.sorted[std::size_t( axis )];
		sorted = all;
		std::sort( sorted.begin(), sorted.end(), [&]( int a, int b ) {
			const float first = spheres[std::size_t( a )].centre[axis], second = spheres[std::size_t( b )].centre[axis];
			return first < second || ( first == second && a < b );
		} );
	}
	return whole;
}

std::pair<Part, Part> divided( const std::vector<Sphere>& spheres, const Part& part, std::vector<unsigned char>& isFirst )
{
	const Division division = bestDivision( spheres, part );
	const std::vector<int>& best = part.sorted[std::size_t( division.axis )];
	const auto middle = best.begin() + std::ptrdiff_t( division.count );
	std::pair<Part, Part> halves{
		Part( spheres, std::vector<int>( best.begin(), middle ) ), Part( spheres, std::vector<int>( middle, best.end() ) ) };
	for ( std::size_t k = 0; k < best.size(); ++k )
	{
		isFirst[std::size_t( best[k] )] = k < division.count ? 1 : 0;
	}
	for ( std::size_t axis = 0; axis < 3; ++axis )
	{
		for ( const int sphere : part.sorted[axis] )
		{
			( isFirst[std::size_t( sphere )] != 0 ? halves.first : halves.second ).sorted[axis].push_back( sphere );
		}
	}
	return halves;
}

/// Divides the nodes until each part is nearly convex, few nodes, or there are as many parts as allowed. The parts with most nodes first.
std::vector<Part> convexParts( const std::vector<Sphere>& spheres )
{
	std::vector<unsigned char> isFirst( spheres.size() );
	std::vector<Part> done, open;
	open.push_back( wholePart( spheres ) );
	while ( !open.empty() )
	{
		const auto largest = std::max_element(
			open.begin(), open.end(), []( const Part& a, const Part& b ) { return a.order.size() < b.order.size(); } );
		Part part = std::move( *largest );
		open.erase( largest );
		const bool isWhole = int( part.order.size() ) < kLeastHullNodes || int( done.size() + open.size() ) + 1 >= kMostHulls ||
			isConvex( part );
		if ( isWhole )
		{
			done.push_back( std::move( part ) );
			continue;
		}
		auto [first, second] = divided( spheres, part, isFirst );
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
	for ( const Part& part : convexParts( spheres ) )
	{
		const std::vector<btVector3> points = hullPoints( part, margin );
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
