#pragma once

// The collision algorithm that Bullet's dispatcher creates for pairs with a soft body, and its registration.

#include <BulletCollision/BroadphaseCollision/btCollisionAlgorithm.h>
#include <BulletCollision/CollisionDispatch/btCollisionCreateFunc.h>

#include <memory>
#include <vector>

class btCollisionDispatcher;

namespace pliant {

class ContactProxyPool;
class PairContacts;
struct PairScratch;

/// Bullet's pools give an algorithm a fixed capacity: this one holds a pointer only.
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

	PairContacts& contacts() { return *m_contacts; }

private:
	PairContacts* m_contacts;
};

/// Which of a dispatcher's two tables: contacts of a step, or the points of contact tests.
enum class AlgorithmKind : int
{
	Contacts,
	ContactTests
};

/// For contacts creates a NodeAlgorithm in the world of a soft body that takes part, for contact tests a SurfaceTest; delegates to the
/// previous function where no soft body takes part.
class NodeCreateFunc : public btCollisionAlgorithmCreateFunc
{
public:
	NodeCreateFunc( btCollisionAlgorithmCreateFunc* previous, AlgorithmKind kind ) : m_previous( previous ), m_kind( kind ) {}
	btCollisionAlgorithm* CreateCollisionAlgorithm(
		btCollisionAlgorithmConstructionInfo& info, const btCollisionObjectWrapper* body0, const btCollisionObjectWrapper* body1 ) override;
	btCollisionAlgorithmCreateFunc* previous() const { return m_previous; }

private:
	btCollisionAlgorithmCreateFunc* m_previous;
	AlgorithmKind m_kind;
};

/// Registers our create functions in a dispatcher's two tables, in front of the previous ones, for all pairs with a compound, which a soft
/// body's shape is. Shared by all worlds of a dispatcher; exists as long as one of them has a soft body.
class AlgorithmTable
{
public:
	static std::shared_ptr<AlgorithmTable> of( btCollisionDispatcher& dispatcher );
	~AlgorithmTable();

	AlgorithmTable( const AlgorithmTable& ) = delete;
	AlgorithmTable& operator=( const AlgorithmTable& ) = delete;

	/// Called once per step: puts functions that the game has registered since behind ours.
	void check();

private:
	struct Entry
	{
		int type0, type1;
		AlgorithmKind kind;
		std::unique_ptr<NodeCreateFunc> ours;
	};

	explicit AlgorithmTable( btCollisionDispatcher& dispatcher );

	btCollisionDispatcher& m_dispatcher;
	std::vector<Entry> m_entries;
};

} // namespace pliant
