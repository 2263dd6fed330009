#pragma once

// The children of compounds as a snapshot keeps them: which of them have an algorithm, and so manifolds, depends on where their boxes met
// in the last step, not on where the objects are now.

#include "archive/archive.h"

#include <BulletCollision/BroadphaseCollision/btCollisionAlgorithm.h>
#include <BulletCollision/BroadphaseCollision/btDispatcher.h>
#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionDispatch/btManifoldResult.h>

#include <vector>

namespace pliant {

/// A child of a compound with an algorithm of its own, or two children of two compounds.
struct ChildPair
{
	int first = -1, second = -1; ///< second: -1 where only one of the objects is a compound
	void archive( Archive& archive ) { archive( first, second ); }
};

/// Returns the pairs in the order in which the algorithm lists their manifolds; none for the algorithm of other shapes.
std::vector<ChildPair> childrenOf( btCollisionAlgorithm& algorithm );

/// Two objects as Bullet's algorithms take them.
struct WrappedPair
{
	btCollisionObjectWrapper first, second;
	WrappedPair( const btCollisionObject& a, const btCollisionObject& b );
};

/// Makes the manifolds that a new algorithm had, without points: of compounds those of the given children, in this order. Numbers of
/// children that the shapes do not have are left out. No callback of the game is called.
void makeManifolds( btCollisionAlgorithm& algorithm, const std::vector<ChildPair>& children, const WrappedPair& pair,
	btDispatcher& dispatcher, const btDispatcherInfo& info );

} // namespace pliant
