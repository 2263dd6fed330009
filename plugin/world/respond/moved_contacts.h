#pragma once

// Contact points of nodes while they are solved.

#include <LinearMath/btVector3.h>

#include <vector>

class btDispatcher;
class btPersistentManifold;
struct btContactSolverInfo;

namespace pliant {

/// While Bullet's solver runs, a contact acts at the node's centre, on both sides: a node has no spin that could take up a torque, and
/// angular momentum is conserved. At all other times the contact point lies on the surfaces.
class MovedContacts
{
public:
	/// Also limits penetrations to the depth that Bullet pushes out at kPushOutSpeed in a step.
	void moveToNodes( btDispatcher& dispatcher, const btContactSolverInfo& info );
	void moveBack();
	/// The manifolds with a node.
	const std::vector<btPersistentManifold*>& manifolds() const { return m_manifolds; }
	/// Number of points moved last.
	int count() const { return int( m_moved.size() ); }
	/// Whether any of them has rolling or spinning friction.
	bool hasRollingFriction() const { return m_hasRollingFriction; }

private:
	struct Moved
	{
		btVector3* point;
		btVector3 original; ///< the point on the surface
	};

	struct Deep
	{
		btScalar* distance;
		btScalar original;
	};

	std::vector<btPersistentManifold*> m_manifolds;
	std::vector<Moved> m_moved;
	std::vector<Deep> m_deep;
	bool m_hasRollingFriction = false;
};

} // namespace pliant
