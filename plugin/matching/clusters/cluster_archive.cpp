#include "archive/archive.h"
#include "matching/clusters/cluster_matcher.h"

namespace pliant {

void ClusterMatcher::Cluster::archive( Archive& archive )
{
	archive( restCentre, size, inverseMass, moment, inverseMoment, rotation, linear, centre );
}

void ClusterMatcher::Quadratic::archive( Archive& archive )
{
	archive( mean, moment, inverseMoment, map );
}

// The clusters' members follow from the lattice; their weights are those of the nodes when the matcher was made.
void ClusterMatcher::archive( Archive& archive )
{
	archive( m_frame, m_centre, m_restCentre, m_mass );
	archive.sameLength( m_weight );
	archive.sameLength( m_residual );
	for ( Cluster& cluster : m_cluster )
	{
		archive( cluster );
	}
	for ( Quadratic& quadratic : m_quadratic )
	{
		archive( quadratic );
	}
}

} // namespace pliant
