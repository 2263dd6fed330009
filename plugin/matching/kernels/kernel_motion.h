// Loops over a body's nodes outside matching: external accelerations, and the advance of positions. Included by kernel_source.h only,
// inside its unnamed namespace (see lane.h).

#pragma once

/// Returns 0 where every lane is 0, else NaN: 0 times a non-finite number is NaN.
inline float sumOfLanes( V a )
{
	float sum = 0.0f;
	for ( int lane = 0; lane < kWidth; ++lane )
	{
		sum += a[lane];
	}
	return sum;
}

void push( const MotionView& view, const float* gravity, float h, int begin, int end, VelocityBounds& bounds )
{
	V low[3] = {}, high[3] = {}, worst = {};
	for ( int i = begin; i < end; i += kWidth )
	{
		const V step = h * load( view.freedom + i );
		V sum = {};
		for ( int k = 0; k < 3; ++k )
		{
			const V v = load( view.v[k] + i ) + step * gravity[k];
			store( view.v[k] + i, v );
			low[k] = select( v < low[k], v, low[k] );
			high[k] = select( v > high[k], v, high[k] );
			sum += v;
		}
		worst += 0.0f * sum;
	}
	for ( int k = 0; k < 3; ++k )
	{
		for ( int lane = 0; lane < kWidth; ++lane )
		{
			bounds.low[k] = low[k][lane] < bounds.low[k] ? low[k][lane] : bounds.low[k];
			bounds.high[k] = high[k][lane] > bounds.high[k] ? high[k][lane] : bounds.high[k];
		}
	}
	bounds.worst += sumOfLanes( worst );
}

inline void loadEight( const float* p, D8& to )
{
	to = __builtin_convertvector( *reinterpret_cast<const F8*>( p ), D8 );
}

void advance( const MotionView& view, float h, int begin, int end, MotionSums& sums )
{
	V worst = {};
	D8 mass = {}, squareSpeed = {}, moment[3] = {};
	for ( int first = begin; first < end; first += kVirtualLanes )
	{
		for ( int i = first; i < first + kVirtualLanes; i += kWidth )
		{
			V sum = {};
			for ( int k = 0; k < 3; ++k )
			{
				// x' = x + h v'   (Ohta et al. 2009, eq. 4)
				const V x = load( view.x[k] + i ) + h * load( view.v[k] + i );
				store( view.x[k] + i, x );
				store( view.kept[k] + i, x );
				sum += x;
			}
			worst += 0.0f * sum;
		}
		for ( int i = first; i < first + kVirtualLanes; i += 8 )
		{
			D8 m, x, v, square = {};
			loadEight( view.mass + i, m );
			for ( int k = 0; k < 3; ++k )
			{
				loadEight( view.v[k] + i, v );
				loadEight( view.x[k] + i, x );
				square += v * v;
				moment[k] += m * x;
			}
			mass += m;
			squareSpeed += m * square;
		}
	}
	sums.mass += folded( mass );
	sums.squareSpeed += folded( squareSpeed );
	for ( int k = 0; k < 3; ++k )
	{
		sums.moment[k] += folded( moment[k] );
	}
	sums.worst += sumOfLanes( worst );
}
