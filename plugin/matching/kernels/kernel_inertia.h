// Centres and inertias of a body's regions at the current node positions, for kernel_rates.h. Included by kernel_source.h only, inside its
// unnamed namespace (see lane.h). Lengths in cells, world axes.

#pragma once

/// Regions with hardly any extent about some axis: where the determinant of their inertia is below this fraction of ( trace / 3 )^3, it is
/// raised before inversion. An underestimated inertia would make 1 - P indefinite: a rod of ten cells, bent by 0.01 cells, flew apart.
constexpr float kThinInertia = 1e-2f;
constexpr float kThinRaise = 1e-4f;
/// Added to those, in cells^2 of full cells: a region of one cell has no inertia, and its rotation is undetermined.
constexpr float kPointInertia = 1e-4f;
/// Bound of the rounding error of an inertia, relative to the second moment about the frame's centre before its shift to the region's.
constexpr float kInertiaRounding = 4e-7f;
/// An inertia below this multiple of that error also counts as thin.
constexpr float kSafeInertia = 50.0f;
/// Factor of the tension that is added to an inertia: at a stretch of a half the estimate by second moments falls short by a third, and a
/// region that resists too much is only damped more.
constexpr float kTautRaise = 2.0f;

inline Vec positionOf( const MatchView& view, int i )
{
	const V perMetre = splat( view.cellsPerMetre );
	return { ( load( view.x[0] + i ) - view.frameCentre[0] ) * perMetre, ( load( view.x[1] + i ) - view.frameCentre[1] ) * perMetre,
		( load( view.x[2] + i ) - view.frameCentre[2] ) * perMetre };
}

/// v less the rigid motion that the step removes before summing.
inline Vec strainingRate( const RateView& rates, const Vec& position, int i )
{
	const Vec turn = cross( { splat( rates.turn[0] ), splat( rates.turn[1] ), splat( rates.turn[2] ) }, position );
	return { load( rates.rate[0] + i ) - rates.shift[0] - turn.x, load( rates.rate[1] + i ) - rates.shift[1] - turn.y,
		load( rates.rate[2] + i ) - rates.shift[2] - turn.z };
}

inline void clearRows( Tile& tile, int from )
{
	__builtin_memset( tile.row[from], 0, sizeof( tile.row[0] ) * std::size_t( kRecordFloats - from ) );
}

// With the body's rest shape turned into its frame, g = R x0, and the displacement e = p - g, a region's second moment is
//
//   S = sum a ( p - c )( p - c )^T = R J R^T + Y - M ( g' e'^T + e' g'^T + e' e'^T ),   Y = sum a ( g e^T + e g^T + e e^T )
//
// with the region's means g', e', and the moment J of its rest shape. The terms that cancel are as small as e: from the positions
// themselves, in float, those about the body's centre would leave 4e-5 of S in a body of twenty cells, and G times that is an energy.
// Soft bodies need no such accuracy, and bodies of several parts have no common frame: for these g = 0, e = p.

/// Writes a e and a ( g e^T + e g^T + e e^T ) of each node.
void inertiaRecords( const RateView& rates, int begin, int end )
{
	const MatchView& view = *rates.match;
	Tile tile;
	clearRows( tile, 9 );
	for ( int first = begin; first < end; first += kTile )
	{
		const int last = first + kTile < end ? first + kTile : end;
		for ( int i = first; i < last; i += kWidth )
		{
			const V a = load( view.nodeWeight + i );
			const Vec p = positionOf( view, i );
			V e[3] = { p.x, p.y, p.z };
			for ( int k = 0; k < 3 && rates.displacement[0]; ++k )
			{
				e[k] = load( rates.displacement[k] + i );
			}
			const Vec g = { p.x - e[0], p.y - e[1], p.z - e[2] };
			const V ae[3] = { a * e[0], a * e[1], a * e[2] };
			const V row[9] = { ae[0], ae[1], ae[2], ae[0] * ( g.x + p.x ), ae[1] * ( g.y + p.y ), ae[2] * ( g.z + p.z ),
				ae[2] * g.y + ae[1] * p.z, ae[2] * g.x + ae[0] * p.z, ae[1] * g.x + ae[0] * p.y };
			for ( int k = 0; k < 9; ++k )
			{
				store( &tile.row[k][i - first], row[k] );
			}
		}
		const int real = last < view.nodeCount ? last : view.nodeCount;
		if ( real > first )
		{
			writeRecords( view, tile, first, real, view.nodeRecord );
		}
	}
}

/// The inverse of a symmetric matrix xx, yy, zz, yz, xz, xy by cofactors, same order.
inline void invertSymmetric( V ( &t )[6] )
{
	const V cxx = t[1] * t[2] - t[3] * t[3], cyy = t[0] * t[2] - t[4] * t[4], czz = t[0] * t[1] - t[5] * t[5];
	const V cyz = t[4] * t[5] - t[0] * t[3], cxz = t[5] * t[3] - t[1] * t[4], cxy = t[4] * t[3] - t[2] * t[5];
	const V inverse = 1.0f / ( ( t[0] * cxx + t[5] * cxy ) + t[4] * cxz );
	const V c[6] = { cxx, cyy, czz, cyz, cxz, cxy };
	for ( int k = 0; k < 6; ++k )
	{
		t[k] = c[k] * inverse;
	}
}

inline V determinant( const V ( &t )[6] )
{
	return ( t[0] * ( t[1] * t[2] - t[3] * t[3] ) + t[5] * ( t[4] * t[3] - t[2] * t[5] ) ) + t[4] * ( t[5] * t[3] - t[1] * t[4] );
}

inline V atLeast( V a, V b )
{
	return select( a < b, b, a );
}

/// The second moment of a region's rest shape, rotated as the region is, world axes.
inline Mat turnedMoment( const MatchView& view, int r )
{
	Mat rest = loadSymmetric( view.moment, r );
	if ( view.plastic[0] )
	{
		const Mat flow = loadMatrix( view.plastic, r ), half = timesTransposed( rest, flow ), whole = product( flow, half );
		for ( int k = 0; k < 9; ++k )
		{
			rest.m[k / 3][k % 3] = half.m[k / 3][k % 3] + whole.m[k / 3][k % 3];
		}
	}
	Mat frame, own = rotationLessOne( loadQuat( view, r ) ), moment;
	for ( int k = 0; k < 9; ++k )
	{
		frame.m[k / 3][k % 3] = splat( view.frameRotation[k] );
		own.m[k / 3][k % 3] = own.m[k / 3][k % 3] + ( k % 4 == 0 ? 1.0f : 0.0f );
	}
	const Mat rotation = product( frame, own ), right = product( rotation, rest );
	for ( int k = 0; k < 9; ++k )
	{
		const V* const a = right.m[k / 3];
		const V* const b = rotation.m[k % 3];
		moment.m[k / 3][k % 3] = ( a[0] * b[0] + a[1] * b[1] ) + a[2] * b[2];
	}
	return moment;
}

// A region under tension resists rotation: along v = w x p its energy has the second derivative w . D w, and its rigid motions none. With J
// the rest shape's second moment, rotated, and s the present one, the stretches being small,
//
//   D = tr E - E,   E = ( s - J ) / 2,   and   T' = T + D   gives   v . ( 1 - P ) v = w . D w
//
// D's negative part, of lateral contraction, is left out by a bound of its lowest eigenvalue: T' must not be below T. Returns whether any
// region is taut enough to need it.
inline bool raiseTaut( const RateView& rates, int r, const V ( &s )[6], V ( &t )[6] )
{
	const MatchView& view = *rates.match;
	const V now = ( s[0] + s[1] ) + s[2];
	const V before = ( load( view.moment[0] + r ) + load( view.moment[1] + r ) ) + load( view.moment[2] + r );
	if ( rates.tautMoment == 0.0f || !any( now > before * rates.tautMoment ) )
	{
		return false;
	}
	const Mat rest = turnedMoment( view, r );
	const I isTaut = now > ( ( rest.m[0][0] + rest.m[1][1] ) + rest.m[2][2] ) * rates.tautMoment;
	V e[6];
	for ( int k = 0; k < 6; ++k )
	{
		const int i = k < 3 ? k : ( k == 3 ? 1 : 0 ), j = k < 3 ? k : ( k == 5 ? 1 : 2 );
		e[k] = ( s[k] - rest.m[i][j] ) * ( 0.5f * kTautRaise );
	}
	V d[6] = { e[1] + e[2], e[0] + e[2], e[0] + e[1], -e[3], -e[4], -e[5] };
	const V yz = atLeast( d[3], -d[3] ), xz = atLeast( d[4], -d[4] ), xy = atLeast( d[5], -d[5] );
	const V lack = atLeast( atLeast( ( xz + xy ) - d[0], ( yz + xy ) - d[1] ), atLeast( ( yz + xz ) - d[2], V{} ) );
	for ( int k = 0; k < 6; ++k )
	{
		t[k] = t[k] + select( isTaut, k < 3 ? d[k] + lack : d[k], V{} );
	}
	return any( isTaut );
}

/// Adds R J R^T of a region.
inline void addTurnedMoment( const MatchView& view, int r, V ( &s )[6] )
{
	const Mat rest = loadSymmetric( view.moment, r );
	Vec row[3]; // of J R^T
	for ( int k = 0; k < 3; ++k )
	{
		row[k] = fromFrame( view, { rest.m[k][0], rest.m[k][1], rest.m[k][2] } );
	}
	const Vec x = fromFrame( view, { row[0].x, row[1].x, row[2].x } ), y = fromFrame( view, { row[0].y, row[1].y, row[2].y } ),
			  z = fromFrame( view, { row[0].z, row[1].z, row[2].z } );
	const V turned[6] = { x.x, y.y, z.z, y.z, x.z, x.y };
	for ( int k = 0; k < 6; ++k )
	{
		s[k] = s[k] + turned[k];
	}
}

/// Computes each region's centre c and T^-1, T = sum a ( |p - c|^2 1 - ( p - c )( p - c )^T ). Returns whether any was thin or taut, and
/// raised.
bool regionInertias( const RateView& rates, int begin, int end )
{
	const MatchView& view = *rates.match;
	Tile tile;
	bool isRaised = false;
	for ( int first = begin; first < end; first += kTile )
	{
		const int last = first + kTile < end ? first + kTile : end;
		gatherTile( view, view.nodeRecord, view.memberMass, first, last, tile );
		for ( int r = first; r < last; r += kWidth )
		{
			const int at = r - first;
			const V inverseMass = load( view.inverseMass + r );
			const V sum[3] = { load( &tile.row[0][at] ), load( &tile.row[1][at] ), load( &tile.row[2][at] ) };
			const bool isFramed = rates.displacement[0] != nullptr;
			const Vec g = isFramed
				? fromFrame( view, { load( view.centre[0] + r ), load( view.centre[1] + r ), load( view.centre[2] + r ) } )
				: Vec{};
			const V c[3] = { g.x + sum[0] * inverseMass, g.y + sum[1] * inverseMass, g.z + sum[2] * inverseMass };
			const V shift[6] = { sum[0] * ( g.x + c[0] ), sum[1] * ( g.y + c[1] ), sum[2] * ( g.z + c[2] ), sum[2] * g.y + sum[1] * c[2],
				sum[2] * g.x + sum[0] * c[2], sum[1] * g.x + sum[0] * c[1] };
			V s[6];
			for ( int k = 0; k < 6; ++k )
			{
				s[k] = load( &tile.row[3 + k][at] ) - shift[k];
			}
			isFramed ? addTurnedMoment( view, r, s ) : void();
			V t[6] = { s[1] + s[2], s[0] + s[2], s[0] + s[1], -s[3], -s[4], -s[5] };
			const V third = ( ( t[0] + t[1] ) + t[2] ) * ( 1.0f / 3.0f );
			// Of the positions' moment in both cases: displacements may be large, and cancel in Y.
			const V whole = isFramed ? ( ( s[0] + s[1] ) + s[2] ) + ( ( c[0] * c[0] + c[1] * c[1] ) + c[2] * c[2] ) / inverseMass
									 : ( load( &tile.row[3][at] ) + load( &tile.row[4][at] ) ) + load( &tile.row[5][at] );
			const V roundingError = kInertiaRounding * whole;
			const I thin = determinant( t ) <= third * third * ( kThinInertia * third + kSafeInertia * roundingError );
			const V raised = select( thin, kThinRaise * third + kPointInertia + roundingError, V{} );
			isRaised = isRaised || any( thin & ( third > 0.0f ) ); // padding has no inertia
			for ( int k = 0; k < 3; ++k )
			{
				t[k] = t[k] + raised;
				store( rates.regionCentre[k] + r, c[k] );
			}
			isRaised = raiseTaut( rates, r, s, t ) || isRaised;
			invertSymmetric( t );
			for ( int k = 0; k < 6; ++k )
			{
				store( rates.inverseInertia[k] + r, t[k] );
			}
		}
	}
	return isRaised;
}
