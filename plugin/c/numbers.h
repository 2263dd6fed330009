#pragma once

// Numbers of the C face as Bullet's, and back.

#include "c/call.h"
#include "c/constants.h"
#include "pliant/c/types.h"

#include <LinearMath/btTransform.h>

#include <cmath>
#include <cstdint>
#include <limits>

namespace pliant::c {

inline bool isNumber( const btVector3& v )
{
	return std::isfinite( v.x() ) && std::isfinite( v.y() ) && std::isfinite( v.z() );
}

/// Not finite where the number is not, or is beyond the range of btScalar.
inline btVector3 vectorOf( const pliant_vec3& v )
{
	return btVector3( btScalar( v.x ), btScalar( v.y ), btScalar( v.z ) );
}

inline pliant_vec3 vectorOf( const btVector3& v )
{
	return pliant_vec3{ double( v.x() ), double( v.y() ), double( v.z() ) };
}

/// Whether all components are at most `most`; false for NaN.
inline bool isWithin( const pliant_vec3& v, double most )
{
	return std::fabs( v.x ) <= most && std::fabs( v.y ) <= most && std::fabs( v.z ) <= most;
}

inline bool isWithin( const btVector3& v, double most )
{
	return isWithin( vectorOf( v ), most );
}

/// Whether `low` <= x <= `high`; false for NaN.
inline bool isWithin( double x, double low, double high )
{
	return x >= low && x <= high;
}

/// Rejects a bad number, a position too far out and a quaternion of no length, with a code and a sentence.
inline btTransform takePose( const pliant_pose& pose, pliant_result code = PLIANT_BAD_ARGUMENT,
	const char* sentence = "The pose must be within 1e9 m, with a quaternion that is not zero." )
{
	const double* const q = pose.rotation;
	const double square = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
	rejectIf( !isWithin( pose.position, kMostPosition ) || !isWithin( square, 1e-12, 1e12 ), code, sentence );
	return btTransform( btQuaternion( btScalar( q[0] ), btScalar( q[1] ), btScalar( q[2] ), btScalar( q[3] ) ), vectorOf( pose.position ) );
}

/// The same for an argument of a call, which may be null.
inline btTransform readPose( const pliant_pose* pose )
{
	requirePointers( pose );
	return takePose( *pose );
}

inline pliant_pose poseOf( const btTransform& transform )
{
	const btQuaternion q = transform.getRotation();
	return pliant_pose{ vectorOf( transform.getOrigin() ), { double( q.x() ), double( q.y() ), double( q.z() ), double( q.w() ) } };
}

/// User data as Bullet keeps it.
inline void* userPointer( std::uint64_t data )
{
	rejectIf( data > std::numeric_limits<std::uintptr_t>::max(), PLIANT_BAD_ARGUMENT,
		"The user data does not fit into a pointer of this machine." );
	return reinterpret_cast<void*>( std::uintptr_t( data ) );
}

constexpr pliant_pose kOrigin = { { 0, 0, 0 }, { 0, 0, 0, 1 } };

} // namespace pliant::c
