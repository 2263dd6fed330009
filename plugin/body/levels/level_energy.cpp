// A change of levels adds no energy. Children of a split node are moved to positions consistent with their neighbours; energy that the
// change still adds, elastic or kinetic, becomes a debt that is removed from the nodes' internal motion. Beyond Steinemann et al. 2008,
// section 5.2.

#include "body/body.h"
#include "body/levels/level_nodes.h"
#include "body/levels/levels.h"
#include "matching/step/lattice_matcher.h"

#include <algorithm>
#include <numeric>

namespace pliant {

namespace {

/// The regions' energy and that of the whole body: K, and the nodes' deviation from its rigid fit, u = x - c - R x0.
LevelEnergy storedIn( const RegionWork& regions, const NodeState& nodes, const Eigen::Quaterniond& frame )
{
	const Eigen::Matrix3d rotation = frame.toRotationMatrix();
	Vec3d centre = Vec3d::Zero();
	double mass = 0.0;
	for ( int i = 0; i < nodes.count; ++i )
	{
		const double m = double( nodes.mass[i] );
		centre += m * ( nodes.x.get( i ).cast<double>() - rotation * nodes.x0.get( i ).cast<double>() );
		mass += m;
	}
	centre /= mass;
	LevelEnergy stored{ regions.springs, regions.power };
	for ( int i = 0; i < nodes.count; ++i )
	{
		const double m = double( nodes.mass[i] );
		const Vec3d u = nodes.x.get( i ).cast<double>() - centre - rotation * nodes.x0.get( i ).cast<double>(),
					v = nodes.v.get( i ).cast<double>();
		stored.motion += 0.5 * m * v.squaredNorm();
		stored.deviation += 0.5 * m * u.squaredNorm();
		stored.deviationPower -= m * u.dot( v );
	}
	return stored;
}

} // namespace

/// Previous regions that are not kept.
std::vector<std::uint32_t> Levels::removedRegions( const std::vector<std::uint32_t>& regionBefore, int countBefore ) const
{
	std::vector<std::uint8_t> isKept( std::size_t( countBefore ), 0 );
	for ( const std::uint32_t r : regionBefore )
	{
		if ( r != kNoNode )
		{
			isKept[r] = 1;
		}
	}
	std::vector<std::uint32_t> removed;
	for ( std::uint32_t r = 0; r < std::uint32_t( countBefore ); ++r )
	{
		if ( isKept[r] == 0 )
		{
			removed.push_back( r );
		}
	}
	return removed;
}

void Levels::findParts( const NodeState& nodes )
{
	m_parts.clear();
	const std::vector<std::uint32_t>& source = m_change.source;
	for ( std::size_t i = 0, end = 0; i < source.size(); i = end )
	{
		for ( end = i + 1; end < source.size() && source[end] == source[i]; ++end )
		{}
		for ( std::size_t k = i; k < end && end - i > 1 && nodes.freedom[i] != 0.0f; ++k )
		{
			m_parts.push_back( std::uint32_t( k ) );
		}
	}
}

// Where a body is bent, F differs from region to region, and children placed by their own parent's region are inconsistent with their
// neighbours. They move to the mean position predicted by all their regions, g = mean of c + F q,
//   x <- x + ( g - x ) - mean of g - x over the children of one parent,
// which keeps each parent's mass centre and all other nodes; uniform deformation stays unchanged.
void Levels::easeParts( NodeState& nodes, LatticeMatcher& matcher )
{
	findParts( nodes );
	m_partDisplacement.resize( 3 * m_parts.size() );
	const auto displacementOf = [this]( std::size_t k ) {
		return Vec3d( Eigen::Map<const Vec3>( m_partDisplacement.data() + 3 * k ).cast<double>() );
	};
	for ( int round = 0; round < kEasingRounds && !m_parts.empty(); ++round )
	{
		matcher.offsetsOf( nodes, m_parts, m_partDisplacement.data() );
		for ( std::size_t first = 0, end = 0; first < m_parts.size(); first = end )
		{
			Vec3d mean = Vec3d::Zero();
			double mass = 0.0;
			for ( end = first; end < m_parts.size() && m_change.source[m_parts[end]] == m_change.source[m_parts[first]]; ++end )
			{
				const double m = nodes.mass[m_parts[end]];
				mean += m * displacementOf( end );
				mass += m;
			}
			mean /= mass;
			for ( std::size_t k = first; k < end; ++k )
			{
				const int i = int( m_parts[k] );
				nodes.x.set( i, nodes.x.get( i ) + ( displacementOf( k ) - mean ).cast<float>() );
			}
		}
	}
}

/// With the new tables; m_scratch.nodes are the previous nodes. `before`: the work of the removed regions; null: not measured.
void Levels::settle( NodeState& nodes, LatticeMatcher& matcher, const RegionWork* before )
{
	if ( m_skippedRows.empty() )
	{
		easeParts( nodes, matcher );
	}
	restoreMomentum( nodes, m_scratch.nodes );
	m_change.energy = LevelEnergy{};
	if ( before )
	{
		const RegionWork now = matcher.workOf( nodes, m_change.measured );
		m_change.energy = storedIn( now, nodes, matcher.frame() ).plus( storedIn( *before, m_scratch.nodes, matcher.frame() ), -1.0 );
	}
}

void Body::addEnergyDebt( const LevelEnergy& added )
{
	m_energyDebt.added = m_energyDebt.added.plus( added );
	m_energyDebt.timeLeft = kEnergyRemovalTime;
}

// Implicit steps dissipate more energy in each step than a change adds; only explicit steps conserve all elastic energy.
LevelEnergy Body::storedEnergy()
{
	if ( !m_levels || m_wasImplicit )
	{
		return {};
	}
	std::vector<std::uint32_t> all( std::size_t( m_nodes.count ) );
	std::iota( all.begin(), all.end(), 0u );
	return storedIn( m_levelMatcher->workOf( m_nodes, all ), m_nodes, m_levelMatcher->frame() );
}

void Body::addEnergyDebtSince( const LevelEnergy& before )
{
	if ( m_levels && !m_wasImplicit )
	{
		addEnergyDebt( storedEnergy().plus( before, -1.0 ) );
	}
}

// The substep v <- v + h f / m, x <- x + h v does not conserve K + U, but H = K + U + h / 2 f.v, whose last term is as large as the others
// for alpha = 1. U = ( 1 - s ) alpha / h^2 times the regions' for 1, and s / h^2 times the body's, s the weight of its rigid fit in the
// goals.
double Body::joules( const LevelEnergy& stored, float h, float alpha ) const
{
	const double cell = double( m_lattice->cellSize ), fullCell = double( m_material.density ) * cell * cell * cell;
	const double seconds = double( h ), fraction = double( bodyFraction( h, alpha ) );
	const double regions = ( 1.0 - fraction ) * double( alpha ) * fullCell * ( stored.springs + 0.5 * seconds * stored.power );
	const double body = fraction * ( stored.deviation + 0.5 * seconds * stored.deviationPower );
	return ( regions + body ) / ( seconds * seconds ) + stored.motion;
}

void Body::reduceEnergyDebt( float h, float alpha )
{
	if ( !( m_energyDebt.timeLeft > 0.0f ) )
	{
		return;
	}
	// Energy removed by one change offsets energy added by others, but is not credited further.
	m_energyDebt.energy = std::max( 0.0, m_energyDebt.energy + joules( m_energyDebt.added, h, alpha ) );
	m_energyDebt.added = LevelEnergy{};
	m_energyDebt.energy -= m_energyDebt.energy > 0.0 ? removeInternalMotion( m_nodes, m_energyDebt.energy ) : 0.0;
	m_energyDebt.timeLeft -= h;
	if ( !( m_energyDebt.timeLeft > 0.0f ) || !( m_energyDebt.energy > 0.0 ) )
	{
		m_energyDebt = LevelDebt{};
	}
}

} // namespace pliant
