#pragma once

// Common to all functions of the C face: no exception leaves a function, and a refusal stores a sentence for the thread.

#include "pliant/c/types.h"
#include "pliant/result.h"

#include <cstring>
#include <new>
#include <type_traits>
#include <utility>

namespace pliant::c {

/// Keeps the sentence for pliant_last_error; returns the code.
pliant_result refuse( pliant_result code, const char* sentence ) noexcept;
/// The same for an outcome of the library.
pliant_result resultOf( const Status& status ) noexcept;
inline pliant_result resultOf( pliant_result code ) noexcept
{
	return code;
}

/// Thrown by the work of a call that is refused; the sentence is kept by then.
struct Refusal
{
	pliant_result code;
};

/// Refuses the call in progress.
[[noreturn]] inline void reject( pliant_result code, const char* sentence )
{
	throw Refusal{ refuse( code, sentence ) };
}

inline void rejectIf( bool isBad, pliant_result code, const char* sentence )
{
	if ( isBad )
	{
		reject( code, sentence );
	}
}

/// Rejects null.
template <class... P>
void requirePointers( P... pointers )
{
	rejectIf( ( ( pointers == nullptr ) || ... ), PLIANT_BAD_ARGUMENT, "A required pointer is null." );
}

/// Runs a call's work, which returns nothing, a Status or the result of another call.
template <class F>
pliant_result call( F&& work ) noexcept
{
	try
	{
		if constexpr ( std::is_void_v<decltype( work() )> )
		{
			work();
			return PLIANT_OK;
		}
		else
		{
			return resultOf( work() );
		}
	}
	catch ( const Refusal& refusal )
	{
		return refusal.code;
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

/// Writes an answer.
template <class T>
void give( T value, std::type_identity_t<T>* out )
{
	requirePointers( out );
	*out = value;
}

/// Writes an answer where it is asked for.
template <class T>
void offer( T value, std::type_identity_t<T>* out )
{
	if ( out )
	{
		*out = std::move( value );
	}
}

/// The same for an answer that there may not be.
template <class T>
Status offer( Result<T> result, T* out )
{
	if ( result.ok() )
	{
		offer( std::move( result.value ), out );
	}
	return result.status;
}

/// Rejects an array of the caller's that is missing, and writes the number of its elements.
inline void giveCount( std::uint64_t total, const void* array, std::uint64_t capacity, std::uint64_t* count )
{
	requirePointers( count );
	if ( capacity > 0 )
	{
		requirePointers( array );
	}
	*count = total;
}

/// Size of a structure in the first version that had it; when one grows, it gets a specialisation with its former size.
template <class T>
inline constexpr std::uint32_t kFirstSize = sizeof( T );

template <class T>
void requireSize( std::uint32_t size )
{
	rejectIf( size < kFirstSize<T> || size > sizeof( T ), PLIANT_BAD_ARGUMENT,
		"Unknown structure size: initialise the structure by its _init function, and pass its sizeof." );
}

/// Rejects what `writeSized` cannot write.
template <class T>
void requireSized( const T* out, std::uint32_t size )
{
	requirePointers( out );
	requireSize<T>( size );
}

/// Writes the fields of `full` that the caller's version of a structure has.
template <class T>
void writeSized( T full, T* out, std::uint32_t size )
{
	requireSized( out, size );
	full.size = size;
	std::memcpy( out, &full, size );
}

/// The same as a call of its own.
template <class T>
pliant_result initSized( const T& full, T* out, std::uint32_t size ) noexcept
{
	return call( [&]() { writeSized( full, out, size ); } );
}

/// Reads the fields that the caller's version of a structure has over the defaults in `full`. Null: the defaults.
template <class T>
void readSized( const T* given, T& full )
{
	if ( given )
	{
		requireSize<T>( given->size );
		std::memcpy( &full, given, given->size );
	}
}

} // namespace pliant::c
