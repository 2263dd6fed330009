#include "pliant/soft_body_world.h"

namespace pliant {

SoftBodyWorld::SoftBodyWorld(
	btDispatcher* dispatcher, btBroadphaseInterface* broadphase, btConstraintSolver* solver, btCollisionConfiguration* configuration ) :
	SoftBodyWorldOver( dispatcher, broadphase, solver, configuration )
{}

SoftBodyWorld::~SoftBodyWorld() = default;

} // namespace pliant
