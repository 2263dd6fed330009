#pragma once

// Which rigid bodies of an island take part in the solution of its implicit block. All of a small island; of a large one those nearest to
// its soft bodies by contacts, for the block's coarse system grows with them. Contacts of the others are Bullet's.

#include <vector>

class btCollisionObject;
class btDispatcher;
class btPersistentManifold;

namespace pliant {

class BlockPositions;

class ImplicitReach
{
public:
	/// From the contacts there are. `blocks`: how many there are.
	void choose( btDispatcher& dispatcher, const BlockPositions& positions, int blocks );
	bool takesPart( int block, const btCollisionObject& rigid ) const;

private:
	struct Edge
	{
		int a, b, block; ///< indices of two rigid bodies in the world
	};
	void look( const btPersistentManifold& manifold, const BlockPositions& positions );
	void note( const btCollisionObject& rigid, int block, bool touchesSoft );
	bool addRing();

	std::vector<unsigned char> m_isIn, m_isKnown; ///< by a rigid body's index in the world
	std::vector<Edge> m_edges;
	std::vector<int> m_bodies, m_taken; ///< by block: rigid bodies there are, and those that take part
	std::vector<int> m_next;            ///< scratch
};

} // namespace pliant
