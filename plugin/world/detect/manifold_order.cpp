#include "world/detect/manifold_order.h"

#include <BulletCollision/BroadphaseCollision/btCollisionAlgorithm.h>
#include <BulletCollision/BroadphaseCollision/btDispatcher.h>
#include <BulletCollision/BroadphaseCollision/btOverlappingPairCache.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>
#include <LinearMath/btThreads.h>

#include <unordered_set>
#include <vector>

namespace pliant {

namespace {

/// In a field of manifolds that Bullet sets to 0 and does not use.
constexpr int kKnown = 1;

bool hasThreads()
{
	const btITaskScheduler* const scheduler = btGetTaskScheduler();
	return scheduler && scheduler->getNumThreads() > 1;
}

} // namespace

void noteManifolds( btDispatcher& dispatcher )
{
	for ( int i = 0; hasThreads() && i < dispatcher.getNumManifolds(); ++i )
	{
		dispatcher.getManifoldByIndexInternal( i )->m_companionIdA = kKnown;
	}
}

void orderNewManifolds( btDispatcher& dispatcher, btOverlappingPairCache& pairs )
{
	if ( !hasThreads() )
	{
		return;
	}
	std::vector<int> indices;
	std::unordered_set<const btPersistentManifold*> added;
	for ( int i = 0; i < dispatcher.getNumManifolds(); ++i )
	{
		if ( btPersistentManifold* const manifold = dispatcher.getManifoldByIndexInternal( i ); manifold->m_companionIdA != kKnown )
		{
			indices.push_back( i );
			added.insert( manifold );
		}
	}
	if ( indices.size() < 2 )
	{
		return;
	}
	std::vector<btPersistentManifold*> inOrder;
	btManifoldArray ofPair;
	for ( int k = 0; k < pairs.getNumOverlappingPairs() && inOrder.size() < indices.size(); ++k )
	{
		btCollisionAlgorithm* const algorithm = pairs.getOverlappingPairArrayPtr()[k].m_algorithm;
		ofPair.resizeNoInitialize( 0 );
		if ( algorithm )
		{
			algorithm->getAllContactManifolds( ofPair );
		}
		for ( int m = 0; m < ofPair.size(); ++m )
		{
			if ( added.count( ofPair[m] ) != 0 )
			{
				inOrder.push_back( ofPair[m] );
			}
		}
	}
	if ( inOrder.size() != indices.size() )
	{
		return; // the game makes manifolds of its own: they are no pair's
	}
	for ( std::size_t k = 0; k < indices.size(); ++k )
	{
		inOrder[k]->m_index1a = indices[k];
		dispatcher.getInternalManifoldPointer()[indices[k]] = inOrder[k];
	}
}

} // namespace pliant
