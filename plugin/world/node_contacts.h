#pragma once

// Soft body against anything: a collision algorithm that makes one manifold a touching node, between the node's stand-in and the other
// object, so that Bullet's own solver does the rest. Registered by the world for pairs with a compound; other compounds pass through.

#include "world/node_body.h"
#include "world/node_search.h"
#include "world/parting.h"
#include "world/self_search.h"

#include <BulletCollision/BroadphaseCollision/btCollisionAlgorithm.h>
#include <BulletCollision/CollisionDispatch/btCollisionCreateFunc.h>

#include <cstdint>
#include <vector>

class btManifoldResult;

namespace pliant {

/// One touching node (or pair of nodes) and what Bullet keeps for it.
struct NodeContact
{
	std::uint64_t key = 0; ///< NodeHit's
	NodeBody* first = nullptr;
	NodeBody* second = nullptr; ///< soft against soft only
	btPersistentManifold* manifold = nullptr;
};

class PairContacts;

/// What the pairs of one world use in turn: with a search of its own each pair would have some kB that are nowhere near when its turn comes.
struct PairScratch
{
	NodeSearch search;
	std::vector<NodeContact> contacts;
	PairContacts* last = nullptr; ///< whose turn it was
};

/// All contacts of one pair of objects, in the order of their keys.
class PairContacts
{
public:
	BT_DECLARE_ALIGNED_ALLOCATOR();

	PairContacts( btDispatcher& dispatcher, NodeBodyPool& pool, PairScratch& scratch ) : m_dispatcher( dispatcher ), m_pool( pool ), m_scratch( scratch ) {}
	~PairContacts();

	void process( const btCollisionObjectWrapper& body0, const btCollisionObjectWrapper& body1, double step );
	/// A body's contacts with itself.
	void processSelf( SoftBody& soft, SelfSearch& search, double step );
	/// How many there are.
	int count() const { return int( m_contacts.size() ); }
	void collectManifolds( btManifoldArray& manifolds ) const;

private:
	/// The two objects as Bullet ordered them; `soft` is the one whose nodes the keys name first; `other` where that is rigid.
	struct Pair
	{
		SoftBody* soft;
		SoftBody* otherSoft;
		const btCollisionObject* other;
		bool softIsFirst;
	};

	void followNodes( const SoftBody* soft0, const SoftBody* soft1 );
	void askAhead( std::size_t contact ) const;
	void matchHits( const Pair& pair, const std::vector<NodeHit>& hits );
	void open( const Pair& pair, NodeContact& contact );
	void write( const Pair& pair, NodeContact& contact, const NodeHit* hits, int count );
	void drop( NodeContact& contact );

	btDispatcher& m_dispatcher;
	NodeBodyPool& m_pool;
	PairScratch& m_scratch;
	std::vector<NodeContact> m_contacts;
	Parting m_parting;
	bool m_isNew = true; ///< it has not been looked at yet
	const void* m_after = nullptr; ///< whose turn it was next: asked for, and else not looked at, as it may be gone
	unsigned m_numbering = 0; ///< of both bodies, when their nodes were last followed
};

/// Bullet's pools give an algorithm a fixed room: this one holds a pointer only.
class NodeAlgorithm : public btCollisionAlgorithm
{
public:
	NodeAlgorithm( const btCollisionAlgorithmConstructionInfo& info, NodeBodyPool& pool, PairScratch& scratch );
	~NodeAlgorithm() override;

	void processCollision( const btCollisionObjectWrapper* body0, const btCollisionObjectWrapper* body1, const btDispatcherInfo& info,
		btManifoldResult* result ) override;
	btScalar calculateTimeOfImpact( btCollisionObject*, btCollisionObject*, const btDispatcherInfo&, btManifoldResult* ) override
	{
		return btScalar( 1 );
	}
	void getAllContactManifolds( btManifoldArray& manifolds ) override { m_contacts->collectManifolds( manifolds ); }

private:
	PairContacts* m_contacts;
};

/// Creates NodeAlgorithm where a soft body takes part, and asks the function that was there before for all else.
class NodeCreateFunc : public btCollisionAlgorithmCreateFunc
{
public:
	NodeCreateFunc( btCollisionAlgorithmCreateFunc* before, NodeBodyPool& pool, PairScratch& scratch ) : m_before( before ), m_pool( pool ), m_scratch( scratch ) {}
	btCollisionAlgorithm* CreateCollisionAlgorithm( btCollisionAlgorithmConstructionInfo& info, const btCollisionObjectWrapper* body0,
		const btCollisionObjectWrapper* body1 ) override;

private:
	btCollisionAlgorithmCreateFunc* m_before;
	NodeBodyPool& m_pool;
	PairScratch& m_scratch;
};

} // namespace pliant
