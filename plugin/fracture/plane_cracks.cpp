#include "fracture/plane_cracks.h"

#include "fracture/constants.h"
#include "matching/region_moments.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <tuple>

namespace pliant {

namespace {

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

Vec3d restPlace( const Lattice& lattice, std::uint32_t cell )
{
	return lattice.massCentre + lattice.restCentre[cell].cast<double>();
}

} // namespace

/// Sums over links: p q^T and q q^T.
struct PlaneCracks::Moment
{
	Eigen::Matrix3d now = Eigen::Matrix3d::Zero(), rest = Eigen::Matrix3d::Zero();
};

/// Of the links of cells, each cell's made when they are first asked for.
class PlaneCracks::Moments
{
public:
	Moments( const Lattice& lattice, const CellPlaces& places ) : m_lattice( lattice ), m_places( places ), m_slot( std::size_t( lattice.cellCount() ), kNone ) {}

	const Moment& of( std::uint32_t cell )
	{
		if ( m_slot[cell] == kNone )
		{
			m_slot[cell] = std::uint32_t( m_made.size() );
			m_made.push_back( measure( cell ) );
		}
		return m_made[m_slot[cell]];
	}
	/// Of the cell and of all it is linked to.
	Moment around( std::uint32_t cell )
	{
		Moment sum = of( cell );
		for ( std::uint32_t k = m_lattice.linkStart[cell]; k < m_lattice.linkStart[cell + 1]; ++k )
		{
			const Moment& more = of( m_lattice.linkTo[k] );
			sum.now += more.now;
			sum.rest += more.rest;
		}
		return sum;
	}

private:
	static constexpr std::uint32_t kNone = 0xffffffffu;

	Moment measure( std::uint32_t cell ) const
	{
		Moment sum;
		for ( std::uint32_t k = m_lattice.linkStart[cell]; k < m_lattice.linkStart[cell + 1] && m_places.has( cell ); ++k )
		{
			const std::uint32_t j = m_lattice.linkTo[k];
			if ( m_places.has( j ) )
			{
				const Vec3d q = ( m_lattice.restCentre[j] - m_lattice.restCentre[cell] ).cast<double>();
				sum.now += ( m_places.at( j ) - m_places.at( cell ) ).cast<double>() * q.transpose();
				sum.rest += q * q.transpose();
			}
		}
		return sum;
	}

	const Lattice& m_lattice;
	const CellPlaces& m_places;
	std::vector<std::uint32_t> m_slot;
	std::vector<Moment> m_made;
};

float PlaneCracks::candidateStrain() const
{
	return kCandidateShare * m_growthShare * m_breakStrain;
}

// Links are cheap to look at and single out the few cells for which the deformation of all that is around them is worth measuring.
std::vector<PlaneCracks::Overload> PlaneCracks::overloads( const Lattice& lattice, const LinkLimits& limits, const CellPlaces& places ) const
{
	std::vector<std::uint8_t> isStretched( std::size_t( lattice.cellCount() ), 0 );
	for ( std::uint32_t i = 0; i < std::uint32_t( lattice.cellCount() ); ++i )
	{
		const bool hasPlace = places.has( i );
		for ( std::uint32_t k = limits.start[i]; hasPlace && k < limits.start[i + 1]; ++k )
		{
			const std::uint32_t j = limits.to[k];
			if ( places.has( j ) && ( places.at( i ) - places.at( j ) ).squaredNorm() > limits.lengthSquared[k] )
			{
				isStretched[i] = isStretched[j] = 1;
			}
		}
	}
	std::vector<Overload> found;
	Moments moments( lattice, places );
	for ( std::uint32_t i = 0; i < std::uint32_t( isStretched.size() ); ++i )
	{
		if ( isStretched[i] == 0 || !places.mayBreak( i ) )
		{
			continue;
		}
		Overload overload{ i, measure( lattice, limits, moments.of( i ), i ), {} };
		if ( overload.near.excess > 1.0f )
		{
			overload.wide = measure( lattice, limits, moments.around( i ), i );
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
	return found;
}

// F = ( sum p q^T ) ( sum q q^T )^+ over the links of the cell, or of it and all it is linked to; the largest stretch is the root of the largest
// eigenvalue of F^T F, and its eigenvector the direction in the body at rest.
PlaneCracks::Pull PlaneCracks::measure( const Lattice& lattice, const LinkLimits& limits, const Moment& around, std::uint32_t i ) const
{
	Pull found;
	Eigen::Matrix3d outside;
	const Eigen::Matrix3d f = around.now * inverseInPlane( around.rest, kFlatNeighbourhood, outside );
	const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver( Eigen::Matrix3d( f.transpose() * f ) );
	found.normal = solver.eigenvectors().col( 2 );
	if ( found.normal.dot( Vec3d( 1.0, 1e-3, 1e-6 ) ) < 0.0 )
	{
		found.normal = -found.normal; // either would do; one must
	}
	const double strain = std::sqrt( std::max( 0.0, solver.eigenvalues()[2] ) ) - 1.0;

	// What is to break is as tough as its links are, those weighed most that lie along the pull.
	double toughness = 0.0, weights = 0.0;
	for ( std::uint32_t k = lattice.linkStart[i]; k < lattice.linkStart[i + 1]; ++k )
	{
		const std::uint32_t j = lattice.linkTo[k];
		const double along = ( lattice.restCentre[j] - lattice.restCentre[i] ).cast<double>().normalized().dot( found.normal );
		toughness += along * along * toughnessOf( limits, std::min( i, j ), std::max( i, j ) );
		weights += along * along;
	}
	found.excess = float( strain * weights / ( double( m_breakStrain ) * toughness ) );
	return found;
}

PlaneCracks::Plane* PlaneCracks::planeFor( const Overload& found, const Vec3d& at, double cellSize, bool& isShielded )
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
		const double outside = std::sqrt( outsideSquared( at, plane.low, plane.high ) );
		const double height = std::fabs( plane.normal.dot( at - plane.point ) );
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

void PlaneCracks::breakAcross( const Lattice& lattice, const LinkLimits& limits, std::uint32_t cell, Plane& plane, std::vector<CellLink>& broken ) const
{
	std::vector<std::uint32_t> members( lattice.linkTo.begin() + lattice.linkStart[cell], lattice.linkTo.begin() + lattice.linkStart[cell + 1] );
	members.insert( std::lower_bound( members.begin(), members.end(), cell ), cell );
	const auto isAbove = [&]( std::uint32_t c ) { return plane.normal.dot( restPlace( lattice, c ) - plane.point ) >= 0.0; };
	for ( const std::uint32_t a : members )
	{
		for ( std::uint32_t k = limits.start[a]; k < limits.start[a + 1]; ++k )
		{
			const std::uint32_t b = limits.to[k];
			const bool isTough = !limits.toughness.empty() && std::isinf( limits.toughness[k] );
			if ( !isTough && isAbove( a ) != isAbove( b ) && std::binary_search( members.begin(), members.end(), b ) )
			{
				broken.push_back( CellLink{ a, b } );
			}
		}
		plane.low = plane.low.cwiseMin( restPlace( lattice, a ) );
		plane.high = plane.high.cwiseMax( restPlace( lattice, a ) );
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
	bool hasBegun = false;
	for ( const Overload& overload : overloads( lattice, limits, places ) )
	{
		const Vec3d at = restPlace( lattice, overload.cell );
		bool isShielded = false;
		Plane* plane = planeFor( overload, at, lattice.cellSize, isShielded );
		if ( !plane && mayBegin && !isShielded && overload.wide.excess > 1.0f )
		{
			m_planes.push_back( Plane{ at + 0.5 * double( lattice.cellSize ) * overload.wide.normal, overload.wide.normal, at, at, 0.0f } );
			plane = &m_planes.back();
			hasBegun = true;
		}
		if ( plane )
		{
			const std::size_t before = broken.size();
			breakAcross( lattice, limits, overload.cell, *plane, broken );
			plane->age = broken.size() > before ? 0.0f : plane->age;
		}
	}
	std::sort( broken.begin(), broken.end() );
	broken.erase( std::unique( broken.begin(), broken.end() ), broken.end() );
	return hasBegun;
}

} // namespace pliant
