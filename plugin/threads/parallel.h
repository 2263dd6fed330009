#pragma once

// One loop over independent tasks, in the calling thread or through a TaskRunner. Tasks write to their own places only, so that
// results do not depend on how they are spread.

#include "pliant/task_runner.h"

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

/// Shares a range is cut into at most. What is summed up share by share, and the shares in order, is the same for any number of threads.
constexpr int kMostShares = 16;
/// Entries a share has at least: some microseconds of work, which is what handing out a task costs.
constexpr int kLeastShare = 1024;

/// A value for each share, without memory from the heap.
template <class T>
using OfFractions = std::array<T, kMostShares>;

/// 0 .. count - 1, cut into shares by nothing but how many there are.
struct Shares
{
	int count;

	/// A multiple of 16, so that no two shares write to one line of the cache.
	int size() const { return std::max( kLeastShare, ( ( count + kMostShares - 1 ) / kMostShares + 15 ) / 16 * 16 ); }
	int fractions() const { return ( count + size() - 1 ) / size(); }
	int begin( int fraction ) const { return fraction * size(); }
	int end( int fraction ) const { return std::min( count, ( fraction + 1 ) * size() ); }
};

/// work( share, begin, end ) for each.
template <class F>
void runShares( TaskRunner* runner, const Shares& range, F&& work )
{
	auto task = [&]( int fraction ) { work( fraction, range.begin( fraction ), range.end( fraction ) ); };
	runTasks( runner, range.fractions(), task );
}

} // namespace pliant
