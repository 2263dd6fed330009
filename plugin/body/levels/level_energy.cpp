// A change of levels brings no energy. What parts of a split node would hold at odds with those beside them is let go at once; what is more
// than before then, in springs and in motion, the body owes, and it is taken out of how its nodes move against one another. Beyond
// Steinemann et al. 2008, section 5.2.

#include "body/body.h"
#include "body/levels/level_nodes.h"
#include "body/levels/levels.h"
#include "matching/step/lattice_matcher.h"

#include <algorithm>
#include <numeric>

namespace pliant {

namespace {

/// What the regions do, and what is the whole body's: K, and how far nodes stray from its rigid fit, u = x - c - R x0.
LevelEnergy heldBy( const RegionWork& regions, const NodeState& nodes, const Eigen::Quaterniond& frame )
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
	LevelEnergy held{ regions.springs, regions.power };
	for ( int i = 0; i < nodes.count; ++i )
	{
		const double m = double( nodes.mass[i] );
		const Vec3d u = nodes.x.get( i ).cast<double>() - centre - rotation * nodes.x0.get( i ).cast<double>(),
					v = nodes.v.get( i ).cast<double>();
		held.motion += 0.5 * m * v.squaredNorm();
		held.stray += 0.5 * m * u.squaredNorm();
		held.strayPower -= m * u.dot( v );
	}
	return held;
}

} // namespace

/// The regions before that none is the same as.
std::vector<std::uint32_t> Levels::regionsGone( const std::vector<std::uint32_t>& regionBefore, int countBefore ) const
{
	std::vector<std::uint8_t> isKept( std::size_t( countBefore ), 0 );
	for ( const std::uint32_t r : regionBefore )
	{
		if ( r != kNoNode )
		{
			isKept[r] = 1;
		}
	}
	std::vector<std::uint32_t> gone;
	for ( std::uint32_t r = 0; r < std::uint32_t( countBefore ); ++r )
	{
		if ( isKept[r] == 0 )
		{
			gone.push_back( r );
		}
	}
	return gone;
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

// Where a body is bent, F differs from region to region, and parts that stand where their own parent's has carried them stand at odds with
// those beside. They go to where all regions that they are in now have them, g = mean of c + F q,
//   x <- x + ( g - x ) - mean of g - x over the parts of one parent,
// so that each parent's mass centre stays, and all other nodes; what is stretched alike everywhere stays as it is.
void Levels::easeParts( NodeState& nodes, LatticeMatcher& matcher )
{
	findParts( nodes );
	m_partDisplacement.resize( 3 * m_parts.size() );
	const auto way = [this](
						 std::size_t k ) { return Vec3d( Eigen::Map<const Vec3>( m_partDisplacement.data() + 3 * k ).cast<double>() ); };
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
				mean += m * way( end );
				mass += m;
			}
			mean /= mass;
			for ( std::size_t k = first; k < end; ++k )
			{
				const int i = int( m_parts[k] );
				nodes.x.set( i, nodes.x.get( i ) + ( way( k ) - mean ).cast<float>() );
			}
		}
	}
}

/// With the new tables; m_room.nodes are those before. `before`: what the regions did that are gone; null: it is not measured.
void Levels::settle( NodeState& nodes, LatticeMatcher& matcher, const RegionWork* before )
{
	if ( m_left.empty() )
	{
		easeParts( nodes, matcher );
	}
	restoreMotion( nodes, m_scratch.nodes );
	m_change.energy = LevelEnergy{};
	if ( before )
	{
		const RegionWork now = matcher.workOf( nodes, m_change.measured );
		m_change.energy = heldBy( now, nodes, matcher.frame() ).plus( heldBy( *before, m_scratch.nodes, matcher.frame() ), -1.0 );
	}
}

void Body::owe( const LevelEnergy& brought )
{
	m_owed.brought = m_owed.brought.plus( brought );
	m_owed.left = kEnergyRemovalTime;
}

// What steps implicitly loses more in each step than a change brings; only explicit steps give back all that springs hold.
LevelEnergy Body::heldEnergy()
{
	if ( !m_levels || m_wasImplicit )
	{
		return {};
	}
	std::vector<std::uint32_t> all( std::size_t( m_nodes.count ) );
	std::iota( all.begin(), all.end(), 0u );
	return heldBy( m_levelMatcher->workOf( m_nodes, all ), m_nodes, m_levelMatcher->frame() );
}

void Body::oweSince( const LevelEnergy& before )
{
	if ( m_levels && !m_wasImplicit )
	{
		owe( heldEnergy().plus( before, -1.0 ) );
	}
}

// What the substep v <- v + h f / m, x <- x + h v keeps is not K + U, but  H = K + U + h / 2 f.v,  and the last is as large as they are
// where alpha is 1. U = ( 1 - s ) alpha / h^2 times the regions' for 1, and s / h^2 times the body's, s the share of its rigid fit in the
// goals.
double Body::joules( const LevelEnergy& held, float h, float alpha ) const
{
	const double cell = double( m_lattice->cellSize ), fullCell = double( m_material.density ) * cell * cell * cell;
	const double seconds = double( h ), fraction = double( bodyFraction( h, alpha ) );
	const double regions = ( 1.0 - fraction ) * double( alpha ) * fullCell * ( held.springs + 0.5 * seconds * held.power );
	const double body = fraction * ( held.stray + 0.5 * seconds * held.strayPower );
	return ( regions + body ) / ( seconds * seconds ) + held.motion;
}

void Body::payForLevels( float h, float alpha )
{
	if ( !( m_owed.left > 0.0f ) )
	{
		return;
	}
	// What a change has taken away pays for what others have brought, and no more.
	m_owed.energy = std::max( 0.0, m_owed.energy + joules( m_owed.brought, h, alpha ) );
	m_owed.brought = LevelEnergy{};
	m_owed.energy -= m_owed.energy > 0.0 ? takeOwnMotion( m_nodes, m_owed.energy ) : 0.0;
	m_owed.left -= h;
	if ( !( m_owed.left > 0.0f ) || !( m_owed.energy > 0.0 ) )
	{
		m_owed = LevelDebt{};
	}
}

} // namespace pliant
