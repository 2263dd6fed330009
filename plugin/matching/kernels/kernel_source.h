// The kernels themselves. Each kernels_<target>.cpp defines PLIANT_LANE_WIDTH and PLIANT_KERNEL_TABLE and includes this file once.
// Lanes are independent but for sums, and sums are kept per virtual lane (16 of them) and folded at the end: hence equal bits
// for every width. No template or inline function of any other header is instantiated here.

#include "matching/kernels/kernels.h"

#include <cstdint>

#if defined( __x86_64__ ) || defined( __i386__ )
	#include <immintrin.h>
#endif

namespace pliant {

namespace {

#include "matching/kernels/lane.h"

constexpr int kVirtualLanes = 16;

/// Newton stops when its last turn is below this angle, rad: the error left is its square, below float's rounding.
constexpr float kTurnConverged = 3e-4f;
constexpr int kMostTurns = 6;

/// Added to Newton's matrix in shares of the region's own moment, and absolutely for regions of one cell, where all is zero:
/// it slows the iteration by that share, leaves its fixed point where it is, and keeps what the matrix leaves open as it was.
constexpr float kHessianShare = 1e-6f;
constexpr float kHessianFloor = 1e-8f;

struct Vec
{
	V x, y, z;
};

struct Mat
{
	V m[3][3];
};

inline Vec cross( const Vec& a, const Vec& b )
{
	return { a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x };
}

/// Sums kept per virtual lane. `sub` is the first virtual lane of the vector at hand.
template <int n>
struct LaneSums
{
	alignas( 64 ) float lane[n][kVirtualLanes];

	LaneSums()
	{
		__builtin_memset( lane, 0, sizeof( lane ) );
	}
	void add( int k, int sub, V value )
	{
		store( &lane[k][sub], load( &lane[k][sub] ) + value );
	}
	/// Folds 16 lanes to one, halves onto halves, and adds that to `to`.
	void foldInto( float* to )
	{
		for ( int k = 0; k < n; ++k )
		{
			for ( int half = kVirtualLanes / 2; half > 0; half /= 2 )
			{
				for ( int i = 0; i < half; ++i )
				{
					lane[k][i] += lane[k][i + half];
				}
			}
			to[k] += lane[k][0];
		}
	}
};

/// Twelve rows of one tile, component by component.
struct Tile
{
	alignas( 64 ) float row[kRecordUsed][kTile];
};

inline void storeGroup( Tile& tile, int first, F4 a, F4 b, F4 c, F4 d, int at )
{
	transpose4( a, b, c, d );
	store4( &tile.row[first + 0][at], a );
	store4( &tile.row[first + 1][at], b );
	store4( &tile.row[first + 2][at], c );
	store4( &tile.row[first + 3][at], d );
}

/// Four records become four columns of the tile at `at`.
inline void storeColumns( Tile& tile, const Record ( &r )[4], int at )
{
	storeGroup( tile, 0, quarter<0>( r[0] ), quarter<0>( r[1] ), quarter<0>( r[2] ), quarter<0>( r[3] ), at );
	storeGroup( tile, 4, quarter<1>( r[0] ), quarter<1>( r[1] ), quarter<1>( r[2] ), quarter<1>( r[3] ), at );
	storeGroup( tile, 8, quarter<2>( r[0] ), quarter<2>( r[1] ), quarter<2>( r[2] ), quarter<2>( r[3] ), at );
}

inline std::uint32_t slotOf( const MatchView& view, int node )
{
	return view.slot ? view.slot[node] : std::uint32_t( node );
}

/// Columns of the tile become records of nodes or regions begin .. end.
void writeRecords( const MatchView& view, const Tile& tile, int begin, int end, float* records )
{
	for ( int first = begin; first < end; first += 4 )
	{
		float* to[4];
		for ( int j = 0; j < 4; ++j )
		{
			to[j] = records + std::size_t( first + j < end ? slotOf( view, first + j ) : slotOf( view, end - 1 ) ) * kRecordFloats;
		}
		for ( int group = 0; group < kRecordUsed; group += 4 )
		{
			F4 a = load4( &tile.row[group + 0][first - begin] );
			F4 b = load4( &tile.row[group + 1][first - begin] );
			F4 c = load4( &tile.row[group + 2][first - begin] );
			F4 d = load4( &tile.row[group + 3][first - begin] );
			transpose4( a, b, c, d );
			const F4 column[4] = { a, b, c, d };
			for ( int j = 0; j < 4 && first + j < end; ++j )
			{
				store4( to[j] + group, column[j] );
			}
		}
	}
}

/// Sum of the listed records, even and odd terms apart, so that two chains of additions run side by side.
inline Record sumList( const float* records, const std::uint32_t* member, std::uint32_t count )
{
	Record even = loadRecord( records + std::size_t( member[0] ) * kRecordFloats );
	if ( count == 1 )
	{
		return even;
	}
	Record odd = loadRecord( records + std::size_t( member[1] ) * kRecordFloats );
	std::uint32_t k = 2;
	for ( ; k + 1 < count; k += 2 )
	{
		even = even + loadRecord( records + std::size_t( member[k] ) * kRecordFloats );
		odd = odd + loadRecord( records + std::size_t( member[k + 1] ) * kRecordFloats );
	}
	if ( k < count )
	{
		even = even + loadRecord( records + std::size_t( member[k] ) * kRecordFloats );
	}
	return even + odd;
}

/// Sum of 2w + 1 plane sums through a lattice position along z, from below.
inline Record sumColumn( const MatchView& view, const float* records, std::uint32_t slot )
{
	const std::size_t plane = std::size_t( view.gridX ) * std::size_t( view.gridY );
	const int z = int( slot / plane );
	const int low = z - view.halfWidth > 0 ? z - view.halfWidth : 0;
	const int high = z + view.halfWidth < view.gridZ - 1 ? z + view.halfWidth : view.gridZ - 1;
	const float* from = records + ( slot - std::size_t( z - low ) * plane ) * kRecordFloats;
	Record sum = loadRecord( from );
	for ( int k = low + 1; k <= high; ++k )
	{
		from += plane * kRecordFloats;
		sum = sum + loadRecord( from );
	}
	return sum;
}

inline Record sumAround( const MatchView& view, const float* records, int i )
{
	if ( view.gridX > 0 )
	{
		return sumColumn( view, records, slotOf( view, i ) );
	}
	const std::uint32_t* member = view.member + view.start[i];
	const std::uint32_t count = view.start[i + 1] - view.start[i];
	if ( !view.addOwner )
	{
		return sumList( records, member, count );
	}
	const Record own = loadRecord( records + std::size_t( i ) * kRecordFloats );
	return count == 0 ? own : sumList( records, member, count ) + own;
}

void gatherTile( const MatchView& view, const float* records, int begin, int end, Tile& tile )
{
	for ( int first = begin; first < end; first += 4 )
	{
		Record r[4];
		for ( int j = 0; j < 4; ++j )
		{
			if ( first + j < view.nodeCount )
			{
				r[j] = sumAround( view, records, first + j );
				continue;
			}
			for ( V& piece : r[j].piece )
			{
				piece = V{};
			}
		}
		storeColumns( tile, r, first - begin );
	}
}

inline Vec restPosition( const MatchView& view, int i )
{
	const V perMetre = splat( view.cellsPerMetre );
	return { load( view.x0[0] + i ) * perMetre, load( view.x0[1] + i ) * perMetre, load( view.x0[2] + i ) * perMetre };
}

/// R_b^T a.
inline Vec toFrame( const MatchView& view, const Vec& a )
{
	const float* r = view.frameRotation;
	return { ( a.x * r[0] + a.y * r[3] ) + a.z * r[6], ( a.x * r[1] + a.y * r[4] ) + a.z * r[7], ( a.x * r[2] + a.y * r[5] ) + a.z * r[8] };
}

/// R_b a.
inline Vec fromFrame( const MatchView& view, const Vec& a )
{
	const float* r = view.frameRotation;
	return { ( a.x * r[0] + a.y * r[1] ) + a.z * r[2], ( a.x * r[3] + a.y * r[4] ) + a.z * r[5], ( a.x * r[6] + a.y * r[7] ) + a.z * r[8] };
}

void frameSums( const MatchView& view, int begin, int end, float* sums )
{
	LaneSums<kFrameSums> sum;
	for ( int i = begin; i < end; i += kVirtualLanes )
	{
		for ( int sub = 0; sub < kVirtualLanes; sub += kWidth )
		{
			const V m = load( view.mass + i + sub );
			const Vec q = restPosition( view, i + sub );
			sum.add( 12, sub, m );
			for ( int row = 0; row < 3; ++row )
			{
				const V mx = m * load( view.x[row] + i + sub );
				sum.add( row, sub, mx );
				sum.add( 3 + 3 * row, sub, mx * q.x );
				sum.add( 4 + 3 * row, sub, mx * q.y );
				sum.add( 5 + 3 * row, sub, mx * q.z );
			}
		}
	}
	sum.foldInto( sums );
}

void nodeRecords( const MatchView& view, int begin, int end )
{
	Tile tile;
	for ( int first = begin; first < end; first += kTile )
	{
		const int last = first + kTile < end ? first + kTile : end;
		for ( int i = first; i < last; i += kWidth )
		{
			const V perMetre = splat( view.cellsPerMetre );
			const Vec q = restPosition( view, i );
			const Vec arm = { ( load( view.x[0] + i ) - view.frameCentre[0] ) * perMetre,
				( load( view.x[1] + i ) - view.frameCentre[1] ) * perMetre, ( load( view.x[2] + i ) - view.frameCentre[2] ) * perMetre };

			// u = R_b^T ( x - c_b ) / d - q
			const Vec turned = toFrame( view, arm );
			const Vec u = { turned.x - q.x, turned.y - q.y, turned.z - q.z };
			store( view.change[0] + i, u.x );
			store( view.change[1] + i, u.y );
			store( view.change[2] + i, u.z );

			const V a = load( view.nodeWeight + i );
			const V au[3] = { a * u.x, a * u.y, a * u.z };
			for ( int row = 0; row < 3; ++row )
			{
				store( &tile.row[row][i - first], au[row] );
				store( &tile.row[3 + 3 * row][i - first], au[row] * q.x );
				store( &tile.row[4 + 3 * row][i - first], au[row] * q.y );
				store( &tile.row[5 + 3 * row][i - first], au[row] * q.z );
			}
		}
		const int real = last < view.nodeCount ? last : view.nodeCount;
		if ( real > first )
		{
			writeRecords( view, tile, first, real, view.nodeRecord );
		}
	}
}

/// Along one line of `count` records, `stride` records apart: each becomes the sum over w neighbours to either side, in place.
template <int w>
void boxLine( float* line, int count, std::size_t stride )
{
	const std::size_t step = stride * kRecordFloats;
	for ( int piece = 0; piece < kPieces; ++piece )
	{
		float* at = line + piece * kWidth;
		V window[2 * w + 1]; // originals i - w .. i + w
		for ( int k = 0; k < w; ++k )
		{
			window[k] = V{};
		}
		for ( int k = 0; k <= w; ++k )
		{
			window[w + k] = k < count ? load( at + std::size_t( k ) * step ) : V{};
		}
		for ( int i = 0; i < count; ++i )
		{
			V sum = window[0];
			for ( int k = 1; k <= 2 * w; ++k )
			{
				sum = sum + window[k];
			}
			store( at + std::size_t( i ) * step, sum );
			for ( int k = 0; k < 2 * w; ++k )
			{
				window[k] = window[k + 1];
			}
			window[2 * w] = i + w + 1 < count ? load( at + std::size_t( i + w + 1 ) * step ) : V{};
		}
	}
}

template <int w>
void boxPlaneOf( const MatchView& view, float* plane )
{
	for ( int y = 0; y < view.gridY; ++y )
	{
		boxLine<w>( plane + std::size_t( y ) * view.gridX * kRecordFloats, view.gridX, 1 );
	}
	for ( int x = 0; x < view.gridX; ++x )
	{
		boxLine<w>( plane + std::size_t( x ) * kRecordFloats, view.gridY, std::size_t( view.gridX ) );
	}
}

void boxPlane( const MatchView& view, float* records, int z )
{
	float* plane = records + std::size_t( z ) * view.gridX * view.gridY * kRecordFloats;
	switch ( view.halfWidth )
	{
		case 1: boxPlaneOf<1>( view, plane ); break;
		case 2: boxPlaneOf<2>( view, plane ); break;
		case 3: boxPlaneOf<3>( view, plane ); break;
		default: boxPlaneOf<4>( view, plane ); break;
	}
}

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

inline Quat loadQuat( const MatchView& view, int r )
{
	return { load( view.quaternion[0] + r ), load( view.quaternion[1] + r ), load( view.quaternion[2] + r ), load( view.quaternion[3] + r ) };
}

inline void storeQuat( const MatchView& view, int r, const Quat& q )
{
	store( view.quaternion[0] + r, q.w );
	store( view.quaternion[1] + r, q.x );
	store( view.quaternion[2] + r, q.y );
	store( view.quaternion[3] + r, q.z );
}

int fitRegions( const MatchView& view, int begin, int end, std::uint32_t* open )
{
	Tile in, out;
	int openCount = 0;
	for ( int first = begin; first < end; first += kTile )
	{
		const int last = first + kTile < end ? first + kTile : end;
		gatherTile( view, view.nodeRecord, first, last, in );
		for ( int r = first; r < last; r += kWidth )
		{
			const RegionFit fit = readRegion( view, in, r, r - first );
			const V trace = ( load( view.moment[0] + r ) + load( view.moment[1] + r ) ) + load( view.moment[2] + r );
			Quat q = loadQuat( view, r );
			const V floor = view.rotationFromF ? splat( kHessianShare ) : trace * kHessianShare + kHessianFloor;
			const I openLanes = fitLanes( view.rotationFromF ? deformation( view, fit.a, r ) : fit.a, floor, q );
			storeQuat( view, r, q );
			writeGoal( view, fit, q, r, out, r - first );
			for ( int lane = 0; any( openLanes ) && lane < kWidth; ++lane )
			{
				if ( openLanes[lane] != 0 && r + lane < view.nodeCount )
				{
					open[openCount++] = std::uint32_t( r + lane );
				}
			}
		}
		const int real = last < view.nodeCount ? last : view.nodeCount;
		if ( real > first )
		{
			writeRecords( view, out, first, real, view.regionRecord );
		}
	}
	return openCount;
}

/// One region alone, in the lanes it has in its block, so that its numbers are the same bits as in the block.
struct Single
{
	Tile tile;
	int block;
	RegionFit fit;
};

inline void readSingle( const MatchView& view, int region, Single& single )
{
	single.block = region / kWidth * kWidth;
	const int first = region / kVirtualLanes * kVirtualLanes;
	gatherTile( view, view.nodeRecord, first, first + kVirtualLanes, single.tile );
	single.fit = readRegion( view, single.tile, single.block, single.block - first );
}

void finishRegion( const MatchView& view, int region )
{
	Single single;
	readSingle( view, region, single );
	Tile out;
	writeGoal( view, single.fit, loadQuat( view, single.block ), single.block, out, single.block % kVirtualLanes );
	float* record = view.regionRecord + std::size_t( slotOf( view, region ) ) * kRecordFloats;
	for ( int k = 0; k < kRecordUsed; ++k )
	{
		record[k] = out.row[k][region % kVirtualLanes];
	}
}

void regionMatrix( const MatchView& view, int region, float* matrix )
{
	Single single;
	readSingle( view, region, single );
	const Mat wanted = view.rotationFromF ? deformation( view, single.fit.a, single.block ) : single.fit.a;
	for ( int i = 0; i < 3; ++i )
	{
		for ( int j = 0; j < 3; ++j )
		{
			matrix[3 * i + j] = wanted.m[i][j][region % kWidth];
		}
	}
}

/// e = ( sum of ( L - 1 ) q + sum of ( uc - ( L - 1 ) c0 ) ) / C - u
inline Vec residualOf( const MatchView& view, const Tile& tile, int i, int at, const Vec& q, const Vec& u )
{
	const V cover = load( view.inverseCover + i );
	V goal[3];
	for ( int k = 0; k < 3; ++k )
	{
		goal[k] = ( ( load( &tile.row[3 * k][at] ) * q.x + load( &tile.row[3 * k + 1][at] ) * q.y ) + load( &tile.row[3 * k + 2][at] ) * q.z ) +
				  load( &tile.row[9 + k][at] );
	}
	return { goal[0] * cover - u.x, goal[1] * cover - u.y, goal[2] * cover - u.z };
}

void scatter( const MatchView& view, int begin, int end, float* sums )
{
	LaneSums<kImpulseSums> sum;
	Tile tile;
	for ( int first = begin; first < end; first += kTile )
	{
		const int last = first + kTile < end ? first + kTile : end;
		gatherTile( view, view.regionRecord, first, last, tile );
		for ( int i = first; i < last; i += kWidth )
		{
			const int sub = i % kVirtualLanes;
			const Vec q = restPosition( view, i );
			const Vec u = { load( view.change[0] + i ), load( view.change[1] + i ), load( view.change[2] + i ) };
			const Vec e = residualOf( view, tile, i, i - first, q, u );

			// y = ( 1 - s ) alpha e - s u + k ( e - e before ); u is the way from the whole body's rigid fit
			const float k = view.dampingShare, s = view.bodyShare, alpha = ( 1.0f - s ) * view.alpha;
			const Vec y = { ( alpha * e.x - s * u.x ) + k * ( e.x - load( view.residual[0] + i ) ),
				( alpha * e.y - s * u.y ) + k * ( e.y - load( view.residual[1] + i ) ),
				( alpha * e.z - s * u.z ) + k * ( e.z - load( view.residual[2] + i ) ) };
			store( view.residual[0] + i, e.x );
			store( view.residual[1] + i, e.y );
			store( view.residual[2] + i, e.z );
			store( view.change[0] + i, y.x );
			store( view.change[1] + i, y.y );
			store( view.change[2] + i, y.z );

			const V m = load( view.mass + i );
			const Vec p = { q.x + u.x, q.y + u.y, q.z + u.z };
			const Vec mp = { m * p.x, m * p.y, m * p.z };
			const Vec turn = cross( mp, y );
			const Vec mv = { m * load( view.v[0] + i ), m * load( view.v[1] + i ), m * load( view.v[2] + i ) };
			const Vec arm = { load( view.x[0] + i ) - view.frameCentre[0], load( view.x[1] + i ) - view.frameCentre[1],
				load( view.x[2] + i ) - view.frameCentre[2] };
			const Vec spin = cross( arm, mv );
			const V value[kImpulseSums] = { m * y.x, m * y.y, m * y.z, turn.x, turn.y, turn.z, mp.x, mp.y, mp.z, mp.x * p.x, mp.y * p.y,
				mp.z * p.z, mp.y * p.z, mp.x * p.z, mp.x * p.y, mv.x, mv.y, mv.z, spin.x, spin.y, spin.z };
			for ( int n = 0; n < kImpulseSums; ++n )
			{
				sum.add( n, sub, value[n] );
			}
		}
	}
	sum.foldInto( sums );
}

void apply( const MatchView& view, int begin, int end )
{
	for ( int i = begin; i < end; i += kWidth )
	{
		const Vec y = fromFrame( view, { load( view.change[0] + i ), load( view.change[1] + i ), load( view.change[2] + i ) } );
		const Vec arm = { load( view.x[0] + i ) - view.pivot[0], load( view.x[1] + i ) - view.pivot[1], load( view.x[2] + i ) - view.pivot[2] };
		const Vec turn = cross( { splat( view.turn[0] ), splat( view.turn[1] ), splat( view.turn[2] ) }, arm );
		const V freedom = load( view.freedom + i );
		const V change[3] = { ( y.x * view.speedPerCell - view.shift[0] ) - turn.x, ( y.y * view.speedPerCell - view.shift[1] ) - turn.y,
			( y.z * view.speedPerCell - view.shift[2] ) - turn.z };
		for ( int k = 0; k < 3; ++k )
		{
			const V v = load( view.v[k] + i );
			store( view.v[k] + i, v + freedom * ( change[k] - view.wobbleShare * v ) );
		}
	}
}

} // namespace

extern const Kernels PLIANT_KERNEL_TABLE;
const Kernels PLIANT_KERNEL_TABLE = { &frameSums, &nodeRecords, &boxPlane, &fitRegions, &finishRegion, &scatter, &apply, &regionMatrix,
	PLIANT_KERNEL_NAME };

} // namespace pliant
