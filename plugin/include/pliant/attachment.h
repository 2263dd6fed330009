#pragma once

// Two-way attachments: a point of a soft body attached to a point of a rigid body or of another soft body.

#include <LinearMath/btScalar.h>
#include <LinearMath/btVector3.h>

class btCollisionObject;

namespace pliant {

class SoftBody;

/// How an attachment holds.
struct AttachmentSettings
{
	/// Compliance: distance between the two points per force, m/N; 0 (the default): rigid. Must be finite and not negative.
	btScalar compliance = btScalar( 0 );
	/// The force at which it breaks, N; above 0; default: never.
	btScalar breakingForce = SIMD_INFINITY;
};

/// An attachment that broke because its force exceeded AttachmentSettings::breakingForce.
struct AttachmentEvent
{
	int id = -1;                               ///< as attach returned it
	SoftBody* body = nullptr;                  ///< the first body
	SoftBody* other = nullptr;                 ///< the second, if it is soft
	btCollisionObject* rigid = nullptr;        ///< the second, if it is a rigid body or a multibody's link
	btVector3 force = btVector3( 0, 0, 0 );    ///< on the first body when it broke, N
	btVector3 position = btVector3( 0, 0, 0 ); ///< where it held the first body, world, m
};

} // namespace pliant
