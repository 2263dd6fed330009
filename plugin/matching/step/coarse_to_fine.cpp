#include "matching/step/coarse_to_fine.h"

#include "matching/constants.h"
#include "matching/step/settle_region.h"
#include "threads/parallel.h"

#include <algorithm>
#include <cstring>

namespace pliant {

namespace {

static_assert( kBlocksPerTask % kTile == 0 );

int blockChunks( int padded )
{
	return ( padded + kBlocksPerTask - 1 ) / kBlocksPerTask;
}

template <class F>
void runChunks( TaskRunner* runner, int count, F&& work )
{
	auto task = [&]( int chunk ) { work( chunk, chunk * kBlocksPerTask, std::min( count, ( chunk + 1 ) * kBlocksPerTask ) ); };
	runTasks( runner, blockChunks( count ), task );
}

} // namespace

void CoarseToFine::reset()
{
	for ( Level& level : m_levels )
	{
		for ( int k = 0; k < 4; ++k )
		{
			std::fill( level.quaternion[k].begin(), level.quaternion[k].end(), k == 0 ? 1.0f : 0.0f );
		}
	}
}

void CoarseToFine::match( MatchView& view, const FarFractions& fractions, const Kernels& kernels, TaskRunner* runner )
{
	// The game may pin and free nodes at any time; weights are measured again after a change.
	if ( std::memcmp( m_freedom.data(), view.freedom, m_block.size() * sizeof( float ) ) != 0 )
	{
		weighCells( view.freedom );
		m_fractions = {};
	}
	if ( fractions != m_fractions )
	{
		weighPulls( fractions );
	}
	int used = 0;
	while ( used < levels() && fractions[used] > 0.0f )
	{
		++used;
	}
	for ( int l = 0; l < used; ++l )
	{
		Level& level = m_levels[l];
		RecordSums up;
		up.from = l == 0 ? view.nodeRecord : m_levels[l - 1].sums.data();
		up.weight = l == 0 ? m_perRecord.data() : nullptr;
		up.start = level.childStart.data();
		up.member = l == 0 && !m_record.empty() ? m_record.data() : level.child.data();
		up.scale = level.inverseCover.data();
		up.sum = level.sums.data();
		up.to = level.blockRecord.data();
		runChunks( runner, level.count, [&]( int, int begin, int end ) { kernels.sumRecords( up, begin, end ); } );
		matchLevel( level, view, kernels, runner );
	}
	for ( int l = used; l-- > 0; )
	{
		Level& level = m_levels[l];
		RecordSums down;
		down.from = level.regionRecord.data();
		down.start = level.regionStart.data();
		down.member = level.region.data();
		down.scale = level.inverseCover.data();
		down.factor = fractions[l];
		down.base = l + 1 < used ? m_levels[l + 1].goal.data() : nullptr;
		down.baseOf = level.parent.data();
		down.to = level.goal.data();
		runChunks( runner, level.count, [&]( int, int begin, int end ) { kernels.sumRecords( down, begin, end ); } );
	}
	view.farRecord = m_levels[0].goal.data();
	view.farBlock = m_block.data();
	view.farPull = m_nodePull.data();
}

void CoarseToFine::matchLevel( Level& level, const MatchView& body, const Kernels& kernels, TaskRunner* runner )
{
	MatchView view;
	view.nodeCount = level.count;
	view.cellsPerMetre = body.cellsPerMetre;
	view.start = level.regionStart.data();
	view.member = level.region.data();
	view.inverseMass = level.inverseMass.data();
	view.regionWeight = level.weight.data();
	view.regionEta = level.eta.data();
	view.nodeRecord = level.blockRecord.data();
	view.regionRecord = level.regionRecord.data();
	for ( int k = 0; k < 3; ++k )
	{
		view.centre[k] = level.centre[k].data();
	}
	for ( int k = 0; k < 4; ++k )
	{
		view.quaternion[k] = level.quaternion[k].data();
	}
	for ( int k = 0; k < 6; ++k )
	{
		view.moment[k] = level.moment[k].data();
		view.inverseMoment[k] = level.inverseMoment[k].data();
		view.outOfPlane[k] = level.outOfPlane[k].empty() ? nullptr : level.outOfPlane[k].data();
	}
	runChunks( runner, level.padded,
		[&]( int chunk, int begin, int end ) { level.openCount[chunk] = kernels.fitRegions( view, begin, end, &level.open[begin] ); } );
	for ( int chunk = 0; chunk < int( level.openCount.size() ); ++chunk )
	{
		for ( int k = 0; k < level.openCount[chunk]; ++k )
		{
			settleRegion( kernels, view, int( level.open[chunk * kBlocksPerTask + k] ) );
		}
	}
}

} // namespace pliant
