#pragma once

// Converts Bullet's manifolds to the contacts of blocks and back: positions, friction, restitution and the last substep's impulses
// are read from the contact points, and the solved impulses are written to them for callers. docs/design/implicit.md.

#include "world/block/block_reach.h"
#include "world/block/island_block.h"

#include <LinearMath/btScalar.h>

#include <deque>
#include <vector>

class btCollisionObject;
class btPersistentManifold;
struct btContactSolverInfo;

namespace pliant {

class Attachments;
class ContactProxy;

/// Maps collision objects to blocks and their parts.
class BlockLookup
{
public:
	virtual ~BlockLookup() = default;
	/// Returns the block of a soft body; -1: none.
	virtual int blockOf( const SoftBody& body ) const = 0;
	/// Returns the block of the island with Bullet's tag; -1: none.
	virtual int blockOfIsland( int tag ) const = 0;
	virtual int softPart( const SoftBody& body ) const = 0;
	/// Returns true if the block moves a rigid body of its island (block_reach.h).
	virtual bool takesPart( int block, const btCollisionObject& rigid ) const = 0;
	/// Returns the part of a movable rigid body or link in a block, creating it if necessary; -1 for a link that is held.
	virtual int rigidPart( int block, btCollisionObject& object ) = 0;
};

/// Gathers the contacts that blocks solve, and hides them from Bullet's solver.
class BlockContacts
{
public:
	/// Adds the contacts of those manifolds with a node of a block's body or with two rigid bodies of its island, and hides these.
	/// `manifolds`: all that may be in blocks, and those of `taken`, to which the hidden ones are added.
	void gather( const std::vector<btPersistentManifold*>& manifolds, const btContactSolverInfo& info, BlockLookup& lookup,
		std::deque<IslandBlock>& blocks, ManifoldFilter& taken );
	/// Adds the attachments of the blocks' bodies. `h` in s.
	void gatherAttachments( Attachments& attachments, double h, BlockLookup& lookup, std::deque<IslandBlock>& blocks );
	/// Stores the forces of a block's attachments.
	static void storeForces( const IslandBlock& block, Attachments& attachments );
	/// Writes the impulses to the contact points.
	static void writeBack( IslandBlock& block );
	/// Writes the impulses that the next substep starts from.
	static void carryImpulses( IslandBlock& block );
	/// Makes the hidden manifolds visible to Bullet again.
	void unhide();
	int count() const { return m_count; }

private:
	void gatherFrom(
		btPersistentManifold& manifold, const btContactSolverInfo& info, BlockLookup& lookup, std::deque<IslandBlock>& blocks );
	ContactSide sideOf( const btCollisionObject& object, int block, BlockLookup& lookup, const Vec3d& at ) const;

	struct Hidden
	{
		btPersistentManifold* manifold;
		btScalar threshold;
	};
	std::vector<Hidden> m_hidden;
	int m_count = 0;
};

} // namespace pliant
