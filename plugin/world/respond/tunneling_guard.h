#pragma once

// Final check of fast nodes, between the solver and the step: no velocity may carry a node's centre through a static object
// (docs/design/contacts.md). Contacts are found along the motion that nodes had before the solver redirected them, and solvers stop before
// they have converged; at a hundred metres a second either leads through a wall.

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
	/// Limits the velocities of nodes that would pass through one of `walls` in a step of `h` s; returns the number of nodes changed.
	int hold( SoftBody& body, const std::vector<const btCollisionObject*>& walls, double h );
	/// Corrects the positions of nodes that a change of levels created, given those of their sources; true where any was moved.
	bool place( SoftBody& body, const std::vector<const btCollisionObject*>& walls, const std::vector<Vec3>& positionBefore );
	/// Whether nodes without a sphere reached a wall in the last call.
	bool hasInnerNodes() const { return m_hasInnerNodes; }

private:
	/// The node's displacement w must satisfy normal . w >= least.
	struct Barrier
	{
		int node;
		Vec3d normal;
		double least;   ///< m
		Vec3d fallback; ///< displacement of the wall, which none of its barriers excludes
	};

	void begin( SoftBody& body, double h );
	void enforceBarriers( const std::vector<const btCollisionObject*>& walls );
	void addBarriers( const Obstacle& part, const ObstacleMotion& motion );
	void addMeshBarriers( const Obstacle& mesh, const ObstacleMotion& motion );
	template <class IsFar, class FindTouch>
	void addBarriersOf( const ObstacleMotion& motion, const IsFar& isFar, const FindTouch& find );
	void constrain( std::size_t first, std::size_t end, bool isLast );

	SoftBody* m_body = nullptr;
	double m_h = 0.0;
	bool m_hasInnerNodes = false;
	std::vector<int> m_nodes, m_corrected;     ///< to be tested in this round, and in the next
	std::vector<int> m_changed;                ///< nodes corrected in any round
	std::vector<Vec3d> m_from, m_displacement; ///< by node, m
	std::vector<Barrier> m_barriers;
	btSphereShape m_sphere{ btScalar( 1 ) };
};

} // namespace pliant
