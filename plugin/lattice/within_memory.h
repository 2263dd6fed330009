#pragma once

// Work that may need more memory than there is.

#include "pliant/result.h"

#include <new>
#include <stdexcept>
#include <type_traits>
#include <utility>

namespace pliant {

/// What is said where a template or a mesh cannot be made.
inline constexpr const char* kNoMemoryToBuild = "Not enough memory to build the body; a larger LatticeSettings::cellSize needs less.";

inline Status outOfMemory( const char* sentence ) noexcept
{
	Status status;
	status.code = ResultCode::OutOfMemory;
	try
	{
		status.sentence = sentence;
	}
	catch ( const std::bad_alloc& )
	{
		status.sentence = "Out of memory."; // short enough to be stored without an allocation
	}
	return status;
}

/// Returns what `work` returns, a Status or a Result; OutOfMemory with the sentence where memory does not suffice, also for the length that
/// an array would have.
template <class Work>
auto withinMemory( const char* sentence, Work&& work ) -> decltype( work() )
{
	try
	{
		return work();
	}
	catch ( const std::bad_alloc& )
	{}
	catch ( const std::length_error& )
	{}
	if constexpr ( std::is_same_v<decltype( work() ), Status> )
	{
		return outOfMemory( sentence );
	}
	else
	{
		return { outOfMemory( sentence ), {} };
	}
}

} // namespace pliant
