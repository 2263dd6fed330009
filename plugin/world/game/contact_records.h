#pragma once

// Contacts between whole bodies (ContactEvent), collected from the manifolds of their nodes.

#include "pliant/game/contact_events.h"
#include "pliant/soft_body.h"

#include <vector>

class btCollisionWorld;
class btDispatcher;
class btPersistentManifold;

namespace pliant {

/// The contacts of one body.
struct ContactRecord
{
	btCollisionObject* other = nullptr;
	bool isNew = true;                                                    ///< no event has said that it began
	bool isThere = false;                                                 ///< found at the end of the step
	double impulse = 0.0;                                                 ///< of the step so far, N s
	btVector3 push = btVector3( 0, 0, 0 ), moment = btVector3( 0, 0, 0 ); ///< on the body, N s; impulses times positions, N s m
	btVector3 position = btVector3( 0, 0, 0 );                            ///< of a point, world, m
	int event = -1;                                                       ///< its event in this tick
};

struct ContactRecords
{
	std::vector<ContactRecord> all;
};

class ContactEvents
{
public:
	/// After a pass is solved: sums the contacts of `dispatcher`. Costs nothing while no body of `bodies` has records.
	void add( btDispatcher& dispatcher, const std::vector<SoftBody*>& bodies );
	/// After a game step: makes its events. `dispatcher` lists all manifolds.
	void endStep( btDispatcher& dispatcher, const std::vector<SoftBody*>& bodies, const btCollisionWorld& world );
	/// Before the first step of a tick.
	void clear( const std::vector<SoftBody*>& bodies );
	/// An object leaves the world.
	void forget( const btCollisionObject& object, const std::vector<SoftBody*>& bodies );
	const std::vector<ContactEvent>& events() const { return m_events; }

private:
	void addSide( SoftBody& body, const btPersistentManifold& manifold, bool isFirst );
	void tell( SoftBody& body, ContactRecord& record );

	std::vector<ContactEvent> m_events;
};

} // namespace pliant
