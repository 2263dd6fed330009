#include "world/detect/node_algorithm.h"

#include "world/bodies/soft_body_impl.h"
#include "world/detect/node_contacts.h"
#include "world/query/surface_tests.h"
#include "world/step/soft_body_system.h"

#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionDispatch/btEmptyCollisionAlgorithm.h>

#include <mutex>
#include <new>
#include <utility>

namespace pliant {

namespace {

/// The soft body as a whole only: Bullet handles contact proxies that meet a compound, and contact tests single triangles.
SoftBodySystem* systemOf( const btCollisionObjectWrapper* wrapper )
{
	return SurfaceTest::isSurface( *wrapper ) ? asSoftBody( const_cast<btCollisionObject*>( wrapper->getCollisionObject() ) )->impl().system
											  : nullptr;
}

/// Reads the registered functions, for which Bullet has no accessor.
struct OpenDispatcher : btCollisionDispatcher
{
	static btCollisionAlgorithmCreateFunc* registered( const btCollisionDispatcher& dispatcher, int type0, int type1, AlgorithmKind kind )
	{
		return kind == AlgorithmKind::Contacts ? ( dispatcher.*( &OpenDispatcher::m_doubleDispatchContactPoints ) )[type0][type1]
											   : ( dispatcher.*( &OpenDispatcher::m_doubleDispatchClosestPoints ) )[type0][type1];
	}
};

void registerFunction(
	btCollisionDispatcher& dispatcher, int type0, int type1, AlgorithmKind kind, btCollisionAlgorithmCreateFunc* function )
{
	kind == AlgorithmKind::Contacts ? dispatcher.registerCollisionCreateFunc( type0, type1, function )
									: dispatcher.registerClosestPointsCreateFunc( type0, type1, function );
}

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
	m_contacts->meet( *body0, *body1, double( info.m_timeStep ) );
}

void NodeAlgorithm::getAllContactManifolds( btManifoldArray& manifolds )
{
	m_contacts->collectManifolds( manifolds );
}

btCollisionAlgorithm* NodeCreateFunc::CreateCollisionAlgorithm(
	btCollisionAlgorithmConstructionInfo& info, const btCollisionObjectWrapper* body0, const btCollisionObjectWrapper* body1 )
{
	if ( m_kind == AlgorithmKind::ContactTests )
	{
		if ( !SurfaceTest::isSurface( *body0 ) && !SurfaceTest::isSurface( *body1 ) )
		{
			return m_previous->CreateCollisionAlgorithm( info, body0, body1 );
		}
		void* const memory = info.m_dispatcher1->allocateCollisionAlgorithm( sizeof( SurfaceTest ) );
		return new ( memory ) SurfaceTest( info );
	}
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
	for ( const AlgorithmKind kind : { AlgorithmKind::Contacts, AlgorithmKind::ContactTests } )
	{
		for ( int type = 0; type < MAX_BROADPHASE_COLLISION_TYPES; ++type )
		{
			m_entries.push_back( Entry{ COMPOUND_SHAPE_PROXYTYPE, type, kind, nullptr } );
			if ( type != COMPOUND_SHAPE_PROXYTYPE )
			{
				m_entries.push_back( Entry{ type, COMPOUND_SHAPE_PROXYTYPE, kind, nullptr } );
			}
		}
	}
	check();
}

void AlgorithmTable::check()
{
	for ( Entry& entry : m_entries )
	{
		btCollisionAlgorithmCreateFunc* const now = OpenDispatcher::registered( m_dispatcher, entry.type0, entry.type1, entry.kind );
		if ( now != entry.ours.get() )
		{
			entry.ours = std::make_unique<NodeCreateFunc>( now, entry.kind );
			registerFunction( m_dispatcher, entry.type0, entry.type1, entry.kind, entry.ours.get() );
		}
	}
}

AlgorithmTable::~AlgorithmTable()
{
	for ( const Entry& entry : m_entries )
	{
		if ( OpenDispatcher::registered( m_dispatcher, entry.type0, entry.type1, entry.kind ) == entry.ours.get() )
		{
			registerFunction( m_dispatcher, entry.type0, entry.type1, entry.kind, entry.ours->previous() );
		}
	}
}

} // namespace pliant
