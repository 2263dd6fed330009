#pragma once

// Rolling and spinning friction of soft bodies' contacts. A node cannot rotate, so that Bullet's rows would rotate the other body alone,
// and without limit between two nodes. They are removed, and after the solver the bodies as a whole are braked by equal and opposite
// torques, limited by the normal impulses of their contacts. docs/design/contacts.md.

#include "lattice/lattice.h"

#include <LinearMath/btScalar.h>

#include <vector>

class btCollisionObject;
class btPersistentManifold;

namespace pliant {

class RollingFriction
{
public:
	/// Removes rolling and spinning friction from all points of the manifolds, those with a node, before Bullet's solver.
	void hide( const std::vector<btPersistentManifold*>& manifolds );
	/// Restores it and brakes the bodies.
	void apply();

private:
	struct Hidden
	{
		btPersistentManifold* manifold;
		int point;
		btScalar rolling, spinning;
	};
	/// All contacts between two bodies.
	struct Pair
	{
		btCollisionObject* first;
		btCollisionObject* second;
		Vec3d normalImpulse;  ///< sum of the normal impulses on the first, N s
		double rolling = 0.0; ///< limit of the contacts' rolling torque impulse, N m s
		double spinning = 0.0;
	};

	Pair& pairOf( btCollisionObject* first, btCollisionObject* second );
	static void brake( const Pair& pair );

	std::vector<Hidden> m_hidden;
	std::vector<Pair> m_pairs;
};

} // namespace pliant
