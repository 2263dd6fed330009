#pragma once

// Distances from a node to all nodes closer than a limit. Steinemann et al. 2008, section 6.2: Moore's search with a bucket for each
// integer distance, since edges have different lengths.

#include "adapt/octree/visibility_graph.h"

namespace pliant {

/// Search with reusable scratch, which grows to the largest graph it has processed and then allocates no more. Use one per thread.
class BucketMoore
{
public:
	struct Reached
	{
		std::uint32_t node = 0;
		std::uint32_t distance = 0; ///< half cells
	};

	/// Returns all nodes closer to `source` than `limit`, by distance, each once, the source first. Valid until the next search.
	const std::vector<Reached>& from( const VisibilityGraph& graph, std::uint32_t source, std::uint32_t limit );

private:
	struct Tentative
	{
		std::uint32_t search = 0;   ///< the search that wrote this
		std::uint32_t shortest = 0; ///< d_min
		bool isMarked = false;
	};

	/// State of the search: distance k, its bucket, and the distance limit.
	struct Front
	{
		std::uint32_t k;
		std::size_t bucket;
		std::uint32_t limit;
	};

	void begin( const VisibilityGraph& graph );
	void insert( std::uint32_t node, std::uint32_t distance, std::size_t bucket );
	void run( const VisibilityGraph& graph, std::uint32_t limit );
	void visit( const VisibilityGraph& graph, std::uint32_t node, const Front& front );

	std::vector<Tentative> m_tentative;
	std::vector<std::vector<std::uint32_t>> m_buckets; ///< d_max + 1 in a ring: the first bucket index advances instead of shifting them
	std::vector<Reached> m_reached;
	std::uint32_t m_search = 0;
	std::size_t m_pending = 0; ///< entries in all buckets
};

} // namespace pliant
