#include "fracture/shards/shard_event.h"

#include "fracture/constants.h"
#include "fracture/stretch.h"
#include "lattice/axis_neighbours.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <queue>
#include <utility>

namespace pliant {

ShardEvent::ShardEvent( const Lattice& lattice, const LinkLimits& limits, const std::vector<std::uint32_t>& shards,
	const std::vector<Vec3d>& positions, const ShardLaw& law, FaceStretch& faces ) :
	m_lattice( lattice ),
	m_limits( limits ), m_at( positions ), m_law( law ), m_faces( faces )
{
	numberShards( shards );
	measureEnergy();
	findBorders();
}

double ShardEvent::costOf( const Border& border ) const
{
	return m_law.toughness * border.toughness * border.toughness * border.across.norm();
}

void ShardEvent::numberShards( const std::vector<std::uint32_t>& number )
{
	std::vector<std::uint32_t> local( std::size_t( *std::max_element( number.begin(), number.end() ) ) + 1, kNone );
	std::vector<double> mass;
	for ( std::size_t cell = 0; cell < number.size(); ++cell )
	{
		std::uint32_t& own = local[number[cell]];
		if ( own == kNone )
		{
			own = std::uint32_t( m_centre.size() );
			m_centre.push_back( Vec3d::Zero() );
			mass.push_back( 0.0 );
		}
		m_shard.push_back( own );
		m_centre[own] += double( m_lattice.fill[cell] ) * rest( std::uint32_t( cell ) );
		mass[own] += double( m_lattice.fill[cell] );
	}
	for ( std::size_t s = 0; s < m_centre.size(); ++s )
	{
		m_centre[s] /= mass[s];
	}
}

void ShardEvent::measureEnergy()
{
	const std::size_t cells = m_shard.size();
	m_cellEnergy.assign( cells, 0.0 );
	for ( std::uint32_t a = 0; a < std::uint32_t( cells ); ++a )
	{
		for ( std::uint32_t k = m_limits.start[a]; k < m_limits.start[a + 1]; ++k )
		{
			const std::uint32_t b = m_limits.to[k];
			const double strain = std::sqrt( ( m_at[b] - m_at[a] ).squaredNorm() / ( rest( b ) - rest( a ) ).squaredNorm() ) - 1.0;
			m_cellEnergy[a] += strain * strain;
			m_cellEnergy[b] += strain * strain;
		}
	}
	m_energy.assign( m_centre.size(), 0.0 );
	const double d = double( m_lattice.cellSize ), most = 0.5 * kLinkEnergyFactor * m_law.youngsModulus * d * d * d;
	for ( std::size_t cell = 0; cell < cells; ++cell )
	{
		const double links = double( m_lattice.linkStart[cell + 1] - m_lattice.linkStart[cell] );
		m_cellEnergy[cell] *= links > 0.0 ? most * double( m_lattice.fill[cell] ) / links : 0.0;
	}
	for ( const ThinCell& thin : m_faces.thin() )
	{
		m_cellEnergy[thin.cell] += 0.5 * m_law.youngsModulus * d * d * d * double( m_lattice.fill[thin.cell] ) *
			m_faces.hiddenSquare( thin );
	}
	for ( std::size_t cell = 0; cell < cells; ++cell )
	{
		m_energy[m_shard[cell]] += m_cellEnergy[cell];
	}
	m_left = m_energy;
}

std::uint32_t ShardEvent::borderBetween( std::uint32_t a, std::uint32_t b )
{
	for ( const std::uint32_t border : m_bordersOf[a] )
	{
		if ( m_borders[border].shard[0] == b || m_borders[border].shard[1] == b )
		{
			return border;
		}
	}
	const std::uint32_t border = std::uint32_t( m_borders.size() );
	m_borders.emplace_back();
	m_borders.back().shard[0] = std::min( a, b );
	m_borders.back().shard[1] = std::max( a, b );
	m_bordersOf[a].push_back( border );
	m_bordersOf[b].push_back( border );
	return border;
}

void ShardEvent::findBorders()
{
	m_bordersOf.resize( m_centre.size() );
	m_borderOfLink.assign( m_limits.to.size(), kNone );
	for ( std::uint32_t a = 0; a < std::uint32_t( m_shard.size() ); ++a )
	{
		for ( std::uint32_t k = m_limits.start[a]; k < m_limits.start[a + 1]; ++k )
		{
			const std::uint32_t b = m_limits.to[k];
			if ( m_shard[a] != m_shard[b] )
			{
				m_borderOfLink[k] = borderBetween( m_shard[a], m_shard[b] );
				addLink( m_borders[m_borderOfLink[k]], a, b, m_limits.toughness.empty() ? 1.0 : double( m_limits.toughness[k] ) );
			}
		}
	}
	for ( Border& border : m_borders )
	{
		border.deformation = border.now * inverseOfRest( border.rest );
		border.toughness /= std::max( 1, border.links );
	}
}

// Few borders are asked for it.
void ShardEvent::measureBending( Border& border )
{
	const double count = double( border.thin.size() );
	for ( const ThinCell* const thin : border.thin )
	{
		for ( int k = 0; k < thin->normals && m_faces.isBent( *thin ); ++k )
		{
			const double side = border.thin.front()->normal[k].dot( thin->normal[k] ) < 0.0f ? -1.0 : 1.0;
			border.bending[k] += side / count * m_faces.bendingOf( *thin, k );
		}
	}
	border.thin.clear();
}

void ShardEvent::addLink( Border& border, std::uint32_t a, std::uint32_t b, double toughness )
{
	const Vec3d q = rest( b ) - rest( a ), p = m_at[b] - m_at[a];
	border.now += p * q.transpose();
	border.rest += q * q.transpose();
	for ( const std::uint32_t end : { a, b } )
	{
		const ThinCell* const thin = m_faces.moments().isNode( end ) ? m_faces.thinCellOf( end ) : nullptr;
		thin ? border.thin.push_back( thin ) : void();
	}
	if ( shareFace( m_lattice, a, b ) )
	{
		const auto steps = m_lattice.coordinate[b].cast<int>() - m_lattice.coordinate[a].cast<int>();
		const double d = double( m_lattice.cellSize ), fill = 0.5 * double( m_lattice.fill[a] + m_lattice.fill[b] );
		border.hasArea = true;
		border.across += ( m_shard[a] == border.shard[0] ? d * d * fill : -d * d * fill ) * steps.cast<double>();
	}
	if ( std::isfinite( toughness ) )
	{
		border.middle = ( border.links * border.middle + 0.5 * ( rest( a ) + rest( b ) ) ) / ( border.links + 1.0 );
		border.toughness += toughness;
		++border.links;
	}
}

double ShardEvent::pullOn( Border& border, const Vec3d& normal )
{
	measureBending( border );
	const double stretch = ( border.deformation * normal ).norm() - 1.0 + std::fabs( normal.dot( border.bending[0] * normal ) ) +
		std::fabs( normal.dot( border.bending[1] * normal ) );
	return stretch / ( double( m_law.breakStrain ) * border.toughness );
}

bool ShardEvent::opens( Border& border, const Vec3d& normal )
{
	return border.links > 0 && !border.isBroken && m_left[border.shard[0]] + m_left[border.shard[1]] > costOf( border ) &&
		pullOn( border, normal ) > kOpensAt;
}

void ShardEvent::open( Border& border )
{
	border.isBroken = true;
	double &a = m_left[border.shard[0]], &b = m_left[border.shard[1]];
	const double kept = std::max( 0.0, 1.0 - costOf( border ) / ( a + b ) ); // a + b > 0: it opens
	a *= kept;
	b *= kept;
}

bool ShardEvent::isShielded( const ShardOverload& overload ) const
{
	const Vec3d position = rest( overload.cell );
	const double excess = double( overload.excess );
	return std::any_of( m_cracks.begin(), m_cracks.end(), [&]( const Crack& crack ) {
		const double away = ( position - position.cwiseMax( crack.low ).cwiseMin( crack.high ) ).norm();
		return std::fabs( crack.normal.dot( overload.normal ) ) > kSameCrackCosine &&
			away * excess * excess < m_law.size + 0.5 * ( crack.high - crack.low ).norm();
	} );
}

std::uint32_t ShardEvent::startOf( const ShardOverload& overload )
{
	std::uint32_t best = kNone;
	double most = 0.0;
	for ( const std::uint32_t b : m_bordersOf[m_shard[overload.cell]] )
	{
		Border& border = m_borders[b];
		const double area = border.across.norm(), cosine = std::fabs( border.across.dot( overload.normal ) ) / std::max( area, 1e-300 );
		if ( cosine > kStartCosine && opens( border, overload.normal ) )
		{
			const double away = ( border.middle - rest( overload.cell ) ).norm();
			const double score = pullOn( border, overload.normal ) * cosine * cosine / ( 1.0 + away / m_law.size );
			best = score > most ? b : best;
			most = std::max( most, score );
		}
	}
	return best;
}

// Borders between shards above and below the plane through the first border open, the most stretched first, each next to one that is open
// by a shard.
void ShardEvent::runFrom( const ShardOverload& overload )
{
	const std::uint32_t start = isShielded( overload ) ? kNone : startOf( overload );
	if ( start == kNone )
	{
		return;
	}
	const Vec3d normal = overload.normal;
	Crack crack{ m_borders[start].middle, normal, m_borders[start].middle, m_borders[start].middle };
	const unsigned visit = unsigned( m_cracks.size() ) + 1;
	std::priority_queue<std::pair<double, std::uint32_t>> front;
	front.emplace( pullOn( m_borders[start], normal ), ~start );
	m_borders[start].visit = visit;
	while ( !front.empty() )
	{
		const std::uint32_t b = ~front.top().second;
		front.pop();
		Border& border = m_borders[b];
		if ( !opens( border, normal ) )
		{
			continue; // its shards' energy has been used
		}
		open( border );
		crack.low = crack.low.cwiseMin( border.middle );
		crack.high = crack.high.cwiseMax( border.middle );
		for ( const std::uint32_t side : border.shard )
		{
			for ( const std::uint32_t next : m_bordersOf[side] )
			{
				if ( m_borders[next].visit != visit && isCrossed( m_borders[next], crack ) )
				{
					m_borders[next].visit = visit;
					front.emplace( pullOn( m_borders[next], normal ), ~next );
				}
			}
		}
	}
	m_cracks.push_back( crack );
}

void ShardEvent::runAround( std::uint32_t impact )
{
	std::vector<std::pair<double, std::uint32_t>> order;
	for ( std::uint32_t b = 0; b < std::uint32_t( m_borders.size() ); ++b )
	{
		const Vec3d away = m_borders[b].middle - rest( impact );
		const bool isSpoke = std::fabs( m_borders[b].across.dot( away ) ) < kSpokeCosine * m_borders[b].across.norm() * away.norm();
		order.emplace_back( ( isSpoke ? 0.5 : 1.0 ) * away.norm(), b );
	}
	std::sort( order.begin(), order.end() );
	double whole = 0.0;
	for ( const double energy : m_left )
	{
		whole += energy;
	}
	double left = whole;
	for ( const auto& [distance, b] : order )
	{
		const double cost = costOf( m_borders[b] );
		if ( cost > left )
		{
			break;
		}
		m_borders[b].isBroken = m_borders[b].links > 0;
		left -= cost;
	}
	for ( double& energy : m_left )
	{
		energy *= whole > 0.0 ? left / whole : 0.0;
	}
}

bool ShardEvent::isCrossed( const Border& border, const Crack& crack ) const
{
	const double a = crack.normal.dot( m_centre[border.shard[0]] - crack.point );
	const double b = crack.normal.dot( m_centre[border.shard[1]] - crack.point );
	return ( a < 0.0 ) != ( b < 0.0 );
}

std::vector<std::uint8_t> ShardEvent::crumble(
	const std::vector<std::uint32_t>& crumb, const std::vector<ShardOverload>& overloads, double& mass ) const
{
	struct Candidate
	{
		double energy = 0.0, mass = 0.0, faces = 0.0;
		bool isOverloaded = false;
	};
	const auto [low, high] = std::minmax_element( crumb.begin(), crumb.end() );
	const std::uint32_t first = *low;
	std::vector<Candidate> all( std::size_t( *high - first ) + 1 );
	for ( std::uint32_t a = 0; a < std::uint32_t( crumb.size() ); ++a )
	{
		Candidate& own = all[crumb[a] - first];
		own.energy += m_energy[m_shard[a]] > 0.0 ? m_cellEnergy[a] * m_left[m_shard[a]] / m_energy[m_shard[a]] : 0.0;
		own.mass += double( m_lattice.fill[a] );
		for ( std::uint32_t k = m_lattice.linkStart[a]; k < m_lattice.linkStart[a + 1]; ++k )
		{
			const std::uint32_t b = m_lattice.linkTo[k];
			own.faces += crumb[b] != crumb[a] && shareFace( m_lattice, a, b ) ? 0.5 * double( m_lattice.fill[a] + m_lattice.fill[b] ) : 0.0;
		}
	}
	for ( const ShardOverload& overload : overloads )
	{
		all[crumb[overload.cell] - first].isOverloaded = true;
	}
	std::vector<std::pair<double, std::uint32_t>> order; // densest energy first
	const double face = double( m_lattice.cellSize ) * double( m_lattice.cellSize ) / kStairs;
	for ( std::uint32_t c = 0; c < std::uint32_t( all.size() ); ++c )
	{
		if ( all[c].isOverloaded && all[c].faces > 0.0 && all[c].energy > m_law.toughness * face * all[c].faces )
		{
			order.emplace_back( -all[c].energy / all[c].mass, c );
		}
	}
	std::sort( order.begin(), order.end() );
	std::vector<std::uint8_t> isChosen( all.size(), 0 );
	for ( const auto& [density, c] : order )
	{
		isChosen[c] = all[c].mass <= mass ? 1 : 0;
		mass -= isChosen[c] != 0 ? all[c].mass : 0.0;
	}
	std::vector<std::uint8_t> isCrumb( crumb.size(), 0 );
	for ( std::size_t cell = 0; cell < crumb.size(); ++cell )
	{
		isCrumb[cell] = isChosen[crumb[cell] - first];
	}
	return isCrumb;
}

} // namespace pliant
