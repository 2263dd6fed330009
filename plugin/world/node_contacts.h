#pragma once

// Soft body against anything: a collision algorithm that makes one manifold a touching node, between the node's stand-in and the other
// object, so that Bullet's own solver does the rest. Registered by the world for pairs with a compound; other compounds pass through.

#include "world/node_body.h"

#include <BulletCollision/BroadphaseCollision/btCollisionAlgorithm.h>
#include <BulletCollision/CollisionDispatch/btCollisionCreateFunc.h>

#include <cstdint>
#include <memory>
#include <vector>

class btCollisionDispatcher;
class btManifoldResult;

namespace pliant {

/// One touching node (or pair of nodes) and what Bullet keeps for it.
struct NodeContact
{
	std::uint64_t key = 0;                    ///< node, or ( node of the first body ) << 32 | node of the second
	NodeBody* first = nullptr;
	NodeBody* second = nullptr;               ///< soft against soft only
	btPersistentManifold* manifold = nullptr; ///< closed forms: ours
	btCollisionAlgorithm* algorithm = nullptr; ///< other shapes: Bullet's own, which keeps its manifolds itself
};

/// All contacts of one pair of objects, in the order of their keys.
class PairContacts
{
public:
	PairContacts( btDispatcher& dispatcher, NodeBodyPool& pool ) : m_dispatcher( dispatcher ), m_pool( pool ) {}
	~PairContacts();

	void process( const btCollisionObjectWrapper* body0, const btCollisionObjectWrapper* body1, const btDispatcherInfo& info,
		btManifoldResult& result );
	void collectManifolds( btManifoldArray& manifolds ) const;

private:
	struct Side
	{
		const btCollisionObjectWrapper* wrapper;
		bool isFirst; ///< of the two objects as Bullet ordered them
	};

	void processRigid( SoftBody& soft, const Side& softSide, const btCollisionObjectWrapper* other, const btDispatcherInfo& info,
		btManifoldResult& result );
	void processSoft( SoftBody& a, SoftBody& b, const btDispatcherInfo& info, btManifoldResult& result );
	void findCandidates( SoftBody& soft, const btCollisionObjectWrapper* other, btScalar step );
	void findSoftCandidates( SoftBody& a, SoftBody& b );
	void matchEntries();
	void drop( NodeContact& contact );
	void closedForm( NodeContact& contact, const btCollisionObjectWrapper* other, bool softIsFirst, btScalar step, btManifoldResult& result );
	void stockForm( NodeContact& contact, const btCollisionObjectWrapper* other, bool softIsFirst, const btDispatcherInfo& info,
		btManifoldResult& result );
	void softSoft( NodeContact& contact, btScalar step, btManifoldResult& result );

	btDispatcher& m_dispatcher;
	NodeBodyPool& m_pool;
	std::vector<NodeContact> m_contacts, m_next;
	std::vector<std::uint64_t> m_candidates;
};

/// Bullet's pools give an algorithm a fixed room: this one holds a pointer only.
class NodeAlgorithm : public btCollisionAlgorithm
{
public:
	NodeAlgorithm( const btCollisionAlgorithmConstructionInfo& info, NodeBodyPool& pool );
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
	NodeCreateFunc( btCollisionAlgorithmCreateFunc* before, NodeBodyPool& pool ) : m_before( before ), m_pool( pool ) {}
	btCollisionAlgorithm* CreateCollisionAlgorithm( btCollisionAlgorithmConstructionInfo& info, const btCollisionObjectWrapper* body0,
		const btCollisionObjectWrapper* body1 ) override;

private:
	btCollisionAlgorithmCreateFunc* m_before;
	NodeBodyPool& m_pool;
};

} // namespace pliant
