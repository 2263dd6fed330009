// Eccentric loads on a soft block: which loads lean, by how much, and which must tip. Compared with the theory of columns and with the same
// lattice in very fine explicit steps (docs/design/implicit.md, "Leaning and tipping").

#include "world/test_world.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace pliant {
namespace {

using test::at;
using test::block;
using test::kGravity;
using test::TestWorld;

constexpr double kWeight = 216.0 * kGravity, kArea = 0.36;
constexpr int kFineSubsteps = 64;

/// A box on a block of 6 cells: mass ratio, dimensions and offset in m.
struct Order
{
	double ratio = 1.0;
	double strain = 0.02; ///< the box's weight over E and the block's top face
	double offset = 0.0;
	btVector3 half{ btScalar( 0.3 ), btScalar( 0.3 ), btScalar( 0.3 ) };
	double rampTime = 0.0; ///< time over which gravity is ramped up, s
	Elasticity elasticity = Elasticity::Implicit;
	float numericalDamping = 1.0f;
	int stepsPerFrame = 1; ///< implicit steps per frame
};

struct Outcome
{
	bool stands = true;
	double lean = 0.0; ///< degrees, mean of the last second
};

double leanOf( const btRigidBody& box )
{
	return double( btAcos( btMin( btScalar( 1 ), box.getWorldTransform().getBasis()[1].y() ) ) ) * 180.0 / SIMD_PI;
}

Outcome lay( const Order& order, int frames )
{
	TestWorld t;
	t.addPlane()->setFriction( btScalar( 0.8 ) );
	Material material = test::stiff( float( order.ratio * kWeight / kArea / order.strain ) );
	material.elasticity = order.elasticity;
	material.numericalDamping = order.numericalDamping;
	if ( order.elasticity == Elasticity::Explicit )
	{
		t.world.setMaxSoftSubsteps( kFineSubsteps );
		t.world.setSoftSubsteps( kFineSubsteps );
	}
	SoftBody* cube = t.addSoft( block( 6, 6, 6, 0.1f ), at( 0, btScalar( 0.3 ), 0 ), material );
	cube->setFriction( btScalar( 0.8 ) );
	btRigidBody* box = t.addBox(
		btScalar( order.ratio * 216.0 ), order.half, at( btScalar( order.offset ), btScalar( 0.601 ) + order.half.y(), 0 ) );
	box->setFriction( btScalar( 0.8 ) );
	// Kept awake: Bullet lets a box fall asleep below 0.8 m/s, which would stop a slow sway at any angle.
	cube->setActivationState( DISABLE_DEACTIVATION );
	box->setActivationState( DISABLE_DEACTIVATION );
	Outcome outcome;
	for ( int frame = 0; frame < frames && outcome.stands; ++frame )
	{
		const double fraction = order.rampTime > 0.0 ? std::min( 1.0, ( frame + 1 ) / ( 60.0 * order.rampTime ) ) : 1.0;
		t.world.setGravity( btVector3( 0, btScalar( -kGravity * fraction ), 0 ) );
		for ( int k = 0; k < order.stepsPerFrame; ++k )
		{
			t.world.stepSimulation( test::kFrame / order.stepsPerFrame, 0 );
		}
		outcome.lean += frame >= frames - 60 ? leanOf( *box ) / 60.0 : 0.0;
		outcome.stands = box->getWorldTransform().getOrigin().y() > btScalar( 0.5 );
	}
	EXPECT_TRUE( cube->stiffnessPlan().reachable );
	return outcome;
}

// A column of length L between the outermost layers' centres, its end rotated by the weight W of a rigid box whose centre is c above it and
// e off the axis: EI y'' = W ( D - y ), D = e + y( L ) + c y'( L ). With q^2 = W / EI: y' = D q sin q L, D = e / ( cos q L - c q sin q L ).
double columnLean( const Order& order )
{
	const double length = 0.5, above = 0.05 + double( order.half.y() );
	const double q = std::sqrt( 12.0 * order.strain / 0.36 ); // W / E I = 12 strain / edge^2
	const double shifted = order.offset / ( std::cos( q * length ) - above * q * std::sin( q * length ) );
	return std::atan( shifted * q * std::sin( q * length ) ) * 180.0 / SIMD_PI;
}

TEST( ImplicitLean, OfAnEccentricBoxOfAnyMassIsThatOfAColumn )
{
	for ( const double strain : { 0.005, 0.01, 0.02 } )
	{
		for ( const double ratio : { 10.0, 1000.0 } )
		{
			Order order;
			order.ratio = ratio;
			order.strain = strain;
			order.offset = 0.05;
			const Outcome outcome = lay( order, 600 );
			std::printf( "strain %.3f 1:%-4.0f leans %.3f deg, column %.3f (%+.1f %%)\n", strain, ratio, outcome.lean, columnLean( order ),
				100.0 * ( outcome.lean / columnLean( order ) - 1.0 ) );
			EXPECT_NEAR( outcome.lean / columnLean( order ), 1.0, 0.03 );
		}
	}
}

/// A narrow box along one edge, a third of the block wide.
Order edgeOrder( double ratio )
{
	Order order;
	order.ratio = ratio;
	order.strain = 0.005;
	order.offset = 0.2;
	order.half = btVector3( btScalar( 0.1 ), btScalar( 0.1 ), btScalar( 0.3 ) );
	return order;
}

TEST( ImplicitLean, OfABoxPutDownOnAnEdgeIsThatOfTheSameLatticeInManySubsteps )
{
	Order order = edgeOrder( 10.0 );
	order.rampTime = 2.0;
	const Outcome implicitOne = lay( order, 480 );
	order.elasticity = Elasticity::Explicit;
	const Outcome explicitOne = lay( order, 480 );
	std::printf( "1:10 leans %.3f deg, explicitly in %d substeps %.3f\n", implicitOne.lean, kFineSubsteps, explicitOne.lean );
	EXPECT_TRUE( implicitOne.stands && explicitOne.stands );
	EXPECT_NEAR( implicitOne.lean / explicitOne.lean, 1.0, 0.05 );
	for ( const double ratio : { 100.0, 1000.0 } )
	{
		Order heavier = edgeOrder( ratio );
		heavier.rampTime = 2.0;
		const Outcome outcome = lay( heavier, 480 );
		std::printf( "1:%.0f put down: leans %.3f deg\n", ratio, outcome.lean );
		EXPECT_TRUE( outcome.stands );
		EXPECT_LT( outcome.lean, 2.0 );
	}
}

// Released at once, the load swings beyond its lean at rest and tips. The finely stepped explicit lattice falls like the implicit step in
// fine steps without numerical damping.
TEST( ImplicitLean, ReleasedLoadsTipAsInManySubsteps )
{
	for ( const double ratio : { 7.0, 30.0 } )
	{
		Order order = edgeOrder( ratio );
		order.stepsPerFrame = 16;
		order.numericalDamping = 0.0f;
		const bool implicitStands = lay( order, 150 ).stands;
		order = edgeOrder( ratio );
		order.elasticity = Elasticity::Explicit;
		const bool explicitStands = lay( order, 150 ).stands;
		EXPECT_EQ( implicitStands, ratio == 7.0 );
		EXPECT_EQ( explicitStands, ratio == 7.0 );
	}
}

} // namespace
} // namespace pliant
