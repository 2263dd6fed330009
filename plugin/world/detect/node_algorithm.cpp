#include "world/detect/node_algorithm.h"

#include "world/bodies/soft_body_impl.h"
#include "world/detect/node_contacts.h"
#include "world/step/soft_body_system.h"

#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionDispatch/btEmptyCollisionAlgorithm.h>

#include <mutex>
#include <new>
#include <utility>

namespace pliant {

namespace {

/// The soft body itself only: Bullet handles contact proxies that meet a compound.
SoftBodySystem* systemOf( const btCollisionObjectWrapper* wrapper )
{
	const SoftBody* const soft = asSoftBody( const_cast<btCollisionObject*>( wrapper->getCollisionObject() ) );
	return soft ? soft->impl().system : nullptr;
}

/// Reads the registered functions, for which Bullet has no accessor.
struct OpenDispatcher : btCollisionDispatcher
{
	static btCollisionAlgorithmCreateFunc* registered( const btCollisionDispatcher& dispatcher, int type0, int type1 )
	{
		return ( dispatcher.*( &OpenDispatcher::m_doubleDispatchContactPoints ) )[type0][type1];
	}
};

/// Tables of all dispatchers that serve a world with soft bodies. Worlds may be created on several threads.
struct Tables
{
	std::mutex mutex;
	std::vector<std::pair<const btCollisionDispatcher*, std::weak_ptr<AlgorithmTable>>> known;
};

Tables& tables()
{
	static Tables all;
	return all;
}

} // namespace

NodeAlgorithm::NodeAlgorithm( const btCollisionAlgorithmConstructionInfo& info, ContactProxyPool& pool, PairScratch& scratch ) :
	btCollisionAlgorithm( info ), m_contacts( new PairContacts( *info.m_dispatcher1, pool, scratch ) )
{
	m_contacts->algorithm = this;
}

NodeAlgorithm::~NodeAlgorithm()
{
	delete m_contacts;
}

void NodeAlgorithm::processCollision(
	const btCollisionObjectWrapper* body0, const btCollisionObjectWrapper* body1, const btDispatcherInfo& info, btManifoldResult* )
{
	m_contacts->process( *body0, *body1, double( info.m_timeStep ) );
}

void NodeAlgorithm::getAllContactManifolds( btManifoldArray& manifolds )
{
	m_contacts->collectManifolds( manifolds );
}

btCollisionAlgorithm* NodeCreateFunc::CreateCollisionAlgorithm(
	btCollisionAlgorithmConstructionInfo& info, const btCollisionObjectWrapper* body0, const btCollisionObjectWrapper* body1 )
{
	SoftBodySystem* const system0 = systemOf( body0 );
	SoftBodySystem* const system1 = systemOf( body1 );
	if ( !system0 && !system1 )
	{
		return m_previous->CreateCollisionAlgorithm( info, body0, body1 );
	}
	if ( system0 && system1 && system0 != system1 ) // objects of two worlds do not collide
	{
		void* const memory = info.m_dispatcher1->allocateCollisionAlgorithm( sizeof( btEmptyAlgorithm ) );
		return new ( memory ) btEmptyAlgorithm( info );
	}
	SoftBodySystem& system = system0 ? *system0 : *system1;
	void* const memory = info.m_dispatcher1->allocateCollisionAlgorithm( sizeof( NodeAlgorithm ) );
	return new ( memory ) NodeAlgorithm( info, system.pool, system.pairScratch );
}

std::shared_ptr<AlgorithmTable> AlgorithmTable::of( btCollisionDispatcher& dispatcher )
{
	Tables& all = tables();
	const std::lock_guard<std::mutex> lock( all.mutex );
	for ( std::size_t k = all.known.size(); k-- > 0; )
	{
		if ( all.known[k].second.expired() )
		{
			all.known.erase( all.known.begin() + std::ptrdiff_t( k ) );
		}
		else if ( all.known[k].first == &dispatcher )
		{
			return all.known[k].second.lock();
		}
	}
	std::shared_ptr<AlgorithmTable> table( new AlgorithmTable( dispatcher ) );
	all.known.emplace_back( &dispatcher, table );
	return table;
}

AlgorithmTable::AlgorithmTable( btCollisionDispatcher& dispatcher ) : m_dispatcher( dispatcher )
{
	for ( int type = 0; type < MAX_BROADPHASE_COLLISION_TYPES; ++type )
	{
		if ( type == GIMPACT_SHAPE_PROXYTYPE )
		{
			continue;
		}
		m_entries.push_back( Entry{ COMPOUND_SHAPE_PROXYTYPE, type, nullptr } );
		if ( type != COMPOUND_SHAPE_PROXYTYPE )
		{
			m_entries.push_back( Entry{ type, COMPOUND_SHAPE_PROXYTYPE, nullptr } );
		}
	}
	check();
}

void AlgorithmTable::check()
{
	for ( Entry& entry : m_entries )
	{
		btCollisionAlgorithmCreateFunc* const now = OpenDispatcher::registered( m_dispatcher, entry.type0, entry.type1 );
		if ( now != entry.ours.get() )
		{
			entry.ours = std::make_unique<NodeCreateFunc>( now );
			m_dispatcher.registerCollisionCreateFunc( entry.type0, entry.type1, entry.ours.get() );
		}
	}
}

AlgorithmTable::~AlgorithmTable()
{
	for ( const Entry& entry : m_entries )
	{
		if ( OpenDispatcher::registered( m_dispatcher, entry.type0, entry.type1 ) == entry.ours.get() )
		{
			m_dispatcher.registerCollisionCreateFunc( entry.type0, entry.type1, entry.ours->previous() );
		}
	}
}

} // namespace pliant
