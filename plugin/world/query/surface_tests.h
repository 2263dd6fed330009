#pragma once

// The collision algorithm of Bullet's contact tests (contactTest, contactPairTest) for pairs with a soft body: its drawn surface against
// the other object, of any shape.

#include <BulletCollision/BroadphaseCollision/btCollisionAlgorithm.h>

class btDispatcher;

namespace pliant {

class SurfaceTest : public btCollisionAlgorithm
{
public:
	using btCollisionAlgorithm::btCollisionAlgorithm;

	/// Adds one contact point for each triangle of the surface that is nearer to the other object than the test's threshold, and one for an
	/// object whose centre is inside. Normals point out of the soft body.
	void processCollision( const btCollisionObjectWrapper* body0, const btCollisionObjectWrapper* body1, const btDispatcherInfo& info,
		btManifoldResult* result ) override;
	btScalar calculateTimeOfImpact( btCollisionObject*, btCollisionObject*, const btDispatcherInfo&, btManifoldResult* ) override
	{
		return btScalar( 1 );
	}
	void getAllContactManifolds( btManifoldArray& ) override {}

	/// Whether it is the shape of a deformable soft body as a whole.
	static bool isSurface( const btCollisionObjectWrapper& wrapper );
};

} // namespace pliant
