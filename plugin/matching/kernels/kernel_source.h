// The kernels. Each kernels_<target>.cpp defines PLIANT_LANE_WIDTH and PLIANT_KERNEL_TABLE and includes this file once. Lanes are
// independent except in sums, which are kept per virtual lane (16 of them) and folded at the end: hence equal bits for every width. No
// template or inline function of any other header is instantiated here.

#pragma once

#include "matching/kernels/kernels.h"
#include "matching/kernels/volume_limits.h"

#include <cstdint>

#if defined( __x86_64__ ) || defined( __i386__ )
	#include <immintrin.h>
#endif

namespace pliant {

namespace {

#include "matching/kernels/lane.h"

constexpr int kVirtualLanes = 16;

// In the order of use.
// clang-format off
#include "matching/kernels/kernel_tile.h"
#include "matching/kernels/kernel_volume.h"
#include "matching/kernels/kernel_fit.h"
#include "matching/kernels/kernel_far.h"
#include "matching/kernels/kernel_boxes.h"
#include "matching/kernels/kernel_inertia.h"
#include "matching/kernels/kernel_rates.h"
#include "matching/kernels/kernel_sums.h"
#include "matching/kernels/kernel_motion.h"
// clang-format on

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

/// Along one line of `count` records, `stride` records apart: replaces each by the sum over w neighbours to either side, in place.
template <int w, class Size>
void boxLine( float* line, int count, std::size_t stride )
{
	using Piece = typename Size::Piece;
	const std::size_t step = stride * Size::floats;
	for ( int piece = 0; piece < Size::pieces; ++piece )
	{
		float* at = line + piece * kPieceFloats<Size>;
		Piece window[2 * w + 1]; // originals i - w .. i + w
		for ( int k = 0; k < w; ++k )
		{
			window[k] = Piece{};
		}
		for ( int k = 0; k <= w; ++k )
		{
			window[w + k] = k < count ? loadPiece<Size>( at + std::size_t( k ) * step ) : Piece{};
		}
		for ( int i = 0; i < count; ++i )
		{
			Piece sum = window[0];
			for ( int k = 1; k <= 2 * w; ++k )
			{
				sum = sum + window[k];
			}
			*reinterpret_cast<Piece*>( at + std::size_t( i ) * step ) = sum;
			for ( int k = 0; k < 2 * w; ++k )
			{
				window[k] = window[k + 1];
			}
			window[2 * w] = i + w + 1 < count ? loadPiece<Size>( at + std::size_t( i + w + 1 ) * step ) : Piece{};
		}
	}
}

template <int w, class Size>
void boxPlaneOf( const MatchView& view, float* plane )
{
	for ( int y = 0; y < view.gridY; ++y )
	{
		boxLine<w, Size>( plane + std::size_t( y ) * view.gridX * Size::floats, view.gridX, 1 );
	}
	for ( int x = 0; x < view.gridX; ++x )
	{
		boxLine<w, Size>( plane + std::size_t( x ) * Size::floats, view.gridY, std::size_t( view.gridX ) );
	}
}

template <class Size>
void boxPlaneOfSize( const MatchView& view, float* records, int z )
{
	float* plane = records + std::size_t( z ) * view.gridX * view.gridY * Size::floats;
	switch ( view.halfWidth )
	{
		case 1: boxPlaneOf<1, Size>( view, plane ); break;
		case 2: boxPlaneOf<2, Size>( view, plane ); break;
		case 3: boxPlaneOf<3, Size>( view, plane ); break;
		default: boxPlaneOf<4, Size>( view, plane ); break;
	}
}

void boxPlane( const MatchView& view, float* records, int z )
{
	boxPlaneOfSize<Whole>( view, records, z );
}

void boxPlaneHalf( const MatchView& view, float* records, int z )
{
	boxPlaneOfSize<Half>( view, records, z );
}

void boxPlaneFull( const MatchView& view, float* records, int z )
{
	boxPlaneOfSize<Full>( view, records, z );
}

int fitRegions( const MatchView& view, int begin, int end, std::uint32_t* open )
{
	Tile in, out;
	int openCount = 0;
	for ( int first = begin; first < end; first += kTile )
	{
		const int last = first + kTile < end ? first + kTile : end;
		gatherTile( view, view.nodeRecord, view.memberMass, first, last, in );
		for ( int r = first; r < last; r += kWidth )
		{
			const RegionFit fit = readRegion( view, in, r, r - first );
			const V trace = ( load( view.moment[0] + r ) + load( view.moment[1] + r ) ) + load( view.moment[2] + r );
			Quat q = loadQuat( view, r );
			const V floor = view.rotationFromF ? splat( kHessianFraction ) : trace * kHessianFraction + kHessianFloor;
			const I openLanes = fitLanes( fittedMatrix( view, fit.a, r ), floor, q );
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

/// A single region, in the lane it has within its block, so that its results are bitwise the same as in the block.
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
	gatherTile( view, view.nodeRecord, view.memberMass, first, first + kVirtualLanes, single.tile );
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
	const Mat wanted = fittedMatrix( view, single.fit.a, single.block );
	for ( int i = 0; i < 3; ++i )
	{
		for ( int j = 0; j < 3; ++j )
		{
			matrix[3 * i + j] = wanted.m[i][j][region % kWidth];
		}
	}
}

/// e = ( sum of D q + sum of ( ( 1 - eta ) uc - D c0 ) ) / C - pull u; on a uniform lattice D = L - 1 and pull = 1.
inline Vec residualOf( const MatchView& view, const Tile& tile, int i, int at, const Vec& q, const Vec& u )
{
	const V cover = load( view.inverseCover + i );
	const V pull = view.pull ? load( view.pull + i ) : splat( 1.0f );
	V goal[3];
	for ( int k = 0; k < 3; ++k )
	{
		goal[k] = ( ( load( &tile.row[3 * k][at] ) * q.x + load( &tile.row[3 * k + 1][at] ) * q.y ) +
					  load( &tile.row[3 * k + 2][at] ) * q.z ) +
			load( &tile.row[9 + k][at] );
	}
	return { goal[0] * cover - pull * u.x, goal[1] * cover - pull * u.y, goal[2] * cover - pull * u.z };
}

void scatter( const MatchView& view, int begin, int end, float* sums )
{
	LaneSums<kImpulseSums> sum;
	Tile tile, farTile;
	for ( int first = begin; first < end; first += kTile )
	{
		const int last = first + kTile < end ? first + kTile : end;
		gatherTile( view, view.regionRecord, view.memberFraction, first, last, tile );
		if ( view.farRecord )
		{
			gatherFar( view, first, last, farTile );
		}
		for ( int i = first; i < last; i += kWidth )
		{
			const int sub = i % kVirtualLanes;
			const Vec q = restPosition( view, i );
			const Vec u = { load( view.change[0] + i ), load( view.change[1] + i ), load( view.change[2] + i ) };
			Vec e = residualOf( view, tile, i, i - first, q, u );

			// y = ( 1 - s ) alpha e - s u + k ( e - e before ); u is the displacement from the whole body's rigid fit
			const float k = view.dampingFraction, s = view.bodyFraction, alpha = ( 1.0f - s ) * view.alpha;
			Vec displacement = { alpha * e.x, alpha * e.y, alpha * e.z };
			if ( view.farRecord )
			{
				const Vec far = farDisplacement( view, farTile, i, i - first, q, u );
				const float fraction = 1.0f - s, damped = view.farDamping;
				displacement = { displacement.x + fraction * far.x, displacement.y + fraction * far.y, displacement.z + fraction * far.z };
				e = { e.x + damped * far.x, e.y + damped * far.y, e.z + damped * far.z };
			}
			const Vec y = { ( displacement.x - s * u.x ) + k * ( e.x - load( view.residual[0] + i ) ),
				( displacement.y - s * u.y ) + k * ( e.y - load( view.residual[1] + i ) ),
				( displacement.z - s * u.z ) + k * ( e.z - load( view.residual[2] + i ) ) };
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
		const Vec arm = {
			load( view.x[0] + i ) - view.pivot[0], load( view.x[1] + i ) - view.pivot[1], load( view.x[2] + i ) - view.pivot[2] };
		const Vec turn = cross( { splat( view.turn[0] ), splat( view.turn[1] ), splat( view.turn[2] ) }, arm );
		const V freedom = load( view.freedom + i );
		const V change[3] = { ( y.x * view.velocityPerCell - view.shift[0] ) - turn.x,
			( y.y * view.velocityPerCell - view.shift[1] ) - turn.y, ( y.z * view.velocityPerCell - view.shift[2] ) - turn.z };
		for ( int k = 0; k < 3; ++k )
		{
			const V v = load( view.v[k] + i );
			store( view.v[k] + i, v + freedom * ( change[k] - view.wobbleFraction * v ) );
		}
	}
}

void deformations( const MatchView& view, int begin, int end, float* gradients )
{
	Tile in;
	for ( int first = begin; first < end; first += kTile )
	{
		const int last = first + kTile < end ? first + kTile : end;
		gatherTile( view, view.nodeRecord, view.memberMass, first, last, in );
		for ( int r = first; r < last; r += kWidth )
		{
			const RegionFit fit = readRegion( view, in, r, r - first );
			Mat f = deformationLessOne( view, fit.a, rotationLessOne( loadQuat( view, r ) ), r );
			if ( view.plastic[0] )
			{
				f = withFlow( f, loadMatrix( view.plastic, r ) );
			}
			for ( int lane = 0; lane < kWidth && r + lane < view.nodeCount; ++lane )
			{
				for ( int k = 0; k < 9; ++k )
				{
					gradients[9 * std::size_t( r + lane - begin ) + k] = f.m[k / 3][k % 3][lane] + ( k % 4 == 0 ? 1.0f : 0.0f );
				}
			}
		}
	}
}

} // namespace

extern const Kernels PLIANT_KERNEL_TABLE;
const Kernels PLIANT_KERNEL_TABLE = { &frameSums, &nodeRecords, &boxPlane, &fitRegions, &finishRegion, &scatter, &apply, &regionMatrix,
	&deformations, &sumRecords, &inertiaRecords, &regionInertias, &rateSums, &rateRecords, &boxPlaneHalf, &boxPlaneFull, &boxRows,
	&rigidRates, &resist, &resistPart, &finishResist, &push, &advance, &dot, &affineSums, &addAffine, PLIANT_KERNEL_NAME };

} // namespace pliant
