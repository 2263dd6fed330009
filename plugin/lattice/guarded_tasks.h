#pragma once

// Tasks that may run out of memory: pool threads must not throw, so the exception is rethrown in the building thread.

#include "threads/parallel.h"

#include <atomic>
#include <new>
#include <vector>

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

/// Appends the results of each task, in the order of the tasks, and frees them.
template <class T>
void appendAll( std::vector<std::vector<T>>& parts, std::vector<T>& out )
{
	std::size_t total = out.size();
	for ( const auto& part : parts )
	{
		total += part.size();
	}
	out.reserve( total );
	for ( auto& part : parts )
	{
		out.insert( out.end(), part.begin(), part.end() );
		std::vector<T>().swap( part );
	}
}

} // namespace pliant
