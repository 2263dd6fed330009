#include "adapt/octree/bucket_moore.h"

#include <algorithm>

namespace pliant {

const std::vector<BucketMoore::Reached>& BucketMoore::from( const VisibilityGraph& graph, std::uint32_t source, std::uint32_t limit )
{
	begin( graph );
	if ( limit > 0 )
	{
		insert( source, 0, 0 );
		run( graph, limit );
	}
	return m_reached;
}

/// Step 1: nothing is marked, every d_min is infinite; k = 0.
void BucketMoore::begin( const VisibilityGraph& graph )
{
	if ( m_tentative.size() < std::size_t( graph.count() ) )
	{
		m_tentative.resize( std::size_t( graph.count() ) );
	}
	if ( m_buckets.size() < std::size_t( graph.longest ) + 1 )
	{
		m_buckets.resize( std::size_t( graph.longest ) + 1 );
	}
	if ( ++m_search == 0 ) // counter overflow: entries of old searches must not appear current
	{
		std::fill( m_tentative.begin(), m_tentative.end(), Tentative{} );
		m_search = 1;
	}
	m_reached.clear();
	m_pending = 0;
}

void BucketMoore::insert( std::uint32_t node, std::uint32_t distance, std::size_t bucket )
{
	m_tentative[node] = { m_search, distance, false };
	m_buckets[bucket].push_back( node );
	++m_pending;
}

/// Steps 2 to 4. Every entry is at most d_max ahead of k, so a ring of d_max + 1 buckets keeps distances apart.
void BucketMoore::run( const VisibilityGraph& graph, std::uint32_t limit )
{
	std::size_t front = 0;
	for ( std::uint32_t k = 0; k < limit && m_pending > 0; ++k )
	{
		// No edge has length 0, so the front bucket does not grow while it is processed.
		for ( const std::uint32_t node : m_buckets[front] )
		{
			visit( graph, node, { k, front, limit } );
		}
		m_pending -= m_buckets[front].size();
		m_buckets[front].clear();
		front = front + 1 == m_buckets.size() ? 0 : front + 1;
	}
}

void BucketMoore::visit( const VisibilityGraph& graph, std::uint32_t node, const Front& front )
{
	if ( m_tentative[node].isMarked ) // already reached on a shorter path
	{
		return;
	}
	m_tentative[node].isMarked = true;
	m_reached.push_back( { node, front.k } );
	const std::size_t ring = m_buckets.size();
	for ( std::uint32_t e = graph.start[node]; e < graph.start[node + 1]; ++e )
	{
		const std::uint32_t d = front.k + graph.length[e];
		if ( d >= front.limit ) // rows are ordered by length: all remaining edges are too long as well
		{
			return;
		}
		const std::uint32_t next = graph.to[e];
		if ( m_tentative[next].search != m_search || d < m_tentative[next].shortest )
		{
			const std::size_t ahead = front.bucket + graph.length[e];
			insert( next, d, ahead < ring ? ahead : ahead - ring );
		}
	}
}

} // namespace pliant
