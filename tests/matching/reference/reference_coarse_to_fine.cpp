#include "matching/reference/reference_coarse_to_fine.h"

#include "matching/regions/region_moments.h"
#include "matching/rotation.h"

#include <set>

namespace pliant {

namespace {

struct Fit
{
	Vec3d centre = Vec3d::Zero(), restCentre = Vec3d::Zero(); ///< m
	Eigen::Matrix3d turn = Eigen::Matrix3d::Identity(), gradient = Eigen::Matrix3d::Identity();
};

/// c = sum w x / M,   A_pq = sum w ( x - c ) q^T,   F = A_pq J^+, and R where the region has no extent.
Fit fitRegion( const Lattice& lattice, const NodeState& nodes, const std::vector<double>& weight )
{
	Fit fit;
	double mass = 0.0;
	for ( int i = 0; i < nodes.count; ++i )
	{
		mass += weight[i];
		fit.centre += weight[i] * nodes.x.get( i ).cast<double>();
		fit.restCentre += weight[i] * lattice.restCentre[i].cast<double>();
	}
	fit.centre /= mass;
	fit.restCentre /= mass;
	Eigen::Matrix3d mixed = Eigen::Matrix3d::Zero(), rest = Eigen::Matrix3d::Zero();
	for ( int i = 0; i < nodes.count; ++i )
	{
		const Vec3d q = lattice.restCentre[i].cast<double>() - fit.restCentre;
		mixed += weight[i] * ( nodes.x.get( i ).cast<double>() - fit.centre ) * q.transpose();
		rest += weight[i] * q * q.transpose();
	}
	fit.turn = fitRotation( Eigen::Matrix3d( mixed / ( rest.trace() > 0.0 ? rest.trace() : 1.0 ) ), Eigen::Quaterniond::Identity() )
				   .toRotationMatrix();
	Eigen::Matrix3d outside;
	const Eigen::Matrix3d inverse = inverseInPlane( rest, kMomentFloor, outside );
	fit.gradient = mixed * inverse + fit.turn * outside;
	return fit;
}

} // namespace

std::vector<Vec3d> referenceFarDisplacement( const Lattice& lattice, const NodeState& nodes, const CoarseToFine& far, int level )
{
	const Octree octree = buildOctree( lattice, far.levels() );
	std::vector<std::uint32_t> block( nodes.count );
	const std::uint32_t first = octree.levelStart[level], count = octree.levelStart[level + 1] - first;
	std::vector<std::set<std::uint32_t>> region( count );
	for ( int i = 0; i < nodes.count; ++i )
	{
		std::uint32_t node = std::uint32_t( i );
		while ( node < first )
		{
			node = octree.parent[node];
		}
		block[i] = node - first;
		region[block[i]].insert( block[i] );
	}
	for ( int i = 0; i < nodes.count; ++i )
	{
		for ( std::uint32_t k = lattice.linkStart[i]; k < lattice.linkStart[i + 1]; ++k )
		{
			region[block[i]].insert( block[lattice.linkTo[k]] );
		}
	}
	std::vector<Vec3d> displacement( nodes.count, Vec3d::Zero() );
	std::vector<double> weight( nodes.count );
	for ( std::uint32_t r = 0; r < count; ++r )
	{
		for ( int i = 0; i < nodes.count; ++i )
		{
			const double pinnedFactor = nodes.freedom[i] == 0.0f ? double( kPinnedWeight ) : 1.0;
			weight[i] = region[r].count( block[i] ) ? pinnedFactor * lattice.fill[i] / double( region[block[i]].size() ) : 0.0;
		}
		const Fit fit = fitRegion( lattice, nodes, weight );
		for ( int i = 0; i < nodes.count; ++i )
		{
			if ( weight[i] > 0.0 )
			{
				// goal = c + R q + eta ( x - c - F q )
				const Vec3d q = lattice.restCentre[i].cast<double>() - fit.restCentre, x = nodes.x.get( i ).cast<double>();
				const Vec3d goal = fit.centre + fit.turn * q + far.eta( level, int( r ) ) * ( x - fit.centre - fit.gradient * q );
				displacement[i] += far.pull( level, int( r ) ) / double( region[block[i]].size() ) * ( goal - x );
			}
		}
	}
	return displacement;
}

} // namespace pliant
