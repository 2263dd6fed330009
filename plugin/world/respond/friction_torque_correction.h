#pragma once

// Angular momentum of soft bodies that rub on each other. Bullet's solver moves two nodes at their middles, which are apart, by equal and
// opposite impulses J: of those across the line between them
//   ( x0 - x1 ) x J
// appears from nowhere. It is taken from the two bodies as wholes, as if J acted where the spheres touch, and friction sees how they turn
// there. docs/design/contacts.md.

#include "lattice/lattice.h"

#include <LinearMath/btVector3.h>

#include <algorithm>
#include <vector>

class btDispatcher;
class btUnionFind;

namespace pliant {

class ContactProxy;
class SoftBody;

class FrictionTorqueCorrection
{
public:
	/// Islands are found anew.
	void clear()
	{
		m_refinementState.clear();
		m_frictionTorque.clear();
	}
	/// Two things touch; by the union-find's index, -1 of what stands, whatever meets it. `areSoft`: nodes of two soft bodies.
	void touch( int first, int second, bool areSoft )
	{
		if ( areSoft )
		{
			note( first, m_frictionTorque );
		}
		else if ( ( first < 0 ) != ( second < 0 ) )
		{
			note( std::max( first, second ), m_refinementState );
		}
	}
	/// Each index has its island: those in which soft bodies rub and nothing stands are left.
	void choose( btUnionFind& islands );
	/// Before the solver, and when contacts of implicit blocks are hidden: those keep spin by themselves. Nodes of bodies that rub turn as
	/// their bodies do, and touch where their spheres do, so that friction sees how fast they slip there.
	void aim( btDispatcher& dispatcher );
	/// What is to be given, after the solver.
	void sum( btDispatcher& dispatcher );
	/// When the nodes have been moved: the solver is to see how they move then before it brings them into each other.
	void give();

private:
	struct Turn
	{
		SoftBody* body;
		Vec3d impulse;   ///< N m s
		btVector3 speed; ///< rad/s
	};
	/// Where a contact was, m.
	struct Placed
	{
		btVector3* point;
		btVector3 was;
	};

	/// Manifolds of two things come one after the other.
	static void note( int index, std::vector<int>& list )
	{
		if ( list.empty() || list.back() != index )
		{
			list.push_back( index );
		}
	}
	Turn& turnOf( SoftBody& body );
	void place( btVector3& point, const btVector3& at );

	std::vector<int> m_refinementState,
		m_frictionTorque; ///< by Bullet's index, islands that touch what stands, and in which soft bodies rub
	std::vector<Turn> m_turns;
	std::vector<Placed> m_placed;         ///< from aim to sum
	std::vector<ContactProxy*> m_turning; ///< the same
};

} // namespace pliant
