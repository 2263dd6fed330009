#pragma once

// Rolling and spinning friction of soft bodies' contacts. A node cannot turn, so Bullet's rows for it would turn the other body alone and
// find no limit between two that cannot; they are taken out, and after the solver the bodies as wholes are braked, with what their contacts
// pressed with as the limit, and with equal and opposite torques. docs/design/contacts.md.

#include "lattice/lattice.h"

#include <LinearMath/btScalar.h>

#include <vector>

class btCollisionObject;
class btDispatcher;
class btPersistentManifold;

namespace pliant {

class RollingFriction
{
public:
	/// Takes rolling and spinning friction out of all points that name a node, before Bullet's solver.
	void hide( btDispatcher& dispatcher );
	/// Puts it back, and brakes.
	void apply();

private:
	struct Hidden
	{
		btPersistentManifold* manifold;
		int point;
		btScalar rolling, spinning;
	};
	/// All contacts of two bodies together.
	struct Pair
	{
		btCollisionObject* first;
		btCollisionObject* second;
		Vec3d pressing;       ///< sum of the impulses, N s, towards the first
		double rolling = 0.0; ///< what the contacts can turn against at most, N m s
		double spinning = 0.0;
	};

	Pair& pairOf( btCollisionObject* first, btCollisionObject* second );
	static void brake( const Pair& pair );

	std::vector<Hidden> m_hidden;
	std::vector<Pair> m_pairs;
};

} // namespace pliant
