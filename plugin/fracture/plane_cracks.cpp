#include "fracture/plane_cracks.h"

#include "fracture/constants.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace pliant {

float PlaneCracks::candidateStrain() const
{
	return kCandidateFraction * m_growthFraction * m_breakStrain;
}

void PlaneCracks::findRestPositions( const Lattice& lattice )
{
	m_scratch.rest.resize( std::size_t( lattice.cellCount() ) );
	for ( std::size_t cell = 0; cell < m_scratch.rest.size(); ++cell )
	{
		m_scratch.rest[cell] = lattice.massCentre + lattice.restCentre[cell].cast<double>();
	}
}

// Checking links is cheap and selects the few cells for which the deformation of their surroundings is worth measuring. Where most cells
// are stretched, most links join two that are already known to be and are skipped.
void PlaneCracks::findStretched( const LinkLimits& limits, const CellPositions& positions )
{
	std::vector<std::uint8_t>&isStretched = m_scratch.mark, &isUnresolved = m_scratch.isUnresolved;
	isStretched.assign( m_scratch.isActive.size(), 0 );
	isUnresolved = m_scratch.isActive;
	m_scratch.stretched.clear();
	const LinkMoments& cells = m_scratch.faces.moments();
	auto thin = limits.thin.begin();
	for ( std::uint32_t i = 0; i < std::uint32_t( isStretched.size() ); ++i )
	{
		for ( std::uint32_t k = limits.start[i]; cells.isNode( i ) && k < limits.start[i + 1]; ++k )
		{
			const std::uint32_t j = limits.to[k];
			if ( ( isUnresolved[i] | isUnresolved[j] ) != 0 && cells.isNode( j ) &&
				cells.distanceSquared( i, j ) > limits.lengthSquared[k] )
			{
				isStretched[i] = isStretched[j] = 1;
				isUnresolved[i] = isUnresolved[j] = 0;
			}
		}
		if ( thin != limits.thin.end() && thin->cell == i )
		{
			if ( m_scratch.isActive[i] != 0 )
			{
				isStretched[i] = m_scratch.faces.mayBreak( *thin, isStretched[i] != 0 ) ? 1 : 0;
			}
			++thin;
		}
		if ( isStretched[i] != 0 && m_scratch.isActive[i] != 0 &&
			positions.mayBreak( i ) ) // all links of i are checked: those to lower cells in their rows
		{
			m_scratch.stretched.push_back( i );
		}
	}
}

void PlaneCracks::measureWide( const Lattice& lattice, const LinkLimits& limits, Overload& overload )
{
	if ( overload.near.excess > 1.0f )
	{
		overload.wide = measure( lattice, limits, m_scratch.faces.deformationOf( overload.cell, true ), overload );
		overload.wide.excess = overload.near.excess > kNeckFactor
			? std::max( overload.wide.excess, 1.0f + overload.near.excess - kNeckFactor )
			: overload.wide.excess;
	}
}

void PlaneCracks::findOverloads( const Lattice& lattice, const LinkLimits& limits, const CellPositions& positions, bool mayBegin )
{
	std::vector<Overload>& found = m_scratch.found;
	found.clear();
	const bool growsOnly = !mayBegin && !m_checksEveryCell;
	const double minStrain = double( m_growthFraction ) * double( m_breakStrain ) * double( limits.weakest );
	for ( const std::uint32_t i : m_scratch.stretched )
	{
		const Eigen::Matrix3d around = m_scratch.faces.deformationOf( i, false );
		if ( !m_checksEveryCell && isStretchedLess( around, minStrain * ( 1.0 - kExcessRounding ) ) )
		{
			continue; // no crack would grow or start
		}
		Overload overload{ i, positions.strainFactor( i ), {}, {}, 0 };
		overload.near = measure( lattice, limits, around, overload );
		overload.planes = growsOnly ? planesOf( i, overload.near, lattice.cellSize ) : 0;
		if ( overload.near.excess > m_growthFraction && ( !growsOnly || overload.planes != 0 ) ) // otherwise it has no effect
		{
			found.push_back( overload );
		}
	}
	const std::uint64_t unreached = growsOnly ? unreachedPlanes( lattice.cellSize ) : 0;
	for ( Overload& overload : found )
	{
		if ( !growsOnly || ( overload.planes & unreached ) != 0 ) // otherwise the order of processing has no effect
		{
			measureWide( lattice, limits, overload );
		}
	}
	std::sort( found.begin(), found.end(), []( const Overload& a, const Overload& b ) {
		return std::tie( b.wide.excess, b.near.excess, a.cell ) < std::tie( a.wide.excess, a.near.excess, b.cell );
	} );
}

PlaneCracks::Pull PlaneCracks::measure(
	const Lattice& lattice, const LinkLimits& limits, const Eigen::Matrix3d& around, const Overload& overload ) const
{
	const std::uint32_t i = overload.cell;
	const Stretch stretch = largestStretch( around );
	Pull found;
	found.normal = stretch.axis;
	if ( found.normal.dot( Vec3d( 1.0, 1e-3, 1e-6 ) ) < 0.0 )
	{
		found.normal = -found.normal; // both signs are valid; one is chosen
	}
	const double toughness = toughnessAlong( lattice, limits, i, found.normal );
	found.excess = float( stretch.strain / ( double( m_breakStrain ) * toughness * double( overload.strainFactor ) ) );
	return found;
}

PlaneCracks::Plane* PlaneCracks::planeFor( const Overload& found, const Vec3d& at, double cellSize, bool mayBegin, bool& isShielded )
{
	isShielded = false;
	Plane* nearest = nullptr;
	double nearestHeight = kCrackThickness * cellSize;
	for ( Plane& plane : m_planes )
	{
		if ( std::fabs( plane.normal.dot( found.near.normal ) ) < kSameCrackCosine )
		{
			continue;
		}
		const double height = std::fabs( heightOver( plane, found.cell ) );
		if ( height > nearestHeight && !mayBegin )
		{
			continue;
		}
		const double outside = plane.distanceOf( at );
		if ( outside <= kCrackReach * cellSize && height <= nearestHeight )
		{
			nearestHeight = height;
			nearest = &plane;
		}
		// A crack unloads the material beside it over a distance of its length, even before the unloading has arrived there.
		isShielded = isShielded || outside < kCrackShield * cellSize + 0.5 * ( plane.high - plane.low ).norm();
	}
	return nearest;
}

bool PlaneCracks::breakAcross( const Lattice& lattice, const LinkLimits& limits, std::uint32_t cell, Plane& plane )
{
	std::vector<std::uint32_t>& members = m_scratch.members;
	members.assign( lattice.linkTo.begin() + lattice.linkStart[cell], lattice.linkTo.begin() + lattice.linkStart[cell + 1] );
	members.insert( std::lower_bound( members.begin(), members.end(), cell ), cell );
	std::vector<std::uint8_t>& sideOf = m_scratch.sideOf;
	sideOf.resize( std::max( sideOf.size(), std::size_t( lattice.cellCount() ) ), 0 );
	std::uint8_t sides = 0;
	for ( const std::uint32_t a : members )
	{
		const Vec3d& at = m_scratch.rest[a];
		sideOf[a] = heightOver( plane, a ) >= 0.0 ? 2 : 1;
		sides |= sideOf[a];
		plane.low = plane.low.cwiseMin( at );
		plane.high = plane.high.cwiseMax( at );
	}
	bool breaks = false;
	for ( std::size_t m = 0; m < members.size() && sides == 3; ++m ) // otherwise all are on one side
	{
		const std::uint32_t a = members[m];
		bool breaksHere = false;
		for ( std::uint32_t k = limits.start[a]; k < limits.start[a + 1]; ++k )
		{
			const std::uint32_t b = limits.to[k];
			const bool isTough = !limits.toughness.empty() && std::isinf( limits.toughness[k] );
			if ( ( sideOf[a] ^ sideOf[b] ) == 3 && !isTough )
			{
				m_scratch.isBroken[k] = 1;
				breaksHere = true;
			}
		}
		if ( breaksHere )
		{
			m_scratch.mark[a] = 1;
			breaks = true;
		}
	}
	for ( const std::uint32_t a : members )
	{
		sideOf[a] = 0;
	}
	return breaks;
}

/// Collects the marked links, ascending, in the order of the limits: many links are visited by several cells along a crack.
void PlaneCracks::collectBroken( const LinkLimits& limits, std::vector<CellLink>& broken )
{
	const bool hadBroken = !broken.empty();
	for ( std::uint32_t a = 0; a < std::uint32_t( m_scratch.mark.size() ); ++a )
	{
		for ( std::uint32_t k = limits.start[a]; m_scratch.mark[a] != 0 && k < limits.start[a + 1]; ++k )
		{
			if ( m_scratch.isBroken[k] != 0 )
			{
				m_scratch.isBroken[k] = 0;
				broken.push_back( CellLink{ a, limits.to[k] } );
			}
		}
	}
	if ( hadBroken )
	{
		std::sort( broken.begin(), broken.end() );
		broken.erase( std::unique( broken.begin(), broken.end() ), broken.end() );
	}
}

bool PlaneCracks::hasLinkAlong( const Lattice& lattice, std::uint32_t cell, const Vec3d& direction ) const
{
	const auto row = lattice.linkTo.begin() + lattice.linkStart[cell], end = lattice.linkTo.begin() + lattice.linkStart[cell + 1];
	return std::any_of( row, end,
		[&]( std::uint32_t j ) { return direction.dot( m_scratch.rest[j] - m_scratch.rest[cell] ) > 0.5 * double( lattice.cellSize ); } );
}

bool PlaneCracks::find( const Lattice& lattice, const LinkLimits& limits, const CellPositions& positions, float h, bool mayBegin,
	std::vector<CellLink>& broken )
{
	for ( Plane& plane : m_planes )
	{
		plane.age += h;
	}
	m_planes.erase(
		std::remove_if( m_planes.begin(), m_planes.end(), []( const Plane& plane ) { return plane.age > kCrackRest; } ), m_planes.end() );
	if ( m_planes.empty() && !mayBegin )
	{
		return false;
	}
	m_scratch.faces.update( lattice, limits, positions, double( m_growthFraction ) * double( m_breakStrain ) * double( limits.weakest ) );
	const bool growsOnly = !mayBegin && !m_checksEveryCell;
	m_scratch.isActive.assign( std::size_t( lattice.cellCount() ), 1 );
	if ( growsOnly )
	{
		findRestPositions( lattice );
		findActive( lattice );
	}
	findStretched( limits, positions );
	if ( m_scratch.stretched.empty() )
	{
		return false; // as in most substeps of most bodies
	}
	if ( growsOnly )
	{
		dropUnreachable( lattice );
	}
	else
	{
		findRestPositions( lattice );
	}
	findOverloads( lattice, limits, positions, mayBegin );
	m_scratch.mark.assign( std::size_t( lattice.cellCount() ), 0 );
	m_scratch.isBroken.resize( std::max( m_scratch.isBroken.size(), limits.to.size() ), 0 );
	bool hasStarted = false;
	for ( const Overload& overload : m_scratch.found )
	{
		const Vec3d& at = m_scratch.rest[overload.cell];
		bool isShielded = false;
		Plane* plane = planeFor( overload, at, lattice.cellSize, mayBegin, isShielded );
		if ( !plane && mayBegin && !isShielded && overload.wide.excess > 1.0f )
		{
			const Vec3d& normal = overload.wide.normal;
			const double away = hasLinkAlong( lattice, overload.cell, normal ) ? 0.5 : -0.5; // within the body
			m_planes.push_back( Plane{ at + away * double( lattice.cellSize ) * normal, normal, at, at, 0.0f } );
			plane = &m_planes.back();
			hasStarted = true;
		}
		if ( plane )
		{
			plane->age = breakAcross( lattice, limits, overload.cell, *plane ) ? 0.0f : plane->age;
		}
	}
	collectBroken( limits, broken );
	return hasStarted;
}

} // namespace pliant
