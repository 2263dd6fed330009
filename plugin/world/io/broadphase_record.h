#pragma once

// The broadphase as bytes. In which order it finds new pairs decides on the order of contacts, and so on the last bits of a step. That
// order follows from the trees of a btDbvtBroadphase, which follow from all earlier steps; so the trees are stored as they are. Other
// broadphases get the objects' boxes.

#include "archive/archive.h"

#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>
#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <LinearMath/btAlignedObjectArray.h>

#include <vector>

class btDispatcher;

namespace pliant {

class BroadphaseRecord
{
public:
	using Objects = btAlignedObjectArray<btCollisionObject*>;

	/// `withTrees`: false: the boxes only.
	static BroadphaseRecord of( btBroadphaseInterface& broadphase, const Objects& objects, bool withTrees );
	/// For the same objects in the same order. Call when there are no pairs.
	void applyTo( btBroadphaseInterface& broadphase, Objects& objects, btDispatcher* dispatcher ) const;
	/// `objects`: their number.
	void archive( Archive& archive, int objects );

private:
	struct Box
	{
		btVector3 low = btVector3( 0, 0, 0 ), high = btVector3( 0, 0, 0 );
		void archive( Archive& archive );
	};
	/// Nodes of a tree, parents before children: the first child's branch, then the second's.
	struct Node
	{
		Box box;
		int object = -1;        ///< of a leaf; -1: it has two children
		std::uint32_t rank = 0; ///< by address, by which btDbvt orders nodes when it balances the tree
		void archive( Archive& archive );
	};
	struct Tree
	{
		std::vector<Node> nodes;
		bool hasFree = false; ///< the tree keeps an unused node
		std::uint32_t freeRank = 0;
		int lookahead = -1;
		unsigned path = 0;
		void archive( Archive& archive );
	};
	struct Proxy
	{
		Box box;
		int stage = 0, id = 0;
		void archive( Archive& archive );
	};

	static btDbvtBroadphase* treesOf( btBroadphaseInterface& broadphase );
	static void readTree( const btDbvt& from, Tree& tree );
	void fillTree( const Tree& tree, btDbvt& to, const Objects& objects ) const;
	void readTrees( const btDbvtBroadphase& from, const Objects& objects );
	void fillTrees( btDbvtBroadphase& to, const Objects& objects ) const;
	bool areComplete( int objects ) const;
	bool areStaged() const;

	std::vector<Proxy> m_proxies; ///< by object
	bool m_hasTrees = false;
	Tree m_trees[2];
	std::vector<int> m_stages[3]; ///< objects of each list of the broadphase, in its order
	int m_counters[8] = {};
	unsigned m_calls = 0, m_done = 0;
	bool m_needsCleanup = false;
};

} // namespace pliant
