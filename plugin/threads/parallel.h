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
		runner->run( count, []( void* context, int index ) { ( *static_cast<F*>( context ) )( index ); }, &task );
		return;
	}
	for ( int i = 0; i < count; ++i )
	{
		task( i );
	}
}

/// Pieces a range is cut into at most. What is summed up piece by piece, and the pieces in order, is the same for any number of threads.
constexpr int kMostPieces = 16;
/// Entries a piece has at least: some microseconds of work, which is what handing out a task costs.
constexpr int kLeastPiece = 1024;

/// A value for each piece, without memory from the heap.
template <class T>
using OfPieces = std::array<T, kMostPieces>;

/// 0 .. count - 1, cut into pieces by nothing but how many there are.
struct Pieces
{
	int count;

	/// A multiple of 16, so that no two pieces write to one line of the cache.
	int size() const { return std::max( kLeastPiece, ( ( count + kMostPieces - 1 ) / kMostPieces + 15 ) / 16 * 16 ); }
	int pieces() const { return ( count + size() - 1 ) / size(); }
	int begin( int piece ) const { return piece * size(); }
	int end( int piece ) const { return std::min( count, ( piece + 1 ) * size() ); }
};

/// work( piece, begin, end ) for each.
template <class F>
void runPieces( TaskRunner* runner, const Pieces& range, F&& work )
{
	auto task = [&]( int piece ) { work( piece, range.begin( piece ), range.end( piece ) ); };
	runTasks( runner, range.pieces(), task );
}

} // namespace pliant
