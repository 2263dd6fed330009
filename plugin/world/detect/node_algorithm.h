#pragma once

// The collision algorithm that Bullet's dispatcher makes for a pair with a soft body, and how the dispatcher comes to know it.

#include <BulletCollision/BroadphaseCollision/btCollisionAlgorithm.h>
#include <BulletCollision/CollisionDispatch/btCollisionCreateFunc.h>

#include <memory>
#include <vector>

class btCollisionDispatcher;

namespace pliant {

class ContactProxyPool;
class PairContacts;
struct PairScratch;

/// Bullet's pools give an algorithm a fixed room: this one holds a pointer only.
class NodeAlgorithm : public btCollisionAlgorithm
{
public:
	NodeAlgorithm( const btCollisionAlgorithmConstructionInfo& info, ContactProxyPool& pool, PairScratch& scratch );
	~NodeAlgorithm() override;

	void processCollision( const btCollisionObjectWrapper* body0, const btCollisionObjectWrapper* body1, const btDispatcherInfo& info,
		btManifoldResult* result ) override;
	btScalar calculateTimeOfImpact( btCollisionObject*, btCollisionObject*, const btDispatcherInfo&, btManifoldResult* ) override
	{
		return btScalar( 1 );
	}
	void getAllContactManifolds( btManifoldArray& manifolds ) override;

private:
	PairContacts* m_contacts;
};

/// Creates NodeAlgorithm where a soft body takes part, and asks the function that was there before for all else. Knows no world: the soft
/// body does.
class NodeCreateFunc : public btCollisionAlgorithmCreateFunc
{
public:
	explicit NodeCreateFunc( btCollisionAlgorithmCreateFunc* before ) : m_before( before ) {}
	btCollisionAlgorithm* CreateCollisionAlgorithm(
		btCollisionAlgorithmConstructionInfo& info, const btCollisionObjectWrapper* body0, const btCollisionObjectWrapper* body1 ) override;
	btCollisionAlgorithmCreateFunc* before() const { return m_before; }

private:
	btCollisionAlgorithmCreateFunc* m_before;
};

/// A dispatcher's table of algorithms with ours in front of what was there, for all pairs with a compound, which is what a soft body's
/// shape is. The table of closest-point algorithms stays as it is: contact tests see a compound of spheres. So do the entries for GImpact
/// meshes, which games register themselves. One for all worlds that share a dispatcher; there as long as one of them has a soft body.
class AlgorithmTable
{
public:
	static std::shared_ptr<AlgorithmTable> of( btCollisionDispatcher& dispatcher );
	~AlgorithmTable();

	AlgorithmTable( const AlgorithmTable& ) = delete;
	AlgorithmTable& operator=( const AlgorithmTable& ) = delete;

	/// Once a step: what the game has registered since goes behind ours.
	void check();

private:
	struct Entry
	{
		int type0, type1;
		std::unique_ptr<NodeCreateFunc> ours;
	};

	explicit AlgorithmTable( btCollisionDispatcher& dispatcher );

	btCollisionDispatcher& m_dispatcher;
	std::vector<Entry> m_entries;
};

} // namespace pliant
