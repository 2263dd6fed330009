#pragma once

// Vectors of four floats, used for skinning.

namespace pliant {

/// Vector extension of all supported compilers; emulated where the processor has no such registers.
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
