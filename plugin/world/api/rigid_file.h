#pragma once

// What Bullet's serializer is given of a world with soft bodies in it: all else.

#include <BulletCollision/CollisionDispatch/btCollisionObject.h>

class btDispatcher;
class btSerializer;

namespace pliant {

btCollisionObjectArray withoutSoftBodies( const btCollisionObjectArray& objects );

/// As btCollisionWorld::serializeContactManifolds, without the contacts of soft bodies.
void serializeRigidContacts( btDispatcher& dispatcher, btSerializer& serializer );

} // namespace pliant
