// One region's fit, sixteen side by side: moments, rotation by Newton's method, goal transform. Included by kernel_source.h only,
// inside its unnamed namespace (see lane.h). Steinemann et al. 2008, eq. 1; Ohta et al. 2009, eq. 1 and 5.

#pragma once

/// Newton stops when its last turn is below this angle, rad: the error left is its square, below float's rounding.
constexpr float kTurnConverged = 3e-4f;
constexpr int kMostTurns = 6;

/// Added to Newton's matrix in shares of the region's own moment, and absolutely for regions of one cell, where all is zero:
/// it slows the iteration by that share, leaves its fixed point where it is, and keeps what the matrix leaves open as it was.
constexpr float kHessianShare = 1e-6f;
constexpr float kHessianFloor = 1e-8f;

struct Quat
{
	V w, x, y, z;
};

/// R( q ) - 1 of a unit quaternion, small where the rotation is small: nothing of order 1 is added and taken away again.
inline Mat rotationLessOne( const Quat& q )
{
	const V x2 = q.x + q.x, y2 = q.y + q.y, z2 = q.z + q.z;
	const V xx = q.x * x2, yy = q.y * y2, zz = q.z * z2;
	const V xy = q.x * y2, xz = q.x * z2, yz = q.y * z2;
	const V wx = q.w * x2, wy = q.w * y2, wz = q.w * z2;
	return { { { -( yy + zz ), xy - wz, xz + wy }, { xy + wz, -( xx + zz ), yz - wx }, { xz - wy, yz + wx, -( xx + yy ) } } };
}

/// One turn of Newton's method on the rotations for max tr( R^T A ): omega solves ( tr M - M_s ) omega = axial( M ), M = A R^T.
struct Turn
{
	Vec omega;
	I isUphill; ///< the matrix is positive definite: what is near is the maximum, not a saddle
};

inline Turn newtonTurn( const Mat& a, const Quat& q, V floor )
{
	Mat r = rotationLessOne( q );
	for ( int i = 0; i < 3; ++i )
	{
		r.m[i][i] = r.m[i][i] + 1.0f;
	}
	Mat m;
	for ( int i = 0; i < 3; ++i )
	{
		for ( int j = 0; j < 3; ++j )
		{
			m.m[i][j] = ( a.m[i][0] * r.m[j][0] + a.m[i][1] * r.m[j][1] ) + a.m[i][2] * r.m[j][2];
		}
	}
	const Vec axial = { m.m[2][1] - m.m[1][2], m.m[0][2] - m.m[2][0], m.m[1][0] - m.m[0][1] };
	const V hxx = ( m.m[1][1] + m.m[2][2] ) + floor, hyy = ( m.m[0][0] + m.m[2][2] ) + floor, hzz = ( m.m[0][0] + m.m[1][1] ) + floor;
	const V hxy = -0.5f * ( m.m[0][1] + m.m[1][0] ), hxz = -0.5f * ( m.m[0][2] + m.m[2][0] ), hyz = -0.5f * ( m.m[1][2] + m.m[2][1] );

	// The symmetric 3x3 system by cofactors.
	const V cxx = hyy * hzz - hyz * hyz, cxy = hxz * hyz - hxy * hzz, cxz = hxy * hyz - hxz * hyy;
	const V cyy = hxx * hzz - hxz * hxz, cyz = hxy * hxz - hxx * hyz, czz = hxx * hyy - hxy * hxy;
	const V det = ( hxx * cxx + hxy * cxy ) + hxz * cxz;
	const V inverse = 1.0f / det;
	Turn turn;
	turn.omega = { ( ( cxx * axial.x + cxy * axial.y ) + cxz * axial.z ) * inverse,
		( ( cxy * axial.x + cyy * axial.y ) + cyz * axial.z ) * inverse, ( ( cxz * axial.x + cyz * axial.y ) + czz * axial.z ) * inverse };
	turn.isUphill = ( hxx > 0.0f ) & ( czz > 0.0f ) & ( det > 0.0f );
	return turn;
}

/// ( 1, omega / 2 ) q, normalised.
inline Quat turned( const Quat& q, const Vec& omega )
{
	const V x = 0.5f * omega.x, y = 0.5f * omega.y, z = 0.5f * omega.z;
	const Quat p = { q.w - ( ( x * q.x + y * q.y ) + z * q.z ), q.x + ( ( x * q.w + y * q.z ) - z * q.y ),
		q.y + ( ( y * q.w + z * q.x ) - x * q.z ), q.z + ( ( z * q.w + x * q.y ) - y * q.x ) };
	const V scale = 1.0f / squareRoot( ( p.w * p.w + p.x * p.x ) + ( p.y * p.y + p.z * p.z ) );
	return { p.w * scale, p.x * scale, p.y * scale, p.z * scale };
}

/// Turns `q` until it fits `a`; lanes that do not settle on a maximum come back in the mask, their quaternion as it was.
inline I fitLanes( const Mat& a, V floor, Quat& q )
{
	const Quat before = q;
	I active = ~I{};
	I settled = I{};
	for ( int turnNumber = 0; turnNumber < kMostTurns && any( active ); ++turnNumber )
	{
		const Turn turn = newtonTurn( a, q, floor );
		const Quat next = turned( q, turn.omega );
		const V size = ( turn.omega.x * turn.omega.x + turn.omega.y * turn.omega.y ) + turn.omega.z * turn.omega.z;
		q = { select( active, next.w, q.w ), select( active, next.x, q.x ), select( active, next.y, q.y ), select( active, next.z, q.z ) };
		const I done = active & ( size <= kTurnConverged * kTurnConverged );
		settled = settled | ( done & turn.isUphill );
		active = active & ~done;
	}
	const I open = ~settled;
	q = { select( open, before.w, q.w ), select( open, before.x, q.x ), select( open, before.y, q.y ), select( open, before.z, q.z ) };
	return open;
}

/// What a region's sums say: c - c0 in cells (uc) and A_pq.
struct RegionFit
{
	Vec uc;
	Mat a;
};

inline RegionFit readRegion( const MatchView& view, const Tile& tile, int r, int at )
{
	// uc = sum a u / M,   A_pq = J + sum a u q^T - ( sum a u ) c0^T
	const V inverseMass = load( view.inverseMass + r );
	const V c0[3] = { load( view.centre[0] + r ), load( view.centre[1] + r ), load( view.centre[2] + r ) };
	const V sum[3] = { load( &tile.row[0][at] ), load( &tile.row[1][at] ), load( &tile.row[2][at] ) };
	RegionFit fit;
	fit.uc = { sum[0] * inverseMass, sum[1] * inverseMass, sum[2] * inverseMass };
	for ( int i = 0; i < 3; ++i )
	{
		for ( int j = 0; j < 3; ++j )
		{
			const int symmetric = i == j ? i : 6 - i - j; // xx yy zz yz xz xy
			fit.a.m[i][j] = load( view.moment[symmetric] + r ) + ( load( &tile.row[3 + 3 * i + j][at] ) - sum[i] * c0[j] );
		}
	}
	return fit;
}

/// F = A_pq J^+.
inline Mat deformation( const MatchView& view, const Mat& a, int r )
{
	Mat f;
	for ( int i = 0; i < 3; ++i )
	{
		for ( int j = 0; j < 3; ++j )
		{
			V sum = V{};
			for ( int k = 0; k < 3; ++k )
			{
				sum = sum + a.m[i][k] * load( view.inverseMoment[k == j ? k : 6 - k - j] + r );
			}
			f.m[i][j] = sum;
		}
	}
	return f;
}

/// The region's record into the tile: b_r ( L - 1, uc - ( L - 1 ) c0 ), L = R + beta ( F - R ).
inline void writeGoal( const MatchView& view, const RegionFit& fit, const Quat& q, int r, Tile& tile, int at )
{
	Mat l = rotationLessOne( q );
	if ( view.beta > 0.0f )
	{
		const Mat f = deformation( view, fit.a, r );
		for ( int i = 0; i < 3; ++i )
		{
			for ( int j = 0; j < 3; ++j )
			{
				const V fLessOne = i == j ? f.m[i][j] - 1.0f : f.m[i][j];
				l.m[i][j] = l.m[i][j] + view.beta * ( fLessOne - l.m[i][j] );
			}
		}
	}
	const V c0[3] = { load( view.centre[0] + r ), load( view.centre[1] + r ), load( view.centre[2] + r ) };
	const V uc[3] = { fit.uc.x, fit.uc.y, fit.uc.z };
	const V b = view.regionWeight ? load( view.regionWeight + r ) : splat( 1.0f );
	for ( int i = 0; i < 3; ++i )
	{
		const V moved = ( l.m[i][0] * c0[0] + l.m[i][1] * c0[1] ) + l.m[i][2] * c0[2];
		store( &tile.row[9 + i][at], b * ( uc[i] - moved ) );
		for ( int j = 0; j < 3; ++j )
		{
			store( &tile.row[3 * i + j][at], b * l.m[i][j] );
		}
	}
}
