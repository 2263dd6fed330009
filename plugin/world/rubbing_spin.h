#pragma once

// Angular momentum of soft bodies that rub on each other. Bullet's solver moves two nodes at their middles, which are apart, by equal and opposite
// impulses J: of those across the line between them
//   ( x0 - x1 ) x J
// appears from nowhere. It is taken from the two bodies as wholes, as if J acted where the spheres touch. docs/contacts.md.

#include "lattice/lattice.h"

#include <algorithm>
#include <vector>

class btDispatcher;
class btUnionFind;

namespace pliant {

class SoftBody;

class RubbingSpin
{
public:
	/// Islands are found anew.
	void clear()
	{
		m_standing.clear();
		m_rubbing.clear();
	}
	/// Two things touch; by the union-find's index, -1 of what stands, whatever meets it. `areSoft`: nodes of two soft bodies.
	void touch( int first, int second, bool areSoft )
	{
		if ( areSoft )
		{
			note( first, m_rubbing );
		}
		else if ( ( first < 0 ) != ( second < 0 ) )
		{
			note( std::max( first, second ), m_standing );
		}
	}
	/// Each index has its island: those in which soft bodies rub and nothing stands are left.
	void choose( btUnionFind& islands );
	/// What is to be given, after the solver and before contacts of implicit blocks are shown again: those keep spin by themselves.
	void sum( btDispatcher& dispatcher );
	/// When the nodes have been moved: the solver is to see how they move then before it brings them into each other.
	void give();

private:
	struct Turn
	{
		SoftBody* body;
		Vec3d impulse; ///< N m s
	};

	/// Manifolds of two things come one after the other.
	static void note( int index, std::vector<int>& list )
	{
		if ( list.empty() || list.back() != index )
		{
			list.push_back( index );
		}
	}
	Vec3d& turnOf( SoftBody& body );

	std::vector<int> m_standing, m_rubbing; ///< by Bullet's index, islands that touch what stands, and in which soft bodies rub
	std::vector<Turn> m_turns;
};

} // namespace pliant
