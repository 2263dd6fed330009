// In a build without clusters: the methods that need them are refused (material.cpp), and this is never reached.

#include "matching/clusters/cluster_matcher.h"

namespace pliant {

std::unique_ptr<Matcher> makeClusterMatcher( const Lattice&, const Material&, const NodeState& )
{
	return nullptr;
}

} // namespace pliant
