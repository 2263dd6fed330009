#include "world/game/contact_records.h"

#include "world/bodies/soft_body_impl.h"
#include "world/shape/contact_proxy.h"

#include <BulletCollision/BroadphaseCollision/btDispatcher.h>
#include <BulletCollision/CollisionDispatch/btCollisionWorld.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>

#include <algorithm>

namespace pliant {

namespace {

bool areWanted( const std::vector<SoftBody*>& bodies )
{
	return std::any_of( bodies.begin(), bodies.end(), []( const SoftBody* body ) { return body->impl().contactRecords != nullptr; } );
}

btCollisionObject* bodyOf( const btCollisionObject* side )
{
	SoftBody* const soft = SoftBody::upcast( const_cast<btCollisionObject*>( side ) );
	return soft ? soft : const_cast<btCollisionObject*>( side );
}

/// Null if there is none. The manifolds of a pair come one after another, so the last one is tested first.
ContactRecord* findRecord( ContactRecords& records, const btCollisionObject* other )
{
	if ( !records.all.empty() && records.all.back().other == other )
	{
		return &records.all.back();
	}
	const auto found = std::find_if(
		records.all.begin(), records.all.end(), [other]( const ContactRecord& record ) { return record.other == other; } );
	return found == records.all.end() ? nullptr : &*found;
}

/// Calls visit( body, other, is the body the manifold's first ) for each body of the manifold with contact events.
template <class F>
void forSides( const btPersistentManifold& manifold, F&& visit )
{
	const btCollisionObject* const side[2] = { manifold.getBody0(), manifold.getBody1() };
	for ( int k = 0; k < 2 && manifold.getNumContacts() > 0; ++k )
	{
		SoftBody* const body = SoftBody::upcast( const_cast<btCollisionObject*>( side[k] ) );
		btCollisionObject* const other = bodyOf( side[1 - k] );
		if ( body && body != other && body->impl().contactRecords )
		{
			visit( *body, other, k == 0 );
		}
	}
}

} // namespace

void ContactEvents::add( btDispatcher& dispatcher, const std::vector<SoftBody*>& bodies )
{
	for ( int m = 0; areWanted( bodies ) && m < dispatcher.getNumManifolds(); ++m )
	{
		const btPersistentManifold& manifold = *dispatcher.getManifoldByIndexInternal( m );
		forSides( manifold, [&]( SoftBody& body, btCollisionObject*, bool isFirst ) {
			if ( body.isActive() ) // else its impulses are those of an earlier step
			{
				addSide( body, manifold, isFirst );
			}
		} );
	}
}

// A contact that is only foreseen has neither an impulse nor an overlap.
void ContactEvents::addSide( SoftBody& body, const btPersistentManifold& manifold, bool isFirst )
{
	ContactRecords& records = *body.impl().contactRecords;
	btCollisionObject* const other = bodyOf( isFirst ? manifold.getBody1() : manifold.getBody0() );
	ContactRecord* record = findRecord( records, other );
	for ( int k = 0; k < manifold.getNumContacts(); ++k )
	{
		const btManifoldPoint& point = manifold.getContactPoint( k );
		const btScalar impulse = point.getAppliedImpulse();
		if ( !( impulse > 0 ) && point.getDistance() > 0 )
		{
			continue;
		}
		if ( !record )
		{
			records.all.push_back( ContactRecord{} );
			record = &records.all.back();
			record->other = other;
		}
		record->impulse += double( impulse );
		record->push += point.m_normalWorldOnB * ( isFirst ? impulse : -impulse );
		record->moment += point.getPositionWorldOnB() * impulse;
		record->position = point.getPositionWorldOnB();
	}
}

void ContactEvents::tell( SoftBody& body, ContactRecord& record )
{
	if ( record.event < 0 )
	{
		record.event = int( m_events.size() );
		m_events.push_back( ContactEvent{
			&body, record.other, asSoftBody( record.other ), record.isNew, false, btScalar( 0 ), btVector3( 0, 0, 0 ), record.position } );
	}
	ContactEvent& event = m_events[std::size_t( record.event )];
	const btScalar impulse = btScalar( record.impulse ), sum = event.impulse + impulse;
	event.position = sum > 0 ? ( event.position * event.impulse + record.moment ) / sum : record.position;
	event.impulse = sum;
	event.push += record.push;
	event.ended = !record.isThere;
	record.isNew = false;
	record.impulse = 0.0;
	record.push.setZero();
	record.moment.setZero();
}

void ContactEvents::endStep( btDispatcher& dispatcher, const std::vector<SoftBody*>& bodies, const btCollisionWorld& world )
{
	if ( !areWanted( bodies ) )
	{
		return;
	}
	for ( int m = 0; m < dispatcher.getNumManifolds(); ++m )
	{
		forSides( *dispatcher.getManifoldByIndexInternal( m ), []( SoftBody& body, btCollisionObject* other, bool ) {
			if ( ContactRecord* const record = findRecord( *body.impl().contactRecords, other ) )
			{
				record->isThere = true;
			}
		} );
	}
	for ( SoftBody* body : bodies )
	{
		ContactRecords* const records = body->impl().contactRecords.get();
		if ( !records )
		{
			continue;
		}
		for ( ContactRecord& record : records->all )
		{
			const bool isKnown = record.isThere ||
				world.getCollisionObjectArray().findLinearSearch( record.other ) < world.getNumCollisionObjects();
			if ( isKnown && ( body->isActive() || !record.isThere || record.impulse > 0.0 ) )
			{
				tell( *body, record );
			}
		}
		std::erase_if( records->all, []( const ContactRecord& record ) { return !record.isThere; } );
		for ( ContactRecord& record : records->all )
		{
			record.isThere = false;
		}
	}
}

void ContactEvents::clear( const std::vector<SoftBody*>& bodies )
{
	if ( m_events.empty() )
	{
		return;
	}
	m_events.clear();
	for ( SoftBody* body : bodies )
	{
		for ( std::size_t k = 0; body->impl().contactRecords && k < body->impl().contactRecords->all.size(); ++k )
		{
			body->impl().contactRecords->all[k].event = -1;
		}
	}
}

// The game may be reading the events: they stay where they are.
void ContactEvents::forget( const btCollisionObject& object, const std::vector<SoftBody*>& bodies )
{
	for ( ContactEvent& event : m_events )
	{
		event.body = event.body == &object ? nullptr : event.body;
		event.otherSoft = event.otherSoft == &object ? nullptr : event.otherSoft;
		event.other = event.other == &object ? nullptr : event.other;
	}
	for ( SoftBody* body : bodies )
	{
		ContactRecords* const records = body->impl().contactRecords.get();
		if ( records && body == &object )
		{
			records->all.clear();
		}
		else if ( records )
		{
			std::erase_if( records->all, [&object]( const ContactRecord& record ) { return record.other == &object; } );
		}
	}
}

void SoftBody::setContactEvents( bool isOn )
{
	if ( isOn != contactEvents() && !m_impl->isInField() )
	{
		m_impl->contactRecords = isOn ? std::make_unique<ContactRecords>() : nullptr;
	}
}

bool SoftBody::contactEvents() const
{
	return m_impl->contactRecords != nullptr;
}

} // namespace pliant
