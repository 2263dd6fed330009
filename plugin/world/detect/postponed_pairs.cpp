// Pairs that a dispatcher calls on several threads at a time. Neither the search for contacts nor Bullet's manifolds may be shared by
// threads as they are, and contacts must not depend on the order of threads: the pairs are noted, and processed in the order of their
// objects.

#include "world/detect/node_contacts.h"

#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <LinearMath/btThreads.h>

#include <algorithm>
#include <utility>

namespace pliant {

namespace {

std::pair<int, int> orderOf( const btCollisionObject* const ( &pair )[2] )
{
	return { pair[0]->getBroadphaseHandle()->m_uniqueId, pair[1]->getBroadphaseHandle()->m_uniqueId };
}

} // namespace

void PairContacts::meet( const btCollisionObjectWrapper& body0, const btCollisionObjectWrapper& body1, double step )
{
	if ( !m_scratch.postponesAll && !btThreadsAreRunning() )
	{
		process( body0, body1, step );
		return;
	}
	const std::lock_guard<std::mutex> lock( m_scratch.postponedMutex );
	if ( !m_postponed[0] )
	{
		m_scratch.postponed.push_back( this );
	}
	m_postponed[0] = body0.getCollisionObject();
	m_postponed[1] = body1.getCollisionObject();
	m_postponedStep = step;
}

void PairContacts::processPostponed()
{
	const auto wrapperOf = []( const btCollisionObject& object ) {
		return btCollisionObjectWrapper( nullptr, object.getCollisionShape(), &object, object.getWorldTransform(), -1, -1 );
	};
	const btCollisionObject &first = *m_postponed[0], &second = *m_postponed[1];
	m_postponed[0] = m_postponed[1] = nullptr;
	process( wrapperOf( first ), wrapperOf( second ), m_postponedStep );
}

void PairScratch::processPostponed()
{
	std::erase( postponed, nullptr );
	std::sort( postponed.begin(), postponed.end(), PairContacts::areInOrder );
	for ( std::size_t k = 0; k < postponed.size(); ++k ) // callbacks of the game may destroy pairs that wait, which leaves null
	{
		if ( postponed[k] )
		{
			postponed[k]->processPostponed();
		}
	}
	postponed.clear();
}

bool PairContacts::areInOrder( const PairContacts* a, const PairContacts* b )
{
	return orderOf( a->m_postponed ) < orderOf( b->m_postponed );
}

} // namespace pliant
