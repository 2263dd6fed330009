#pragma once

// Where contacts of nodes act while they are solved.

#include <LinearMath/btVector3.h>

#include <vector>

class btDispatcher;
struct btContactSolverInfo;

namespace pliant {

/// While Bullet's solver is at work a contact acts at the node's centre, on both sides: a node has no spin that could take up the rest,
/// and angular momentum is kept. At all other times the contact's point lies on the surfaces.
class MovedContacts
{
public:
	/// What is deeper than Bullet pushes out of at kPushOutSpeed in a step is shown to be just so deep.
	void moveToNodes( btDispatcher& dispatcher, const btContactSolverInfo& info );
	void moveBack();
	/// Those moved last.
	int count() const { return int( m_moved.size() ); }
	/// Some of them have rolling or spinning friction.
	bool hasRollingFriction() const { return m_hasRollingFriction; }
	/// Some have restitution.
	bool hasRestitution() const { return m_hasRestitution; }

private:
	struct Moved
	{
		btVector3* point;
		btVector3 was; ///< the point on the surface
	};

	struct Deep
	{
		btScalar* distance;
		btScalar was;
	};

	std::vector<Moved> m_moved;
	std::vector<Deep> m_deep;
	bool m_hasRollingFriction = false, m_hasRestitution = false;
};

} // namespace pliant
