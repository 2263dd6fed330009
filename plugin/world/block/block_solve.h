#pragma once

// One block for each island that has a deformable body with contacts, attachments or the implicit step, solved before Bullet's own solver,
// which handles joints and the remaining rigid contacts. docs/design/implicit.md.

#include "world/block/block_contacts.h"
#include "world/block/block_reach.h"
#include "world/block/moved_object.h"

#include <deque>
#include <vector>

namespace pliant {

class SoftBodySystem;

/// The velocity change of a rigid body by joints and by contacts outside the blocks, smoothed over substeps.
struct OutsideImpulse
{
	const btCollisionObject* object = nullptr;
	Vector6 change = Vector6::Zero(); ///< e, m/s and rad/s
	unsigned stamp = 0;
};

class BlockSolve : private BlockLookup
{
public:
	/// The input of before().
	struct Scene
	{
		const std::vector<SoftBody*>& awake;
		Attachments& attachments;
		const JointGroup::Joints& joints; ///< of the pass
		btDispatcher& dispatcher;
		const btContactSolverInfo& info;
		btVector3 gravity;                                     ///< m/s^2
		ManifoldFilter& taken;                                 ///< the manifolds of all passes' blocks
		const std::vector<const btCollisionObject*>& onFrames; ///< rigid bodies on joints with frames
	};
	/// Solves the blocks of the awake bodies, sets the velocities of nodes and rigid bodies, and hides the blocks' contacts from Bullet.
	void before( const Scene& scene, TaskRunner* runner );
	/// Called after Bullet's solver: records its impulses on the rigid bodies as the expectation for the next substep.
	void after();
	/// Called once the impulses have been reported: sets those that the next substep starts from.
	void carryImpulses();
	void forget( const btCollisionObject& object );
	/// A block of an implicit body alone, without its contacts, ready to respond to impulses; until the next call.
	IslandBlock& responseBlock( SoftBody& body, TaskRunner* runner );

	/// The data that one substep passes to the next.
	const std::vector<OutsideImpulse>& carried() const { return m_outside; }
	void carry( std::vector<OutsideImpulse> from ) { m_outside = std::move( from ); }

	int blockCount() const { return int( m_tagOf.size() ); }
	const IslandBlock& block( int k ) const { return m_blocks[std::size_t( k )]; }
	int contacts() const { return m_contacts.count(); }
	const BlockCount& count() const { return m_count; } ///< maximum over all blocks

private:
	int blockOf( const SoftBody& body ) const override;
	int blockOfIsland( int tag ) const override;
	int softPart( const SoftBody& body ) const override;
	bool takesPart( int block, const btCollisionObject& rigid ) const override { return m_reach.takesPart( block, rigid ); }
	int rigidPart( int block, btCollisionObject& object ) override;

	void makeBlocks( const std::vector<SoftBody*>& awake, const Attachments& attachments );
	OutsideImpulse& outsideOf( const btCollisionObject& object );
	void storeVelocities( IslandBlock& block );

	std::deque<IslandBlock> m_blocks; ///< grows only
	std::vector<int> m_tagOf;         ///< island tag of each block
	IslandBlock m_responseBlock;
	BlockReach m_reach;
	BlockContacts m_contacts;
	MovedObjects m_moved;
	std::vector<OutsideImpulse> m_outside; ///< in order of first contact
	BlockCount m_count;
	double m_h = 0.0;
	unsigned m_stamp = 0;
};

} // namespace pliant
