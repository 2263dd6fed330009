#pragma once

// Where a body is put: a rigid transform of Bullet's in the core's terms, and what is refused of one.

#include "body/body.h"
#include "world/bodies/soft_body_impl.h"

#include <string>

namespace pliant {

inline Eigen::Quaterniond rotationOf( const btTransform& t )
{
	const btQuaternion q = t.getRotation();
	return Eigen::Quaterniond( q.w(), q.x(), q.y(), q.z() ).normalized();
}

/// Where the lattice's mass centre goes when its mesh goes through `t`.
inline Placement placementOf( const Lattice& lattice, const btTransform& t )
{
	const Eigen::Quaterniond rotation = rotationOf( t );
	return Placement{ rotation, rotation * lattice.massCentre + toVec3d( t.getOrigin() ) };
}

inline Status refused( const char* call, const std::string& why )
{
	return Status{ ResultCode::BadArgument, std::string( call ) + ": " + why };
}

/// Ok for a rotation and a translation to a place that Bullet can hold.
Status checkTransform( const btTransform& transform, const char* call );

/// Ok for three finite numbers.
Status checkVector( const btVector3& vector, const char* call, const char* what );

} // namespace pliant
