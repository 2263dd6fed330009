#pragma once

// C++: both faces on one world. Handles of worlds that C++ owns, and the objects behind identities.

#include "pliant/c/types.h"
#include "pliant/export.h"

#include <memory>

class btCollisionObject;

namespace pliant {

class BodyTemplate;
class SoftBodyHost;

/// As pliant_world_wrap, with a type.
PLIANT_API pliant_result wrapWorld( SoftBodyHost& world, pliant_world** made );
/// The world behind a handle, made by C or wrapped; null for null. Valid as long as the handle.
[[nodiscard]] PLIANT_API SoftBodyHost* hostOf( pliant_world* world );
/// The object behind an identity (SoftBody::upcast, btRigidBody::upcast); null for one that is gone. Valid until it ends.
[[nodiscard]] PLIANT_API btCollisionObject* objectOf( pliant_world* world, pliant_id object );
/// The identity of an object in the world, given to it where it had none; 0 for one that is not in the world, and when out of memory.
[[nodiscard]] PLIANT_API pliant_id idOf( pliant_world* world, const btCollisionObject* object );
/// A handle of a template; the caller's to release. Errors: PLIANT_BAD_ARGUMENT for null, PLIANT_OUT_OF_MEMORY.
PLIANT_API pliant_result wrapTemplate( std::shared_ptr<const BodyTemplate> bodyTemplate, pliant_template** made );

} // namespace pliant
