#pragma once

// A dispatcher that shows some of another's manifolds: Bullet's islands and solver see only the objects of one pass of the step.

#include <BulletCollision/BroadphaseCollision/btDispatcher.h>

#include <vector>

class btPersistentManifold;

namespace pliant {

class ManifoldView : public btDispatcher
{
public:
	/// Shows the manifolds of `behind` for which `keeps( manifold )` is true, in its order.
	template <class Keeps>
	void show( btDispatcher& behind, const Keeps& keeps )
	{
		m_behind = &behind;
		m_shown.clear();
		for ( int m = 0; m < behind.getNumManifolds(); ++m )
		{
			btPersistentManifold* const manifold = behind.getManifoldByIndexInternal( m );
			if ( keeps( *manifold ) )
			{
				m_shown.push_back( manifold );
			}
		}
	}

	int getNumManifolds() const override { return int( m_shown.size() ); }
	btPersistentManifold* getManifoldByIndexInternal( int index ) override { return m_shown[std::size_t( index )]; }
	btPersistentManifold** getInternalManifoldPointer() override { return m_shown.empty() ? nullptr : m_shown.data(); }

	btCollisionAlgorithm* findAlgorithm( const btCollisionObjectWrapper* body0, const btCollisionObjectWrapper* body1,
		btPersistentManifold* shared, ebtDispatcherQueryType query ) override
	{
		return m_behind->findAlgorithm( body0, body1, shared, query );
	}
	btPersistentManifold* getNewManifold( const btCollisionObject* body0, const btCollisionObject* body1 ) override
	{
		return m_behind->getNewManifold( body0, body1 );
	}
	void releaseManifold( btPersistentManifold* manifold ) override { m_behind->releaseManifold( manifold ); }
	void clearManifold( btPersistentManifold* manifold ) override { m_behind->clearManifold( manifold ); }
	bool needsCollision( const btCollisionObject* body0, const btCollisionObject* body1 ) override
	{
		return m_behind->needsCollision( body0, body1 );
	}
	bool needsResponse( const btCollisionObject* body0, const btCollisionObject* body1 ) override
	{
		return m_behind->needsResponse( body0, body1 );
	}
	void dispatchAllCollisionPairs( btOverlappingPairCache* pairs, const btDispatcherInfo& info, btDispatcher* dispatcher ) override
	{
		m_behind->dispatchAllCollisionPairs( pairs, info, dispatcher );
	}
	btPoolAllocator* getInternalManifoldPool() override { return m_behind->getInternalManifoldPool(); }
	const btPoolAllocator* getInternalManifoldPool() const override
	{
		return static_cast<const btDispatcher*>( m_behind )->getInternalManifoldPool();
	}
	void* allocateCollisionAlgorithm( int size ) override { return m_behind->allocateCollisionAlgorithm( size ); }
	void freeCollisionAlgorithm( void* algorithm ) override { m_behind->freeCollisionAlgorithm( algorithm ); }

private:
	btDispatcher* m_behind = nullptr;
	std::vector<btPersistentManifold*> m_shown;
};

} // namespace pliant
