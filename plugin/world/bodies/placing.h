#pragma once

// Placement of a body: converts and validates Bullet's transforms.

#include "body/body.h"
#include "world/bodies/soft_body_impl.h"

#include <string>

namespace pliant {

inline Eigen::Quaterniond rotationOf( const btTransform& t )
{
	const btQuaternion q = t.getRotation();
	return Eigen::Quaterniond( q.w(), q.x(), q.y(), q.z() ).normalized();
}

/// Returns the placement of the lattice's centre of mass when its mesh is transformed by `t`.
inline Placement placementOf( const Lattice& lattice, const btTransform& t )
{
	const Eigen::Quaterniond rotation = rotationOf( t );
	return Placement{ rotation, rotation * lattice.massCentre + toVec3d( t.getOrigin() ) };
}

inline Status refused( const char* call, const std::string& why )
{
	return Status{ ResultCode::BadArgument, std::string( call ) + ": " + why };
}

/// The sentence of a refused call from a force field.
inline constexpr const char* kInField = "force fields are being evaluated; they may query the world but not change it.";

/// Returns ok for a rotation and a translation to a position that Bullet can represent.
Status checkTransform( const btTransform& transform, const char* call );

/// Returns ok for three finite numbers.
Status checkVector( const btVector3& vector, const char* call, const char* what );

} // namespace pliant
