#pragma once

// Which bodies touch, one event a pair instead of one manifold a node.

#include <LinearMath/btVector3.h>

class btCollisionObject;

namespace pliant {

class SoftBody;

/// A soft body and an object that it touches, in the last stepSimulation. For bodies with SoftBody::setContactEvents only; if both bodies
/// of a pair have it, each has an event of its own. A sleeping pair has none.
struct ContactEvent
{
	SoftBody* body = nullptr;           ///< null once it has left the world
	btCollisionObject* other = nullptr; ///< a rigid body, a soft one, a ghost, ...; null once it has left the world
	SoftBody* otherSoft = nullptr;      ///< the same where it is soft
	bool began = false;                 ///< they did not touch before
	bool ended = false;                 ///< they do not touch any more. A pair also ends, without an event, when one of them is removed
	btScalar impulse = btScalar( 0 );   ///< sum of the normal impulses, of all steps and substeps, N s
	btVector3 push;                     ///< the same as a vector, on `body`, without friction, N s
	btVector3 position;                 ///< where: the mean weighted by impulses; without impulses a point of contact. World, m
};

} // namespace pliant
