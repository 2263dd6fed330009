#pragma once

// For calls that cannot fail with a demo's own numbers.

#include <pliant/result.h>

#include <cstdio>

namespace pliant_demos {

/// Prints the reason if such a call is refused nevertheless.
inline void mustSucceed( const pliant::Status& status )
{
	if ( !status.ok() )
	{
		std::fprintf( stderr, "%s: %s\n", pliant::toString( status.code ), status.sentence.c_str() );
	}
}

} // namespace pliant_demos
