#include "world/query/sphere_sweep.h"

#include "world/query/query_constants.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace pliant {

namespace {

/// The weights of a point in the triangle's plane. False for a triangle without area.
bool weightsOf( const Vec3d& point, const Vec3d ( &corner )[3], const Vec3d& area, Vec3d& weights )
{
	const double size = area.squaredNorm();
	if ( !( size > 0.0 ) )
	{
		return false;
	}
	for ( int k = 0; k < 3; ++k )
	{
		const Vec3d &a = corner[( k + 1 ) % 3], &b = corner[( k + 2 ) % 3];
		weights[k] = ( a - point ).cross( b - point ).dot( area ) / size;
	}
	return true;
}

/// The first time at which   | from + t along - on | = radius   within [0, limit], where `on` runs along a line (unit `axis`) or is a point
/// (`axis` zero).
bool meetsRound( const Vec3d& from, const Vec3d& along, const Vec3d& axis, double radius, double limit, double& t )
{
	const Vec3d at = from - from.dot( axis ) * axis, v = along - along.dot( axis ) * axis;
	const double a = v.squaredNorm(), b = at.dot( v ), c = at.squaredNorm() - radius * radius, root = b * b - a * c;
	if ( !( a > 0.0 ) || root < 0.0 || b >= 0.0 )
	{
		return false;
	}
	t = ( -b - std::sqrt( root ) ) / a;
	return t >= 0.0 && t <= limit;
}

} // namespace

bool meets( const Vec3d& from, const Vec3d& along, const Vec3d ( &corner )[3], double limit, TriangleHit& hit )
{
	const Vec3d area = ( corner[1] - corner[0] ).cross( corner[2] - corner[0] );
	const double speed = along.dot( area ), distance = ( corner[0] - from ).dot( area );
	if ( speed == 0.0 )
	{
		return false;
	}
	const double t = distance / speed;
	if ( !( t >= 0.0 && t < limit ) )
	{
		return false;
	}
	const Vec3d point = from + t * along;
	if ( !weightsOf( point, corner, area, hit.weights ) || hit.weights.minCoeff() < -kTriangleBorder )
	{
		return false;
	}
	hit.fraction = t;
	hit.point = point;
	hit.normal = area.normalized();
	return true;
}

// The foot of the perpendicular where that is within the triangle, else the nearest point of an edge.
Vec3d nearestWeights( const Vec3d& to, const Vec3d ( &corner )[3] )
{
	const Vec3d area = ( corner[1] - corner[0] ).cross( corner[2] - corner[0] );
	Vec3d weights;
	if ( weightsOf( to - ( to - corner[0] ).dot( area ) / std::max( area.squaredNorm(), kNoArea ) * area, corner, area, weights ) &&
		weights.minCoeff() >= 0.0 )
	{
		return weights;
	}
	double least = -1.0;
	Vec3d best = Vec3d::UnitX();
	for ( int k = 0; k < 3; ++k )
	{
		const int next = ( k + 1 ) % 3;
		const Vec3d edge = corner[next] - corner[k];
		const double t = std::clamp( ( to - corner[k] ).dot( edge ) / std::max( edge.squaredNorm(), kNoArea ), 0.0, 1.0 );
		const double distance = ( corner[k] + t * edge - to ).squaredNorm();
		if ( least < 0.0 || distance < least )
		{
			least = distance;
			best.setZero();
			best[k] = 1.0 - t;
			best[next] = t;
		}
	}
	return best;
}

bool meets( const Vec3d& from, const Vec3d& along, double radius, const Vec3d ( &corner )[3], double limit, TriangleHit& hit )
{
	const auto at = [&corner]( const Vec3d& weights ) {
		return Vec3d( weights[0] * corner[0] + weights[1] * corner[1] + weights[2] * corner[2] );
	};
	const auto finish = [&]( double t ) {
		hit.fraction = t;
		const Vec3d centre = from + t * along;
		hit.weights = nearestWeights( centre, corner );
		hit.point = at( hit.weights );
		hit.normal = ( centre - hit.point ).normalized();
		return true;
	};
	const Vec3d start = from - at( nearestWeights( from, corner ) );
	if ( start.squaredNorm() <= radius * radius )
	{
		return start.dot( along ) < 0.0 && finish( 0.0 );
	}
	double first = limit, t = 0.0;
	bool isMet = false;
	const Vec3d area = ( corner[1] - corner[0] ).cross( corner[2] - corner[0] );
	if ( const double size = area.norm(); size > 0.0 )
	{
		// The face, moved by the radius towards where the sphere is.
		const Vec3d normal = ( from - corner[0] ).dot( area ) >= 0.0 ? Vec3d( area / size ) : Vec3d( -area / size );
		const double speed = along.dot( normal );
		t = speed < 0.0 ? ( radius - ( from - corner[0] ).dot( normal ) ) / speed : -1.0;
		Vec3d weights;
		if ( t >= 0.0 && t <= first && weightsOf( from + t * along - radius * normal, corner, area, weights ) && weights.minCoeff() >= 0.0 )
		{
			return finish( t );
		}
	}
	for ( int k = 0; k < 3; ++k )
	{
		const Vec3d edge = corner[( k + 1 ) % 3] - corner[k];
		const double length = edge.norm();
		if ( length > 0.0 && meetsRound( from - corner[k], along, edge / length, radius, first, t ) )
		{
			const double on = ( from + t * along - corner[k] ).dot( edge ) / length;
			if ( on >= 0.0 && on <= length )
			{
				first = t;
				isMet = true;
			}
		}
		if ( meetsRound( from - corner[k], along, Vec3d::Zero(), radius, first, t ) )
		{
			first = t;
			isMet = true;
		}
	}
	return isMet && finish( first );
}

} // namespace pliant
