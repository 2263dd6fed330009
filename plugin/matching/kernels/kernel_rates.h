// Strain rates of a body's regions: v - P v, with P v at a node the mean of its regions' rigid motions, at the current node positions. The
// operator of the implicit step (matching/implicit/strain_rates.h; docs/design/implicit.md). Rivers and James 2007, section 5, use the same
// P for damping. Included by kernel_source.h only, inside its unnamed namespace (see lane.h). Lengths in cells, world axes.

#pragma once

inline bool conservesVolume( const RateView& rates )
{
	return rates.match->volumeGradient[0] != nullptr;
}

/// Gathers the sums of a tile's rates.
inline void gatherRates( const RateView& rates, bool isOfRegions, int begin, int end, Tile& tile )
{
	const MatchView& view = *rates.match;
	const float* const records = isOfRegions ? view.regionRecord : view.nodeRecord;
	const std::uint32_t* const weight = isOfRegions ? view.memberFraction : view.memberMass;
	if ( conservesVolume( rates ) )
	{
		gatherTile<Full>( view, records, weight, begin, end, tile );
		return;
	}
	if ( rates.flat.node[0] )
	{
		sumPlanes( view, isOfRegions ? rates.flat.region : rates.flat.node, begin, end, tile );
		return;
	}
	gatherTile<Half>( view, records, weight, begin, end, tile );
}

/// Stores a tile's rates where the sums read them.
inline void giveRates( const RateView& rates, bool isOfRegions, const Tile& tile, int begin, int end )
{
	const MatchView& view = *rates.match;
	if ( rates.flat.node[0] )
	{
		float* const* const to = isOfRegions ? rates.flat.region : rates.flat.node;
		for ( int k = 0; k < kRateSums; ++k )
		{
			for ( int i = begin; i < end; i += kWidth )
			{
				store( to[k] + i, load( &tile.row[k][i - begin] ) );
			}
		}
		return;
	}
	const int real = end < view.nodeCount ? end : view.nodeCount;
	float* const records = isOfRegions ? view.regionRecord : view.nodeRecord;
	if ( real > begin )
	{
		conservesVolume( rates ) ? writeRecords<Full>( view, tile, begin, real, records )
								 : writeRecords<Half>( view, tile, begin, real, records );
	}
}

/// Sums over the nodes: m v and m p x v, v given as three component arrays.
void rateSums( const RateView& rates, const float* const* velocity, int begin, int end, float* sums )
{
	const MatchView& view = *rates.match;
	LaneSums<kRateSums> sum;
	for ( int i = begin; i < end; i += kWidth )
	{
		const int sub = i % kVirtualLanes;
		const V m = load( view.mass + i );
		const Vec mv = { m * load( velocity[0] + i ), m * load( velocity[1] + i ), m * load( velocity[2] + i ) };
		const Vec spin = cross( positionOf( view, i ), mv );
		const V value[kRateSums] = { mv.x, mv.y, mv.z, spin.x, spin.y, spin.z };
		for ( int k = 0; k < kRateSums; ++k )
		{
			sum.add( k, sub, value[k] );
		}
	}
	sum.foldInto( sums );
}

/// Writes a v and a p x v of each node, or a v, a v q^T and a p x v where volume is conserved, q the rest position.
void rateRecords( const RateView& rates, int begin, int end )
{
	const MatchView& view = *rates.match;
	Tile tile;
	clearRows( tile, 6 );
	for ( int first = begin; first < end; first += kTile )
	{
		const int last = first + kTile < end ? first + kTile : end;
		for ( int i = first; i < last; i += kWidth )
		{
			const Vec p = positionOf( view, i ), v = strainingRate( rates, p, i );
			const V a = load( view.nodeWeight + i );
			const Vec av = { a * v.x, a * v.y, a * v.z };
			const Vec spin = cross( p, av );
			if ( conservesVolume( rates ) )
			{
				const Vec q = restPosition( view, i );
				const V row[15] = { av.x, av.y, av.z, av.x * q.x, av.x * q.y, av.x * q.z, av.y * q.x, av.y * q.y, av.y * q.z, av.z * q.x,
					av.z * q.y, av.z * q.z, spin.x, spin.y, spin.z };
				for ( int k = 0; k < 15; ++k )
				{
					store( &tile.row[k][i - first], row[k] );
				}
				continue;
			}
			const V row[6] = { av.x, av.y, av.z, spin.x, spin.y, spin.z };
			for ( int k = 0; k < 6; ++k )
			{
				store( &tile.row[k][i - first], row[k] );
			}
		}
		giveRates( rates, false, tile, first, last );
	}
}

/// A region's rigid motion times its fraction g: w = T^-1 ( sum a p x v - c x sum a v ), and vc - w x c.
struct RigidRate
{
	Vec turn, shift;
};

/// `spin`: the first row of the sums a p x v.
inline RigidRate rigidRate( const RateView& rates, const Tile& in, int spin, V fraction, int r, int at )
{
	const Vec sum = { load( &in.row[0][at] ), load( &in.row[1][at] ), load( &in.row[2][at] ) };
	const Vec c = { load( rates.regionCentre[0] + r ), load( rates.regionCentre[1] + r ), load( rates.regionCentre[2] + r ) };
	const Vec moved = cross( c, sum );
	const Vec b = { load( &in.row[spin][at] ) - moved.x, load( &in.row[spin + 1][at] ) - moved.y, load( &in.row[spin + 2][at] ) - moved.z };
	V t[6];
	for ( int k = 0; k < 6; ++k )
	{
		t[k] = fraction * load( rates.inverseInertia[k] + r );
	}
	RigidRate rigid;
	rigid.turn = {
		( t[0] * b.x + t[5] * b.y ) + t[4] * b.z, ( t[5] * b.x + t[1] * b.y ) + t[3] * b.z, ( t[4] * b.x + t[3] * b.y ) + t[2] * b.z };
	const Vec turned = cross( rigid.turn, c );
	const V mean = fraction * load( rates.match->inverseMass + r );
	rigid.shift = { sum.x * mean - turned.x, sum.y * mean - turned.y, sum.z * mean - turned.z };
	return rigid;
}

// The energy of volume conservation, 1/2 kappa b m^2, has the second derivative kappa ( sum a ( H q ) . v )^2, H = b^1/2 dm / dx as
// volumeMatrix stores it, q the rest position relative to the region's centre. H exerts no torque, so that rigid motions are not resisted.
// Besides its rigid motion a region then makes
//
//   - volume H q t,   t = sum a ( H q ) . v,   written as   D q + constant
inline void storeVolumeRate( const RateView& rates, const RigidRate& rigid, const Tile& in, int r, int at, Tile& out )
{
	const MatchView& view = *rates.match;
	V t = V{};
	for ( int k = 0; k < 9; ++k )
	{
		const V rate = load( &in.row[3 + k][at] ) - load( &in.row[k / 3][at] ) * load( view.centre[k % 3] + r );
		t = t + load( view.volumeGradient[k] + r ) * rate;
	}
	const V weight = view.regionWeight ? load( view.regionWeight + r ) : splat( 1.0f ); // as in writeGoal
	const V push = ( weight * rates.volume ) * t;
	V shift[3] = { rigid.shift.x, rigid.shift.y, rigid.shift.z };
	for ( int k = 0; k < 9; ++k )
	{
		const V d = push * load( view.volumeGradient[k] + r );
		shift[k / 3] = shift[k / 3] + d * load( view.centre[k % 3] + r );
		store( &out.row[3 + k][at], -d );
	}
	const V turn[3] = { rigid.turn.x, rigid.turn.y, rigid.turn.z };
	for ( int k = 0; k < 3; ++k )
	{
		store( &out.row[k][at], shift[k] );
		store( &out.row[12 + k][at], turn[k] );
	}
}

/// Computes each region's motion: the rigid one, g ( w, vc - w x c ), and where volume is conserved that of storeVolumeRate.
void rigidRates( const RateView& rates, int begin, int end )
{
	const bool isVolume = conservesVolume( rates );
	const int spin = isVolume ? 12 : 3;
	Tile in, out;
	clearRows( out, isVolume ? kRecordFloats - 1 : 6 );
	for ( int first = begin; first < end; first += kTile )
	{
		const int last = first + kTile < end ? first + kTile : end;
		gatherRates( rates, false, first, last, in );
		for ( int r = first; r < last; r += kWidth )
		{
			const int at = r - first;
			const V fraction = rates.regionFraction ? load( rates.regionFraction + r ) : splat( 1.0f );
			const RigidRate rigid = rigidRate( rates, in, spin, fraction, r, at );
			if ( isVolume )
			{
				storeVolumeRate( rates, rigid, in, r, at, out );
				continue;
			}
			const V row[6] = { rigid.turn.x, rigid.turn.y, rigid.turn.z, rigid.shift.x, rigid.shift.y, rigid.shift.z };
			for ( int k = 0; k < 6; ++k )
			{
				store( &out.row[k][at], row[k] );
			}
		}
		giveRates( rates, true, out, first, last );
	}
}

/// The sum of the motions of a node's regions at its position p.
inline void carriedAt( const RateView& rates, const Tile& tile, int i, int at, const Vec& p, V ( &carried )[3] )
{
	const bool isVolume = conservesVolume( rates );
	const int spin = isVolume ? 12 : 0, shift = isVolume ? 0 : 3;
	const Vec turn = cross( { load( &tile.row[spin][at] ), load( &tile.row[spin + 1][at] ), load( &tile.row[spin + 2][at] ) }, p );
	carried[0] = load( &tile.row[shift][at] ) + turn.x;
	carried[1] = load( &tile.row[shift + 1][at] ) + turn.y;
	carried[2] = load( &tile.row[shift + 2][at] ) + turn.z;
	if ( isVolume )
	{
		const Vec q = restPosition( *rates.match, i );
		for ( int k = 0; k < 3; ++k )
		{
			const int row = 3 + 3 * k;
			carried[k] = carried[k] +
				( ( load( &tile.row[row][at] ) * q.x + load( &tile.row[row + 1][at] ) * q.y ) + load( &tile.row[row + 2][at] ) * q.z );
		}
	}
}

/// Computes G ( v - P v ) = e of each node and writes m ( v + e ) for free nodes, 0 for the others; with `isPart`, writes e alone.
template <bool isPart>
inline void resistAll( const RateView& rates, int begin, int end )
{
	const MatchView& view = *rates.match;
	Tile tile;
	for ( int first = begin; first < end; first += kTile )
	{
		const int last = first + kTile < end ? first + kTile : end;
		gatherRates( rates, true, first, last, tile );
		for ( int i = first; i < last; i += kWidth )
		{
			const int at = i - first;
			const Vec p = positionOf( view, i ), v = strainingRate( rates, p, i );
			const V cover = load( view.inverseCover + i ), pull = rates.pull ? load( rates.pull + i ) : splat( 1.0f );
			V carried[3];
			carriedAt( rates, tile, i, at, p, carried );
			const V own[3] = { v.x, v.y, v.z };
			const V mass = load( view.mass + i ) * load( view.freedom + i );
			for ( int k = 0; k < 3; ++k )
			{
				const V resists = rates.stiffness * ( pull * own[k] - cover * carried[k] );
				store( rates.result[k] + i, isPart ? resists : mass * ( load( rates.rate[k] + i ) + resists ) );
			}
		}
	}
}

void resist( const RateView& rates, int begin, int end )
{
	resistAll<false>( rates, begin, end );
}

void resistPart( const RateView& rates, int begin, int end )
{
	resistAll<true>( rates, begin, end );
}

/// Subtracts a rigid motion from the result e of `resistPart`: m ( v + e - shift - turn x p ) of each free node.
void finishResist( const RateView& rates, int begin, int end )
{
	const MatchView& view = *rates.match;
	for ( int i = begin; i < end; i += kWidth )
	{
		const Vec turn = cross( { splat( rates.turn[0] ), splat( rates.turn[1] ), splat( rates.turn[2] ) }, positionOf( view, i ) );
		const V turned[3] = { turn.x, turn.y, turn.z };
		const V mass = load( view.mass + i ) * load( view.freedom + i );
		for ( int k = 0; k < 3; ++k )
		{
			const V resists = ( load( rates.result[k] + i ) - rates.shift[k] ) - turned[k];
			store( rates.result[k] + i, mass * ( load( rates.rate[k] + i ) + resists ) );
		}
	}
}
