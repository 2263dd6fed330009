#include "fracture/shards/shard_centres.h"

#include "fracture/constants.h"
#include "matching/constants.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace pliant {

namespace {

/// A hash of two numbers, uniform (the finaliser of MurmurHash3 by Austin Appleby).
std::uint32_t hashed( std::uint32_t number, std::uint32_t seed )
{
	std::uint32_t h = number * 0x9e3779b9u ^ ( seed * 0x85ebca6bu + 0x27d4eb2fu );
	h = ( h ^ h >> 16 ) * 0x85ebca6bu;
	h = ( h ^ h >> 13 ) * 0xc2b2ae35u;
	return h ^ h >> 16;
}

/// Uniform in [-1, 1).
double signedFraction( std::uint32_t number, std::uint32_t seed )
{
	return double( hashed( number, seed ) ) / 2147483648.0 - 1.0;
}

} // namespace

ShardSpace::ShardSpace( const Vec3d& grain, double length, double bend, double wavelength, unsigned seed ) :
	m_metric( Eigen::Matrix3d::Identity() + ( 1.0 / length - 1.0 ) * grain * grain.transpose() ), m_bend( bend )
{
	for ( int k = 0; k < 3; ++k )
	{
		const std::uint32_t first = std::uint32_t( 4 * k );
		const Vec3d wave( signedFraction( first, seed ), signedFraction( first + 1, seed ), signedFraction( first + 2, seed ) );
		const double size = wave.norm();
		m_wave.row( k ) = 2.0 * kPi / wavelength * ( size > 0.1 ? Vec3d( wave / size ) : Vec3d( Vec3d::Unit( k ) ) ).transpose();
		m_phase[k] = kPi * signedFraction( first + 3, seed );
	}
}

Vec3d ShardSpace::map( const Vec3d& at ) const
{
	const Vec3d compressed = m_metric * at;
	const Vec3d angle = m_wave * compressed + m_phase;
	return compressed + m_bend * Vec3d( std::sin( angle.y() ), std::sin( angle.z() ), std::sin( angle.x() ) );
}

// map() is M x + bend ( sin t_y, sin t_z, sin t_x ) with t = W M x + phase: its derivative's transpose, times a vector.
Vec3d ShardSpace::pulledBack( const Vec3d& at, const Vec3d& vector ) const
{
	const Vec3d angle = m_wave * ( m_metric * at ) + m_phase;
	const Vec3d turned( vector.z() * std::cos( angle.x() ), vector.x() * std::cos( angle.y() ), vector.y() * std::cos( angle.z() ) );
	return m_metric.transpose() * ( vector + m_bend * ( m_wave.transpose() * turned ) );
}

void ShardCentreSet::openGrid( const Vec3d& low, const Vec3d& high )
{
	m_low = low;
	for ( int axis = 0; axis < 3; ++axis )
	{
		m_bins[axis] = 1 + int( std::min( ( high[axis] - low[axis] ) / m_size, double( kMostShardBins - 1 ) ) );
	}
	m_first.assign( std::size_t( m_bins.prod() ), kNone );
}

Eigen::Vector3i ShardCentreSet::binOf( const Vec3d& mapped ) const
{
	Eigen::Vector3i bin;
	for ( int axis = 0; axis < 3; ++axis )
	{
		bin[axis] = int( std::clamp( std::floor( ( mapped[axis] - m_low[axis] ) / m_size ), 0.0, double( m_bins[axis] - 1 ) ) );
	}
	return bin;
}

void ShardCentreSet::add( const Vec3d& mapped )
{
	const Eigen::Vector3i bin = binOf( mapped );
	std::uint32_t& first = m_first[std::size_t( ( bin.z() * m_bins.y() + bin.y() ) * m_bins.x() + bin.x() )];
	m_next.push_back( first );
	first = std::uint32_t( m_centre.size() );
	m_centre.push_back( mapped );
}

ShardCentreSet::ShardCentreSet( const ShardSpace& space, double size, const std::vector<Vec3d>& centres ) : m_space( space ), m_size( size )
{
	Vec3d low = Vec3d::Constant( std::numeric_limits<double>::max() ), high = -low;
	for ( const Vec3d& centre : centres )
	{
		low = low.cwiseMin( m_space.map( centre ) );
		high = high.cwiseMax( m_space.map( centre ) );
	}
	openGrid( low, high );
	for ( const Vec3d& centre : centres )
	{
		add( m_space.map( centre ) );
	}
}

// Bins are visited in shells about the position's own one. Positions and centres outside of the grid count to its outermost bins, so that a
// shell's distance holds only for the axes along which the position is inside; the search ends where all bins have been visited.
std::uint32_t ShardCentreSet::nearestMapped( const Vec3d& mapped, double& square ) const
{
	const Eigen::Vector3i own = binOf( mapped );
	std::uint32_t found = kNone;
	square = std::numeric_limits<double>::infinity();
	const int most = m_bins.maxCoeff();
	for ( int shell = 0; shell < most; ++shell )
	{
		const double within = ( shell - 1 ) * m_size; // everything nearer than this has been visited
		if ( found != kNone && within > 0.0 && within * within > square )
		{
			break;
		}
		const Eigen::Vector3i low = ( own.array() - shell ).max( 0 ), high = ( own.array() + shell ).min( m_bins.array() - 1 );
		for ( int z = low.z(); z <= high.z(); ++z )
		{
			for ( int y = low.y(); y <= high.y(); ++y )
			{
				const bool isEdge = std::abs( z - own.z() ) == shell || std::abs( y - own.y() ) == shell;
				for ( int x = low.x(); x <= high.x(); ++x )
				{
					const bool isInShell = isEdge || std::abs( x - own.x() ) == shell;
					std::uint32_t centre = isInShell ? m_first[std::size_t( ( z * m_bins.y() + y ) * m_bins.x() + x )] : kNone;
					for ( ; centre != kNone; centre = m_next[centre] )
					{
						const double away = ( m_centre[centre] - mapped ).squaredNorm();
						if ( away < square || ( away == square && centre < found ) )
						{
							square = away;
							found = centre;
						}
					}
				}
			}
		}
	}
	return found;
}

std::uint32_t ShardCentreSet::nearest( const Vec3d& at ) const
{
	double square = 0.0;
	return m_centre.empty() ? kNone : nearestMapped( m_space.map( at ), square );
}

// Cells in random order become centres where none is near yet: random sequential adsorption. Its centres are 1.15 of their least distance
// apart in the mean (kShardSpacing).
ShardCentreSet ShardCentreSet::scattered( const Lattice& lattice, const ShardSpace& space, double size, unsigned seed )
{
	const std::size_t cells = std::size_t( lattice.cellCount() );
	const double least = size / kShardSpacing;
	ShardCentreSet set( space, least );
	std::vector<std::pair<std::uint32_t, std::uint32_t>> order;
	std::vector<Vec3d> mapped;
	Vec3d low = Vec3d::Constant( std::numeric_limits<double>::max() ), high = -low;
	for ( std::uint32_t cell = 0; cell < std::uint32_t( cells ); ++cell )
	{
		order.emplace_back( hashed( cell, seed ), cell );
		const Vec3d off( signedFraction( 3 * cell, ~seed ), signedFraction( 3 * cell + 1, ~seed ), signedFraction( 3 * cell + 2, ~seed ) );
		mapped.push_back( space.map( restOf( lattice, cell ) + 0.5 * double( lattice.cellSize ) * off ) );
		low = low.cwiseMin( mapped.back() );
		high = high.cwiseMax( mapped.back() );
	}
	std::sort( order.begin(), order.end() );
	set.openGrid( low, high );
	for ( const auto& [number, cell] : order )
	{
		double square = 0.0;
		if ( set.nearestMapped( mapped[cell], square ) == kNone || square > least * least )
		{
			set.add( mapped[cell] );
		}
	}
	return set;
}

// Rings of a width that grows with the radius; a ring has as many sectors as give shards about as wide as long, by doublings, so that
// sectors of neighbouring rings meet.
ShardCentreSet ShardCentreSet::rings(
	const Lattice& lattice, const ShardSpace& space, double size, const Vec3d& point, const Vec3d& axis, unsigned seed )
{
	double reach = 0.0;
	for ( std::size_t cell = 0; cell < std::size_t( lattice.cellCount() ); ++cell )
	{
		const Vec3d away = restOf( lattice, cell ) - point;
		reach = std::max( reach, ( away - away.dot( axis ) * axis ).norm() );
	}
	const Vec3d across = axis.unitOrthogonal(), along = axis.cross( across );
	std::vector<Vec3d> centres( 1, point );
	double inner = 0.5 * size;
	int sectors = kFirstSectors;
	for ( std::uint32_t ring = 0; inner < reach && ring < kMostRings; ++ring )
	{
		const double width = std::max( size, kRingGrowth * inner ), middle = inner + 0.5 * width;
		while ( 2.0 * kPi * middle / sectors > 2.0 * width )
		{
			sectors *= 2;
		}
		for ( int k = 0; k < sectors; ++k )
		{
			// Sectors keep their direction from ring to ring: the jitter is that of the coarsest division that has this border.
			const std::uint32_t spoke = std::uint32_t( std::lround( 4096.0 * k / sectors ) );
			const double turn = kSpokeJitter * signedFraction( spoke, seed );
			const double angle = 2.0 * kPi * ( k + 0.5 + turn ) / sectors;
			const double radius = middle + kSpokeJitter * width * signedFraction( spoke + 8192u * ring, ~seed );
			centres.push_back( point + radius * ( std::cos( angle ) * across + std::sin( angle ) * along ) );
		}
		inner += width;
	}
	return ShardCentreSet( space, size, centres );
}

double ShardCentreSet::borderBetween( const Vec3d& a, std::uint32_t centreA, const Vec3d& b, std::uint32_t centreB, Vec3d& normal ) const
{
	// Below 0 nearer to A's centre. Half the difference of squared distances, over the distance of the centres.
	const Vec3d between = m_centre[centreB] - m_centre[centreA], middle = 0.5 * ( m_centre[centreB] + m_centre[centreA] );
	const auto side = [&]( const Vec3d& at ) { return between.dot( m_space.map( at ) - middle ); };
	double low = 0.0, high = 1.0, sideLow = side( a ), sideHigh = side( b );
	double fraction = 0.5;
	for ( int step = 0; step < kBorderSteps && sideLow < 0.0 && sideHigh > 0.0; ++step )
	{
		fraction = low + ( high - low ) * std::clamp( sideLow / ( sideLow - sideHigh ), 0.1, 0.9 );
		const double at = side( a + fraction * ( b - a ) );
		( at < 0.0 ? low : high ) = fraction;
		( at < 0.0 ? sideLow : sideHigh ) = at;
	}
	normal = m_space.pulledBack( a + fraction * ( b - a ), between );
	const double length = normal.norm();
	normal = length > 0.0 ? Vec3d( normal / length ) : Vec3d( ( b - a ).normalized() );
	return fraction;
}

Vec3d thinnestDirection( const Lattice& lattice )
{
	Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
	for ( std::size_t cell = 0; cell < std::size_t( lattice.cellCount() ); ++cell )
	{
		const Vec3d at = lattice.restCentre[cell].cast<double>();
		spread += double( lattice.fill[cell] ) * at * at.transpose();
	}
	const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver( spread );
	return solver.eigenvectors().col( 0 );
}

} // namespace pliant
