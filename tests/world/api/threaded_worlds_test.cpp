// Soft bodies in Bullet's multithreaded world: dispatcher, islands and solvers on several threads. With a Bullet that is not built for
// threads (BT_THREADSAFE), such as Debian's, the same on one thread; .ci/run builds one that is.

#include "world/bases/stage_over.h"

#include <BulletCollision/CollisionDispatch/btCollisionDispatcherMt.h>
#include <LinearMath/btThreads.h>

#include <pliant/task_runner.h>

#include <cstring>

void btPushThreadsAreRunning(); // Bullet's, for schedulers; in no header
void btPopThreadsAreRunning();

namespace pliant {
namespace {

using test::at;
using test::materialOf;

/// Bullet's tasks on a pool of ours, with as many threads as a test requires, independently of the number of processors.
class PoolScheduler : public btITaskScheduler
{
public:
	PoolScheduler() : btITaskScheduler( "pool" )
	{
		for ( int threads = 1; threads <= kMostThreads; ++threads )
		{
			m_pools.push_back( createThreadPool( threads ) );
		}
	}
	int getMaxNumThreads() const override { return kIndices; }
	int getNumThreads() const override { return kIndices; } // Bullet numbers the threads of all pools consecutively
	void setNumThreads( int count ) override { m_used = std::size_t( count ) - 1; }
	void parallelFor( int begin, int end, int grain, const btIParallelForBody& body ) override
	{
		run( begin, end, grain, [&body]( int, int from, int to ) { body.forLoop( from, to ); } );
	}
	btScalar parallelSum( int begin, int end, int grain, const btIParallelSumBody& body ) override
	{
		std::vector<btScalar> part( std::size_t( end - begin ) );
		run( begin, end, grain, [&]( int chunk, int from, int to ) { part[std::size_t( chunk )] = body.sumLoop( from, to ); } );
		btScalar sum = 0;
		for ( const btScalar value : part )
		{
			sum += value;
		}
		return sum;
	}

private:
	static constexpr int kMostThreads = 4, kIndices = 32;

	template <class Work>
	void run( int begin, int end, int grain, const Work& work )
	{
		struct Task
		{
			int begin, end, grain;
			const Work& work;
		} task{ begin, end, std::max( grain, 1 ), work };
		const auto call = []( void* context, int chunk ) {
			const Task& of = *static_cast<Task*>( context );
			const int from = of.begin + chunk * of.grain;
			of.work( chunk, from, std::min( from + of.grain, of.end ) );
		};
		btPushThreadsAreRunning();
		m_pools[m_used]->run( ( end - begin + task.grain - 1 ) / task.grain, call, &task );
		btPopThreadsAreRunning();
	}

	std::vector<std::unique_ptr<TaskRunner>> m_pools; ///< by number of threads minus 1
	std::size_t m_used = 0;
};

PoolScheduler& scheduler()
{
	static PoolScheduler pools;
	return pools;
}

/// Parts of Bullet's that use four threads at most, by the scheduler above.
struct ThreadedParts
{
	template <class World>
	std::unique_ptr<World> make()
	{
		return std::make_unique<World>( &dispatcher, &broadphase, &solver, nullptr, &configuration );
	}

	btDefaultCollisionConfiguration configuration;
	btCollisionDispatcherMt dispatcher{ &configuration, 4 }; ///< 4 pairs a task
	btDbvtBroadphase broadphase;
	btConstraintSolverPoolMt solver{ 4 };
};

/// Towers of boxes, soft cubes of both solvers under and on boxes, and a brittle one that falls on a box.
class ThreadedScene
{
public:
	/// With explicit bodies Bullet's narrow phase is called pair by pair, since the step is divided; without them on all threads at once.
	ThreadedScene( int threads, Elasticity elasticity ) : m_threads( useThreads( threads ) )
	{
		for ( int tower = 0; tower < 6; ++tower )
		{
			const btScalar x = btScalar( 3 * tower );
			for ( int k = 0; k < 4; ++k )
			{
				m_stage.addBox( 10, btVector3( btScalar( 0.4 ), btScalar( 0.2 ), btScalar( 0.4 ) ),
					at( x + btScalar( 0.1 ) * btScalar( k % 2 ), btScalar( 1.4 + 0.45 * k ), 0 ) );
			}
			m_stage.addCube( at( x, btScalar( 0.55 ), 0 ), materialOf( tower % 2 == 0 ? Elasticity::Implicit : elasticity ) );
			m_stage.addCube( at( x, btScalar( 3.9 ), 0 ), materialOf( Elasticity::Implicit ) );
			m_stage.addBox( 1, btVector3( btScalar( 0.2 ), btScalar( 0.2 ), btScalar( 0.2 ) ), at( x, btScalar( 0.25 ), 3 ) );
		}
		Fracture brittle;
		brittle.rule = BreakRule::Distance;
		brittle.breakStrain = 0.02f;
		EXPECT_TRUE(
			m_stage.addCube( at( 0, 4, 3 ), materialOf( elasticity ), brittle )->setLinearVelocity( btVector3( 0, -12, 0 ) ).ok() );
	}
	void run( int frames )
	{
		for ( int frame = 0; frame < frames; ++frame )
		{
			m_stage.run( 1 );
			for ( const auto& body : m_stage.rigid )
			{
				note( body->getWorldTransform().getOrigin() );
				note( body->getLinearVelocity() );
			}
			for ( int k = 0; k < m_stage.world->softBodyCount(); ++k )
			{
				const SoftBody& body = *m_stage.world->softBody( k );
				EXPECT_TRUE( body.isHealthy() );
				for ( int i = 0; i < body.nodeCount(); ++i )
				{
					note( body.nodePosition( i ) );
				}
			}
		}
	}
	const std::vector<btScalar>& track() const { return m_track; }
	int fragments() const { return m_stage.world->fragmentCount(); }

private:
	static int useThreads( int threads )
	{
		scheduler().setNumThreads( threads );
		btSetTaskScheduler( &scheduler() );
		return threads;
	}
	void note( const btVector3& value ) { m_track.insert( m_track.end(), { value.x(), value.y(), value.z() } ); }

	int m_threads; ///< in use; set before the dispatcher, which reads it, is constructed
	test::StageOver<btDiscreteDynamicsWorldMt, ThreadedParts> m_stage;
	std::vector<btScalar> m_track;
};

class ThreadedWorlds : public testing::TestWithParam<Elasticity>
{};

TEST_P( ThreadedWorlds, BitsDoNotDependOnTheNumberOfThreads )
{
	std::vector<btScalar> first;
	for ( const int threads : { 1, 2, 3, 4 } )
	{
		ThreadedScene scene( threads, GetParam() );
		scene.run( 45 );
		EXPECT_GT( scene.fragments(), 0 );
		first = threads == 1 ? scene.track() : first;
		ASSERT_EQ( scene.track().size(), first.size() ) << threads << " threads";
		EXPECT_EQ( std::memcmp( scene.track().data(), first.data(), first.size() * sizeof( btScalar ) ), 0 ) << threads << " threads";
	}
	btSetTaskScheduler( btGetSequentialTaskScheduler() );
}

INSTANTIATE_TEST_SUITE_P( All, ThreadedWorlds, testing::Values( Elasticity::Explicit, Elasticity::Implicit ) );

} // namespace
} // namespace pliant
