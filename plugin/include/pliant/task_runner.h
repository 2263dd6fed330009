#pragma once

// Where Pliant's parallel work goes: its own pool, or the game's through this interface.

#include "pliant/export.h"

#include <memory>

namespace pliant {

/// Runs `count` independent tasks and returns when all are done. Results never depend on how they are spread over threads.
class PLIANT_API TaskRunner
{
public:
	using Task = void ( * )( void* context, int index );

	virtual ~TaskRunner();

	/// Call `task( context, i )` once for each i in [0, count), in any order, on any threads; return after the last.
	/// Called from one thread at a time. Tasks do not throw and do not call `run`.
	virtual void run( int count, Task task, void* context ) = 0;

	/// How many tasks can run at once, at least 1.
	virtual int threadCount() const = 0;
};

/// A pool of `threadCount` threads (the caller counts as one), clamped to [1, 64]. Null only when out of memory.
/// With 1 nothing is started and tasks run in the caller.
PLIANT_API std::unique_ptr<TaskRunner> createThreadPool( int threadCount );

} // namespace pliant
