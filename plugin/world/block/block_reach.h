#pragma once

// Chooses the rigid bodies of an island that its block solves: all of a small island; in a large one those nearest to its soft
// bodies by number of contacts, because the block's coarse system grows with them. Bullet solves the contacts of the others.

#include <vector>

class btCollisionObject;
class btDispatcher;
class btPersistentManifold;

namespace pliant {

class BlockLookup;

class Attachments;

class BlockReach
{
public:
	/// Chooses from the current contacts. `blocks`: the number of blocks.
	void choose( btDispatcher& dispatcher, const Attachments& attachments, const BlockLookup& lookup, int blocks );
	bool takesPart( int block, const btCollisionObject& rigid ) const;

private:
	struct Edge
	{
		int a, b, block; ///< indices of two rigid bodies in the world
	};
	void addManifold( const btPersistentManifold& manifold, const BlockLookup& lookup );
	void addBody( const btCollisionObject& rigid, int block, bool touchesSoft );
	bool addRing();

	std::vector<unsigned char> m_takesPart, m_isKnown; ///< by a rigid body's index in the world
	std::vector<Edge> m_edges;
	std::vector<int> m_rigidCount, m_taken; ///< by block: number of rigid bodies, and of those that take part
	std::vector<int> m_next;                ///< scratch
};

} // namespace pliant
