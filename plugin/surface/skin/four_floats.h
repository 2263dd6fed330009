#pragma once

// Four floats at a time, as the skin is computed.

namespace pliant {

/// Four floats as every compiler we build with has them; where the processor has no such registers, as four.
using F4 = float __attribute__( ( vector_size( 16 ), may_alias ) );

inline F4 load4( const float* p )
{
	return *reinterpret_cast<const F4*>( p );
}

inline void store4( float* p, F4 a )
{
	*reinterpret_cast<F4*>( p ) = a;
}

} // namespace pliant
