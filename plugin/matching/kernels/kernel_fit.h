// Fit of regions, sixteen side by side: moments, rotation by Newton's method, goal transform. Included by kernel_source.h only, inside its
// unnamed namespace (see lane.h). Steinemann et al. 2008, eq. 1; Ohta et al. 2009, eq. 1 and 5.

#pragma once

/// Newton's method stops when its last rotation is below this angle, rad: the remaining error is its square, below float rounding.
constexpr float kTurnConverged = 3e-4f;
constexpr int kMostTurns = 6;

struct Quat
{
	V w, x, y, z;
};

inline Quat loadQuat( const MatchView& view, int r )
{
	return {
		load( view.quaternion[0] + r ), load( view.quaternion[1] + r ), load( view.quaternion[2] + r ), load( view.quaternion[3] + r ) };
}

inline void storeQuat( const MatchView& view, int r, const Quat& q )
{
	store( view.quaternion[0] + r, q.w );
	store( view.quaternion[1] + r, q.x );
	store( view.quaternion[2] + r, q.y );
	store( view.quaternion[3] + r, q.z );
}

/// R( q ) - 1 of a unit quaternion, accurate for small rotations: no terms of order 1 cancel.
inline Mat rotationLessOne( const Quat& q )
{
	const V x2 = q.x + q.x, y2 = q.y + q.y, z2 = q.z + q.z;
	const V xx = q.x * x2, yy = q.y * y2, zz = q.z * z2;
	const V xy = q.x * y2, xz = q.x * z2, yz = q.y * z2;
	const V wx = q.w * x2, wy = q.w * y2, wz = q.w * z2;
	return { { { -( yy + zz ), xy - wz, xz + wy }, { xy + wz, -( xx + zz ), yz - wx }, { xz - wy, yz + wx, -( xx + yy ) } } };
}

/// One Newton step on the rotations for max tr( R^T A ): omega solves ( tr M - M_s ) omega = axial( M ), M = A R^T.
struct Turn
{
	Vec omega;
	I isUphill; ///< the matrix is positive definite: the nearby stationary point is the maximum, not a saddle
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

/// Iterates `q` until it fits `a`; returns the mask of lanes that do not converge to a maximum, whose quaternions stay unchanged.
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

/// a S^T with S = 1 + s.
inline Mat timesTransposed( const Mat& a, const Mat& s )
{
	Mat c;
	for ( int i = 0; i < 3; ++i )
	{
		for ( int j = 0; j < 3; ++j )
		{
			c.m[i][j] = a.m[i][j] + ( ( a.m[i][0] * s.m[j][0] + a.m[i][1] * s.m[j][1] ) + a.m[i][2] * s.m[j][2] );
		}
	}
	return c;
}

/// ( 1 + f ) ( 1 + s ) - 1: from F_e - 1 to F - 1.
inline Mat withFlow( const Mat& f, const Mat& s )
{
	const Mat fs = product( f, s );
	Mat c;
	for ( int i = 0; i < 3; ++i )
	{
		for ( int j = 0; j < 3; ++j )
		{
			c.m[i][j] = f.m[i][j] + ( fs.m[i][j] + s.m[i][j] );
		}
	}
	return c;
}

/// Fit of a region's sums: c - c0 in cells (uc) and A_pq.
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
	if ( view.plastic[0] )
	{
		fit.a = timesTransposed( fit.a, loadMatrix( view.plastic, r ) ); // Steinemann et al. 2008, eq. 9
	}
	return fit;
}

/// F = A_pq J^+   (eq. 10: where the region has flowed, J^+ is that of its plastic rest shape).
inline Mat deformation( const MatchView& view, const Mat& a, int r )
{
	return product( a, loadSymmetric( view.inverseMoment, r ) );
}

/// The matrix whose rotation is the region's: A_pq, A_pq C where beta is a tensor, or F for comparison.
inline Mat fittedMatrix( const MatchView& view, const Mat& a, int r )
{
	if ( view.rotationFromF )
	{
		return deformation( view, a, r );
	}
	return view.blend[0] ? product( a, loadMatrix( view.blend, r ) ) : a;
}

/// F - 1. Along directions without extent the fit has no information, and F equals R: F = A_pq J^+ + R ( 1 - J J^+ ).
inline Mat deformationLessOne( const MatchView& view, const Mat& a, const Mat& rLessOne, int r )
{
	Mat f = deformation( view, a, r );
	if ( view.outOfPlane[0] )
	{
		const Mat out = loadSymmetric( view.outOfPlane, r ), turned = product( rLessOne, out );
		for ( int i = 0; i < 3; ++i )
		{
			for ( int j = 0; j < 3; ++j )
			{
				f.m[i][j] = f.m[i][j] + ( turned.m[i][j] + out.m[i][j] );
			}
		}
	}
	for ( int i = 0; i < 3; ++i )
	{
		f.m[i][i] = f.m[i][i] - 1.0f;
	}
	return f;
}

/// L - 1 from R - 1 and F - 1: L = R + beta ( F - R ) (Ohta et al. 2009, eq. 5), or F + ( R - F ) C^T with a tensor, less the force of
/// volume conservation (volumeMatrix).
inline Mat goalMatrix( const MatchView& view, const Mat& a, const Mat& rLessOne, const Mat& fLessOne, int r )
{
	const V beta = view.regionBeta ? load( view.regionBeta + r ) : splat( view.beta );
	Mat l;
	if ( view.blend[0] )
	{
		const Mat c = loadMatrix( view.blend, r );
		for ( int i = 0; i < 3; ++i )
		{
			for ( int j = 0; j < 3; ++j )
			{
				V sum = V{};
				for ( int k = 0; k < 3; ++k )
				{
					sum = sum + ( rLessOne.m[i][k] - fLessOne.m[i][k] ) * c.m[j][k];
				}
				l.m[i][j] = fLessOne.m[i][j] + sum;
			}
		}
	}
	else
	{
		for ( int i = 0; i < 3; ++i )
		{
			for ( int j = 0; j < 3; ++j )
			{
				l.m[i][j] = rLessOne.m[i][j] + beta * ( fLessOne.m[i][j] - rLessOne.m[i][j] );
			}
		}
	}
	if ( view.volumeFraction > 0.0f )
	{
		const Mat pushed = volumeMatrix( view, fittedMatrix( view, a, r ), rLessOne, fLessOne, 1.0f - beta, r );
		for ( int k = 0; k < 9; ++k )
		{
			l.m[k / 3][k % 3] = l.m[k / 3][k % 3] - pushed.m[k / 3][k % 3];
		}
	}
	return l;
}

inline bool needsDeformation( const MatchView& view )
{
	return view.beta > 0.0f || view.regionBeta || view.regionEta || view.blend[0] || view.volumeFraction > 0.0f || view.strain;
}

/// Writes the sum over the singular values s of F of ( s - 1 )^2, which is | F - R |^2. And for E = R^T F - 1, with mean m and deviation n
/// = | E - m 1 |, writes m + sqrt( 2 / 3 ) n: equal to the largest s - 1 where the other two are equal, as in tension; otherwise larger, by
/// up to a third of a compression, and at most | E |.
inline void writeStrain( const MatchView& view, const Mat& rLessOne, const Mat& fLessOne, int r )
{
	V sum = V{}, trace = V{};
	for ( int i = 0; i < 3; ++i )
	{
		for ( int j = 0; j < 3; ++j )
		{
			const V difference = fLessOne.m[i][j] - rLessOne.m[i][j];
			sum = sum + difference * difference;
			trace = trace + rLessOne.m[i][j] * difference;
			trace = i == j ? trace + difference : trace;
		}
	}
	store( view.strain + r, sum );
	if ( view.stretch )
	{
		const V mean = trace * ( 1.0f / 3.0f ), about = sum - mean * trace;
		store( view.stretch + r, mean + squareRoot( select( about > 0.0f, about, V{} ) * ( 2.0f / 3.0f ) ) );
	}
}

/// The region's goal, as a matrix D on rest positions q and an associated translation:
///   goal - x = D ( q - c0 ) + ( 1 - eta ) uc - ( 1 - eta ) u,   D = ( L - eta F ) S_p - ( 1 - eta )
/// from goal = c + L S_p q + eta ( x - c - F S_p q ): nodes keep the fraction eta of their non-affine displacement.
inline Mat goalOf( const MatchView& view, const RegionFit& fit, const Quat& q, int r )
{
	const Mat rLessOne = rotationLessOne( q );
	if ( !needsDeformation( view ) && !view.plastic[0] )
	{
		return rLessOne;
	}
	const bool needsF = needsDeformation( view );
	const Mat fLessOne = needsF ? deformationLessOne( view, fit.a, rLessOne, r ) : rLessOne;
	if ( view.strain )
	{
		writeStrain( view, rLessOne, fLessOne, r );
	}
	Mat d = needsF ? goalMatrix( view, fit.a, rLessOne, fLessOne, r ) : rLessOne;
	const V eta = view.regionEta ? load( view.regionEta + r ) : V{};
	if ( view.regionEta )
	{
		for ( int i = 0; i < 3; ++i )
		{
			for ( int j = 0; j < 3; ++j )
			{
				d.m[i][j] = d.m[i][j] - eta * fLessOne.m[i][j];
			}
		}
	}
	if ( view.plastic[0] )
	{
		// D = ( d + ( 1 - eta ) ) ( 1 + s ) - ( 1 - eta ) = d + d s + ( 1 - eta ) s
		const Mat s = loadMatrix( view.plastic, r ), ds = product( d, s );
		for ( int i = 0; i < 3; ++i )
		{
			for ( int j = 0; j < 3; ++j )
			{
				d.m[i][j] = d.m[i][j] + ( ds.m[i][j] + ( 1.0f - eta ) * s.m[i][j] );
			}
		}
	}
	return d;
}

/// Writes the region's record into the tile: b_r ( D, ( 1 - eta ) uc - D c0 ).
inline void writeGoal( const MatchView& view, const RegionFit& fit, const Quat& q, int r, Tile& tile, int at )
{
	const Mat d = goalOf( view, fit, q, r );
	const V c0[3] = { load( view.centre[0] + r ), load( view.centre[1] + r ), load( view.centre[2] + r ) };
	const V uc[3] = { fit.uc.x, fit.uc.y, fit.uc.z };
	const V b = view.regionWeight ? load( view.regionWeight + r ) : splat( 1.0f );
	const V keep = view.regionEta ? 1.0f - load( view.regionEta + r ) : splat( 1.0f );
	for ( int i = 0; i < 3; ++i )
	{
		const V moved = ( d.m[i][0] * c0[0] + d.m[i][1] * c0[1] ) + d.m[i][2] * c0[2];
		store( &tile.row[9 + i][at], b * ( keep * uc[i] - moved ) );
		for ( int j = 0; j < 3; ++j )
		{
			store( &tile.row[3 * i + j][at], b * d.m[i][j] );
		}
	}
}
