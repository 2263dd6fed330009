#include "fracture/cut_links.h"

#include <Eigen/Geometry>

#include <algorithm>

namespace pliant {

namespace {

bool crosses( const PlaneCut& cut, const Vec3d& a, const Vec3d& b )
{
	const double sideA = cut.normal.dot( a - cut.point ), sideB = cut.normal.dot( b - cut.point );
	if ( ( sideA < 0.0 ) == ( sideB < 0.0 ) )
	{
		return false;
	}
	// x = a + s_a / ( s_a - s_b ) ( b - a ); the sides differ, so the divisor is not 0.
	const Vec3d at = a + sideA / ( sideA - sideB ) * ( b - a );
	return !( ( at - cut.point ).squaredNorm() > cut.radius * cut.radius );
}

bool crosses( const SphereCut& cut, const Vec3d& a, const Vec3d& b )
{
	const double r2 = cut.radius * cut.radius;
	const Vec3d fromA = cut.centre - a, along = b - a;
	const bool isInA = fromA.squaredNorm() < r2, isInB = ( b - cut.centre ).squaredNorm() < r2;
	if ( isInA || isInB )
	{
		return !( isInA && isInB );
	}
	// Both outside: the link enters and leaves the sphere if its point closest to the centre is inside.
	const double length2 = along.squaredNorm(), reach = fromA.dot( along );
	return reach > 0.0 && reach < length2 && ( fromA - reach / length2 * along ).squaredNorm() < r2;
}

/// The side on which the line from a along `direction` passes the edge u v: the volume they span. Exactly negated for the edge v u.
double sideOfEdge( const Vec3d& a, const Vec3d& direction, const Vec3d& u, const Vec3d& v )
{
	return ( u - a ).cross( v - a ).dot( direction );
}

bool crossesTriangle( const Vec3d& a, const Vec3d& b, const Vec3d& u, const Vec3d& v, const Vec3d& w )
{
	const Vec3d normal = ( v - u ).cross( w - u ), direction = b - a;
	if ( ( normal.dot( a - u ) < 0.0 ) == ( normal.dot( b - u ) < 0.0 ) )
	{
		return false;
	}
	const double uv = sideOfEdge( a, direction, u, v ), vw = sideOfEdge( a, direction, v, w ), wu = sideOfEdge( a, direction, w, u );
	return ( uv >= 0.0 && vw >= 0.0 && wu >= 0.0 ) || ( uv <= 0.0 && vw <= 0.0 && wu <= 0.0 );
}

bool crosses( const BladeCut& cut, const Vec3d& a, const Vec3d& b )
{
	return crossesTriangle( a, b, cut.p0, cut.p1, cut.q0 ) || crossesTriangle( a, b, cut.q0, cut.p1, cut.q1 );
}

bool isValid( const PlaneCut& cut )
{
	return cut.point.allFinite() && cut.normal.allFinite() && !cut.normal.isZero( 0.0 ) && cut.radius > 0.0;
}

bool isValid( const SphereCut& cut )
{
	return cut.centre.allFinite() && cut.radius > 0.0;
}

bool isValid( const BladeCut& cut )
{
	return cut.p0.allFinite() && cut.p1.allFinite() && cut.q0.allFinite() && cut.q1.allFinite();
}

/// Returns, per position, one bit for each side of the blade's box that it lies beyond. Links with both ends beyond one are not cut.
std::vector<std::uint8_t> sidesBeyond( const std::vector<Vec3d>& positions, const BladeCut& cut )
{
	const Vec3d low = cut.p0.cwiseMin( cut.p1 ).cwiseMin( cut.q0.cwiseMin( cut.q1 ) ),
				high = cut.p0.cwiseMax( cut.p1 ).cwiseMax( cut.q0.cwiseMax( cut.q1 ) );
	std::vector<std::uint8_t> beyond;
	beyond.reserve( positions.size() );
	for ( const Vec3d& at : positions )
	{
		unsigned bits = 0;
		for ( int axis = 0; axis < 3; ++axis )
		{
			bits |= unsigned( at[axis] < low[axis] ) << 2 * axis | unsigned( at[axis] > high[axis] ) << ( 2 * axis + 1 );
		}
		beyond.push_back( std::uint8_t( bits ) );
	}
	return beyond;
}

template <class Cut>
std::vector<std::uint8_t> sidesBeyond( const std::vector<Vec3d>& positions, const Cut& )
{
	return std::vector<std::uint8_t>( positions.size(), 0 );
}

/// True where a cell and all linked cells lie beyond one side. This holds for most cells, so the loop has no early exit.
bool isBeyond( const Lattice& lattice, const std::vector<std::uint8_t>& beyond, std::uint32_t cell )
{
	unsigned all = beyond[cell];
	const std::uint32_t end = all != 0 ? lattice.linkStart[cell + 1] : 0;
	for ( std::uint32_t k = lattice.linkStart[cell]; k < end; ++k )
	{
		all &= beyond[lattice.linkTo[k]];
	}
	return all != 0;
}

template <class Cut>
std::vector<CellLink> findCut( const Lattice& lattice, const std::vector<Vec3d>& positions, const Cut& cut )
{
	std::vector<CellLink> links;
	if ( !isValid( cut ) )
	{
		return links;
	}
	const std::vector<std::uint8_t> beyond = sidesBeyond( positions, cut );
	for ( std::uint32_t i = 0; i < std::uint32_t( lattice.cellCount() ); ++i )
	{
		if ( isBeyond( lattice, beyond, i ) )
		{
			continue;
		}
		const auto row = lattice.linkTo.begin() + lattice.linkStart[i], end = lattice.linkTo.begin() + lattice.linkStart[i + 1];
		for ( auto to = std::upper_bound( row, end, i ); to != end; ++to )
		{
			if ( ( beyond[i] & beyond[*to] ) == 0 && crosses( cut, positions[i], positions[*to] ) )
			{
				links.push_back( CellLink{ i, *to } );
			}
		}
	}
	return links;
}

} // namespace

std::vector<CellLink> linksCut( const Lattice& lattice, const std::vector<Vec3d>& positions, const PlaneCut& cut )
{
	return findCut( lattice, positions, cut );
}

std::vector<CellLink> linksCut( const Lattice& lattice, const std::vector<Vec3d>& positions, const SphereCut& cut )
{
	return findCut( lattice, positions, cut );
}

std::vector<CellLink> linksCut( const Lattice& lattice, const std::vector<Vec3d>& positions, const BladeCut& cut )
{
	return findCut( lattice, positions, cut );
}

std::vector<CellLink> linksToHeal( const Lattice& whole, const Lattice& part, const std::vector<std::uint32_t>& cellInWhole,
	const std::vector<Vec3d>& positions, double maxStretch )
{
	std::vector<CellLink> links;
	for ( std::uint32_t i = 0; i < std::uint32_t( part.cellCount() ); ++i )
	{
		const std::uint32_t inWhole = cellInWhole.empty() ? i : cellInWhole[i];
		const auto rowNow = part.linkTo.begin() + part.linkStart[i], endNow = part.linkTo.begin() + part.linkStart[i + 1];
		for ( std::uint32_t k = whole.linkStart[inWhole]; k < whole.linkStart[inWhole + 1]; ++k )
		{
			const auto found = std::lower_bound( cellInWhole.begin(), cellInWhole.end(), whole.linkTo[k] );
			const bool isElsewhere = !cellInWhole.empty() && ( found == cellInWhole.end() || *found != whole.linkTo[k] );
			const std::uint32_t j = cellInWhole.empty() ? whole.linkTo[k] : std::uint32_t( found - cellInWhole.begin() );
			if ( isElsewhere || j < i || std::binary_search( rowNow, endNow, j ) )
			{
				continue;
			}
			const double rest = ( part.restCentre[i] - part.restCentre[j] ).cast<double>().norm();
			if ( ( positions[i] - positions[j] ).norm() <= maxStretch * rest )
			{
				links.push_back( CellLink{ i, j } );
			}
		}
	}
	return links;
}

} // namespace pliant
