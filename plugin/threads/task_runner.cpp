// A small pool of threads that share out one run of tasks after the other. Tasks are claimed by an atomic counter; the caller works
// too. Nothing is allocated in a run.

#include "pliant/task_runner.h"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <mutex>
#include <new>
#include <system_error>
#include <thread>
#include <vector>

namespace pliant {

TaskRunner::~TaskRunner() = default;

namespace {

constexpr int kMostThreads = 64;

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
				m_threads.emplace_back( [this] { serve(); } );
			}
		}
		catch ( const std::system_error& )
		{
			// The system gives no more threads: those there are will do.
		}
	}

	~Pool() override
	{
		{
			const std::lock_guard<std::mutex> lock( m_mutex );
			m_isEnding = true;
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
		{
			const std::lock_guard<std::mutex> lock( m_mutex );
			m_task = task;
			m_context = context;
			m_count = count;
			m_next.store( 0, std::memory_order_relaxed );
			m_busy = int( m_threads.size() );
			++m_round;
		}
		m_wake.notify_all();
		work( task, context, count );

		// Every helper must have seen this round before the next may begin, or a late one would claim tasks of the wrong run.
		std::unique_lock<std::mutex> lock( m_mutex );
		m_done.wait( lock, [this] { return m_busy == 0; } );
	}

	int threadCount() const override { return int( m_threads.size() ) + 1; }

private:
	void work( Task task, void* context, int count )
	{
		for ( int i = m_next.fetch_add( 1, std::memory_order_relaxed ); i < count; i = m_next.fetch_add( 1, std::memory_order_relaxed ) )
		{
			task( context, i );
		}
	}

	void serve()
	{
		unsigned long seen = 0;
		std::unique_lock<std::mutex> lock( m_mutex );
		while ( true )
		{
			m_wake.wait( lock, [&] { return m_isEnding || m_round != seen; } );
			if ( m_isEnding )
			{
				return;
			}
			seen = m_round;
			const Task task = m_task;
			void* const context = m_context;
			const int count = m_count;
			lock.unlock();
			work( task, context, count );
			lock.lock();
			if ( --m_busy == 0 )
			{
				m_done.notify_one();
			}
		}
	}

	std::vector<std::thread> m_threads;
	std::mutex m_mutex;
	std::condition_variable m_wake, m_done;
	std::atomic<int> m_next{ 0 };
	Task m_task = nullptr;
	void* m_context = nullptr;
	int m_count = 0;
	int m_busy = 0;
	unsigned long m_round = 0;
	bool m_isEnding = false;
};

} // namespace

std::unique_ptr<TaskRunner> createThreadPool( int threadCount )
{
	try
	{
		const int threads = std::clamp( threadCount, 1, kMostThreads );
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
