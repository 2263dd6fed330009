// For builds without clusters: materials that need them are rejected (material.cpp), so this is never called.

#include "matching/clusters/cluster_matcher.h"

namespace pliant {

std::unique_ptr<Matcher> makeClusterMatcher( const Lattice&, const Material&, const NodeState& )
{
	return nullptr;
}

} // namespace pliant
