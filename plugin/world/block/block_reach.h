#pragma once

// Chooses the rigid bodies of an island that its block solves: all of a small island; in a large one those that touch its soft bodies and
// those that rest on these, the nearest first, because the block's coarse system grows with them. Bullet solves the contacts of the others.
// Also lists the manifolds of these islands, so that those of other islands are visited once.

#include <LinearMath/btVector3.h>

#include <cstddef>
#include <cstdint>
#include <vector>

class btCollisionObject;
class btDispatcher;
class btPersistentManifold;

namespace pliant {

class BlockLookup;

class Attachments;

/// The manifolds that were added in this game step or the one before, by their addresses alone, since Bullet may have freed them. Others
/// may seem to be among them.
class ManifoldFilter
{
public:
	void beginStep() { ++m_step; }
	void add( const btPersistentManifold& manifold )
	{
		m_added.resize( kSlots, 0 );
		m_added[slot( manifold )] = m_last = m_step;
	}
	void addAll()
	{
		m_added.assign( kSlots, m_step );
		m_last = m_step;
	}
	bool mayContainAny() const { return m_last + 1 >= m_step; }
	bool mayContain( const btPersistentManifold& manifold ) const { return !m_added.empty() && m_added[slot( manifold )] + 1 >= m_step; }

private:
	static constexpr std::size_t kSlots = 4096, kBytes = 512; ///< a manifold takes more bytes than that
	static std::size_t slot( const btPersistentManifold& manifold )
	{
		return std::size_t( reinterpret_cast<std::uintptr_t>( &manifold ) / kBytes ) % kSlots;
	}

	std::uint64_t m_step = 2, m_last = 0; ///< the present step, and the last one in which any was added
	std::vector<std::uint64_t> m_added;   ///< by slot: the last step; empty before the first one
};

class BlockReach
{
public:
	/// Chooses from the current contacts. `blocks`: the number of blocks. `gravity`: m/s^2; zero: bodies rest on each other all around.
	/// `taken`: manifolds that were in blocks. `onFrames`: rigid bodies on joints with soft bodies, whose contacts Bullet solves together
	/// with these joints unless they touch a soft body.
	void choose( btDispatcher& dispatcher, const Attachments& attachments, const BlockLookup& lookup, int blocks, const btVector3& gravity,
		const ManifoldFilter& taken, const std::vector<const btCollisionObject*>& onFrames = {} );
	bool takesPart( int block, const btCollisionObject& rigid ) const;
	/// The manifolds with a soft body or in the island of a block, and those of `taken`, in Bullet's order.
	const std::vector<btPersistentManifold*>& manifolds() const { return m_manifolds; }

private:
	struct Edge
	{
		int a, b, block; ///< indices of the manifold's two rigid bodies in the world
		const btPersistentManifold* manifold;
	};
	bool addManifold( const btPersistentManifold& manifold, const BlockLookup& lookup );
	void addBody( const btCollisionObject& rigid, int block, bool touchesSoft, bool restsOnSoft );
	bool isCarried( const btPersistentManifold& manifold, bool isFirst ) const;
	bool addRing();

	std::vector<unsigned char> m_takesPart, m_isKnown; ///< by a rigid body's index in the world
	std::vector<unsigned char> m_isCarried;            ///< the same: it rests on a soft body
	std::vector<unsigned char> m_isOnFrame;            ///< the same: on a joint with a soft body
	btVector3 m_up = btVector3( 0, 0, 0 );             ///< of unit length, or zero
	std::vector<Edge> m_edges;
	std::vector<int> m_rigidCount, m_taken; ///< by block: number of rigid bodies, and of those that take part
	std::vector<int> m_next;                ///< scratch
	std::vector<btPersistentManifold*> m_manifolds;
};

} // namespace pliant
