// Sums over velocity vectors and their affine motions, for the implicit step's solver. Included by kernel_source.h only, inside its unnamed
// namespace (see lane.h).

#pragma once

using F8 = float __attribute__( ( vector_size( 32 ), may_alias ) );
using D8 = double __attribute__( ( vector_size( 64 ) ) );

/// Adds the products of eight floats each of a and b, in double, to `sum`.
inline void addProduct( D8& sum, const float* a, const float* b )
{
	const F8 left = *reinterpret_cast<const F8*>( a ), right = *reinterpret_cast<const F8*>( b );
	sum += __builtin_convertvector( left, D8 ) * __builtin_convertvector( right, D8 );
}

inline double folded( const D8& sum )
{
	const double a = sum[0] + sum[4], b = sum[1] + sum[5], c = sum[2] + sum[6], d = sum[3] + sum[7];
	return ( a + c ) + ( b + d );
}

double dot( const float* a, const float* b, int size )
{
	D8 low = {}, high = {};
	for ( int i = 0; i < size; i += kVirtualLanes )
	{
		addProduct( low, a + i, b + i );
		addProduct( high, a + i + 8, b + i + 8 );
	}
	low += high;
	return folded( low );
}

void affineSums( const float* r, const float* arms, const float* free, int padded, double* sums )
{
	D8 sum[12] = {};
	for ( int i = 0; i < padded; i += 8 )
	{
		for ( int k = 0; k < 3; ++k )
		{
			addProduct( sum[k], r + k * padded + i, free + i );
			for ( int j = 0; j < 3; ++j )
			{
				addProduct( sum[3 + 3 * j + k], r + k * padded + i, arms + j * padded + i );
			}
		}
	}
	for ( int k = 0; k < 12; ++k )
	{
		sums[k] = folded( sum[k] );
	}
}

void addAffine( const float* motion, const float* arms, const float* free, int padded, float* z )
{
	for ( int i = 0; i < padded; i += kWidth )
	{
		const V one = load( free + i ), x = load( arms + i ), y = load( arms + padded + i ), w = load( arms + 2 * padded + i );
		for ( int k = 0; k < 3; ++k )
		{
			float* const to = z + k * padded + i;
			store( to, load( to ) + ( motion[k] * one + ( ( motion[3 + k] * x + motion[6 + k] * y ) + motion[9 + k] * w ) ) );
		}
	}
}
