// Far levels (matching/step/coarse_to_fine.h): sums of records over lists, and the displacements towards the levels' goals. Included by
// kernel_source.h only, inside its unnamed namespace (see lane.h).

#pragma once

/// Gathers the record of each node's block, as columns.
void gatherFar( const MatchView& view, int begin, int end, Tile& tile )
{
	for ( int first = begin; first < end; first += 4 )
	{
		Record r[4];
		for ( int j = 0; j < 4; ++j )
		{
			const int node = first + j < view.nodeCount ? first + j : view.nodeCount - 1;
			r[j] = loadRecord( view.farRecord + std::size_t( view.farBlock[node] ) * kRecordFloats );
		}
		storeColumns( tile, r, first - begin );
	}
}

/// Displacement of a node towards the far levels' goals: D q + t - P u. For a pinned node it has the factor by which the sums weigh the
/// node, so that action and reaction stay equal.
inline Vec farDisplacement( const MatchView& view, const Tile& tile, int i, int at, const Vec& q, const Vec& u )
{
	const V pull = load( view.farPull + i );
	const V pinnedFactor = kPinnedWeight - ( kPinnedWeight - 1.0f ) * load( view.freedom + i );
	const V move[3] = { u.x, u.y, u.z };
	V displacement[3];
	for ( int k = 0; k < 3; ++k )
	{
		displacement[k] = ( ( load( &tile.row[3 * k][at] ) * q.x + load( &tile.row[3 * k + 1][at] ) * q.y ) +
							  load( &tile.row[3 * k + 2][at] ) * q.z ) +
			( load( &tile.row[9 + k][at] ) - pull * move[k] );
		displacement[k] = pinnedFactor * displacement[k];
	}
	return { displacement[0], displacement[1], displacement[2] };
}

/// sumList with a weight per record.
inline Record sumScaled( const float* records, const float* weight, const std::uint32_t* member, std::uint32_t count )
{
	const auto term = [&]( std::uint32_t k ) {
		return loadRecord( records + std::size_t( member[k] ) * kRecordFloats ) * weight[member[k]];
	};
	Record even = term( 0 );
	if ( count == 1 )
	{
		return even;
	}
	Record odd = term( 1 );
	std::uint32_t k = 2;
	for ( ; k + 1 < count; k += 2 )
	{
		even = even + term( k );
		odd = odd + term( k + 1 );
	}
	return k < count ? ( even + term( k ) ) + odd : even + odd;
}

void sumRecords( const RecordSums& job, int begin, int end )
{
	for ( int i = begin; i < end; ++i )
	{
		const std::uint32_t* member = job.member + job.start[i];
		const std::uint32_t count = job.start[i + 1] - job.start[i];
		Record sum = job.weight ? sumScaled( job.from, job.weight, member, count ) : sumList( job.from, member, count );
		const std::size_t at = std::size_t( i ) * kRecordFloats;
		if ( job.sum )
		{
			storeRecord( job.sum + at, sum );
		}
		if ( job.scale )
		{
			sum = sum * ( job.factor * job.scale[i] );
		}
		storeRecord( job.to + at, job.base ? sum + loadRecord( job.base + std::size_t( job.baseOf[i] ) * kRecordFloats ) : sum );
	}
}
