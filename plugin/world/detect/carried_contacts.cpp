// The data that one collision phase passes to the next: all of it, in snapshots, and the nodes that pressed, for the search.

#include "world/bodies/soft_body_impl.h"
#include "world/constants.h"
#include "world/detect/node_contacts.h"
#include "world/rigid/rigid_load.h"

#include <algorithm>

namespace pliant {

PairContacts::Carried PairContacts::carried() const
{
	Carried state{ m_isNew, m_phase != 0, m_numbering, m_parting, {} };
	for ( const NodeContact& contact : m_contacts )
	{
		state.keys.push_back( contact.key );
	}
	return state;
}

PairContacts::Pair PairContacts::pairOf( const btCollisionObject& first, const btCollisionObject& second )
{
	const auto softOf = []( const btCollisionObject& object ) {
		SoftBody* const soft = asSoftBody( const_cast<btCollisionObject*>( &object ) );
		return soft && !soft->impl().rigidProxy ? soft : nullptr;
	};
	SoftBody *const soft0 = softOf( first ), *const soft1 = softOf( second );
	SoftBody* const other = soft0 ? soft1 : nullptr;
	return Pair{ soft0 ? soft0 : soft1, other, other ? nullptr : soft0 ? &second : &first, soft0 != nullptr };
}

void PairContacts::carry( const Carried& from, const btCollisionObject& first, const btCollisionObject& second )
{
	carryOver( from, pairOf( first, second ) );
}

void PairContacts::carrySelf( const Carried& from, SoftBody& soft )
{
	carryOver( from, Pair{ &soft, &soft, nullptr, true } );
}

void PairContacts::carryOver( const Carried& from, const Pair& pair )
{
	enlist();
	m_isNew = from.isNew;
	m_phase = from.wasProcessed ? m_pool.phase() : 0;
	m_numbering = from.numbering;
	m_parting = from.parting;
	for ( const std::uint64_t key : from.keys )
	{
		NodeContact contact;
		contact.key = key;
		create( pair, contact );
		m_contacts.push_back( contact );
	}
}

// A node may be off the object that it presses by more than a contact's slack: at the rear of a rolling ball, or where a peg stops that a
// taut band is ahead of. Its elasticity, of which its velocity tells nothing, may bring it back within the substep. So nodes that pressed
// keep their contacts while they are no farther away than the impulse would have moved them.
void PairContacts::notePressed( const SoftBody& soft, double step )
{
	std::vector<NodeSearch::Pressed>& pressed = m_scratch.search.pressed();
	pressed.clear();
	const NodeState& nodes = soft.impl().body->nodes();
	for ( const NodeContact& contact : m_contacts )
	{
		const int node = contact.first->node;
		const double impulse = impulseOf( *contact.manifold );
		if ( impulse > 0.0 && ( pressed.empty() || pressed.back().node != node ) )
		{
			const double most = kMostPressedReach * double( contact.first->radius() );
			pressed.push_back( { node, std::min( step * impulse / double( nodes.mass[node] ), most ) } );
		}
	}
}

} // namespace pliant
