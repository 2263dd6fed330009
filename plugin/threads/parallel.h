#pragma once

// A loop over independent tasks, in the calling thread or through a TaskRunner. Each task writes only its own data, so that results do not
// depend on the distribution over threads.

#include "pliant/task_runner.h"
#include "threads/constants.h"

#include <algorithm>
#include <array>

namespace pliant {

template <class F>
void runTasks( TaskRunner* runner, int count, F& task )
{
	if ( runner && count > 1 && runner->threadCount() > 1 )
	{
		runner->run(
			count, []( void* context, int index ) { ( *static_cast<F*>( context ) )( index ); }, &task );
		return;
	}
	for ( int i = 0; i < count; ++i )
	{
		task( i );
	}
}

/// A value per chunk, without heap memory.
template <class T>
using PerChunk = std::array<T, kMaxChunks>;

/// 0 .. count - 1, divided into chunks depending only on the count.
struct ChunkedRange
{
	int count;

	/// A multiple of 16, so that no two chunks write to the same cache line.
	int size() const { return std::max( kMinChunkSize, ( ( count + kMaxChunks - 1 ) / kMaxChunks + 15 ) / 16 * 16 ); }
	int chunks() const { return ( count + size() - 1 ) / size(); }
	int begin( int chunk ) const { return chunk * size(); }
	int end( int chunk ) const { return std::min( count, ( chunk + 1 ) * size() ); }
};

/// Calls work( chunk, begin, end ) for each chunk.
template <class F>
void runChunks( TaskRunner* runner, const ChunkedRange& range, F&& work )
{
	auto task = [&]( int chunk ) { work( chunk, range.begin( chunk ), range.end( chunk ) ); };
	runTasks( runner, range.chunks(), task );
}

} // namespace pliant
