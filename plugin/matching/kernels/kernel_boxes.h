// Box sums of rates over a lattice that fills its grid, one row per component: neighbours are at constant index offsets, and those beyond
// the grid's edges are masked. Whole vectors of nodes are summed at once, without conversion between records and rows. Sums have the same
// order, and the same bits, as those of records. Included by kernel_source.h only, inside its unnamed namespace (see lane.h).

#pragma once

inline V loadAnywhere( const float* p )
{
	V v; // clang takes a load through a less aligned type for an aligned one where it masks it
	__builtin_memcpy( &v, p, sizeof v );
	return v;
}

inline I loadPositions( const int* p )
{
	return *reinterpret_cast<const I*>( p );
}

inline V keep( I mask, V a )
{
	return (V)( (I)a & mask );
}

/// to = sum of `from` over w neighbours to either side along one axis of the grid, `step` apart; `position` holds the nodes' coordinates
/// along it, below `count`.
template <int w>
void boxRowsOf( float* const* from, float* const* to, const int* position, int count, int step, int begin, int end )
{
	for ( int i = begin; i < end; i += kWidth )
	{
		const I at = loadPositions( position + i );
		I below[w], above[w];
		for ( int k = 0; k < w; ++k )
		{
			below[k] = at >= w - k;
			above[k] = at < count - 1 - k;
		}
		for ( int component = 0; component < kRateSums; ++component )
		{
			const float* const row = from[component] + i;
			V sum = V{};
			for ( int k = 0; k < w; ++k )
			{
				sum = sum + keep( below[k], loadAnywhere( row - ( w - k ) * step ) );
			}
			sum = sum + load( row );
			for ( int k = 0; k < w; ++k )
			{
				sum = sum + keep( above[k], loadAnywhere( row + ( k + 1 ) * step ) );
			}
			store( to[component] + i, sum );
		}
	}
}

void boxRows( const RateView& rates, bool isOfRegions, int axis, int begin, int end )
{
	const MatchView& view = *rates.match;
	const FlatRows& flat = rates.flat;
	float* const* const own = isOfRegions ? flat.region : flat.node;
	float* const* const other = isOfRegions ? flat.node : flat.region;
	float* const* const from = axis == 0 ? own : other;
	float* const* const to = axis == 0 ? other : own;
	const int* const position = axis == 0 ? flat.x : flat.y;
	const int count = axis == 0 ? view.gridX : view.gridY, step = axis == 0 ? 1 : view.gridX;
	switch ( view.halfWidth )
	{
		case 1: boxRowsOf<1>( from, to, position, count, step, begin, end ); break;
		case 2: boxRowsOf<2>( from, to, position, count, step, begin, end ); break;
		case 3: boxRowsOf<3>( from, to, position, count, step, begin, end ); break;
		default: boxRowsOf<4>( from, to, position, count, step, begin, end ); break;
	}
}

/// Sums a tile over the planes within the half-width.
inline void sumPlanes( const MatchView& view, float* const* rows, int begin, int end, Tile& tile )
{
	const int plane = view.gridX * view.gridY;
	const int w = view.halfWidth < view.gridZ - 1 ? view.halfWidth : view.gridZ - 1;
	I lane = {};
	for ( int k = 0; k < kWidth; ++k )
	{
		lane[k] = k;
	}
	for ( int i = begin; i < end; i += kWidth )
	{
		V sum[kRateSums] = {};
		for ( int k = -w; k <= w; ++k )
		{
			const I node = lane + ( i + k * plane );
			const I isThere = ( node >= 0 ) & ( node < view.nodeCount );
			for ( int component = 0; component < kRateSums; ++component )
			{
				sum[component] = sum[component] + keep( isThere, loadAnywhere( rows[component] + i + k * plane ) );
			}
		}
		for ( int component = 0; component < kRateSums; ++component )
		{
			store( &tile.row[component][i - begin], sum[component] );
		}
	}
}
