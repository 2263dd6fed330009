// Vectors of PLIANT_LANE_WIDTH floats and the few operations on them that the kernels need.
// Included by kernel_source.h and surface/kernels/skin_kernel_source.h only, once per instruction set, inside an unnamed namespace: nothing
// here may be shared between object files, or the linker could keep the AVX-512 copy for a processor without it.

#pragma once

using V = float __attribute__( ( vector_size( 4 * PLIANT_LANE_WIDTH ), may_alias ) );
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
	return (V)_mm512_maskz_sqrt_ps( 0xffff, (__m512)a ); // the unmasked form triggers a g++ 12 warning
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

/// Transposes four rows of four.
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

/// A record of 16 floats during summation: one vector of 16, two of 8, or three of 4 (the last four floats of a record are unused).
struct Whole
{
	using Piece = V;
	static constexpr int floats = 16, groups = 3, pieces = PLIANT_LANE_WIDTH == 16 ? 1 : PLIANT_LANE_WIDTH == 8 ? 2 : 3;
};

/// A record of 16 floats of which all are used.
struct Full
{
	using Piece = V;
	static constexpr int floats = 16, groups = 4, pieces = 16 / PLIANT_LANE_WIDTH;
};

/// A record of 8 floats: one vector of 8, or two of 4.
struct Half
{
#if PLIANT_LANE_WIDTH == 4
	using Piece = V;
	static constexpr int floats = 8, groups = 2, pieces = 2;
#else
	using Piece = float __attribute__( ( vector_size( 32 ), may_alias ) );
	static constexpr int floats = 8, groups = 2, pieces = 1;
#endif
};

template <class Size>
struct RecordOf
{
	typename Size::Piece piece[Size::pieces];
};
using Record = RecordOf<Whole>;

template <class Size>
constexpr int kPieceFloats = int( sizeof( typename Size::Piece ) / sizeof( float ) );

template <class Size>
inline typename Size::Piece loadPiece( const float* p )
{
	return *reinterpret_cast<const typename Size::Piece*>( p );
}

template <class Size = Whole>
inline RecordOf<Size> loadRecord( const float* p )
{
	RecordOf<Size> r;
	for ( int i = 0; i < Size::pieces; ++i )
	{
		r.piece[i] = loadPiece<Size>( p + i * kPieceFloats<Size> );
	}
	return r;
}

inline void storeRecord( float* p, const Record& r )
{
	for ( int i = 0; i < Whole::pieces; ++i )
	{
		store( p + i * kWidth, r.piece[i] );
	}
}

template <class Size>
inline RecordOf<Size> operator+( const RecordOf<Size>& a, const RecordOf<Size>& b )
{
	RecordOf<Size> r;
	for ( int i = 0; i < Size::pieces; ++i )
	{
		r.piece[i] = a.piece[i] + b.piece[i];
	}
	return r;
}

template <class Size>
inline RecordOf<Size> operator*( const RecordOf<Size>& a, float b )
{
	RecordOf<Size> r;
	for ( int i = 0; i < Size::pieces; ++i )
	{
		r.piece[i] = a.piece[i] * b;
	}
	return r;
}

/// Floats 4k to 4k + 3 of a record, k in 0 .. 3.
template <int k, class Size>
inline F4 quarter( const RecordOf<Size>& r )
{
#if PLIANT_LANE_WIDTH == 4
	return r.piece[k];
#else
	constexpr int perPiece = kPieceFloats<Size> / 4;
	constexpr int from = 4 * ( k % perPiece );
	const typename Size::Piece piece = r.piece[k / perPiece];
	return __builtin_shufflevector( piece, piece, from, from + 1, from + 2, from + 3 );
#endif
}
