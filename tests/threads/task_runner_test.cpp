// The pool runs every task once, for any counts, and returns only when all are done.

#include "pliant/task_runner.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <memory>
#include <thread>
#include <vector>

namespace pliant {
namespace {

/// Counts, without atomics, how often each index was run: two threads on one index, or a run that returns early, are data races.
struct Tally
{
	std::vector<int> hits;

	static void hit( void* context, int index ) { ++static_cast<Tally*>( context )->hits[index]; }

	void expectOnceEach( TaskRunner& runner, int count )
	{
		hits.assign( count, 0 );
		runner.run( count, hit, this );
		for ( int i = 0; i < count; ++i )
		{
			ASSERT_EQ( hits[i], 1 ) << "index " << i << " of " << count;
		}
	}
};

TEST( TaskRunner, RunsEveryIndexOnce )
{
	for ( int threads : { 1, 2, 3, 4, 8 } )
	{
		const std::unique_ptr<TaskRunner> runner = createThreadPool( threads );
		ASSERT_TRUE( runner );
		EXPECT_EQ( runner->threadCount(), threads );
		Tally tally;
		for ( int count : { 0, 1, 2, 3, 7, 100, 10000 } )
		{
			tally.expectOnceEach( *runner, count );
		}
		tally.expectOnceEach( *runner, 0 );
	}
}

TEST( TaskRunner, RunsMoreTasksThanItCanNameAtOnce )
{
	const std::unique_ptr<TaskRunner> runner = createThreadPool( 2 );
	Tally tally;
	for ( int count : { ( 1 << 20 ) - 1, 1 << 20, ( 2 << 20 ) - 2, ( 2 << 20 ) - 1, 5 << 19 } )
	{
		tally.expectOnceEach( *runner, count );
	}
}

TEST( TaskRunner, BearsTenThousandShortRuns )
{
	for ( int threads : { 2, 4 } )
	{
		const std::unique_ptr<TaskRunner> runner = createThreadPool( threads );
		Tally tally;
		for ( int k = 0; k < 10000; ++k )
		{
			tally.expectOnceEach( *runner, k % 6 );
			if ( HasFatalFailure() )
			{
				return;
			}
		}
	}
}

TEST( TaskRunner, WakesAThreadThatSleepsAndLetsBothWorkAtOnce )
{
	// Each task waits for the other: a pool that gave both to one thread, or did not wake the other thread, would never finish.
	const auto meet = []( void* context, int ) {
		std::atomic<int>& arrived = *static_cast<std::atomic<int>*>( context );
		++arrived;
		const auto limit = std::chrono::steady_clock::now() + std::chrono::seconds( 20 );
		while ( arrived.load() < 2 && std::chrono::steady_clock::now() < limit )
		{
			std::this_thread::yield();
		}
		EXPECT_EQ( arrived.load(), 2 );
	};
	const std::unique_ptr<TaskRunner> runner = createThreadPool( 2 );
	for ( int k = 0; k < 20; ++k )
	{
		std::this_thread::sleep_for( std::chrono::milliseconds( k % 2 ) ); // longer than any thread waits actively, or not at all
		std::atomic<int> arrived{ 0 };
		runner->run( 2, meet, &arrived );
		if ( HasFailure() )
		{
			return;
		}
	}
}

TEST( TaskRunner, WaitsForTheLastTask )
{
	const std::unique_ptr<TaskRunner> runner = createThreadPool( 4 );
	std::vector<int> done( 8, 0 );
	const auto slow = []( void* context, int index ) {
		std::this_thread::sleep_for( std::chrono::milliseconds( index == 7 ? 20 : 1 ) );
		( *static_cast<std::vector<int>*>( context ) )[index] = 1;
	};
	runner->run( 8, slow, &done );
	EXPECT_EQ( done, std::vector<int>( 8, 1 ) );
}

TEST( TaskRunner, ClampsTheNumberOfThreads )
{
	EXPECT_EQ( createThreadPool( 0 )->threadCount(), 1 );
	EXPECT_EQ( createThreadPool( -5 )->threadCount(), 1 );
	EXPECT_EQ( createThreadPool( 1 )->threadCount(), 1 );
	const std::unique_ptr<TaskRunner> many = createThreadPool( 1000 );
	EXPECT_EQ( many->threadCount(), 64 );
	Tally tally;
	tally.expectOnceEach( *many, 1000 );
	tally.expectOnceEach( *many, 3 );
}

TEST( TaskRunner, PoolsDoNotKnowEachOther )
{
	// Two games, each with a pool of its own, run from threads of their own.
	const auto game = [] {
		const std::unique_ptr<TaskRunner> runner = createThreadPool( 3 );
		Tally tally;
		for ( int k = 0; k < 1000; ++k )
		{
			tally.expectOnceEach( *runner, k % 17 );
		}
	};
	std::thread other( game );
	game();
	other.join();
}

TEST( TaskRunner, EndsWhileIdle )
{
	for ( int k = 0; k < 100; ++k )
	{
		const std::unique_ptr<TaskRunner> runner = createThreadPool( 1 + k % 5 );
		Tally tally;
		if ( k % 2 == 0 )
		{
			tally.expectOnceEach( *runner, 5 );
		}
	}
}

TEST( TaskRunner, MayBeCalledFromAnotherThreadEachTime )
{
	const std::unique_ptr<TaskRunner> runner = createThreadPool( 2 );
	for ( int k = 0; k < 50; ++k )
	{
		std::thread( [&] {
			Tally tally;
			tally.expectOnceEach( *runner, 20 );
		} ).join();
	}
}

} // namespace
} // namespace pliant
