#pragma once

// Conserves the angular momentum of soft bodies that rub on each other. Bullet's solver applies opposite impulses J to two nodes at their
// centres, which are apart: for components across the line between them, an angular momentum of
//   ( x0 - x1 ) x J
// appears. It is subtracted from the two bodies, as if J acted where the spheres touch (docs/design/contacts.md).

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
	/// Clears the lists, before islands are rebuilt.
	void clear()
	{
		m_grounded.clear();
		m_rubbing.clear();
	}
	/// Records a contact of two objects by their union-find indices, -1 for static objects. `areSoft`: nodes of two soft bodies.
	void touch( int first, int second, bool areSoft )
	{
		if ( areSoft )
		{
			note( first, m_rubbing );
		}
		else if ( ( first < 0 ) != ( second < 0 ) )
		{
			note( std::max( first, second ), m_grounded );
		}
	}
	/// Replaces indices by islands: keeps those in which soft bodies rub and nothing touches a static object.
	void choose( btUnionFind& islands );
	/// Called before the solver, with contacts of implicit blocks hidden. Nodes of rubbing bodies receive their bodies' angular velocity,
	/// and contact points move to where the spheres touch, so that friction acts on the slip velocity there.
	void aim( btDispatcher& dispatcher );
	/// Sums the corrections, after the solver.
	void sum( btDispatcher& dispatcher );
	/// Applies them, after the nodes have been moved: the next solve uses the new velocities before they cause overlaps.
	void give();

private:
	struct Turn
	{
		SoftBody* body;
		Vec3d impulse;             ///< N m s
		btVector3 angularVelocity; ///< rad/s
	};
	/// The former position of a contact point, m.
	struct MovedPoint
	{
		btVector3* point;
		btVector3 original;
	};

	/// Manifolds of the same two objects are consecutive.
	static void note( int index, std::vector<int>& list )
	{
		if ( list.empty() || list.back() != index )
		{
			list.push_back( index );
		}
	}
	Turn& turnOf( SoftBody& body );
	void movePoint( btVector3& point, const btVector3& at );

	std::vector<int> m_grounded,
		m_rubbing; ///< by Bullet's index: islands that touch static objects, and those in which soft bodies rub
	std::vector<Turn> m_turns;
	std::vector<MovedPoint> m_movedPoints; ///< from aim to sum
	std::vector<ContactProxy*> m_turning;  ///< from aim to sum
};

} // namespace pliant
