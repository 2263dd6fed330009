// Adds and removes bodies, through Bullet's functions or ours, in any order and at any time.

#include "world/bodies/soft_body_impl.h"
#include "world/constants.h"
#include "world/detect/pair_contacts.h"
#include "world/step/soft_body_system.h"

#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>

#include <algorithm>
#include <cmath>
#include <iterator>

namespace pliant {

SoftBodySystem::SoftBodySystem( btDiscreteDynamicsWorld& world, btDispatcher* dispatcher ) :
	fields( world ), substeps( kDefaultSubsteps ), maxSubsteps( kDefaultMaxSubsteps ), ownRunner( createThreadPool( 1 ) ), m_world( world ),
	m_dispatcher( *static_cast<btCollisionDispatcher*>( dispatcher ) )
{}

SoftBodySystem::~SoftBodySystem()
{
	dropPredictiveContacts();
	for ( SoftBody* body : m_bodies )
	{
		body->impl().system = nullptr;
	}
}

bool SoftBodySystem::add( SoftBody& body )
{
	if ( body.impl().system )
	{
		return false;
	}
	if ( !m_algorithms )
	{
		m_algorithms = AlgorithmTable::of( m_dispatcher );
	}
	body.impl().system = this;
	body.impl().serial = ++m_serials;
	m_bodies.push_back( &body );
	isPlain = false;
	releaseLostPins( body, true );
	return true;
}

// A callback may remove a body in the middle of a step, so it is erased from all lists of the step.
bool SoftBodySystem::remove( SoftBody& body )
{
	if ( std::erase( m_bodies, &body ) == 0 )
	{
		return false;
	}
	for ( std::vector<SoftBody*>* list : { &m_awake, &m_rigid, &m_asleep, &m_substepped, &m_parallel, &m_serial, &m_stale } )
	{
		std::erase( *list, &body );
	}
	SoftBody::Impl& impl = body.impl();
	if ( impl.rigidProxy )
	{
		deform( body );
	}
	if ( impl.self )
	{
		impl.self->contacts.reset();
	}
	impl.isWorldOwned ? stopIgnoring( body ) : void(); // the game has not made these entries, and would not remove them
	ContactProxyPool::detach( body );
	impl.system = nullptr;
	impl.block = -1;
	release( body );
	if ( m_bodies.empty() )
	{
		m_algorithms.reset(); // the dispatcher may be destroyed before the world
	}
	return true;
}

void SoftBodySystem::ignoreAs( SoftBody& parent, SoftBody& fragment ) const
{
	for ( int k = 0; k < parent.getNumObjectsWithoutCollision(); ++k )
	{
		fragment.setIgnoreCollisionCheck( parent.getObjectWithoutCollision( k ), true );
	}
	const btCollisionObjectArray& objects = m_world.getCollisionObjectArray();
	for ( int k = 0; k < objects.size(); ++k )
	{
		if ( objects[k] != &parent && !objects[k]->checkCollideWith( &parent ) )
		{
			objects[k]->setIgnoreCollisionCheck( &fragment, true );
		}
	}
}

void SoftBodySystem::stopIgnoring( SoftBody& fragment ) const
{
	const btCollisionObjectArray& objects = m_world.getCollisionObjectArray();
	for ( int k = 0; k < objects.size(); ++k )
	{
		objects[k]->setIgnoreCollisionCheck( &fragment, false );
	}
}

void SoftBodySystem::forget( SoftBody& body )
{
	m_world.removeCollisionObject( &body );
}

void SoftBodySystem::refreshBox( SoftBody& body )
{
	m_world.updateSingleAabb( &body );
}

bool SoftBodySystem::holds( const btCollisionObject* object, int& index ) const
{
	const btCollisionObjectArray& all = m_world.getCollisionObjectArray();
	if ( index < 0 || index >= all.size() || all[index] != object )
	{
		index = all.findLinearSearch( const_cast<btCollisionObject*>( object ) );
	}
	return index < all.size();
}

void SoftBodySystem::updateWorldIndex( SoftBody& body ) const
{
	int index = body.getWorldArrayIndex();
	body.setWorldArrayIndex( holds( &body, index ) ? index : -1 );
}

bool SoftBodySystem::acceptsSteps( btScalar& timeStep, int maxSubSteps, btScalar fixedTimeStep ) const
{
	if ( m_bodies.empty() )
	{
		return true; // Bullet's own world
	}
	const bool isSingle = maxSubSteps == 0;
	if ( !std::isfinite( timeStep ) || !std::isfinite( fixedTimeStep ) || ( isSingle ? timeStep < 0 : fixedTimeStep <= 0 ) )
	{
		return false;
	}
	timeStep = isSingle ? timeStep : std::min( timeStep, fixedTimeStep * kMostFrames );
	return true;
}

SoftBody* SoftBodySystem::bodyAfter( unsigned serial ) const
{
	const auto next = std::upper_bound(
		m_bodies.begin(), m_bodies.end(), serial, []( unsigned s, const SoftBody* body ) { return s < body->impl().serial; } );
	return next == m_bodies.end() ? nullptr : *next;
}

// A game that resets itself may have emptied Bullet's list of objects directly.
void SoftBodySystem::removeLost()
{
	std::erase_if( attachments.all(),
		[this]( Attachment& attachment ) { return attachment.rigid && !holds( attachment.rigid, attachment.rigidIndex ); } );
	for ( Frame& frame : frames.all() )
	{
		if ( frame.isInWorld && !holds( frame.rigid.get(), frame.rigidIndex ) )
		{
			frames.forget( *frame.rigid, m_world );
		}
	}
	unsigned serial = 0;
	while ( SoftBody* const body = bodyAfter( serial ) )
	{
		serial = body->impl().serial;
		int index = body->getWorldArrayIndex();
		if ( !holds( body, index ) )
		{
			m_world.removeCollisionObject( body );
		}
	}
}

bool SoftBodySystem::openStep( btScalar& timeStep )
{
	if ( m_bodies.empty() )
	{
		return true; // Bullet's own world
	}
	if ( !std::isfinite( timeStep ) || timeStep <= 0 )
	{
		return false;
	}
	timeStep = std::min( timeStep, kLongestStep );
	removeLost();
	for ( SoftBody* body : m_bodies )
	{
		releaseLostPins( *body, false );
	}
	if ( m_algorithms )
	{
		m_algorithms->check();
	}
	wakeRestingOnWoken();
	return true;
}

void SoftBodySystem::noteSleepers()
{
	m_asleep.clear();
	std::copy_if(
		m_bodies.begin(), m_bodies.end(), std::back_inserter( m_asleep ), []( const SoftBody* body ) { return !body->isActive(); } );
}

// A body that was woken since the last step wakes the bodies in contact with it. Bullet's islands would do so only after the step in which
// the body has moved away, and bodies that have lost contact by then would stay asleep in mid-air.
void SoftBodySystem::wakeRestingOnWoken()
{
	for ( const SoftBody* body : m_asleep )
	{
		if ( body->isActive() )
		{
			wakeTouching( *body );
		}
	}
	noteSleepers();
}

void SoftBodySystem::releaseRefusedPairs()
{
	for ( std::size_t k = pairScratch.all.size(); k-- > 0; )
	{
		if ( k >= pairScratch.all.size() ) // callbacks for ended contacts may remove bodies
		{
			continue;
		}
		const btPersistentManifold* const any = pairScratch.all[k]->anyManifold();
		if ( any && isPairInPass( *any->getBody0(), *any->getBody1() ) )
		{
			pairScratch.all[k]->releaseIfRefused();
		}
	}
}

void SoftBodySystem::wakeTouching( const SoftBody& body )
{
	for ( int m = 0; m < m_dispatcher.getNumManifolds(); ++m )
	{
		const btPersistentManifold& manifold = *m_dispatcher.getManifoldByIndexInternal( m );
		const btCollisionObject* side[2] = { manifold.getBody0(), manifold.getBody1() };
		for ( int k = 0; k < 2 && manifold.getNumContacts() > 0; ++k )
		{
			if ( &ownerOf( *side[k] ) == &body )
			{
				ownerOf( *side[1 - k] ).activate();
			}
		}
	}
}

} // namespace pliant
