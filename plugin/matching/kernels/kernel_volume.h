// Volume conservation of regions, sixteen side by side, and the matrix operations shared with the fit. Included by kernel_source.h only,
// inside its unnamed namespace (see lane.h).

#pragma once

/// Added to Newton's matrix, relative to the region's own moment, and absolutely for regions of one cell, where all is zero: slows the
/// iteration by that fraction, does not move its fixed point, and keeps undetermined rotations unchanged.
constexpr float kHessianFraction = 1e-6f;
constexpr float kHessianFloor = 1e-8f;

inline Mat product( const Mat& a, const Mat& b )
{
	Mat c;
	for ( int i = 0; i < 3; ++i )
	{
		for ( int j = 0; j < 3; ++j )
		{
			c.m[i][j] = ( a.m[i][0] * b.m[0][j] + a.m[i][1] * b.m[1][j] ) + a.m[i][2] * b.m[2][j];
		}
	}
	return c;
}

inline Mat loadMatrix( const float* const ( &rows )[9], int r )
{
	Mat a;
	for ( int i = 0; i < 3; ++i )
	{
		for ( int j = 0; j < 3; ++j )
		{
			a.m[i][j] = load( rows[3 * i + j] + r );
		}
	}
	return a;
}

/// Component order: xx, yy, zz, yz, xz, xy.
inline Mat loadSymmetric( const float* const ( &components )[6], int r )
{
	Mat a;
	for ( int i = 0; i < 3; ++i )
	{
		for ( int j = 0; j < 3; ++j )
		{
			a.m[i][j] = load( components[i == j ? i : 6 - i - j] + r );
		}
	}
	return a;
}

/// The weights of volume conservation in a region: b, a mean of its moments J (0 for a region without extent), and B - 1:
///   b = ( n / tr( J^+ ) ) min( n | J^+ |^2 / tr( J^+ )^2, kVolumeLimit ),   n directions with extent
///   B = ( ( 1 - s ) b + s J ) / ( ( 1 - s ) b + s tr J / n ),   s = kMomentShare
/// Of a body with free faces, m by B = 1 puts too little of the pressure along the faces and too much across them, by B = J the reverse.
struct VolumeWeights
{
	V mean;
	Mat lessOne;
};

inline VolumeWeights volumeWeights( const MatchView& view, const Mat& inverse, int r )
{
	const V sum = ( inverse.m[0][0] + inverse.m[1][1] ) + inverse.m[2][2];
	V extents = splat( 3.0f ), square = V{};
	if ( view.outOfPlane[0] )
	{
		const Mat out = loadSymmetric( view.outOfPlane, r );
		extents = extents - ( ( out.m[0][0] + out.m[1][1] ) + out.m[2][2] );
	}
	for ( int i = 0; i < 3; ++i )
	{
		for ( int j = 0; j < 3; ++j )
		{
			square = square + inverse.m[i][j] * inverse.m[i][j];
		}
	}
	const V harmonic = extents / sum, uneven = harmonic * ( square / sum );
	const Mat moment = loadSymmetric( view.moment, r );
	VolumeWeights weights;
	weights.mean = select( sum > 0.0f, harmonic * select( uneven > kVolumeLimit, splat( kVolumeLimit ), uneven ), V{} );
	const V own = ( 1.0f - kMomentShare ) * weights.mean;
	const V whole = own + kMomentShare * ( ( ( moment.m[0][0] + moment.m[1][1] ) + moment.m[2][2] ) / extents );
	const V scale = select( whole > 0.0f, 1.0f / whole, V{} );
	for ( int i = 0; i < 3; ++i )
	{
		for ( int j = 0; j < 3; ++j )
		{
			const V share = kMomentShare * moment.m[i][j];
			weights.lessOne.m[i][j] = i == j ? ( own + share ) * scale - 1.0f : share * scale;
		}
	}
	return weights;
}

/// U = sym( R^T F ) of a region, the volume-preserving shape with the same deviator, and how far the region is from it.
struct VolumeStrain
{
	V size;       ///< m = tr U - 3 x + tr( ( B - 1 )( U - 1 ) ): positive where the region is expanded
	Mat gradient; ///< N = dm / dU = 3 U'^-1 / tr U'^-1 + B - 1 = 3 cof U' / e2( U' ) + B - 1,   U' = x + dev U
	V square;     ///< | N |^2; with B = 1: 3 at rest, 4.5 at most in tension, 9 at most
};

// x is the root of det U' = x^3 - q x / 2 + det( dev U ) = ( x - s )^2 ( x + 2 s ) + det( dev U ) - 2 s^3 = 1,   q = | dev U |^2 = 6 s^2
// at most 1 + 2 s, and at most s + ( D / 3 s )^1/2 with D = 1 + 2 s^3 - det( dev U ); Newton's method falls to it from there. With B = 1, m
// is zero exactly where det U = 1, and linear in displacements along the identity. A deviator too large for floats counts as none.
inline VolumeStrain volumeStrain( const Mat& rLessOne, const Mat& fLessOne, const Mat& weights )
{
	Mat strain; // U - 1
	for ( int i = 0; i < 3; ++i )
	{
		for ( int j = 0; j < 3; ++j )
		{
			V sum = rLessOne.m[j][i] + fLessOne.m[i][j];
			for ( int k = 0; k < 3; ++k )
			{
				sum = sum + rLessOne.m[k][i] * fLessOne.m[k][j];
			}
			strain.m[i][j] = sum;
		}
	}
	const V trace = ( strain.m[0][0] + strain.m[1][1] ) + strain.m[2][2], third = trace * ( 1.0f / 3.0f );
	V xx = strain.m[0][0] - third, yy = strain.m[1][1] - third, zz = strain.m[2][2] - third;
	V yz = 0.5f * ( strain.m[1][2] + strain.m[2][1] ), xz = 0.5f * ( strain.m[0][2] + strain.m[2][0] ),
	  xy = 0.5f * ( strain.m[0][1] + strain.m[1][0] );
	V half = 0.5f * ( ( xx * xx + yy * yy ) + zz * zz ) + ( ( yz * yz + xz * xz ) + xy * xy ); // q / 2
	const I isBounded = half < kMostDeviator;
	V* const parts[7] = { &xx, &yy, &zz, &yz, &xz, &xy, &half };
	for ( V* const part : parts )
	{
		*part = select( isBounded, *part, V{} );
	}
	const V det = ( xx * ( yy * zz - yz * yz ) + xy * ( yz * xz - xy * zz ) ) + xz * ( xy * yz - yy * xz );
	const V s = squareRoot( half * ( 1.0f / 3.0f ) ),
			upper = s - 1.0f + squareRoot( ( ( 1.0f - det ) + 2.0f * ( s * s * s ) ) / ( 3.0f * s + 1e-20f ) );
	V y = select( upper < 2.0f * s, upper, 2.0f * s ); // x - 1
	for ( int k = 0; k < kVolumeSteps; ++k )
	{
		const V x = 1.0f + y, error = ( y * ( ( y + 3.0f ) * y + 3.0f ) - half * x ) + det;
		y = y - error / ( 3.0f * ( x * x ) - half );
	}
	const V x = 1.0f + y, ux = x + xx, uy = x + yy, uz = x + zz, scale = 3.0f / ( 3.0f * ( x * x ) - half );
	VolumeStrain volume;
	volume.size = trace - 3.0f * y;
	const V n[6] = { scale * ( uy * uz - yz * yz ), scale * ( ux * uz - xz * xz ), scale * ( ux * uy - xy * xy ),
		scale * ( xy * xz - ux * yz ), scale * ( xy * yz - uy * xz ), scale * ( yz * xz - uz * xy ) };
	volume.square = V{};
	for ( int k = 0; k < 9; ++k )
	{
		const int i = k / 3, j = k % 3;
		volume.size = volume.size + weights.m[i][j] * strain.m[i][j];
		volume.gradient.m[i][j] = n[i == j ? i : 6 - i - j] + weights.m[i][j];
		volume.square = volume.square + volume.gradient.m[i][j] * volume.gradient.m[i][j];
	}
	return volume;
}

/// h of volumeMatrix:   ( tr M - M ) h = - axial( F N R^T ),   M = A R^T (A C R^T with a tensor); zero where the fit is not a maximum.
inline Vec volumeTurn( const MatchView& view, const Mat& fitted, const Mat& rotation, const Mat& stretched, int r )
{
	Mat m, stretch;
	for ( int i = 0; i < 3; ++i )
	{
		for ( int j = 0; j < 3; ++j )
		{
			m.m[i][j] = ( fitted.m[i][0] * rotation.m[j][0] + fitted.m[i][1] * rotation.m[j][1] ) + fitted.m[i][2] * rotation.m[j][2];
			stretch.m[i][j] = ( stretched.m[i][0] * rotation.m[j][0] + stretched.m[i][1] * rotation.m[j][1] ) +
				stretched.m[i][2] * rotation.m[j][2];
		}
	}
	const Vec axial = { stretch.m[1][2] - stretch.m[2][1], stretch.m[2][0] - stretch.m[0][2], stretch.m[0][1] - stretch.m[1][0] };
	const V trace = ( load( view.moment[0] + r ) + load( view.moment[1] + r ) ) + load( view.moment[2] + r );
	const V floor = kHessianFraction * trace + kHessianFloor;
	const V hxx = ( m.m[1][1] + m.m[2][2] ) + floor, hyy = ( m.m[0][0] + m.m[2][2] ) + floor, hzz = ( m.m[0][0] + m.m[1][1] ) + floor;
	const V hxy = -0.5f * ( m.m[0][1] + m.m[1][0] ), hxz = -0.5f * ( m.m[0][2] + m.m[2][0] ), hyz = -0.5f * ( m.m[1][2] + m.m[2][1] );
	const V cxx = hyy * hzz - hyz * hyz, cxy = hxz * hyz - hxy * hzz, cxz = hxy * hyz - hxz * hyy;
	const V cyy = hxx * hzz - hxz * hxz, cyz = hxy * hxz - hxx * hyz, czz = hxx * hyy - hxy * hxy;
	const V det = ( hxx * cxx + hxy * cxy ) + hxz * cxz;
	const I isUphill = ( hxx > 0.0f ) & ( czz > 0.0f ) & ( det > kLeastTurning * ( trace * trace * trace ) );
	const V inverse = select( isUphill, -1.0f / det, V{} );
	return { ( ( cxx * axial.x + cxy * axial.y ) + cxz * axial.z ) * inverse,
		( ( cxy * axial.x + cyy * axial.y ) + cyz * axial.z ) * inverse, ( ( cxz * axial.x + cyz * axial.y ) + czz * axial.z ) * inverse };
}

/// Stores what the implicit step's operator needs (storeVolumeRate): the gradient on rest positions before plastic flow, in world axes.
inline void storeVolume( const MatchView& view, const Mat& gradient, V mean, V size, int r )
{
	Mat own = gradient;
	if ( view.plastic[0] )
	{
		const Mat flow = product( gradient, loadMatrix( view.plastic, r ) );
		for ( int k = 0; k < 9; ++k )
		{
			own.m[k / 3][k % 3] = own.m[k / 3][k % 3] + flow.m[k / 3][k % 3];
		}
	}
	const V root = squareRoot( mean );
	for ( int j = 0; j < 3; ++j )
	{
		const Vec column = fromFrame( view, { own.m[0][j], own.m[1][j], own.m[2][j] } );
		const V world[3] = { column.x, column.y, column.z };
		for ( int i = 0; i < 3; ++i )
		{
			store( view.volumeGradient[3 * i + j] + r, root * world[i] );
		}
	}
	store( view.volumeSize + r, size );
}

/// kappa b m ( R N J^+ + h x R ), J^+ that of the current rest shape, b a mean of J's moments: the derivative of 1/2 kappa b m^2, m and N
/// of volumeStrain, for m from -1 to 1, and no larger beyond. For small strain m is tr( B ( R^T F - 1 ) ) and N = B. h x R is the
/// derivative of its R, without which it would exert a torque on the region where R is not the rotation of F. `share`: the share of kappa
/// that acts.
inline Mat volumeMatrix( const MatchView& view, const Mat& fitted, const Mat& rLessOne, const Mat& fLessOne, V share, int r )
{
	const Mat inverse = loadSymmetric( view.inverseMoment, r );
	const VolumeWeights weights = volumeWeights( view, inverse, r );
	const VolumeStrain volume = volumeStrain( rLessOne, fLessOne, weights.lessOne );
	const V size = select( volume.size > 1.0f, splat( 1.0f ), select( volume.size < -1.0f, splat( -1.0f ), volume.size ) );
	const V most = splat( view.mostVolumeResponse );
	const V limited = select( ( volume.square > most ) & ( size > 0.0f ), most / volume.square, splat( 1.0f ) );
	Mat rotation = rLessOne, f = fLessOne;
	for ( int i = 0; i < 3; ++i )
	{
		rotation.m[i][i] = rotation.m[i][i] + 1.0f;
		f.m[i][i] = f.m[i][i] + 1.0f;
	}
	const Vec h = volumeTurn( view, fitted, rotation, product( f, volume.gradient ), r );
	const Mat turned = product( product( rotation, volume.gradient ), inverse );
	Mat across = rotation;
	if ( view.blend[0] ) // R C^T
	{
		const Mat c = loadMatrix( view.blend, r );
		for ( int i = 0; i < 3; ++i )
		{
			for ( int j = 0; j < 3; ++j )
			{
				across.m[i][j] = ( rotation.m[i][0] * c.m[j][0] + rotation.m[i][1] * c.m[j][1] ) + rotation.m[i][2] * c.m[j][2];
			}
		}
	}
	Mat m; // dm / dx
	for ( int j = 0; j < 3; ++j )
	{
		m.m[0][j] = turned.m[0][j] + ( h.y * across.m[2][j] - h.z * across.m[1][j] );
		m.m[1][j] = turned.m[1][j] + ( h.z * across.m[0][j] - h.x * across.m[2][j] );
		m.m[2][j] = turned.m[2][j] + ( h.x * across.m[1][j] - h.y * across.m[0][j] );
	}
	const V mean = share * weights.mean;
	if ( view.volumeGradient[0] )
	{
		storeVolume( view, m, mean, volume.size, r );
	}
	const V push = view.volumeFraction * ( mean * ( size * limited ) );
	for ( int k = 0; k < 9; ++k )
	{
		m.m[k / 3][k % 3] = push * m.m[k / 3][k % 3];
	}
	return m;
}
