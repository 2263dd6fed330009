#pragma once

// Contacts that a body at rest in its rigid state has lost. A contact ends when it has slid by a few millimetres, as slow bodies in heaps
// do again and again. Bullet finds one contact of a pair in a step, the deepest, which may be one that is still there: a shard that rested
// on three corners fell by a step's gravity over the other two, hit the floor at 2 rad/s and stayed awake.

#include <BulletCollision/BroadphaseCollision/btCollisionAlgorithm.h>

#include <vector>

class btDiscreteDynamicsWorld;
struct btBroadphasePair;
struct btDispatcherInfo;

namespace pliant {

class SoftBodySystem;

/// Moves the points of a pair with its objects (refreshContacts), and completes them where a body at rest has lost some.
void refreshPair( const btBroadphasePair& pair, btManifoldArray& manifolds, const btDispatcherInfo& info );

/// The same for pairs that are detected.
class LostContacts
{
public:
	/// Before detection: counts the contacts of bodies at rest.
	void note( const SoftBodySystem& bodies, btDiscreteDynamicsWorld& world );
	/// After it: completes the contacts of pairs that have fewer.
	void complete( btDiscreteDynamicsWorld& world );

private:
	struct Pair
	{
		int first, second; ///< of Bullet's unique numbers of broadphase proxies
		int contacts;

		bool isBefore( const Pair& other ) const { return first < other.first || ( first == other.first && second < other.second ); }
	};
	std::vector<Pair> m_pairs; ///< ascending
	btManifoldArray m_manifolds;
};

} // namespace pliant
