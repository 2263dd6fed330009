#pragma once

// Work that is refused: checks within it throw, and the call that does the work returns the refusal.

#include "pliant/result.h"

#include <new>
#include <stdexcept>
#include <type_traits>
#include <utility>

namespace pliant {

/// Thrown by checks within `attempt`.
struct Refusal
{
	Status status;
};

[[noreturn]] inline void reject( ResultCode code, std::string sentence )
{
	throw Refusal{ Status{ code, std::move( sentence ) } };
}

inline void rejectIf( bool isBad, ResultCode code, const char* sentence )
{
	if ( isBad )
	{
		reject( code, sentence );
	}
}

/// The same for a bad argument of a public call, which is named.
inline void rejectIf( bool isBad, const char* call, const char* why )
{
	if ( isBad )
	{
		std::string sentence = call; // appended piece by piece: GCC warns of the sum where a sanitizer is on
		sentence += ": ";
		sentence += why;
		reject( ResultCode::BadArgument, std::move( sentence ) );
	}
}

/// Rejects with a refusal of a call within the work.
inline void insist( Status status )
{
	if ( !status.ok() )
	{
		reject( status.code, std::move( status.sentence ) );
	}
}

/// The value of a call within the work, or its refusal.
template <class T>
T insist( Result<T> result )
{
	insist( std::move( result.status ) );
	return std::move( result.value );
}

/// Work that returns nothing has a Status, other work what it returns: a Status or a Result.
template <class Work>
using OutcomeOf = std::conditional_t<std::is_void_v<std::invoke_result_t<Work>>, Status, std::invoke_result_t<Work>>;

template <class Outcome>
Outcome failed( Status status )
{
	if constexpr ( std::is_same_v<Outcome, Status> )
	{
		return status;
	}
	else
	{
		return Outcome{ std::move( status ), {} };
	}
}

/// Does the work; returns its outcome, or why it was rejected.
template <class Work>
OutcomeOf<Work&> attempt( Work&& work )
{
	try
	{
		if constexpr ( std::is_void_v<std::invoke_result_t<Work&>> )
		{
			work();
			return {};
		}
		else
		{
			return work();
		}
	}
	catch ( Refusal& refusal )
	{
		return failed<OutcomeOf<Work&>>( std::move( refusal.status ) );
	}
}

/// The sentence of OutOfMemory where a template or a mesh cannot be built.
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

/// The same for work that may need more memory than there is, also for the length that an array would have.
template <class Work>
OutcomeOf<Work&> withinMemory( const char* sentence, Work&& work )
{
	try
	{
		return attempt( work );
	}
	catch ( const std::bad_alloc& )
	{}
	catch ( const std::length_error& )
	{}
	return failed<OutcomeOf<Work&>>( outOfMemory( sentence ) );
}

} // namespace pliant
