// Forces on a body's nodes and the resulting motion against scalar loops, on every instruction set and any number of threads.

#include "support/block_body.h"

#include "matching/kernels/kernels.h"
#include "pliant/task_runner.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <limits>
#include <utility>
#include <vector>

namespace pliant {
namespace {

constexpr float kMotionStep = 1.0f / 240.0f;
const Vec3 kGravity( 0.5f, -9.81f, 2.0f );

/// More nodes than one task's range has, and not a multiple of the lanes.
std::unique_ptr<Body> makeMoving( unsigned seed )
{
	auto body = test::makeBlock( 13, 11, 9, 0.1f );
	test::Seeded random( seed );
	for ( int i = 0; i < body->nodeCount(); ++i )
	{
		body->nodes().v.set( i, random.inBox( 3.0f ) );
	}
	body->setPinned( 700, true );
	return body;
}

bool haveEqualBits( const Vec3Array& a, const Vec3Array& b )
{
	return a.x == b.x && a.y == b.y && a.z == b.z;
}

TEST( Motion, SumsEqualTheReferenceImplementation )
{
	const auto body = makeMoving( 1 );
	for ( int k = 0; k < 3; ++k )
	{
		body->applyForces( kMotionStep, kGravity );
		ASSERT_EQ( body->integrate( kMotionStep ), BodyHealth::Good );
		const MotionSums &sums = body->motion(), twin = body->measureMotion();
		EXPECT_NEAR( sums.mass, twin.mass, 1e-12 * twin.mass );
		EXPECT_NEAR( sums.squareSpeed, twin.squareSpeed, 1e-12 * twin.squareSpeed );
		for ( int axis = 0; axis < 3; ++axis )
		{
			EXPECT_NEAR( sums.moment[axis], twin.moment[axis], 1e-12 * twin.mass );
		}
		EXPECT_EQ( sums.worst, 0.0f );
	}
}

// Three nodes of a piece at rest were reported to spin by 94 rad/s: their inertia about their line is next to nothing.
TEST( Motion, NearlyCollinearNodesHardlySpinAboutTheirLine )
{
	const auto body = test::makeBlock( 3, 1, 1, 0.1f );
	body->nodes().x.set( 1, body->nodes().x.get( 1 ) + Vec3( 0, 0.001f, 0 ) );
	body->nodes().v.set( 1, Vec3( 0, 0, 0.1f ) );
	EXPECT_LT( body->angularVelocity().norm(), 1.0 ); // .1 m/s a cell; 100 rad/s of a rigid body with these nodes
	body->nodes().v.set( 0, Vec3( 0, -0.2f, 0 ) );
	body->nodes().v.set( 1, Vec3( 0, 0, 0 ) );
	body->nodes().v.set( 2, Vec3( 0, 0.2f, 0 ) );
	EXPECT_NEAR( body->angularVelocity().z(), 2.0, 0.01 );
}

// A body of one cell has no inertia: the least one about its axes was divided by it.
TEST( Motion, OneNodeDoesNotSpin )
{
	const auto body = test::makeBlock( 1, 1, 1, 0.1f );
	body->nodes().v.set( 0, Vec3( 1, 2, 3 ) );
	EXPECT_TRUE( body->inverseInertia( body->sums() ).isZero( 0.0 ) );
	EXPECT_TRUE( body->angularVelocity().isZero( 0.0 ) );
	EXPECT_TRUE( body->angularVelocityOf( Vec3d( 1, 2, 3 ) ).isZero( 0.0 ) );
}

TEST( Motion, ForcesAreAddedNodeByNodeAndTheirSpeedsSpanned )
{
	const auto body = makeMoving( 2 );
	NodeState& nodes = body->nodes();
	nodes.force.resize( nodes.padded );
	nodes.force.set( 1200, Vec3( 0, 500, 0 ) );
	nodes.force.set( 700, Vec3( 0, 500, 0 ) ); // pinned
	const Vec3Array before = nodes.v;
	body->applyForces( kMotionStep, kGravity );
	Vec3 low = Vec3::Zero(), high = Vec3::Zero();
	for ( int i = 0; i < nodes.count; ++i )
	{
		const Vec3 pushed = before.get( i ) + nodes.freedom[i] * kMotionStep * ( kGravity + nodes.force.get( i ) / nodes.mass[i] );
		EXPECT_LT( ( nodes.v.get( i ) - pushed ).norm(), 1e-5f ) << i;
		low = low.cwiseMin( nodes.v.get( i ) );
		high = high.cwiseMax( nodes.v.get( i ) );
	}
	EXPECT_EQ( nodes.v.get( 700 ), before.get( 700 ) );
	EXPECT_GT( nodes.v.get( 1200 ).y(), before.get( 1200 ).y() + 1.0f );
	EXPECT_EQ( Vec3( body->velocities().low ), low );
	EXPECT_EQ( Vec3( body->velocities().high ), high );
	EXPECT_EQ( body->velocities().worst, 0.0f );
	nodes.v.z[nodes.count - 1] = std::numeric_limits<float>::infinity();
	body->applyForces( kMotionStep, kGravity );
	EXPECT_NE( body->velocities().worst, 0.0f );
}

TEST( Motion, IsTheSameToTheBitOnAnyThreadCount )
{
	const auto alone = makeMoving( 3 ), shared = makeMoving( 3 );
	const auto threads = createThreadPool( 3 );
	for ( int k = 0; k < 5; ++k )
	{
		for ( const auto& [body, runner] : { std::pair( alone.get(), (TaskRunner*)nullptr ), std::pair( shared.get(), threads.get() ) } )
		{
			body->accelerateTowardGoals( kMotionStep, 0.5f, runner );
			body->applyForces( kMotionStep, kGravity, runner );
			ASSERT_EQ( body->integrate( kMotionStep, runner ), BodyHealth::Good );
		}
		EXPECT_TRUE( haveEqualBits( alone->nodes().x, shared->nodes().x ) );
		EXPECT_TRUE( haveEqualBits( alone->nodes().v, shared->nodes().v ) );
		EXPECT_TRUE( haveEqualBits( alone->velocityBefore(), shared->velocityBefore() ) );
		EXPECT_EQ( std::memcmp( &alone->motion(), &shared->motion(), offsetof( MotionSums, worst ) ), 0 );
	}
}

// The last finite state is one of two buffers, which are swapped in each substep: the body must not return to a state that the task with
// the bad number has written in part.
TEST( Motion, RestoresTheLastFinitePositionsForABadNumberAnywhere )
{
	const auto body = makeMoving( 4 );
	for ( const int bad : { 0, 640, body->nodeCount() - 1 } )
	{
		for ( int good = 1; good <= 2; ++good )
		{
			for ( int k = 0; k < good; ++k )
			{
				ASSERT_EQ( test::substep( *body, kMotionStep, 0.5f, kGravity ), BodyHealth::Good );
			}
			const Vec3Array last = body->nodes().x;
			body->nodes().v.z[bad] = std::numeric_limits<float>::quiet_NaN();
			EXPECT_EQ( body->integrate( kMotionStep ), BodyHealth::Quarantined );
			EXPECT_TRUE( haveEqualBits( body->nodes().x, last ) ) << bad;
			EXPECT_EQ( body->motion().squareSpeed, 0.0 );
		}
	}
}

TEST( Motion, KernelsGiveTheSameBitsOnEveryInstructionSet )
{
	const auto body = makeMoving( 5 );
	const int padded = body->nodes().padded;
	struct Moved
	{
		NodeState nodes;
		Vec3Array kept;
		VelocityBounds span;
		MotionSums sums;
	};
	std::vector<Moved> moved;
	for ( const KernelTarget target : { KernelTarget::Baseline, KernelTarget::Avx2, KernelTarget::Avx512 } )
	{
		const Kernels* const kernels = findKernels( target );
		if ( kernels == nullptr )
		{
			continue;
		}
		Moved& one = moved.emplace_back();
		one.nodes = body->nodes();
		one.kept.resize( padded );
		MotionView view;
		float* const arrays[3][3] = { { one.nodes.x.x.data(), one.nodes.x.y.data(), one.nodes.x.z.data() },
			{ one.nodes.v.x.data(), one.nodes.v.y.data(), one.nodes.v.z.data() },
			{ one.kept.x.data(), one.kept.y.data(), one.kept.z.data() } };
		std::copy_n( arrays[0], 3, view.x );
		std::copy_n( arrays[1], 3, view.v );
		std::copy_n( arrays[2], 3, view.kept );
		view.mass = one.nodes.mass.data();
		view.freedom = one.nodes.freedom.data();
		kernels->push( view, kGravity.data(), kMotionStep, 0, padded, one.span );
		kernels->advance( view, kMotionStep, 0, padded, one.sums );
		EXPECT_TRUE( haveEqualBits( one.nodes.x, one.kept ) );
	}
	for ( const Moved& one : moved )
	{
		EXPECT_TRUE( haveEqualBits( one.nodes.x, moved[0].nodes.x ) );
		EXPECT_TRUE( haveEqualBits( one.nodes.v, moved[0].nodes.v ) );
		EXPECT_EQ( std::memcmp( one.span.low, moved[0].span.low, sizeof( one.span.low ) ), 0 );
		EXPECT_EQ( std::memcmp( one.span.high, moved[0].span.high, sizeof( one.span.high ) ), 0 );
		EXPECT_EQ( one.sums.mass, moved[0].sums.mass );
		EXPECT_EQ( one.sums.squareSpeed, moved[0].sums.squareSpeed );
		EXPECT_EQ( std::memcmp( one.sums.moment, moved[0].sums.moment, sizeof( one.sums.moment ) ), 0 );
	}
}

} // namespace
} // namespace pliant
