#pragma once

// Tasks that may run out of memory: what a pool's thread must not throw is thrown again in the building thread.

#include "threads/parallel.h"

#include <atomic>
#include <new>

namespace pliant {

template <class F>
void runGuarded( TaskRunner* runner, int count, F& task )
{
	std::atomic<bool> isOutOfMemory = false;
	auto guarded = [&]( int index ) {
		try
		{
			task( index );
		}
		catch ( const std::bad_alloc& )
		{
			isOutOfMemory = true;
		}
	};
	runTasks( runner, count, guarded );
	if ( isOutOfMemory )
	{
		throw std::bad_alloc();
	}
}

} // namespace pliant
