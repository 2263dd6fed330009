#pragma once

// Checks of whole data structures after each change of topology, in builds with assertions.

#ifndef NDEBUG
	#include "pliant/result.h"

	#include <cstdio>
	#include <cstdlib>
#endif

namespace pliant {

/// Ends the program with validate's sentence where `object` violates an invariant. Does nothing with NDEBUG.
template <class Object>
void assertValid( [[maybe_unused]] const Object& object )
{
#ifndef NDEBUG
	if ( const Status status = validate( object ); !status.ok() )
	{
		std::fprintf( stderr, "Pliant: invalid after a change of topology: %s\n", status.sentence.c_str() );
		std::abort();
	}
#endif
}

} // namespace pliant
