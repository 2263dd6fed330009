#include "fracture/shards/shard_cracks.h"

#include "fracture/constants.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <queue>
#include <tuple>
#include <utility>

namespace pliant {

void ShardCracks::findOverloads( const Lattice& lattice, const LinkLimits& limits, const CellPositions& positions )
{
	m_overloads.clear();
	m_faces.update( lattice, limits, positions, double( m_law.breakStrain ) * double( limits.weakest ) );
	const LinkMoments& moments = m_faces.moments();
	auto thin = limits.thin.begin();
	const std::uint32_t cells = std::uint32_t( lattice.cellCount() );
	std::vector<std::uint8_t> isStretched( cells, 0 );
	const double strength = double( m_law.breakStrain );
	for ( std::uint32_t i = 0; i < cells; ++i )
	{
		for ( std::uint32_t k = limits.start[i]; moments.isNode( i ) && k < limits.start[i + 1]; ++k )
		{
			const std::uint32_t j = limits.to[k];
			if ( ( isStretched[i] & isStretched[j] ) == 0 && moments.isNode( j ) &&
				moments.distanceSquared( i, j ) > limits.lengthSquared[k] )
			{
				isStretched[i] = isStretched[j] = 1;
			}
		}
		// All links of i are tested here: those to lower cells in their rows.
		const bool isThin = thin != limits.thin.end() && thin->cell == i;
		const bool mayBreak = positions.mayBreak( i ) && ( isThin ? m_faces.mayBreak( *thin, isStretched[i] != 0 ) : isStretched[i] != 0 );
		thin += isThin ? 1 : 0;
		const Eigen::Matrix3d around = mayBreak ? m_faces.deformationOf( i, false ) : Eigen::Matrix3d::Identity();
		if ( !mayBreak || isStretchedLess( around, strength * double( limits.weakest ) ) )
		{
			continue;
		}
		const Stretch near = largestStretch( around );
		const double factor = strength * double( positions.strainFactor( i ) );
		const double nearExcess = near.strain / ( factor * toughnessAlong( lattice, limits, i, near.axis ) );
		if ( !( nearExcess > 1.0 ) )
		{
			continue;
		}
		// The measure over the neighbours as well: otherwise every step of a slanted surface would be a notch. A neck breaks in any case.
		const Stretch wide = largestStretch( m_faces.deformationOf( i, true ) );
		const double neck = nearExcess > double( kNeckFactor ) ? 1.0 + nearExcess - double( kNeckFactor ) : 0.0;
		const double excess = std::max( wide.strain / ( factor * toughnessAlong( lattice, limits, i, wide.axis ) ), neck );
		if ( excess > 1.0 )
		{
			m_overloads.push_back( ShardOverload{ i, float( excess ), wide.axis } );
		}
	}
}

void ShardCracks::noteOverload( const Lattice& lattice, const LinkLimits& limits, std::uint32_t cell, const Eigen::Matrix3d& deformation )
{
	const Stretch stretch = largestStretch( deformation );
	const double excess = stretch.strain / ( double( m_law.breakStrain ) * toughnessAlong( lattice, limits, cell, stretch.axis ) );
	if ( excess > 1.0 )
	{
		m_overloads.push_back( ShardOverload{ cell, float( excess ), stretch.axis } );
	}
}

bool ShardCracks::run(
	const Lattice& lattice, const LinkLimits& limits, const std::function<std::vector<Vec3d>()>& positions, std::vector<CellLink>& broken )
{
	if ( m_overloads.empty() )
	{
		return false;
	}
	std::sort( m_overloads.begin(), m_overloads.end(),
		[]( const ShardOverload& a, const ShardOverload& b ) { return std::tie( b.excess, a.cell ) < std::tie( a.excess, b.cell ); } );
	const bool isImpact = m_awaitsImpact;
	const std::uint32_t impact = m_overloads.front().cell;
	if ( isImpact )
	{
		divide( lattice, lattice.massCentre + lattice.restCentre[impact].cast<double>(), {} );
	}
	const std::vector<Vec3d> at = positions();
	ShardEvent event( lattice, limits, m_shard, at, m_law, m_faces );
	isImpact ? event.runAround( impact ) : void();
	for ( const ShardOverload& overload : m_overloads )
	{
		event.runFrom( overload );
	}
	std::vector<std::uint8_t> isCrumb;
	if ( !m_crumb.empty() && m_crumbMass > 0.0 )
	{
		isCrumb = event.crumble( m_crumb, m_overloads, m_crumbMass );
		for ( std::size_t cell = 0; cell < isCrumb.size(); ++cell )
		{
			m_shard[cell] = isCrumb[cell] != 0 ? m_crumb[cell] : m_shard[cell];
		}
		findOne();
	}
	event.openCorners( isCrumb );
	for ( std::uint32_t a = 0; a < std::uint32_t( lattice.cellCount() ); ++a )
	{
		for ( std::uint32_t k = limits.start[a]; k < limits.start[a + 1]; ++k )
		{
			const std::uint32_t b = limits.to[k];
			const bool isTough = !limits.toughness.empty() && std::isinf( limits.toughness[k] );
			const bool comesOff = !isCrumb.empty() && ( isCrumb[a] | isCrumb[b] ) != 0 && m_shard[a] != m_shard[b];
			if ( !isTough && ( comesOff || event.isOpen( k ) ) )
			{
				broken.push_back( CellLink{ a, b } );
			}
		}
	}
	return true;
}

} // namespace pliant
