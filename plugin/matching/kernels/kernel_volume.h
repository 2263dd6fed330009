// Volume keeping of regions, sixteen side by side, and the matrix operations shared with the fit. Included by kernel_source.h only, inside
// its unnamed namespace (see lane.h).

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

/// h of volumeMatrix:   ( tr M - M ) h = - axial( F R^T ),   M = A R^T (A C R^T with a tensor); zero where the fit is not a maximum.
inline Vec volumeTurn( const MatchView& view, const Mat& fitted, const Mat& rLessOne, const Mat& fLessOne, int r )
{
	Mat f = fLessOne, rotation = rLessOne;
	for ( int i = 0; i < 3; ++i )
	{
		f.m[i][i] = f.m[i][i] + 1.0f;
		rotation.m[i][i] = rotation.m[i][i] + 1.0f;
	}
	Mat m, stretch;
	for ( int i = 0; i < 3; ++i )
	{
		for ( int j = 0; j < 3; ++j )
		{
			m.m[i][j] = ( fitted.m[i][0] * rotation.m[j][0] + fitted.m[i][1] * rotation.m[j][1] ) + fitted.m[i][2] * rotation.m[j][2];
			stretch.m[i][j] = ( f.m[i][0] * rotation.m[j][0] + f.m[i][1] * rotation.m[j][1] ) + f.m[i][2] * rotation.m[j][2];
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

/// kappa b ( R J^+ + h x R ), J^+ that of the current rest shape, b a mean of J's moments, so that it is kappa R where these are equal: the
/// derivative of 1/2 kappa b tr( R^T F - 1 )^2. h x R is the derivative of its R, without which it would exert a torque on the region.
/// (kappa R derives from no energy where the moments differ, and would feed energy in.)
///   b = ( n / tr( J^+ ) ) min( n | J^+ |^2 / tr( J^+ )^2, kVolumeLimit ),   n directions with extent
inline Mat volumeMatrix( const MatchView& view, const Mat& fitted, const Mat& rLessOne, const Mat& fLessOne, V push, int r )
{
	const Mat inverse = loadSymmetric( view.inverseMoment, r ), turned = product( rLessOne, inverse );
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
	const V mean = push * select( sum > 0.0f, harmonic * select( uneven > kVolumeLimit, splat( kVolumeLimit ), uneven ), V{} );
	const Vec h = volumeTurn( view, fitted, rLessOne, fLessOne, r );
	Mat across = rLessOne;
	for ( int i = 0; i < 3; ++i )
	{
		across.m[i][i] = across.m[i][i] + 1.0f;
	}
	if ( view.blend[0] ) // R C^T
	{
		const Mat c = loadMatrix( view.blend, r ), rotation = across;
		for ( int i = 0; i < 3; ++i )
		{
			for ( int j = 0; j < 3; ++j )
			{
				across.m[i][j] = ( rotation.m[i][0] * c.m[j][0] + rotation.m[i][1] * c.m[j][1] ) + rotation.m[i][2] * c.m[j][2];
			}
		}
	}
	Mat m;
	for ( int j = 0; j < 3; ++j )
	{
		m.m[0][j] = mean * ( ( turned.m[0][j] + inverse.m[0][j] ) + ( h.y * across.m[2][j] - h.z * across.m[1][j] ) );
		m.m[1][j] = mean * ( ( turned.m[1][j] + inverse.m[1][j] ) + ( h.z * across.m[0][j] - h.x * across.m[2][j] ) );
		m.m[2][j] = mean * ( ( turned.m[2][j] + inverse.m[2][j] ) + ( h.x * across.m[1][j] - h.y * across.m[0][j] ) );
	}
	return m;
}
