#pragma once

#include "body/body.h"

#include <vector>

namespace pliant::test {

/// Fraction of inverted cells, by the frames of the links along the axes, among those that can be tested; of a body on levels: of nodes
/// whose region is inverted.
inline float invertedFraction( const Body& body )
{
	const NodeState& nodes = body.nodes();
	const Lattice& lattice = body.lattice();
	int tested = 0, inverted = 0;
	if ( body.levels() )
	{
		std::vector<float> gradients( std::size_t( nodes.padded ) * 9 );
		body.nodeDeformations( gradients.data() );
		for ( int i = 0; i < nodes.count; ++i )
		{
			inverted += Eigen::Map<const Eigen::Matrix3f>( gradients.data() + 9 * std::size_t( i ) ).determinant() > 0.0f ? 0 : 1;
		}
		return float( inverted ) / float( nodes.count );
	}
	for ( int i = 0; i < nodes.count; ++i )
	{
		Eigen::Matrix3f now = Eigen::Matrix3f::Zero(), rest = Eigen::Matrix3f::Zero();
		for ( std::uint32_t k = lattice.linkStart[i]; k < lattice.linkStart[i + 1]; ++k )
		{
			const int j = int( lattice.linkTo[k] );
			const Eigen::Vector3i step = lattice.coordinate[j].cast<int>() - lattice.coordinate[i].cast<int>();
			if ( step.cwiseAbs().sum() != 1 )
			{
				continue;
			}
			const int axis = step.x() != 0 ? 0 : step.y() != 0 ? 1 : 2;
			now.col( axis ) += float( step.sum() ) * ( nodes.x.get( j ) - nodes.x.get( i ) );
			rest.col( axis ) += float( step.sum() ) * ( nodes.x0.get( j ) - nodes.x0.get( i ) );
		}
		if ( rest.determinant() > 0.0f )
		{
			++tested;
			inverted += now.determinant() > 0.0f ? 0 : 1;
		}
	}
	return tested == 0 ? 0.0f : float( inverted ) / float( tested );
}

} // namespace pliant::test
