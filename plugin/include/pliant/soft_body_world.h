#pragma once

// Drop-in replacement for btDiscreteDynamicsWorld. Without a soft body in it, it is that world, bit for bit. For Bullet's other
// worlds see soft_body_world_over.h.

#include "pliant/soft_body_world_over.h"

namespace pliant {

/// A btDiscreteDynamicsWorld that holds soft bodies too. SoftBodyHost declares the calls beyond Bullet's own.
class PLIANT_API SoftBodyWorld : public SoftBodyWorldOver<btDiscreteDynamicsWorld>
{
public:
	BT_DECLARE_ALIGNED_ALLOCATOR();

	/// As btDiscreteDynamicsWorld; works with any dispatcher, broadphase, solver and configuration.
	SoftBodyWorld(
		btDispatcher* dispatcher, btBroadphaseInterface* broadphase, btConstraintSolver* solver, btCollisionConfiguration* configuration );
	~SoftBodyWorld() override;
};

} // namespace pliant
