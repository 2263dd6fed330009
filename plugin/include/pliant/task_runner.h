#pragma once

// Interface for parallel work: Pliant's own thread pool, or the game's task system behind the same interface.

#include "pliant/export.h"

#include <memory>

namespace pliant {

/// Runs independent tasks. No result of Pliant depends on how tasks are distributed over threads.
class PLIANT_API TaskRunner
{
public:
	/// One task: `context` as given to `run`, `index` its number.
	using Task = void ( * )( void* context, int index );

	virtual ~TaskRunner();

	/// Calls `task( context, i )` once for each i in [0, count), in any order, on any threads; returns when all have finished.
	/// Called from one thread at a time. Tasks do not throw and do not call `run`.
	virtual void run( int count, Task task, void* context ) = 0;

	/// Number of tasks that can run at the same time, at least 1.
	virtual int threadCount() const = 0;
};

/// Creates a pool of `threadCount` threads including the calling one, clamped to [1, 64]. With 1 no thread is started and tasks run in the
/// caller. Null only when out of memory.
[[nodiscard]] PLIANT_API std::unique_ptr<TaskRunner> createThreadPool( int threadCount );

} // namespace pliant
