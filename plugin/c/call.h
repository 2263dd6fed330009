#pragma once

// Common to all functions of the C face: no exception leaves a function, and a refusal stores a sentence for the thread.

#include "pliant/c/types.h"
#include "pliant/result.h"

#include <cstring>
#include <new>

namespace pliant::c {

/// Keeps the sentence for pliant_last_error; returns the code.
pliant_result refuse( pliant_result code, const char* sentence ) noexcept;
/// The same for an outcome of the library.
pliant_result resultOf( const Status& status ) noexcept;

/// Runs a call's work, which returns a pliant_result.
template <class F>
pliant_result call( F&& work ) noexcept
{
	try
	{
		return work();
	}
	catch ( const std::bad_alloc& )
	{
		return refuse( PLIANT_OUT_OF_MEMORY, "Memory did not suffice; nothing has changed." );
	}
	catch ( ... )
	{
		return refuse( PLIANT_BAD_ARGUMENT, "The call failed with an exception of the program's own." );
	}
}

inline pliant_result refuseNull() noexcept
{
	return refuse( PLIANT_BAD_ARGUMENT, "A pointer is null that must not be." );
}

/// Writes an answer.
template <class T>
pliant_result give( T value, T* out )
{
	if ( !out )
	{
		return refuseNull();
	}
	*out = value;
	return PLIANT_OK;
}

/// Size of a structure in the first version that had it; when one grows, it gets a specialisation with its former size.
template <class T>
inline constexpr std::uint32_t kFirstSize = sizeof( T );

template <class T>
bool isSizeKnown( std::uint32_t size )
{
	return size >= kFirstSize<T> && size <= sizeof( T );
}

inline pliant_result refuseSize() noexcept
{
	return refuse(
		PLIANT_BAD_ARGUMENT, "The size of a structure is none that this version knows: call its _init function, pass its sizeof." );
}

/// Writes the fields of `full` that the caller's version of a structure has.
template <class T>
pliant_result writeSized( T full, T* out, std::uint32_t size )
{
	if ( !out )
	{
		return refuseNull();
	}
	if ( !isSizeKnown<T>( size ) )
	{
		return refuseSize();
	}
	full.size = size;
	std::memcpy( out, &full, size );
	return PLIANT_OK;
}

/// Reads the fields that the caller's version of a structure has over the defaults in `full`. Null: the defaults.
template <class T>
pliant_result readSized( const T* given, T& full )
{
	if ( !given )
	{
		return PLIANT_OK;
	}
	if ( !isSizeKnown<T>( given->size ) )
	{
		return refuseSize();
	}
	std::memcpy( &full, given, given->size );
	return PLIANT_OK;
}

} // namespace pliant::c
