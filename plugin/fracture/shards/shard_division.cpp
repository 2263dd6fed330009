// Divides a body's cells into shards and crumbs, before anything breaks.

#include "fracture/constants.h"
#include "fracture/shards/shard_cracks.h"
#include "lattice/union_find.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace pliant {

namespace {

double longestSide( const Lattice& lattice )
{
	Vec3 low = lattice.restCentre.front(), high = low;
	for ( const Vec3& at : lattice.restCentre )
	{
		low = low.cwiseMin( at );
		high = high.cwiseMax( at );
	}
	return double( ( high - low ).maxCoeff() + lattice.cellSize );
}

/// The size of shards that a body gets: see Fracture::shardSize.
double sizeOfShards( const Lattice& lattice, float wanted )
{
	return std::max( kLeastShardCells * double( lattice.cellSize ), std::min( double( wanted ), 0.5 * longestSide( lattice ) ) );
}

ShardSpace spaceFor( const Fracture& settings, double size )
{
	const Vec3d grain( double( settings.grain[0] ), double( settings.grain[1] ), double( settings.grain[2] ) );
	const bool isGrained = settings.shardPattern == ShardPattern::Scattered && grain.squaredNorm() > 0.0;
	return ShardSpace( isGrained ? Vec3d( grain.normalized() ) : Vec3d::Zero(), double( settings.grainLength ), kShardBend * size,
		kShardWave * size, settings.shardSeed );
}

/// Numbers the groups of linked cells that have equal numbers, in the order of their lowest cells.
std::vector<std::uint32_t> connectedGroups( const Lattice& lattice, UnionFind& groups )
{
	std::vector<std::uint32_t> number( std::size_t( lattice.cellCount() ) );
	std::uint32_t count = 0;
	for ( std::uint32_t cell = 0; cell < std::uint32_t( number.size() ); ++cell )
	{
		const std::uint32_t lowest = groups.find( cell ); // not above the cell
		number[cell] = lowest == cell ? count++ : number[lowest];
	}
	return number;
}

UnionFind joinEqual( const Lattice& lattice, const std::vector<std::uint64_t>& kind )
{
	UnionFind groups( kind.size() );
	for ( std::uint32_t i = 0; i < std::uint32_t( kind.size() ); ++i )
	{
		for ( std::uint32_t k = lattice.linkStart[i]; k < lattice.linkStart[i + 1]; ++k )
		{
			if ( lattice.linkTo[k] > i && kind[i] == kind[lattice.linkTo[k]] )
			{
				groups.join( i, lattice.linkTo[k] );
			}
		}
	}
	return groups;
}

/// Joins each group lighter than kShardSliver of the mean to the neighbour with most links to it, the lightest first.
void joinSlivers( const Lattice& lattice, UnionFind& groups )
{
	const std::vector<std::uint32_t> group = connectedGroups( lattice, groups );
	const std::size_t count = std::size_t( *std::max_element( group.begin(), group.end() ) ) + 1;
	std::vector<double> mass( count, 0.0 );
	std::vector<std::uint32_t> lowest( count, 0 );
	double total = 0.0;
	for ( std::uint32_t cell = std::uint32_t( group.size() ); cell-- > 0; )
	{
		mass[group[cell]] += double( lattice.fill[cell] );
		lowest[group[cell]] = cell;
		total += double( lattice.fill[cell] );
	}
	const double least = kShardSliver * total / double( count );
	std::vector<std::pair<std::uint32_t, std::uint32_t>> contacts; // of slivers
	for ( std::uint32_t i = 0; i < std::uint32_t( group.size() ); ++i )
	{
		for ( std::uint32_t k = lattice.linkStart[i]; mass[group[i]] < least && k < lattice.linkStart[i + 1]; ++k )
		{
			if ( group[lattice.linkTo[k]] != group[i] )
			{
				contacts.emplace_back( group[i], group[lattice.linkTo[k]] );
			}
		}
	}
	std::sort( contacts.begin(), contacts.end() );
	std::vector<std::pair<double, std::uint32_t>> order;
	for ( std::uint32_t g = 0; g < std::uint32_t( count ); ++g )
	{
		if ( mass[g] < least )
		{
			order.emplace_back( mass[g], g );
		}
	}
	std::sort( order.begin(), order.end() );
	for ( const auto& [own, sliver] : order )
	{
		auto next = std::lower_bound( contacts.begin(), contacts.end(), std::make_pair( sliver, std::uint32_t( 0 ) ) );
		std::ptrdiff_t widest = 0;
		std::uint32_t neighbour = sliver;
		while ( next != contacts.end() && next->first == sliver )
		{
			const auto end = std::upper_bound( next, contacts.end(), *next );
			neighbour = end - next > widest ? next->second : neighbour;
			widest = std::max( widest, end - next );
			next = end;
		}
		groups.join( lowest[sliver], lowest[neighbour] );
	}
}

/// Smallest mass of the groups with one number, cells' fill; infinite where there are none.
double leastMass( const Lattice& lattice, const std::vector<std::uint32_t>& group )
{
	std::vector<std::pair<std::uint32_t, float>> fills;
	for ( std::size_t cell = 0; cell < group.size(); ++cell )
	{
		fills.emplace_back( group[cell], lattice.fill[cell] );
	}
	std::sort( fills.begin(), fills.end() );
	double least = std::numeric_limits<double>::infinity(), sum = 0.0;
	for ( std::size_t k = 0; k < fills.size(); ++k )
	{
		sum += double( fills[k].second );
		if ( k + 1 == fills.size() || fills[k + 1].first != fills[k].first )
		{
			least = std::min( least, sum );
			sum = 0.0;
		}
	}
	return least;
}

} // namespace

ShardCracks::ShardCracks( const Lattice& lattice, const Fracture& settings, const GivenCentres& given ) : m_settings( settings )
{
	m_law.size = sizeOfShards( lattice, settings.shardSize );
	m_awaitsImpact = given.position.empty() && settings.shardPattern == ShardPattern::Rings;
	if ( !given.position.empty() )
	{
		m_centres = std::make_shared<const ShardCentreSet>( ShardSpace( Vec3d::Zero(), 1.0, 0.0, 1.0, 0 ), m_law.size, given.position );
	}
	if ( m_awaitsImpact )
	{
		m_shard.assign( std::size_t( lattice.cellCount() ), 0 );
	}
	else
	{
		divide( lattice, Vec3d::Zero(), given.shard );
	}
	double mass = 0.0;
	for ( const float fill : lattice.fill )
	{
		mass += double( fill );
	}
	m_crumbMass = double( settings.crumbFraction ) * mass;
}

void ShardCracks::setLaw( float breakStrain, double youngsModulus )
{
	const double runsAt = double( kRunsAt ) * double( breakStrain );
	m_law.breakStrain = breakStrain;
	m_law.youngsModulus = youngsModulus;
	m_law.toughness = m_settings.toughness > 0.0f ? double( m_settings.toughness ) : runsAt * runsAt * youngsModulus * m_law.size;
}

void ShardCracks::divide( const Lattice& lattice, const Vec3d& impact, const std::vector<std::uint32_t>& shardOfCentre )
{
	const std::size_t cells = std::size_t( lattice.cellCount() );
	const ShardSpace space = spaceFor( m_settings, m_law.size );
	if ( m_awaitsImpact )
	{
		const Vec3d grain( double( m_settings.grain[0] ), double( m_settings.grain[1] ), double( m_settings.grain[2] ) );
		const Vec3d axis = grain.squaredNorm() > 0.0 ? Vec3d( grain.normalized() ) : thinnestDirection( lattice );
		m_centres = std::make_shared<const ShardCentreSet>(
			ShardCentreSet::rings( lattice, space, m_law.size, impact, axis, m_settings.shardSeed ) );
		m_awaitsImpact = false;
	}
	else if ( !m_centres )
	{
		m_centres = std::make_shared<const ShardCentreSet>( ShardCentreSet::scattered( lattice, space, m_law.size, m_settings.shardSeed ) );
	}
	std::vector<std::uint64_t> kind( cells );
	for ( std::size_t cell = 0; cell < cells; ++cell )
	{
		const std::uint32_t centre = m_centres->nearest( restOf( lattice, cell ) );
		kind[cell] = shardOfCentre.empty() ? centre : shardOfCentre[centre];
	}
	UnionFind groups = joinEqual( lattice, kind );
	joinSlivers( lattice, groups );
	m_shard = connectedGroups( lattice, groups );
	if ( m_settings.crumbFraction > 0.0f )
	{
		const double crumb = std::max( double( lattice.cellSize ), kCrumbSize * m_law.size );
		m_crumbCentres = std::make_shared<const ShardCentreSet>(
			ShardCentreSet::scattered( lattice, space, crumb, m_settings.shardSeed + 1 ) );
		for ( std::size_t cell = 0; cell < cells; ++cell )
		{
			kind[cell] = std::uint64_t( m_shard[cell] ) << 32 | m_crumbCentres->nearest( restOf( lattice, cell ) );
		}
		UnionFind crumbs = joinEqual( lattice, kind );
		m_crumb = connectedGroups( lattice, crumbs );
		const std::uint32_t shards = *std::max_element( m_shard.begin(), m_shard.end() ) + 1;
		for ( std::uint32_t& number : m_crumb )
		{
			number += shards; // the number that its cells get as shards of their own
		}
	}
	findOne();
}

void ShardCracks::findOne()
{
	m_isOne = !m_awaitsImpact &&
		std::all_of( m_shard.begin(), m_shard.end(), [this]( std::uint32_t shard ) { return shard == m_shard.front(); } );
}

ShardCracks::ShardCracks( const ShardCracks& whole, const Lattice& piece, const std::vector<std::uint32_t>& cells, double fraction ) :
	m_settings( whole.m_settings ), m_law( whole.m_law ), m_centres( whole.m_centres ), m_crumbCentres( whole.m_crumbCentres ),
	m_crumbMass( fraction * whole.m_crumbMass ), m_awaitsImpact( whole.m_awaitsImpact )
{
	m_shard.reserve( cells.size() );
	for ( const std::uint32_t cell : cells )
	{
		m_shard.push_back( whole.m_shard[cell] );
		if ( !whole.m_crumb.empty() )
		{
			m_crumb.push_back( whole.m_crumb[cell] );
		}
	}
	findOne();
	if ( !m_awaitsImpact && m_crumbMass < leastMass( piece, m_crumb ) )
	{
		m_crumbMass = 0.0; // no crumb is so small
	}
}

float ShardCracks::candidateStrain() const
{
	return kCandidateFraction * m_law.breakStrain;
}

std::vector<CutTrace> ShardCracks::tracesOf( const Lattice& lattice, const std::vector<CellLink>& broken ) const
{
	std::vector<CutTrace> traces;
	for ( const CellLink& link : broken )
	{
		const auto steps = ( lattice.coordinate[link.a].cast<int>() - lattice.coordinate[link.b].cast<int>() ).cwiseAbs().sum();
		if ( steps != 1 || !m_centres )
		{
			continue;
		}
		const Vec3d a = restOf( lattice, link.a ), b = restOf( lattice, link.b );
		const ShardCentreSet* set = m_centres.get();
		std::uint32_t centreA = set->nearest( a ), centreB = set->nearest( b );
		if ( centreA == centreB && m_crumbCentres )
		{
			set = m_crumbCentres.get();
			centreA = set->nearest( a );
			centreB = set->nearest( b );
		}
		if ( centreA != centreB ) // otherwise a cut or a healed link
		{
			Vec3d normal;
			const double fraction = set->borderBetween( a, centreA, b, centreB, normal );
			traces.push_back( CutTrace{ link, ( a + fraction * ( b - a ) ).cast<float>(), normal.cast<float>() } );
		}
	}
	return traces;
}

} // namespace pliant
