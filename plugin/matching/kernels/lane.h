// Vectors of PLIANT_LANE_WIDTH floats and the few operations on them that the kernels need.
// Included by kernel_source.h only, once per instruction set, inside an unnamed namespace: nothing here may be shared between
// object files, or the linker could keep the AVX-512 copy for a processor that lacks it.

#pragma once

using V = float __attribute__( ( vector_size( 4 * PLIANT_LANE_WIDTH ), may_alias ) );
using VU = float __attribute__( ( vector_size( 4 * PLIANT_LANE_WIDTH ), may_alias, aligned( 4 ) ) );
using I = int __attribute__( ( vector_size( 4 * PLIANT_LANE_WIDTH ), may_alias ) );
using F4 = float __attribute__( ( vector_size( 16 ), may_alias ) );

constexpr int kWidth = PLIANT_LANE_WIDTH;

inline V load( const float* p )
{
	return *reinterpret_cast<const V*>( p );
}

inline void store( float* p, V a )
{
	*reinterpret_cast<V*>( p ) = a;
}

inline F4 load4( const float* p )
{
	return *reinterpret_cast<const F4*>( p );
}

inline void store4( float* p, F4 a )
{
	*reinterpret_cast<F4*>( p ) = a;
}

inline V splat( float a )
{
	return V{} + a;
}

inline V select( I mask, V a, V b )
{
	return (V)( ( (I)a & mask ) | ( (I)b & ~mask ) );
}

inline V squareRoot( V a )
{
#if PLIANT_LANE_WIDTH == 16
	return (V)_mm512_maskz_sqrt_ps( 0xffff, (__m512)a ); // the unmasked form trips g++ 12 into a warning
#elif PLIANT_LANE_WIDTH == 8
	return (V)_mm256_sqrt_ps( (__m256)a );
#elif defined( __SSE2__ )
	return (V)_mm_sqrt_ps( (__m128)a );
#else
	V r;
	for ( int i = 0; i < kWidth; ++i )
	{
		r[i] = __builtin_sqrtf( a[i] );
	}
	return r;
#endif
}

inline bool any( I mask )
{
	long long bits[sizeof( I ) / 8];
	__builtin_memcpy( bits, &mask, sizeof( I ) );
	long long all = 0;
	for ( long long b : bits )
	{
		all |= b;
	}
	return all != 0;
}

/// Four rows of four become four columns.
inline void transpose4( F4& a, F4& b, F4& c, F4& d )
{
	const F4 ab0 = __builtin_shufflevector( a, b, 0, 4, 1, 5 );
	const F4 ab1 = __builtin_shufflevector( a, b, 2, 6, 3, 7 );
	const F4 cd0 = __builtin_shufflevector( c, d, 0, 4, 1, 5 );
	const F4 cd1 = __builtin_shufflevector( c, d, 2, 6, 3, 7 );
	a = __builtin_shufflevector( ab0, cd0, 0, 1, 4, 5 );
	b = __builtin_shufflevector( ab0, cd0, 2, 3, 6, 7 );
	c = __builtin_shufflevector( ab1, cd1, 0, 1, 4, 5 );
	d = __builtin_shufflevector( ab1, cd1, 2, 3, 6, 7 );
}

/// A record while it is summed: one vector of 16, two of 8, or three of 4 (the last four floats of a record are unused).
constexpr int kPieces = PLIANT_LANE_WIDTH == 16 ? 1 : PLIANT_LANE_WIDTH == 8 ? 2 : 3;

struct Record
{
	V piece[kPieces];
};

inline Record loadRecord( const float* p )
{
	Record r;
	for ( int i = 0; i < kPieces; ++i )
	{
		r.piece[i] = load( p + i * kWidth );
	}
	return r;
}

inline void storeRecord( float* p, const Record& r )
{
	for ( int i = 0; i < kPieces; ++i )
	{
		store( p + i * kWidth, r.piece[i] );
	}
}

inline Record operator+( const Record& a, const Record& b )
{
	Record r;
	for ( int i = 0; i < kPieces; ++i )
	{
		r.piece[i] = a.piece[i] + b.piece[i];
	}
	return r;
}

inline Record operator*( const Record& a, V b )
{
	Record r;
	for ( int i = 0; i < kPieces; ++i )
	{
		r.piece[i] = a.piece[i] * b;
	}
	return r;
}

/// Floats 4k to 4k + 3 of a record, k in 0 .. 2.
template <int k>
inline F4 quarter( const Record& r )
{
#if PLIANT_LANE_WIDTH == 4
	return r.piece[k];
#else
	constexpr int perPiece = PLIANT_LANE_WIDTH / 4;
	constexpr int from = 4 * ( k % perPiece );
	const V piece = r.piece[k / perPiece];
	return __builtin_shufflevector( piece, piece, from, from + 1, from + 2, from + 3 );
#endif
}
