// The diagonal of the implicit step's operator. docs/design/implicit.md.

#include "matching/constants.h"
#include "matching/implicit/strain_rates.h"
#include "matching/regions/region_members.h"
#include "matching/step/lattice_matcher.h"
#include "matching/volume_law.h"

#include <Eigen/LU>

#include <algorithm>
#include <vector>

namespace pliant {

namespace {

/// Rest position of a node, m, and its weight in the sums.
struct WeightedNode
{
	double x, y, z, a;
};

/// Sums over a region's nodes of a, a p and a p p^T, p relative to the region's own node.
struct Sums
{
	double a = 0.0, x = 0.0, y = 0.0, z = 0.0, xx = 0.0, yy = 0.0, zz = 0.0, yz = 0.0, xz = 0.0, xy = 0.0;

	void add( double weight, double px, double py, double pz )
	{
		const double wx = weight * px, wy = weight * py, wz = weight * pz;
		a += weight;
		x += wx;
		y += wy;
		z += wz;
		xx += wx * px;
		yy += wy * py;
		zz += wz * pz;
		yz += wy * pz;
		xz += wx * pz;
		xy += wx * py;
	}
};

/// Rigid-body compliance of a region at rest.
struct Compliance
{
	double x = 0.0, y = 0.0, z = 0.0;                                  ///< its centre, m
	double mean = 0.0;                                                 ///< 3 / M
	double xx = 0.0, yy = 0.0, zz = 0.0, yz = 0.0, xz = 0.0, xy = 0.0; ///< tr( T^-1 ) 1 - T^-1, off-diagonal entries doubled

	Compliance() = default;
	Compliance( const Sums& s, const WeightedNode& own )
	{
		const Eigen::Vector3d c( s.x / s.a, s.y / s.a, s.z / s.a );
		x = own.x + c.x();
		y = own.y + c.y();
		z = own.z + c.z();
		mean = 3.0 / s.a;
		Eigen::Matrix3d second;
		second << s.xx, s.xy, s.xz, s.xy, s.yy, s.yz, s.xz, s.yz, s.zz;
		second -= s.a * c * c.transpose();
		if ( !( second.trace() > 0.0 ) )
		{
			return; // a single node cannot rotate the region
		}
		const Eigen::Matrix3d inertia = ( 1.0 + kLineInertia ) * second.trace() * Eigen::Matrix3d::Identity() - second,
							  inverse = inertia.inverse();
		xx = inverse( 1, 1 ) + inverse( 2, 2 );
		yy = inverse( 0, 0 ) + inverse( 2, 2 );
		zz = inverse( 0, 0 ) + inverse( 1, 1 );
		yz = -2.0 * inverse( 1, 2 );
		xz = -2.0 * inverse( 0, 2 );
		xy = -2.0 * inverse( 0, 1 );
	}

	/// The trace of 1 / M 1 + [d]^T T^-1 [d], d from the centre to the node: the node's response to unit impulses in three directions.
	double complianceAt( const WeightedNode& node ) const
	{
		const double dx = node.x - x, dy = node.y - y, dz = node.z - z;
		return mean + ( dx * ( xx * dx + xy * dy + xz * dz ) + dy * ( yy * dy + yz * dz ) + zz * dz * dz );
	}
};

/// Resistance of a region at rest to changes of its volume: B J^+ and b of volumeMatrix, in cells.
struct VolumeResistance
{
	Eigen::Matrix3d gradient = Eigen::Matrix3d::Zero();
	double mean = 0.0;

	VolumeResistance( const RegionTables& tables, int r )
	{
		const Eigen::Matrix3d inverse = loadSymmetric( tables.moments.inverseMoment, r );
		const double extents = 3.0 - ( tables.outOfPlane[0].empty() ? 0.0 : loadSymmetric( tables.outOfPlane, r ).trace() );
		mean = volumeMean( inverse, extents );
		gradient = volumeWeights( loadSymmetric( tables.moments.moment, r ), mean, extents ) * inverse;
	}

	/// The trace of b ( B J^+ d )( B J^+ d )^T, d from the centre to the node, cells.
	double at( const Eigen::Vector3d& d ) const { return mean * ( gradient * d ).squaredNorm(); }
};

} // namespace

// The diagonal block of P at node i is sum over its regions of g_r a_i / C_i ( 1 / M_r 1 + [d]^T T_r^-1 [d] ), d from the region's centre
// to the node; that of V, g_r a_i / C_i b ( B J^+ d )( B J^+ d )^T. Their traces do not depend on the body's rotation: they are measured at
// rest, once per region tables.
void StrainRates::measureDiagonal( const RegionTables& tables )
{
	const RegionMembers members( tables, m_view );
	std::vector<WeightedNode> node( std::size_t( m_view.nodeCount ) );
	for ( std::size_t i = 0; i < node.size(); ++i )
	{
		node[i] = { double( m_view.x0[0][i] ), double( m_view.x0[1][i] ), double( m_view.x0[2][i] ), double( m_view.nodeWeight[i] ) };
	}
	// With a sum plan a node contributes its full weight to each of its regions.
	const bool isWeighed = tables.matrix && !tables.plan;
	std::vector<Compliance> region( node.size() );
	for ( std::size_t r = 0; r < region.size(); ++r )
	{
		const WeightedNode own = node[r];
		Sums sums;
		members.visit( r, [&]( std::size_t i, std::size_t k ) {
			const WeightedNode& other = node[i];
			sums.add( isWeighed ? other.a * double( tables.matrix->mass[k] ) : other.a, other.x - own.x, other.y - own.y, other.z - own.z );
		} );
		region[r] = Compliance( sums, own );
	}
	std::vector<VolumeResistance> volume;
	const double kappa = double( m_view.volumeFraction ), perMetre = double( m_view.cellsPerMetre );
	for ( std::size_t r = 0; kappa > 0.0 && r < node.size(); ++r )
	{
		volume.emplace_back( tables, int( r ) );
	}
	m_diagonal.assign( std::size_t( m_padded ), 0.0f );
	for ( std::size_t i = 0; i < node.size(); ++i )
	{
		const WeightedNode own = node[i];
		double sum = 0.0;
		members.visit( i, [&]( std::size_t r, std::size_t k ) {
			const double fraction = m_rates.regionFraction ? double( m_rates.regionFraction[r] ) : 1.0;
			// With conserving weights a node's weight in the region's sums equals the region's weight in the node's goal.
			const double weight = isWeighed ? double( tables.matrix->fraction[k] ) : 1.0;
			sum += weight * fraction * std::max( 0.0, 1.0 - weight * own.a * region[r].complianceAt( own ) / 3.0 );
			if ( kappa > 0.0 )
			{
				const Eigen::Vector3d arm( own.x - region[r].x, own.y - region[r].y, own.z - region[r].z );
				const double share = 1.0 - double( m_view.regionBeta ? m_view.regionBeta[r] : m_view.beta );
				const double b = m_view.regionWeight ? double( m_view.regionWeight[r] ) : 1.0;
				sum += weight * b * share * kappa * weight * own.a * volume[r].at( arm * perMetre ) / 3.0;
			}
		} );
		m_diagonal[i] = float( sum * double( m_view.inverseCover[i] ) );
	}
}

} // namespace pliant
