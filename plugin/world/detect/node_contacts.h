#pragma once

// Contacts of a soft body: one manifold per touching node, between its contact proxy and the other object.

#include "world/respond/parting.h"
#include "world/search/node_search.h"
#include "world/self/self_search.h"
#include "world/shape/contact_proxy.h"

#include <BulletCollision/BroadphaseCollision/btCollisionAlgorithm.h>

#include <cstdint>
#include <mutex>
#include <vector>

class btManifoldResult;

namespace pliant {

/// One touching node (or pair of nodes) and the Bullet objects that belong to it.
struct NodeContact
{
	std::uint64_t key = 0; ///< NodeHit's
	ContactProxy* first = nullptr;
	ContactProxy* second = nullptr; ///< soft against soft only
	btPersistentManifold* manifold = nullptr;
};

class PairContacts;

/// Scratch shared by the pairs of one world: with some kB of its own each pair would miss the cache.
struct PairScratch
{
	NodeSearch search;
	std::vector<NodeContact> contacts;
	PairContacts* matching = nullptr; ///< whose contacts are being matched; null where a callback of the game has destroyed it
	std::size_t old = 0;              ///< number of its contacts already carried over into `contacts`, or dropped
	std::vector<PairContacts*> all;
	/// A dispatcher may call the algorithms of its pairs on several threads at a time (btCollisionDispatcherMt). Those only note that they
	/// were called; the pairs are processed afterwards.
	bool postponesAll = false; ///< in a btDiscreteDynamicsWorldMt, however many threads it has: the order must not depend on them
	std::vector<PairContacts*> postponed;
	std::mutex postponedMutex;

	/// Processes the postponed pairs in the order of their objects.
	void processPostponed();
};

/// All contacts of one pair of objects, in the order of their keys.
class PairContacts
{
public:
	BT_DECLARE_ALIGNED_ALLOCATOR();

	PairContacts( btDispatcher& dispatcher, ContactProxyPool& pool, PairScratch& scratch );
	~PairContacts();

	/// Called by the dispatcher. Processes the pair, at once or when all pairs were called (PairScratch::processPostponed).
	void meet( const btCollisionObjectWrapper& body0, const btCollisionObjectWrapper& body1, double step );
	/// Processes the pair if it was postponed and still exists.
	void processPostponed();
	/// Orders postponed pairs by their objects, independently of the threads that found them.
	static bool areInOrder( const PairContacts* a, const PairContacts* b );
	/// Finds a body's contacts with itself.
	void processSelf( SoftBody& soft, SelfSearch& search, double step );
	/// Number of contacts.
	int count() const { return int( m_contacts.size() ); }
	void collectManifolds( btManifoldArray& manifolds ) const;
	/// Null where there is none.
	const btPersistentManifold* anyManifold() const { return m_contacts.empty() ? nullptr : m_contacts.front().manifold; }
	/// The data that one collision phase passes to the next, in addition to the manifolds.
	struct Carried
	{
		bool isNew = true, wasProcessed = false;
		unsigned numbering = 0;
		Parting parting;
		std::vector<std::uint64_t> keys; ///< of the contacts
	};
	Carried carried() const;
	/// Fills new contacts of a pair, with manifolds that are empty still. Keys must be of nodes of the two.
	void carry( const Carried& from, const btCollisionObject& first, const btCollisionObject& second );
	void carrySelf( const Carried& from, SoftBody& soft );
	const std::vector<NodeContact>& contacts() const { return m_contacts; }
	const btCollisionAlgorithm* algorithm = nullptr; ///< that owns it; null: a body's contacts with itself

	/// Called after all pairs were processed: a pair that was not, though one of its objects is awake, has been refused by the game
	/// (setIgnoreCollisionCheck, a near callback), and releases its contacts.
	void releaseIfRefused();

private:
	/// The two objects in Bullet's order; `soft` is the one whose nodes come first in the keys; `other` is set where it is rigid.
	struct Pair
	{
		SoftBody* soft;
		SoftBody* otherSoft;
		const btCollisionObject* other;
		bool softIsFirst;
	};

	void process( const btCollisionObjectWrapper& body0, const btCollisionObjectWrapper& body1, double step );
	/// Lists the nodes that pressed the other, rigid, object in the last substep for the next search.
	void notePressed( const SoftBody& soft, double step );
	void enlist();
	static Pair pairOf( const btCollisionObject& first, const btCollisionObject& second );
	void carryOver( const Carried& from, const Pair& pair );
	bool followNodes( const SoftBody* soft0, const SoftBody* soft1 );
	void startMatching();
	void endMatching();
	void matchHits( const Pair& pair, const std::vector<NodeHit>& hits );
	void create( const Pair& pair, NodeContact& contact );
	bool write( const Pair& pair, const NodeContact& contact, const NodeHit* hits, int count );
	bool notify( btPersistentManifold& manifold, int index, int leaf );
	bool dropBefore( std::uint64_t key );
	void drop( const NodeContact& contact );
	void wakeBoth( const NodeContact& contact ) const;

	btDispatcher& m_dispatcher;
	ContactProxyPool& m_pool;
	PairScratch& m_scratch;
	std::vector<NodeContact> m_contacts;
	Parting m_parting;
	bool m_isNew = true;      ///< not processed yet
	unsigned m_numbering = 0; ///< of both bodies, when their nodes were last followed
	unsigned m_phase = 0;     ///< collision phase in which it was last processed
	std::size_t m_position;   ///< index in PairScratch::all; kNotListed before it was first processed
	/// The dispatcher's arguments, until the pair is processed; null if it is not postponed.
	const btCollisionObject* m_postponed[2] = { nullptr, nullptr };
	double m_postponedStep = 0.0; ///< s
};

} // namespace pliant
