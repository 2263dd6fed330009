#pragma once

// For calls that a demo's own numbers never make fail.

#include <pliant/result.h>

#include <cstdio>

namespace pliant_demos {

/// Prints the reason where such a call is refused all the same.
inline void mustSucceed( const pliant::Status& status )
{
	if ( !status.ok() )
	{
		std::fprintf( stderr, "%s: %s\n", pliant::toString( status.code ), status.sentence.c_str() );
	}
}

} // namespace pliant_demos
