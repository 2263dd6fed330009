// +-----------------------------------------------------------------------------------------------------------------+
// | Solids as fields.                                                                                                |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/solids.h"

#include <algorithm>
#include <cmath>

namespace pliant_demos {

namespace {

float dot( const Point& a, const Point& b )
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

Point between( const Point& a, const Point& b )
{
	return { b[0] - a[0], b[1] - a[1], b[2] - a[2] };
}

} // namespace

float roundBox( const Point& p, const Point& centre, const Point& half, float radius )
{
	Point beyond;
	float inside = -half[0];
	for ( std::size_t k = 0; k < 3; ++k )
	{
		const float q = std::abs( p[k] - centre[k] ) - ( half[k] - radius );
		beyond[k] = std::max( q, 0.0f );
		inside = k == 0 ? q : std::max( inside, q );
	}
	return radius - std::sqrt( dot( beyond, beyond ) ) - std::min( inside, 0.0f );
}

float rod( const Point& p, const Point& a, const Point& b, float radiusA, float radiusB )
{
	const Point along = between( a, b ), from = between( a, p );
	const float t = std::clamp( dot( from, along ) / dot( along, along ), 0.0f, 1.0f );
	const Point off = { from[0] - t * along[0], from[1] - t * along[1], from[2] - t * along[2] };
	return radiusA + t * ( radiusB - radiusA ) - std::sqrt( dot( off, off ) );
}

float ellipsoid( const Point& p, const Point& centre, const std::array<Point, 3>& axes, const Point& radii )
{
	const Point from = between( centre, p );
	float square = 0;
	for ( std::size_t k = 0; k < 3; ++k )
	{
		const float d = dot( from, axes[k] ) / radii[k];
		square += d * d;
	}
	return ( 1 - std::sqrt( square ) ) * std::min( { radii[0], radii[1], radii[2] } );
}

float join( float a, float b, float fillet )
{
	// A parabola where the two distances are nearly equal.
	const float h = std::max( fillet - std::abs( a - b ), 0.0f ) / fillet;
	return std::max( a, b ) + 0.25f * fillet * h * h;
}

} // namespace pliant_demos
