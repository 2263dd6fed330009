// A small pool of threads that executes runs of tasks. A run allocates no memory.
//
// One atomic number, the ticket, holds the run's number and the range of tasks not yet taken. Taking a task is one compare-and-swap on it,
// so that a thread that wakes late can neither miss nor confuse a run: no task is left, or the number has changed. For the same reason
// a run does not wait for threads that are asleep.
//
// Half of the threads take tasks from the front, half from the back. The stages of a step divide the same arrays into the same tasks, so
// each of two threads mostly finds the data of the previous stage in its own cache.

#include "pliant/task_runner.h"
#include "threads/constants.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <mutex>
#include <new>
#include <thread>
#include <vector>

namespace pliant {

TaskRunner::~TaskRunner() = default;

namespace {

/// The ticket, from the highest bits down: the run's number, 24 bits; the first remaining task and the end of those, 20 bits each.
constexpr int kTaskBits = 20;
constexpr int kMaxTasks = ( 1 << kTaskBits ) - 1; // per run

struct Ticket
{
	std::uint64_t bits;

	static Ticket of( std::uint32_t run, int count ) { return { std::uint64_t( run ) << ( 2 * kTaskBits ) | std::uint64_t( count ) }; }
	int first() const { return int( bits >> kTaskBits & kMaxTasks ); }
	int end() const { return int( bits & kMaxTasks ); }
	bool hasTask() const { return first() != end(); }
	std::uint64_t withoutFirst() const { return bits + ( std::uint64_t( 1 ) << kTaskBits ); }
	std::uint64_t withoutLast() const { return bits - 1; }
};

class SerialRunner : public TaskRunner
{
public:
	void run( int count, Task task, void* context ) override
	{
		for ( int i = 0; i < count; ++i )
		{
			task( context, i );
		}
	}
	int threadCount() const override { return 1; }
};

class Pool : public TaskRunner
{
public:
	explicit Pool( int helpers )
	{
		m_threads.reserve( helpers );
		try
		{
			for ( int i = 0; i < helpers; ++i )
			{
				m_threads.emplace_back( [this, isFromBack = i % 2 == 0] { serve( isFromBack ); } );
			}
		}
		catch ( const std::exception& )
		{
			// The system provides no more threads, or no memory for them: the pool works with fewer.
		}
		// Where threads share a core, a spinning thread blocks another.
		m_maySpin = m_threads.size() < std::thread::hardware_concurrency();
	}

	~Pool() override
	{
		{
			const std::lock_guard<std::mutex> lock( m_mutex );
			m_isEnding.store( true );
		}
		m_wake.notify_all();
		for ( std::thread& thread : m_threads )
		{
			thread.join();
		}
	}

	void run( int count, Task task, void* context ) override
	{
		if ( count <= 1 || m_threads.empty() )
		{
			for ( int i = 0; i < count; ++i )
			{
				task( context, i );
			}
			return;
		}
		Slice slice{ task, context, 0 };
		for ( ; slice.first + kMaxTasks < count; slice.first += kMaxTasks )
		{
			distribute( kMaxTasks, Slice::call, &slice );
		}
		slice.first > 0 ? distribute( count - slice.first, Slice::call, &slice ) : distribute( count, task, context );
	}

	int threadCount() const override { return int( m_threads.size() ) + 1; }

private:
	/// Part of a run with more tasks than a ticket can count.
	struct Slice
	{
		Task task;
		void* context;
		int first;

		static void call( void* of, int index )
		{
			const Slice& slice = *static_cast<const Slice*>( of );
			slice.task( slice.context, slice.first + index );
		}
	};

	void distribute( int count, Task task, void* context )
	{
		// No task of the last run remains or is running, so these are unused. The ticket publishes them.
		m_task.store( task, std::memory_order_relaxed );
		m_context.store( context, std::memory_order_relaxed );
		m_count.store( count, std::memory_order_relaxed );
		m_finished.store( 0, std::memory_order_relaxed );
		++m_run;
		m_ticket.store( Ticket::of( m_run, count ).bits );
		wakeHelpers( count - 1 );

		work( false );
		waitForEnd( count );
	}

	bool hasWork() const { return Ticket{ m_ticket.load() }.hasTask(); }

	/// Takes and executes tasks until none is left.
	void work( bool isFromBack )
	{
		int done = 0;
		Ticket ticket{ m_ticket.load() };
		while ( ticket.hasTask() )
		{
			// Read before the swap: if they belong to a later run, the ticket has changed and the swap fails.
			const Task task = m_task.load( std::memory_order_relaxed );
			void* const context = m_context.load( std::memory_order_relaxed );
			const int index = isFromBack ? ticket.end() - 1 : ticket.first();
			if ( m_ticket.compare_exchange_weak( ticket.bits, isFromBack ? ticket.withoutLast() : ticket.withoutFirst() ) )
			{
				task( context, index );
				++done;
				ticket.bits = m_ticket.load(); // still of this run: the next cannot begin before these are reported
			}
		}
		report( done );
	}

	void report( int done )
	{
		if ( done > 0 && m_finished.fetch_add( done ) + done == m_count.load( std::memory_order_relaxed ) && m_callerSleeps.load() )
		{
			const std::lock_guard<std::mutex> lock( m_mutex );
			m_end.notify_one();
		}
	}

	void wakeHelpers( int maxCount )
	{
		if ( m_sleepers.load() == 0 )
		{
			return;
		}
		const std::lock_guard<std::mutex> lock( m_mutex ); // a helper is either before its last check of the ticket, or asleep
		for ( int i = std::min( maxCount, m_sleepers.load() ); i > 0; --i )
		{
			m_wake.notify_one();
		}
	}

	void waitForEnd( int count )
	{
		const auto isOver = [&] { return m_finished.load() == count; };
		if ( spinUntil( isOver ) )
		{
			return;
		}
		std::unique_lock<std::mutex> lock( m_mutex );
		m_callerSleeps.store( true );
		m_end.wait( lock, isOver );
		m_callerSleeps.store( false );
	}

	void serve( bool isFromBack )
	{
		const auto isCalled = [this] { return hasWork() || m_isEnding.load(); };
		while ( true )
		{
			if ( !spinUntil( isCalled ) )
			{
				std::unique_lock<std::mutex> lock( m_mutex );
				++m_sleepers;
				m_wake.wait( lock, isCalled );
				--m_sleepers;
			}
			if ( m_isEnding.load() )
			{
				return;
			}
			work( isFromBack );
		}
	}

	/// Returns true where the condition became true within the spin time.
	template <class F>
	bool spinUntil( const F& condition ) const
	{
		if ( condition() )
		{
			return true;
		}
		if ( !m_maySpin.load( std::memory_order_relaxed ) )
		{
			return false;
		}
		const auto limit = std::chrono::steady_clock::now() + std::chrono::microseconds( kSpinTime );
		do
		{
			for ( int check = 0; check < kChecksPerClockRead; ++check )
			{
				if ( condition() )
				{
					return true;
				}
			}
		} while ( std::chrono::steady_clock::now() < limit );
		return false;
	}

	// Variables that all threads write often have cache lines of their own.
	alignas( 64 ) std::atomic<std::uint64_t> m_ticket{ 0 }; ///< see Ticket
	alignas( 64 ) std::atomic<int> m_finished{ 0 };         ///< completed tasks of this run
	alignas( 64 ) std::atomic<Task> m_task{ nullptr };
	std::atomic<void*> m_context{ nullptr };
	std::atomic<int> m_count{ 0 };
	std::atomic<int> m_sleepers{ 0 }; ///< helpers that wait for m_wake; modified under the mutex
	std::atomic<bool> m_callerSleeps{ false };
	std::atomic<bool> m_isEnding{ false };
	std::atomic<bool> m_maySpin{ false };
	std::uint32_t m_run = 0; ///< used only by the caller
	std::mutex m_mutex;
	std::condition_variable m_wake, m_end;
	std::vector<std::thread> m_threads; ///< last: they use all other members
};

} // namespace

std::unique_ptr<TaskRunner> createThreadPool( int threadCount )
{
	try
	{
		const int threads = std::clamp( threadCount, 1, kMaxThreads );
		if ( threads == 1 )
		{
			return std::make_unique<SerialRunner>();
		}
		return std::make_unique<Pool>( threads - 1 );
	}
	catch ( const std::bad_alloc& )
	{
		return nullptr;
	}
}

} // namespace pliant
