#pragma once

// The nodes of one body as flat arrays, component by component, padded to whole lanes.

#include "matching/aligned_array.h"
#include "matching/constants.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <cstdint>
#include <utility>

namespace pliant {

class Archive;

/// One array per component, each `padded` long; entries from `count` on are zero.
struct Vec3Array
{
	AlignedArray<float> x, y, z;

	void resize( int padded )
	{
		x.assign( padded, 0.0f );
		y.assign( padded, 0.0f );
		z.assign( padded, 0.0f );
	}
	Eigen::Vector3f get( int i ) const { return { x[i], y[i], z[i] }; }
	void set( int i, const Eigen::Vector3f& value )
	{
		x[i] = value.x();
		y[i] = value.y();
		z[i] = value.z();
	}
};

struct NodeState
{
	int count = 0;
	int padded = 0; ///< count rounded up to a multiple of kLanes

	/// World position of the local frame, m. Positions `x` are relative to it, so that precision is the same everywhere in the world.
	Eigen::Vector3d origin = Eigen::Vector3d::Zero();

	Vec3Array x;                 ///< position relative to origin, m
	Vec3Array v;                 ///< velocity, m/s
	Vec3Array x0;                ///< rest position relative to the rest mass centre, m
	AlignedArray<float> mass;    ///< kg
	AlignedArray<float> freedom; ///< 1, or exactly 0 for a pinned node and for padding

	/// External force, N. Empty until the first force on a single node is set.
	Vec3Array force;

	/// Writes or reads everything but rest positions, for nodes whose count is set.
	void archive( Archive& archive );
	Eigen::Vector3d worldPosition( int i ) const { return origin + x.get( i ).cast<double>(); }
	bool hasHeldNodes() const
	{
		return std::any_of( freedom.begin(), freedom.begin() + count, []( float value ) { return value == 0.0f; } );
	}
	/// The smallest and the largest component of any velocity along each axis, m/s.
	std::pair<Eigen::Vector3f, Eigen::Vector3f> velocityBounds() const
	{
		Eigen::Vector3f low = v.get( 0 ), high = low;
		for ( int i = 1; i < count; ++i )
		{
			low = low.cwiseMin( v.get( i ) );
			high = high.cwiseMax( v.get( i ) );
		}
		return { low, high };
	}
};

} // namespace pliant
