#pragma once

// A box tested against many spheres, as boxes and floors in a heap are: values that do not depend on the sphere are computed once, distant
// spheres are rejected without a square root, and spheres over a face need none.

#include "world/constants.h"
#include "world/touch/node_touch.h"

#include <cmath>

namespace pliant {

class BoxTouch
{
public:
	/// `box`: of type BOX_SHAPE_PROXYTYPE; it must outlive this object unmoved.
	explicit BoxTouch( const Obstacle& box );

	/// The result of findTouch, with identical bits.
	bool find( const MovingSphere& sphere, Touch& touch ) const
	{
		const Vec3d p = m_box.toLocal( sphere.centre );
		const Vec3d out = p - p.cwiseMin( m_half ).cwiseMax( -m_half );
		const double touchDistance = sphere.touchDistance(), square = out.squaredNorm();
		if ( square > touchDistance * touchDistance )
		{
			// Out of reach for any direction of motion:   |out| > r ( 1 + slop ) + |w|
			const double farthest = ( touchDistance + std::sqrt( sphere.displacement.squaredNorm() ) ) * ( 1.0 + kFarSlack );
			if ( square > farthest * farthest )
			{
				return false;
			}
		}
		touch = nearest( p, out, square );
		return touch.distance <= touchDistance || !sphere.isFast() ? sphere.reaches( touch.normal, touch.distance )
																   : findTouch( m_box, sphere, touch );
	}

private:
	// Beyond one face only, the normal is an axis and the distance is the root of one square; inside, the nearest face counts.
	Touch nearest( const Vec3d& p, const Vec3d& out, double square ) const
	{
		if ( ( out.array() != 0.0 ).count() > 1 )
		{
			const double length = std::sqrt( square );
			return Touch{ m_box.basis * ( out / length ), length };
		}
		int axis = 0;
		( m_half - p.cwiseAbs() ).minCoeff( &axis );
		const Vec3d face = m_box.basis.col( axis );
		return Touch{ p[axis] < 0.0 ? Vec3d( -face ) : face, std::abs( p[axis] ) - m_half[axis] };
	}

	const Obstacle& m_box;
	Vec3d m_half; ///< half edges, m
};

} // namespace pliant
