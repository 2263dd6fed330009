#pragma once

// The last word on fast nodes, between the solver and the step: whatever the solvers made of a node's speed, it does not carry the node's
// centre through a thing that stands (docs/design/contacts.md). Contacts are found where nodes were going before the solver turned them
// elsewhere, and solvers end before they are exact; at a hundred metres a second either leads through a wall.

#include "world/touch/node_touch.h"
#include "world/touch/obstacle_motion.h"

#include <BulletCollision/CollisionShapes/btSphereShape.h>

#include <vector>

class btCollisionObject;

namespace pliant {

class SoftBody;

/// Keeps its scratch between calls.
class TunnelingGuard
{
public:
	/// Takes from the speeds of the body's nodes what would lead them through one of `walls` in a step of `h` s; returns how many it took
	/// from.
	int hold( SoftBody& body, const std::vector<const btCollisionObject*>& walls, double h );
	/// The same for the places of nodes that a change of levels has brought, by that of their heirs before; true when there were some to be
	/// moved.
	bool place( SoftBody& body, const std::vector<const btCollisionObject*>& walls, const std::vector<Vec3>& positionBefore );
	/// The same for all nodes, by their own places before; what has not moved is not looked at.
	bool keep( SoftBody& body, const std::vector<const btCollisionObject*>& walls, const std::vector<Vec3>& from );
	/// Whether nodes that have no sphere came to a wall in the last call.
	bool isAsked() const { return m_isAsked; }

private:
	/// The node's way w must keep normal . w >= least.
	struct Barrier
	{
		int node;
		Vec3d normal;
		double least;      ///< m
		Vec3d yieldingWay; ///< of the wall: a way that no barrier of it forbids
	};

	void begin( SoftBody& body, double h );
	void turnAway( const std::vector<const btCollisionObject*>& walls );
	void look( const Obstacle& part, const ObstacleMotion& motion );
	void lookAtMesh( const Obstacle& mesh, const ObstacleMotion& motion );
	template <class IsFar, class FindTouch>
	void lookAt( const ObstacleMotion& motion, const IsFar& isFar, const FindTouch& find );
	void lead( std::size_t first, std::size_t end, bool isLast );

	SoftBody* m_body = nullptr;
	double m_h = 0.0;
	bool m_isAsked = false;
	std::vector<int> m_nodes, m_turned; ///< to look at in this round, and in the next
	std::vector<int> m_held;            ///< those that were turned in any
	std::vector<Vec3d> m_from, m_way;   ///< by node, m
	std::vector<Barrier> m_barriers;
	btSphereShape m_sphere{ btScalar( 1 ) };
};

} // namespace pliant
