#pragma once

// The nodes of each cluster: all of them, or boxes that overlap by half, split where the material is cut. Müller et al. 2005, section 4.4.

#include "lattice/lattice.h"

#include <cstdint>
#include <vector>

namespace pliant {

/// Both directions as compressed rows, ascending: nodes of a cluster, clusters of a node. Every node is in at least one cluster.
struct ClusterSet
{
	std::vector<std::uint32_t> start;
	std::vector<std::uint32_t> member; ///< nodes of cluster r: member[ start[r] .. start[r + 1] )
	std::vector<std::uint32_t> coverStart;
	std::vector<std::uint32_t> cover; ///< clusters of node i: cover[ coverStart[i] .. coverStart[i + 1] )

	int count() const { return int( start.size() ) - 1; }
	int coverCount( int node ) const { return int( coverStart[node + 1] - coverStart[node] ); }
};

/// One cluster of all nodes, linked or not.
ClusterSet makeWholeCluster( const Lattice& lattice );

/// Boxes of `edge` cells along an edge, each offset from the next by half an edge, so that two linked cells always share a box. Cells that
/// are not linked within their box form separate clusters.
ClusterSet makeBoxClusters( const Lattice& lattice, int edge );

} // namespace pliant
