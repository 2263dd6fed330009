// Bodies that rotate as a whole: nearly collinear fragments receive no spin about their axis.

#include "support/test_world.h"
#include "world/bodies/soft_body_impl.h"
#include "world/levels/adaptive_bodies.h"
#include "world/shape/rigid_motion_proxy.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

namespace pliant::test {
namespace {

/// A bar of three cells of .1 m, its middle node offset by so many cells from the line through the others.
struct BentBar
{
	SoftWorld world;
	SoftBody* body;

	explicit BentBar( float cells ) : body( world.add( block( 3, 1, 1, 0.1f ), btVector3( 0, 0, 0 ) ) )
	{
		NodeState& nodes = body->impl().body->nodes();
		nodes.x.set( 1, nodes.x.get( 1 ) + Vec3( 0, 0.1f * cells, 0 ) );
	}
	double fastest() const
	{
		double most = 0.0;
		for ( int i = 0; i < body->nodeCount(); ++i )
		{
			most = std::max( most, double( body->nodeVelocity( i ).length() ) );
		}
		return most;
	}
	/// Angular impulse about the line, N m s: enough to give nodes half a cell off the line 1 m/s.
	double impulse() const { return double( body->mass() ) * 0.05; }
};

/// A fragment of three nodes a fiftieth of a cell off a line has none of the inertia about it that its cells would have. The friction
/// torque correction must not spin it until it flies apart.
TEST( RigidMotionProxy, DoesNotSpinNearlyCollinearFragments )
{
	for ( const float beside : { 0.0f, 0.001f, 0.02f, 0.1f } )
	{
		BentBar bar( beside );
		RigidMotionProxy( bar.body ).turn( Vec3d( bar.impulse(), 0, 0 ) );
		std::printf( "%g cells beside a line: %.1f m/s\n", double( beside ), bar.fastest() );
		EXPECT_LT( bar.fastest(), 1.0 ) << beside;
		RigidMotionProxy( bar.body ).turn( Vec3d( 0, 0, bar.impulse() ) );
		EXPECT_GT( bar.fastest(), 0.1 ) << "it rotates about other axes";
	}
}

TEST( RigidMotionProxy, PassesTheFullImpulseToThickBodies )
{
	BentBar bar( 0.6f );
	const Vec3d impulse( 0.3 * bar.impulse(), -0.1 * bar.impulse(), 0.2 * bar.impulse() );
	RigidMotionProxy( bar.body ).turn( impulse );
	EXPECT_LT( ( toVec3d( bar.body->angularMomentum() ) - impulse ).norm(), 1e-5 * impulse.norm() );
}

} // namespace
} // namespace pliant::test
