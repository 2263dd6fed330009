#include "fracture/plane_cracks.h"

#include "fracture/constants.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace pliant {

namespace {

/// What an excess, a float, may be off by.
constexpr double kRoundedShare = 1e-6;

/// Squared distance of a point from a box.
double outsideSquared( const Vec3d& at, const Vec3d& low, const Vec3d& high )
{
	return ( at - at.cwiseMax( low ).cwiseMin( high ) ).squaredNorm();
}

/// Toughness of the link from the lower cell to the higher.
float toughnessOf( const LinkLimits& limits, std::uint32_t a, std::uint32_t b )
{
	if ( limits.toughness.empty() )
	{
		return 1.0f;
	}
	const auto row = limits.to.begin() + limits.start[a], end = limits.to.begin() + limits.start[a + 1];
	return limits.toughness[std::size_t( std::lower_bound( row, end, b ) - limits.to.begin() )];
}

} // namespace

float PlaneCracks::candidateStrain() const
{
	return kCandidateShare * m_growthShare * m_breakStrain;
}

void PlaneCracks::placeAtRest( const Lattice& lattice )
{
	m_room.rest.resize( std::size_t( lattice.cellCount() ) );
	for ( std::size_t cell = 0; cell < m_room.rest.size(); ++cell )
	{
		m_room.rest[cell] = lattice.massCentre + lattice.restCentre[cell].cast<double>();
	}
}

// Links are cheap to look at and single out the few cells for which the deformation of all that is around them is worth measuring.
void PlaneCracks::findStretched( const Lattice& lattice, const LinkLimits& limits, const CellPlaces& places )
{
	std::vector<std::uint8_t>& isStretched = m_room.mark;
	isStretched.assign( std::size_t( lattice.cellCount() ), 0 );
	m_room.stretched.clear();
	const LinkMoments& cells = m_room.moments;
	for ( std::uint32_t i = 0; i < std::uint32_t( isStretched.size() ); ++i )
	{
		for ( std::uint32_t k = limits.start[i]; cells.has( i ) && k < limits.start[i + 1]; ++k )
		{
			const std::uint32_t j = limits.to[k];
			if ( cells.has( j ) && cells.distanceSquared( i, j ) > limits.lengthSquared[k] )
			{
				isStretched[i] = isStretched[j] = 1;
			}
		}
		if ( isStretched[i] != 0 && places.mayBreak( i ) ) // all links of i have been looked at: those to lower cells were theirs
		{
			m_room.stretched.push_back( i );
		}
	}
}

// Where no crack may begin, only those can break links that a crack gets to: they lie within its plane's thickness, and near to where it has been
// or to another such cell that it then has been at.
void PlaneCracks::dropUnreachable( const Lattice& lattice )
{
	std::vector<std::uint8_t>& isReached = m_room.mark;
	isReached.assign( std::size_t( lattice.cellCount() ), 0 );
	const double reach = kCrackReach * lattice.cellSize, most = kCrackThickness * lattice.cellSize;
	const Vec3d ring = Vec3d::Constant( 2.0 * lattice.cellSize ); // middles of material in neighbouring cells are no further apart
	for ( const Plane& plane : m_planes )
	{
		m_room.inSlab.clear();
		for ( const std::uint32_t cell : m_room.stretched )
		{
			if ( std::fabs( plane.normal.dot( m_room.rest[cell] - plane.point ) ) <= most )
			{
				m_room.inSlab.push_back( cell );
			}
		}
		Vec3d low = plane.low, high = plane.high;
		for ( std::size_t before = m_room.inSlab.size() + 1; m_room.inSlab.size() < before; )
		{
			before = m_room.inSlab.size();
			const auto isNear = [&]( std::uint32_t cell ) {
				const Vec3d& at = m_room.rest[cell];
				if ( std::sqrt( outsideSquared( at, low, high ) ) > reach )
				{
					return false;
				}
				isReached[cell] = 1;
				low = low.cwiseMin( at - ring );
				high = high.cwiseMax( at + ring );
				return true;
			};
			m_room.inSlab.erase( std::remove_if( m_room.inSlab.begin(), m_room.inSlab.end(), isNear ), m_room.inSlab.end() );
		}
	}
	std::vector<std::uint32_t>& cells = m_room.stretched;
	cells.erase( std::remove_if( cells.begin(), cells.end(), [&]( std::uint32_t cell ) { return isReached[cell] == 0; } ), cells.end() );
}

/// Whether a crack could go on in the cell, were it near enough.
bool PlaneCracks::isInSomePlane( const Overload& found, const Vec3d& at, double cellSize ) const
{
	return std::any_of( m_planes.begin(), m_planes.end(), [&]( const Plane& plane ) {
		return std::fabs( plane.normal.dot( at - plane.point ) ) <= kCrackThickness * cellSize &&
			std::fabs( plane.normal.dot( found.near.normal ) ) >= kSameCrackCosine;
	} );
}

void PlaneCracks::findOverloads( const Lattice& lattice, const LinkLimits& limits, bool mayBegin )
{
	std::vector<Overload>& found = m_room.found;
	found.clear();
	const double least = double( m_growthShare ) * double( m_breakStrain ) * double( limits.weakest );
	for ( const std::uint32_t i : m_room.stretched )
	{
		const Eigen::Matrix3d around = m_room.moments.of( i ).deformation();
		if ( !m_looksEverywhere && isStretchedLess( around, least * ( 1.0 - kRoundedShare ) ) )
		{
			continue; // no crack would go on or begin
		}
		Overload overload{ i, measure( lattice, limits, around, i ), {} };
		if ( !mayBegin && !m_looksEverywhere && !isInSomePlane( overload, m_room.rest[i], lattice.cellSize ) )
		{
			continue; // it would do nothing
		}
		if ( overload.near.excess > 1.0f )
		{
			overload.wide = measure( lattice, limits, m_room.moments.around( i ).deformation(), i );
			overload.wide.excess = overload.near.excess > kNeck ? std::max( overload.wide.excess, 1.0f + overload.near.excess - kNeck ) : overload.wide.excess;
		}
		if ( overload.near.excess > m_growthShare )
		{
			found.push_back( overload );
		}
	}
	std::sort( found.begin(), found.end(), []( const Overload& a, const Overload& b ) {
		return std::tie( b.wide.excess, b.near.excess, a.cell ) < std::tie( a.wide.excess, a.near.excess, b.cell );
	} );
}

PlaneCracks::Pull PlaneCracks::measure( const Lattice& lattice, const LinkLimits& limits, const Eigen::Matrix3d& around, std::uint32_t i ) const
{
	const Stretch stretch = largestStretch( around );
	Pull found;
	found.normal = stretch.axis;
	if ( found.normal.dot( Vec3d( 1.0, 1e-3, 1e-6 ) ) < 0.0 )
	{
		found.normal = -found.normal; // either would do; one must
	}
	double toughness = 1.0;
	if ( !limits.toughness.empty() )
	{
		// What is to break is as tough as its links are, those weighed most that lie along the pull.
		double sum = 0.0, weights = 0.0;
		for ( std::uint32_t k = lattice.linkStart[i]; k < lattice.linkStart[i + 1]; ++k )
		{
			const std::uint32_t j = lattice.linkTo[k];
			const double along = ( lattice.restCentre[j] - lattice.restCentre[i] ).cast<double>().normalized().dot( found.normal );
			sum += along * along * toughnessOf( limits, std::min( i, j ), std::max( i, j ) );
			weights += along * along;
		}
		toughness = sum / weights;
	}
	found.excess = float( stretch.strain / ( double( m_breakStrain ) * toughness ) );
	return found;
}

PlaneCracks::Plane* PlaneCracks::planeFor( const Overload& found, const Vec3d& at, double cellSize, bool mayBegin, bool& isShielded )
{
	isShielded = false;
	Plane* nearest = nullptr;
	double least = kCrackThickness * cellSize;
	for ( Plane& plane : m_planes )
	{
		if ( std::fabs( plane.normal.dot( found.near.normal ) ) < kSameCrackCosine )
		{
			continue;
		}
		const double height = std::fabs( plane.normal.dot( at - plane.point ) );
		if ( height > least && !mayBegin )
		{
			continue;
		}
		const double outside = std::sqrt( outsideSquared( at, plane.low, plane.high ) );
		if ( outside <= kCrackReach * cellSize && height <= least )
		{
			least = height;
			nearest = &plane;
		}
		// A crack takes the load off what is beside it, as far as it is long; it need not have been felt there yet.
		isShielded = isShielded || outside < kCrackShield * cellSize + 0.5 * ( plane.high - plane.low ).norm();
	}
	return nearest;
}

bool PlaneCracks::breakAcross( const Lattice& lattice, const LinkLimits& limits, std::uint32_t cell, Plane& plane )
{
	std::vector<std::uint32_t>& members = m_room.members;
	members.assign( lattice.linkTo.begin() + lattice.linkStart[cell], lattice.linkTo.begin() + lattice.linkStart[cell + 1] );
	members.insert( std::lower_bound( members.begin(), members.end(), cell ), cell );
	std::vector<std::uint8_t>& sideOf = m_room.sideOf;
	sideOf.resize( std::max( sideOf.size(), std::size_t( lattice.cellCount() ) ), 0 );
	std::uint8_t sides = 0;
	for ( const std::uint32_t a : members )
	{
		const Vec3d& at = m_room.rest[a];
		sideOf[a] = plane.normal.dot( at - plane.point ) >= 0.0 ? 2 : 1;
		sides |= sideOf[a];
		plane.low = plane.low.cwiseMin( at );
		plane.high = plane.high.cwiseMax( at );
	}
	bool breaks = false;
	for ( std::size_t m = 0; m < members.size() && sides == 3; ++m ) // else all are on one side
	{
		const std::uint32_t a = members[m];
		bool breaksHere = false;
		for ( std::uint32_t k = limits.start[a]; k < limits.start[a + 1]; ++k )
		{
			const std::uint32_t b = limits.to[k];
			const bool isTough = !limits.toughness.empty() && std::isinf( limits.toughness[k] );
			if ( ( sideOf[a] ^ sideOf[b] ) == 3 && !isTough )
			{
				m_room.isBroken[k] = 1;
				breaksHere = true;
			}
		}
		if ( breaksHere )
		{
			m_room.mark[a] = 1;
			breaks = true;
		}
	}
	for ( const std::uint32_t a : members )
	{
		sideOf[a] = 0;
	}
	return breaks;
}

/// Those that have been marked, ascending, as limits list them: links are met by many of the cells along a crack.
void PlaneCracks::takeBroken( const LinkLimits& limits, std::vector<CellLink>& broken )
{
	const bool areMore = !broken.empty();
	for ( std::uint32_t a = 0; a < std::uint32_t( m_room.mark.size() ); ++a )
	{
		for ( std::uint32_t k = limits.start[a]; m_room.mark[a] != 0 && k < limits.start[a + 1]; ++k )
		{
			if ( m_room.isBroken[k] != 0 )
			{
				m_room.isBroken[k] = 0;
				broken.push_back( CellLink{ a, limits.to[k] } );
			}
		}
	}
	if ( areMore )
	{
		std::sort( broken.begin(), broken.end() );
		broken.erase( std::unique( broken.begin(), broken.end() ), broken.end() );
	}
}

bool PlaneCracks::find(
	const Lattice& lattice, const LinkLimits& limits, const CellPlaces& places, float h, bool mayBegin, std::vector<CellLink>& broken )
{
	for ( Plane& plane : m_planes )
	{
		plane.age += h;
	}
	m_planes.erase( std::remove_if( m_planes.begin(), m_planes.end(), []( const Plane& plane ) { return plane.age > kCrackRest; } ), m_planes.end() );
	if ( m_planes.empty() && !mayBegin )
	{
		return false;
	}
	placeAtRest( lattice );
	m_room.moments.look( lattice, places );
	findStretched( lattice, limits, places );
	if ( !mayBegin && !m_looksEverywhere )
	{
		dropUnreachable( lattice );
	}
	findOverloads( lattice, limits, mayBegin );
	m_room.mark.assign( std::size_t( lattice.cellCount() ), 0 );
	m_room.isBroken.resize( std::max( m_room.isBroken.size(), limits.to.size() ), 0 );
	bool hasBegun = false;
	for ( const Overload& overload : m_room.found )
	{
		const Vec3d& at = m_room.rest[overload.cell];
		bool isShielded = false;
		Plane* plane = planeFor( overload, at, lattice.cellSize, mayBegin, isShielded );
		if ( !plane && mayBegin && !isShielded && overload.wide.excess > 1.0f )
		{
			m_planes.push_back( Plane{ at + 0.5 * double( lattice.cellSize ) * overload.wide.normal, overload.wide.normal, at, at, 0.0f } );
			plane = &m_planes.back();
			hasBegun = true;
		}
		if ( plane )
		{
			plane->age = breakAcross( lattice, limits, overload.cell, *plane ) ? 0.0f : plane->age;
		}
	}
	takeBroken( limits, broken );
	return hasBegun;
}

} // namespace pliant
