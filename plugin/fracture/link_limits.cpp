#include "fracture/link_limits.h"

#include "fracture/cell_positions.h"

#include <algorithm>
#include <cmath>

namespace pliant {

namespace {

float limitSquared( const Lattice& lattice, std::uint32_t a, std::uint32_t b, float strain )
{
	const float longest = ( 1.0f + strain ) * ( lattice.restCentre[b] - lattice.restCentre[a] ).norm();
	return longest * longest;
}

void findWeakest( LinkLimits& limits )
{
	limits.weakest = limits.toughness.empty() ? 1.0f : *std::min_element( limits.toughness.begin(), limits.toughness.end() );
}

} // namespace

std::size_t LinkLimits::linkOf( std::uint32_t a, std::uint32_t b ) const
{
	const std::uint32_t lower = std::min( a, b ), higher = std::max( a, b );
	return std::size_t( std::lower_bound( to.begin() + start[lower], to.begin() + start[lower + 1], higher ) - to.begin() );
}

double toughnessAlong( const Lattice& lattice, const LinkLimits& limits, std::uint32_t cell, const Vec3d& normal )
{
	if ( limits.toughness.empty() )
	{
		return 1.0;
	}
	double sum = 0.0, weights = 0.0;
	for ( std::uint32_t k = lattice.linkStart[cell]; k < lattice.linkStart[cell + 1]; ++k )
	{
		const std::uint32_t j = lattice.linkTo[k];
		const double along = ( lattice.restCentre[j] - lattice.restCentre[cell] ).cast<double>().normalized().dot( normal );
		sum += along * along * limits.toughness[limits.linkOf( cell, j )];
		weights += along * along;
	}
	return sum / weights;
}

LinkLimits limitLinks( const Lattice& lattice, float strain, std::vector<float> toughness )
{
	LinkLimits limits;
	limits.toughness = std::move( toughness );
	limits.start.reserve( lattice.linkStart.size() );
	limits.to.reserve( lattice.linkTo.size() / 2 );
	limits.lengthSquared.reserve( lattice.linkTo.size() / 2 );
	limits.start.push_back( 0 );
	for ( std::uint32_t i = 0; i < std::uint32_t( lattice.cellCount() ); ++i )
	{
		const auto row = lattice.linkTo.begin() + lattice.linkStart[i], end = lattice.linkTo.begin() + lattice.linkStart[i + 1];
		for ( auto link = std::upper_bound( row, end, i ); link != end; ++link )
		{
			const float fraction = limits.toughness.empty() ? 1.0f : limits.toughness[limits.to.size()];
			limits.to.push_back( *link );
			limits.lengthSquared.push_back( limitSquared( lattice, i, *link, strain * fraction ) );
		}
		limits.start.push_back( std::uint32_t( limits.to.size() ) );
	}
	findWeakest( limits );
	return limits;
}

LinkLimits inheritLimits( const LinkLimits& before, const Lattice& part, const std::vector<std::uint32_t>& cells, float strain )
{
	LinkLimits limits;
	limits.start.reserve( part.linkStart.size() );
	limits.to.reserve( part.linkTo.size() / 2 );
	limits.lengthSquared.reserve( part.linkTo.size() / 2 );
	limits.start.push_back( 0 );
	for ( std::uint32_t i = 0; i < std::uint32_t( part.cellCount() ); ++i )
	{
		std::uint32_t old = before.start[cells[i]];
		const std::uint32_t oldEnd = before.start[cells[i] + 1];
		const auto row = part.linkTo.begin() + part.linkStart[i], end = part.linkTo.begin() + part.linkStart[i + 1];
		const auto upper = std::upper_bound( row, end, i );
		if ( std::equal( upper, end, before.to.begin() + old, before.to.begin() + oldEnd,
				 [&]( std::uint32_t now, std::uint32_t then ) { return cells[now] == then; } ) )
		{
			limits.to.insert( limits.to.end(), upper, end );
			limits.lengthSquared.insert(
				limits.lengthSquared.end(), before.lengthSquared.begin() + old, before.lengthSquared.begin() + oldEnd );
			if ( !before.toughness.empty() )
			{
				limits.toughness.insert( limits.toughness.end(), before.toughness.begin() + old, before.toughness.begin() + oldEnd );
			}
			limits.start.push_back( std::uint32_t( limits.to.size() ) );
			continue;
		}
		for ( auto link = upper; link != end; ++link )
		{
			const std::uint32_t j = *link;
			while ( old < oldEnd && before.to[old] < cells[j] )
			{
				++old;
			}
			const bool isOld = old < oldEnd && before.to[old] == cells[j];
			limits.to.push_back( j );
			limits.lengthSquared.push_back( isOld ? before.lengthSquared[old] : limitSquared( part, i, j, strain ) );
			if ( !before.toughness.empty() )
			{
				limits.toughness.push_back( isOld ? before.toughness[old] : 1.0f );
			}
		}
		limits.start.push_back( std::uint32_t( limits.to.size() ) );
	}
	findWeakest( limits );
	limits.thin = inheritThinCells( before.thin, part, cells );
	return limits;
}

std::vector<float> inheritToughness( const LinkLimits& before, const Lattice& part, const std::vector<std::uint32_t>& cells )
{
	std::vector<float> toughness;
	if ( before.toughness.empty() )
	{
		return toughness;
	}
	toughness.reserve( part.linkTo.size() / 2 );
	for ( std::uint32_t i = 0; i < std::uint32_t( part.cellCount() ); ++i )
	{
		const auto row = before.to.begin() + before.start[cells[i]], end = before.to.begin() + before.start[cells[i] + 1];
		for ( std::uint32_t k = part.linkStart[i]; k < part.linkStart[i + 1]; ++k )
		{
			if ( part.linkTo[k] > i )
			{
				const auto old = std::lower_bound( row, end, cells[part.linkTo[k]] );
				const bool isOld = old != end && *old == cells[part.linkTo[k]];
				toughness.push_back( isOld ? before.toughness[std::size_t( old - before.to.begin() )] : 1.0f );
			}
		}
	}
	return toughness;
}

namespace {

struct Positions
{
	const float *x, *y, *z;

	float distanceSquared( std::uint32_t i, std::uint32_t j ) const
	{
		const float dx = x[i] - x[j], dy = y[i] - y[j], dz = z[i] - z[j];
		return dx * dx + dy * dy + dz * dz;
	}
};

} // namespace

void findOverstretched( const LinkLimits& limits, const NodeState& nodes, std::vector<CellLink>& found )
{
	const Positions positions{ nodes.x.x.data(), nodes.x.y.data(), nodes.x.z.data() };
	const std::uint32_t count = std::uint32_t( limits.start.size() ) - 1;
	for ( std::uint32_t i = 0; i < count; ++i )
	{
		for ( std::uint32_t k = limits.start[i]; k < limits.start[i + 1]; ++k )
		{
			if ( positions.distanceSquared( i, limits.to[k] ) > limits.lengthSquared[k] )
			{
				found.push_back( CellLink{ i, limits.to[k] } );
			}
		}
	}
}

// ( L + b ( M - L ) )^2 with the rest length L and the limit M at b = 1.
float breakingSquared( float limitSquared, const CellPositions& positions, std::uint32_t i, std::uint32_t j )
{
	const float strainFactor = std::max( positions.strainFactor( i ), positions.strainFactor( j ) ),
				rest = ( positions.restOf( i ) - positions.restOf( j ) ).norm();
	const float breaking = rest + strainFactor * ( std::sqrt( limitSquared ) - rest );
	return strainFactor == 1.0f ? limitSquared : breaking * breaking;
}

void findOverstretched( const LinkLimits& limits, const CellPositions& positions, std::vector<CellLink>& found )
{
	const std::uint32_t count = std::uint32_t( limits.start.size() ) - 1;
	for ( std::uint32_t i = 0; i < count; ++i )
	{
		for ( std::uint32_t k = limits.start[i]; positions.mayBreak( i ) && k < limits.start[i + 1]; ++k )
		{
			const std::uint32_t j = limits.to[k];
			const float squared = ( positions.at( i ) - positions.at( j ) ).squaredNorm();
			if ( positions.mayBreak( j ) && squared > limits.lengthSquared[k] &&
				squared > breakingSquared( limits.lengthSquared[k], positions, i, j ) )
			{
				found.push_back( CellLink{ i, j } );
			}
		}
	}
}

} // namespace pliant
