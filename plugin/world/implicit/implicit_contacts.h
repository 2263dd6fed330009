#pragma once

// From Bullet's manifolds to the contacts of implicit blocks and back: places, laws and the last substep's impulses come out of the contact
// points, and the impulses found go back into them, where games look for them. docs/design/implicit.md.

#include "world/implicit/implicit_block.h"

#include <LinearMath/btScalar.h>

#include <deque>
#include <vector>

class btCollisionObject;
class btPersistentManifold;
class btDispatcher;
struct btContactSolverInfo;

namespace pliant {

class ContactProxy;

/// Finds which block, and which part of it, a collision object is.
class BlockPositions
{
public:
	virtual ~BlockPositions() = default;
	/// The block of a soft body; -1: it takes part in none.
	virtual int blockOf( const SoftBody& body ) const = 0;
	/// The block of an island, by Bullet's tag; -1: it has none.
	virtual int blockOfIsland( int tag ) const = 0;
	virtual int softPart( const SoftBody& body ) const = 0;
	/// Whether a rigid body of the block's island is among those that it moves (implicit_reach.h).
	virtual bool takesPart( int block, const btCollisionObject& rigid ) const = 0;
	/// The part of a rigid body that can be moved in a block; made where it is missing.
	virtual int rigidPart( int block, btRigidBody& body ) = 0;
};

/// The contacts of one manifold with its blocks' bodies; true when there are any: they are then no concern of Bullet's solver.
class ImplicitContacts
{
public:
	/// Adds the contacts of all manifolds that name a node of a block's body, or two rigid bodies of its island, and hides them from
	/// Bullet's solver.
	void gather( btDispatcher& dispatcher, const btContactSolverInfo& info, BlockPositions& positions, std::deque<ImplicitBlock>& blocks );
	/// Impulses into the contact points; sleeping bodies that are pressed wake.
	static void writeBack( ImplicitBlock& block );
	/// Bullet may see them again.
	void show();
	int count() const { return m_count; }

private:
	void gatherFrom(
		btPersistentManifold& manifold, const btContactSolverInfo& info, BlockPositions& positions, std::deque<ImplicitBlock>& blocks );
	ContactSide sideOf( const btCollisionObject& object, int block, BlockPositions& positions, const Vec3d& at ) const;

	struct Hidden
	{
		btPersistentManifold* manifold;
		btScalar threshold;
	};
	std::vector<Hidden> m_hidden;
	int m_count = 0;
};

} // namespace pliant
