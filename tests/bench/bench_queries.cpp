// Rays and sweeps at a soft ball from all sides: one after the other, and with the body moved before every twentieth.

#include "lattice/test_meshes.h"
#include "support/surface_queries.h"
#include "support/test_world.h"

#include <benchmark/benchmark.h>

namespace pliant {
namespace {

struct QueriedBall : test::WorldOf<SoftBodyWorld>
{
	explicit QueriedBall( benchmark::State& state )
	{
		LatticeSettings settings;
		settings.cellSize = 0.1f;
		const int rings = int( state.range( 0 ) );
		body = SoftBody::create(
			BodyTemplate::build( test::makeSphere( 0.5, rings, 2 * rings ).view(), settings ).value, btTransform::getIdentity() )
				   .value;
		world.addSoftBody( body.get() );
		state.counters["triangles"] = body->bodyTemplate().triangleCount();
	}
	std::unique_ptr<SoftBody> body;
};

/// `movedEach`: queries between two motions of the body; 0: it does not move.
template <class Ask>
void query( benchmark::State& state, int movedEach, Ask&& ask )
{
	QueriedBall t( state );
	test::RandomPaths paths( *t.body, 1 );
	int asked = 0;
	for ( auto _ : state )
	{
		if ( movedEach > 0 && asked % movedEach == 0 )
		{
			const btScalar by = btScalar( asked % ( 2 * movedEach ) == 0 ? 1e-3 : -1e-3 );
			static_cast<void>( t.body->teleport( btTransform( btQuaternion::getIdentity(), btVector3( by, 0, 0 ) ) ) );
		}
		++asked;
		btVector3 from, to;
		paths.next( from, to );
		ask( t, from, to );
	}
}

void askRay( QueriedBall& t, const btVector3& from, const btVector3& to )
{
	btCollisionWorld::ClosestRayResultCallback ray( from, to );
	t.world.rayTest( from, to, ray );
	benchmark::DoNotOptimize( ray.m_closestHitFraction );
}

void askSweep( QueriedBall& t, const btConvexShape& shape, const btVector3& from, const btVector3& to )
{
	btCollisionWorld::ClosestConvexResultCallback sweep( from, to );
	t.world.convexSweepTest(
		&shape, btTransform( btQuaternion::getIdentity(), from ), btTransform( btQuaternion::getIdentity(), to ), sweep );
	benchmark::DoNotOptimize( sweep.m_closestHitFraction );
}

void queryRays( benchmark::State& state )
{
	query( state, 0, askRay );
}
void queryRaysMoving( benchmark::State& state )
{
	query( state, 20, askRay );
}
void queryBalls( benchmark::State& state )
{
	const btSphereShape ball( btScalar( 0.05 ) );
	query( state, 0, [&ball]( QueriedBall& t, const btVector3& from, const btVector3& to ) { askSweep( t, ball, from, to ); } );
}
void queryBoxes( benchmark::State& state )
{
	const btBoxShape box( btVector3( btScalar( 0.1 ), btScalar( 0.1 ), btScalar( 0.1 ) ) );
	query( state, 0, [&box]( QueriedBall& t, const btVector3& from, const btVector3& to ) { askSweep( t, box, from, to ); } );
}

BENCHMARK( queryRays )->Arg( 24 )->Arg( 120 )->Unit( benchmark::kMicrosecond );
BENCHMARK( queryRaysMoving )->Arg( 24 )->Arg( 120 )->Unit( benchmark::kMicrosecond );
BENCHMARK( queryBalls )->Arg( 24 )->Arg( 120 )->Unit( benchmark::kMicrosecond );
BENCHMARK( queryBoxes )->Arg( 24 )->Arg( 120 )->Unit( benchmark::kMicrosecond );

} // namespace
} // namespace pliant
