#include "matching/regions/link_moments.h"

#include "matching/regions/region_tables.h"
#include "matching/stiffness.h"

#include <Eigen/Eigenvalues>

#include <algorithm>

namespace pliant {

namespace {

/// A link along an axis, from cell `from` in the positive direction.
struct AxisLink
{
	std::uint32_t to;
	int axis;
	double fraction; ///< m_ij / n_ij
};

/// Number of regions that hold both cells: the common members of their own regions, since membership is symmetric.
int regionsOfBoth( const RegionSet& regions, std::uint32_t i, std::uint32_t j )
{
	int count = 0;
	std::uint32_t b = regions.start[j];
	for ( std::uint32_t a = regions.start[i]; a < regions.start[i + 1]; ++a )
	{
		while ( b < regions.start[j + 1] && regions.member[b] < regions.member[a] )
		{
			++b;
		}
		count += b < regions.start[j + 1] && regions.member[b] == regions.member[a] ? 1 : 0;
	}
	return count;
}

struct AxisLinks
{
	std::vector<std::uint32_t> start; ///< of each cell
	std::vector<AxisLink> link;
};

AxisLinks axisLinks( const Lattice& lattice, const RegionSet& regions )
{
	AxisLinks links;
	links.start.push_back( 0 );
	for ( int i = 0; i < lattice.cellCount(); ++i )
	{
		for ( std::uint32_t k = lattice.linkStart[std::size_t( i )]; k < lattice.linkStart[std::size_t( i ) + 1]; ++k )
		{
			const std::uint32_t j = lattice.linkTo[k];
			const Eigen::Vector3i step = ( lattice.coordinate[j] - lattice.coordinate[std::size_t( i )] ).cast<int>();
			int axis = 0;
			if ( step.minCoeff( &axis ) == 0 && step.sum() == 1 )
			{
				step.maxCoeff( &axis );
				const double mass = 0.5 * ( double( lattice.fill[std::size_t( i )] ) + double( lattice.fill[j] ) );
				links.link.push_back( AxisLink{ j, axis, mass / regionsOfBoth( regions, std::uint32_t( i ), j ) } );
			}
		}
		links.start.push_back( std::uint32_t( links.link.size() ) );
	}
	return links;
}

Eigen::Matrix3d symmetric( const AlignedArray<float> ( &m )[6], int r )
{
	const auto at = [&]( int k ) { return double( m[k][std::size_t( r )] ); };
	Eigen::Matrix3d full;
	full << at( 0 ), at( 5 ), at( 4 ), at( 5 ), at( 1 ), at( 3 ), at( 4 ), at( 3 ), at( 2 );
	return full;
}

/// The largest ratio of J* to J over all directions, at least 1: a bound of the region's stiffness in the step's operator.
double largestFraction( const Eigen::Matrix3d& wanted, const Eigen::Matrix3d& inverse )
{
	const Eigen::Matrix3d root = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>( inverse ).operatorSqrt();
	return std::max( 1.0, Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>( root * wanted * root ).eigenvalues()[2] );
}

/// sum over the links in region r of fraction e e^T
Eigen::Vector3d linksOf( const AxisLinks& links, const RegionSet& regions, int r, std::vector<int>& lastRegion )
{
	const std::uint32_t begin = regions.start[std::size_t( r )], end = regions.start[std::size_t( r ) + 1];
	std::for_each( regions.member.begin() + begin, regions.member.begin() + end, [&]( std::uint32_t i ) { lastRegion[i] = r; } );
	Eigen::Vector3d sum = Eigen::Vector3d::Zero();
	for ( std::uint32_t k = begin; k < end; ++k )
	{
		const std::uint32_t i = regions.member[k];
		for ( std::uint32_t l = links.start[i]; l < links.start[i + 1]; ++l )
		{
			sum[links.link[l].axis] += lastRegion[links.link[l].to] == r ? links.link[l].fraction : 0.0;
		}
	}
	return sum;
}

} // namespace

bool usesLinkMoments( const Material& material )
{
	return material.elasticity != Elasticity::Explicit && material.method == Method::Lattice && material.weights == Weights::Conserving &&
		material.rotationFrom == RotationFrom::Apq && material.farLevels == 0 && material.regionHalfWidth > 1;
}

void applyLinkMoments( const Lattice& lattice, const Material& material, RegionTables& tables )
{
	const RegionMoments& moments = tables.moments;
	const AxisLinks links = axisLinks( lattice, tables.regions );
	const double mu = regionSecondMoment( material ), elasticFraction = 1.0 - double( material.beta );
	for ( int k = 0; k < 9; ++k )
	{
		tables.blend[k].assign( std::size_t( moments.padded ), k % 4 == 0 ? 1.0f : 0.0f );
	}
	tables.rateFraction.assign( std::size_t( moments.padded ), 1.0f );
	std::vector<int> lastRegion( std::size_t( moments.count ), -1 );
	for ( int r = 0; r < moments.count; ++r )
	{
		const Eigen::Matrix3d wanted = mu * linksOf( links, tables.regions, r, lastRegion ).asDiagonal().toDenseMatrix();
		const Eigen::Matrix3d inverse = symmetric( moments.inverseMoment, r ), c = elasticFraction * inverse * wanted;
		for ( int k = 0; k < 9; ++k )
		{
			tables.blend[k][std::size_t( r )] = float( c( k / 3, k % 3 ) );
		}
		const double weight = moments.regionWeight.empty() ? 1.0 : double( moments.regionWeight[std::size_t( r )] );
		tables.rateFraction[std::size_t( r )] = float( weight * largestFraction( wanted, inverse ) );
		tables.largestRateFraction = std::max( tables.largestRateFraction, tables.rateFraction[std::size_t( r )] );
	}
	tables.ratePull.assign( std::size_t( moments.padded ), 0.0f );
	for ( int i = 0; i < moments.count; ++i )
	{
		double sum = 0.0;
		for ( std::uint32_t k = tables.regions.start[std::size_t( i )]; k < tables.regions.start[std::size_t( i ) + 1]; ++k )
		{
			sum += double( tables.rateFraction[tables.regions.member[k]] );
		}
		tables.ratePull[std::size_t( i )] = float( sum * double( moments.inverseCover[std::size_t( i )] ) );
	}
}

} // namespace pliant
