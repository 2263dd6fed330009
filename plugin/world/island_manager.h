#pragma once

// Bullet's island manager, which also tells the nodes' stand-ins which island their body is in. It is asked twice a step: once for the
// union-find's index, once for the final tag.

#include "world/soft_body_system.h"

#include <BulletCollision/CollisionDispatch/btSimulationIslandManager.h>

namespace pliant {

class IslandManager : public btSimulationIslandManager
{
public:
	explicit IslandManager( SoftBodySystem& bodies ) : m_bodies( bodies ) {}

	void updateActivationState( btCollisionWorld* world, btDispatcher* dispatcher ) override
	{
		btSimulationIslandManager::updateActivationState( world, dispatcher );
		m_bodies.copyIslandTags();
	}
	void storeIslandActivationState( btCollisionWorld* world ) override
	{
		btSimulationIslandManager::storeIslandActivationState( world );
		m_bodies.copyIslandTags();
	}

private:
	SoftBodySystem& m_bodies;
};

} // namespace pliant
