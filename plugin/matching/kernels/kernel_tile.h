// Tiles of 64 nodes or regions: conversion between records (one line per node, as gathers need them) and rows (one per component, as
// arithmetic needs them), and the sums of records. Included by kernel_source.h only, inside its unnamed namespace (see lane.h).

#pragma once

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

/// Sums kept per virtual lane. `sub` is the first virtual lane of the current vector.
template <int n>
struct LaneSums
{
	alignas( 64 ) float lane[n][kVirtualLanes];

	LaneSums() { __builtin_memset( lane, 0, sizeof( lane ) ); }
	void add( int k, int sub, V value ) { store( &lane[k][sub], load( &lane[k][sub] ) + value ); }
	/// Folds 16 lanes pairwise by halves to one, and adds that to `to`.
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

/// The rows of one tile, component by component: twelve of them, or all of a Full record.
struct Tile
{
	alignas( 64 ) float row[kRecordFloats][kTile];
};

inline void storeGroup( Tile& tile, int first, F4 a, F4 b, F4 c, F4 d, int at )
{
	transpose4( a, b, c, d );
	store4( &tile.row[first + 0][at], a );
	store4( &tile.row[first + 1][at], b );
	store4( &tile.row[first + 2][at], c );
	store4( &tile.row[first + 3][at], d );
}

/// Transposes four records into four columns of the tile at `at`.
template <class Size>
inline void storeColumns( Tile& tile, const RecordOf<Size> ( &r )[4], int at )
{
	storeGroup( tile, 0, quarter<0>( r[0] ), quarter<0>( r[1] ), quarter<0>( r[2] ), quarter<0>( r[3] ), at );
	storeGroup( tile, 4, quarter<1>( r[0] ), quarter<1>( r[1] ), quarter<1>( r[2] ), quarter<1>( r[3] ), at );
	if constexpr ( Size::groups >= 3 )
	{
		storeGroup( tile, 8, quarter<2>( r[0] ), quarter<2>( r[1] ), quarter<2>( r[2] ), quarter<2>( r[3] ), at );
	}
	if constexpr ( Size::groups == 4 )
	{
		storeGroup( tile, 12, quarter<3>( r[0] ), quarter<3>( r[1] ), quarter<3>( r[2] ), quarter<3>( r[3] ), at );
	}
}

inline std::uint32_t slotOf( const MatchView& view, int node )
{
	return view.slot ? view.slot[node] : std::uint32_t( node );
}

/// Transposes columns of the tile into records of nodes or regions begin .. end.
template <class Size = Whole>
void writeRecords( const MatchView& view, const Tile& tile, int begin, int end, float* records )
{
	for ( int first = begin; first < end; first += 4 )
	{
		float* to[4];
		for ( int j = 0; j < 4; ++j )
		{
			to[j] = records + std::size_t( first + j < end ? slotOf( view, first + j ) : slotOf( view, end - 1 ) ) * Size::floats;
		}
		for ( int group = 0; group < 4 * Size::groups; group += 4 )
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

/// Sum of the listed records, with separate even and odd terms, so that two chains of additions run in parallel.
template <class Size = Whole>
inline RecordOf<Size> sumList( const float* records, const std::uint32_t* member, std::uint32_t count )
{
	RecordOf<Size> even = loadRecord<Size>( records + std::size_t( member[0] ) * Size::floats );
	if ( count == 1 )
	{
		return even;
	}
	RecordOf<Size> odd = loadRecord<Size>( records + std::size_t( member[1] ) * Size::floats );
	std::uint32_t k = 2;
	for ( ; k + 1 < count; k += 2 )
	{
		even = even + loadRecord<Size>( records + std::size_t( member[k] ) * Size::floats );
		odd = odd + loadRecord<Size>( records + std::size_t( member[k + 1] ) * Size::floats );
	}
	if ( k < count )
	{
		even = even + loadRecord<Size>( records + std::size_t( member[k] ) * Size::floats );
	}
	return even + odd;
}

/// The same with a weight per term. Integer masses, rounded once to float: the same on every processor.
template <class Size>
inline RecordOf<Size> sumWeighted( const float* records, const std::uint32_t* member, const std::uint32_t* weight, std::uint32_t count )
{
	RecordOf<Size> even = loadRecord<Size>( records + std::size_t( member[0] ) * Size::floats ) * float( weight[0] );
	if ( count == 1 )
	{
		return even;
	}
	RecordOf<Size> odd = loadRecord<Size>( records + std::size_t( member[1] ) * Size::floats ) * float( weight[1] );
	std::uint32_t k = 2;
	for ( ; k + 1 < count; k += 2 )
	{
		even = even + loadRecord<Size>( records + std::size_t( member[k] ) * Size::floats ) * float( weight[k] );
		odd = odd + loadRecord<Size>( records + std::size_t( member[k + 1] ) * Size::floats ) * float( weight[k + 1] );
	}
	if ( k < count )
	{
		even = even + loadRecord<Size>( records + std::size_t( member[k] ) * Size::floats ) * float( weight[k] );
	}
	return even + odd;
}

/// Sum of 2w + 1 plane sums through a lattice position along z, in ascending order.
template <class Size>
inline RecordOf<Size> sumColumn( const MatchView& view, const float* records, std::uint32_t slot )
{
	const std::size_t plane = std::size_t( view.gridX ) * std::size_t( view.gridY );
	const int z = int( slot / plane );
	const int low = z - view.halfWidth > 0 ? z - view.halfWidth : 0;
	const int high = z + view.halfWidth < view.gridZ - 1 ? z + view.halfWidth : view.gridZ - 1;
	const float* from = records + ( slot - std::size_t( z - low ) * plane ) * Size::floats;
	RecordOf<Size> sum = loadRecord<Size>( from );
	for ( int k = low + 1; k <= high; ++k )
	{
		from += plane * Size::floats;
		sum = sum + loadRecord<Size>( from );
	}
	return sum;
}

template <class Size>
inline RecordOf<Size> sumAround( const MatchView& view, const float* records, const std::uint32_t* weight, int i )
{
	if ( view.gridX > 0 )
	{
		return sumColumn<Size>( view, records, slotOf( view, i ) );
	}
	const std::uint32_t* member = view.member + view.start[i];
	const std::uint32_t count = view.start[i + 1] - view.start[i];
	if ( weight )
	{
		return sumWeighted<Size>( records, member, weight + view.start[i], count );
	}
	if ( !view.addOwner )
	{
		return sumList<Size>( records, member, count );
	}
	const RecordOf<Size> own = loadRecord<Size>( records + std::size_t( i ) * Size::floats );
	return count == 0 ? own : sumList<Size>( records, member, count ) + own;
}

/// `weight`: of each term of the table; may be null.
template <class Size = Whole>
void gatherTile( const MatchView& view, const float* records, const std::uint32_t* weight, int begin, int end, Tile& tile )
{
	for ( int first = begin; first < end; first += 4 )
	{
		RecordOf<Size> r[4];
		for ( int j = 0; j < 4; ++j )
		{
			if ( first + j < view.nodeCount )
			{
				r[j] = sumAround<Size>( view, records, weight, first + j );
				continue;
			}
			for ( typename Size::Piece& piece : r[j].piece )
			{
				piece = typename Size::Piece{};
			}
		}
		storeColumns<Size>( tile, r, first - begin );
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
