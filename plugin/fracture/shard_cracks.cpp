#include "fracture/shard_cracks.h"

#include "fracture/constants.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <queue>
#include <tuple>
#include <utility>

namespace pliant {

bool ShardCracks::findOverloads( const Lattice& lattice, const LinkLimits& limits, const CellPositions& positions )
{
	m_overloads.clear();
	m_moments.update( lattice, positions );
	std::vector<std::uint32_t> stretched;
	for ( std::uint32_t i = 0; i < std::uint32_t( lattice.cellCount() ); ++i )
	{
		for ( std::uint32_t k = limits.start[i]; m_moments.isNode( i ) && k < limits.start[i + 1]; ++k )
		{
			const std::uint32_t j = limits.to[k];
			if ( m_moments.isNode( j ) && m_moments.distanceSquared( i, j ) > limits.lengthSquared[k] )
			{
				stretched.push_back( i );
				stretched.push_back( j );
			}
		}
	}
	std::sort( stretched.begin(), stretched.end() );
	stretched.erase( std::unique( stretched.begin(), stretched.end() ), stretched.end() );
	const double strength = double( m_law.breakStrain );
	for ( const std::uint32_t i : stretched )
	{
		if ( !positions.mayBreak( i ) || isStretchedLess( m_moments.of( i ).deformation(), strength * double( limits.weakest ) ) )
		{
			continue;
		}
		// The measure over the neighbours as well: otherwise every step of a slanted surface would be a notch. A neck breaks in any case.
		const Stretch near = largestStretch( m_moments.of( i ).deformation() );
		const Stretch wide = largestStretch( m_moments.around( i ).deformation() );
		const double toughness = toughnessAlong( lattice, limits, i, wide.axis ), limit = strength * toughness;
		const double factor = double( positions.strainFactor( i ) ), nearExcess = near.strain / ( limit * factor );
		const double neck = nearExcess > double( kNeckFactor ) ? 1.0 + nearExcess - double( kNeckFactor ) : 0.0;
		const double excess = std::max( wide.strain / ( limit * factor ), neck );
		if ( excess > 1.0 )
		{
			m_overloads.push_back( Overload{ i, float( excess ), wide.axis } );
		}
	}
	return !m_overloads.empty();
}

/// What run() measures: the borders between shards, and the strain energy of shards and crumbs.
struct ShardCracks::Event
{
	static constexpr std::uint32_t kNone = 0xffffffffu;

	struct Border
	{
		std::uint32_t shard[2];                         ///< local numbers, ascending
		Eigen::Matrix3d now = Eigen::Matrix3d::Zero();  ///< sum p q^T over its links
		Eigen::Matrix3d rest = Eigen::Matrix3d::Zero(); ///< sum q q^T
		Eigen::Matrix3d deformation = Eigen::Matrix3d::Zero();
		Vec3d across = Vec3d::Zero(); ///< its area times its normal, towards the second shard, m^2
		Vec3d middle = Vec3d::Zero(); ///< at rest
		double toughness = 0.0;       ///< factor on the break strain, the mean over links that can break
		int links = 0;                ///< that can break
		bool isBroken = false;
		unsigned visit = 0; ///< the crack that last looked at it
	};
	struct Crack
	{
		Vec3d point, normal; ///< at rest
		Vec3d low, high;     ///< bounding box of its borders' middles
	};

	const Lattice& lattice;
	const LinkLimits& limits;
	const std::vector<Vec3d>& at;
	const ShardLaw& law;
	double size; ///< of shards, m

	std::vector<std::uint32_t> shard; ///< by cell: local number
	std::vector<double> energy, left; ///< by shard, J: all, and what cracks have not used
	std::vector<Vec3d> centre;        ///< by shard, at rest
	std::vector<double> cellEnergy;   ///< J
	std::vector<Border> borders;
	std::vector<std::vector<std::uint32_t>> bordersOf; ///< by shard
	std::vector<std::uint32_t> borderOfLink;           ///< by link of the limits
	std::vector<Crack> cracks;

	Event( const ShardCracks& own, const Lattice& l, const LinkLimits& k, const std::vector<Vec3d>& positions ) :
		lattice( l ), limits( k ), at( positions ), law( own.m_law ), size( own.m_size )
	{
		numberShards( own.m_shard );
		measureEnergy();
		findBorders();
	}

	Vec3d rest( std::uint32_t cell ) const { return lattice.restCentre[cell].cast<double>(); }

	void numberShards( const std::vector<std::uint32_t>& number )
	{
		std::vector<std::uint32_t> local( std::size_t( *std::max_element( number.begin(), number.end() ) ) + 1, kNone );
		std::vector<double> mass;
		for ( std::size_t cell = 0; cell < number.size(); ++cell )
		{
			std::uint32_t& own = local[number[cell]];
			if ( own == kNone )
			{
				own = std::uint32_t( centre.size() );
				centre.push_back( Vec3d::Zero() );
				mass.push_back( 0.0 );
			}
			shard.push_back( own );
			centre[own] += double( lattice.fill[cell] ) * rest( std::uint32_t( cell ) );
			mass[own] += double( lattice.fill[cell] );
		}
		for ( std::size_t s = 0; s < centre.size(); ++s )
		{
			centre[s] /= mass[s];
		}
	}

	/// E e^2 / 2 a volume, from the strains of each cell's links (kLinkEnergyFactor).
	void measureEnergy()
	{
		const std::size_t cells = shard.size();
		cellEnergy.assign( cells, 0.0 );
		for ( std::uint32_t a = 0; a < std::uint32_t( cells ); ++a )
		{
			for ( std::uint32_t k = limits.start[a]; k < limits.start[a + 1]; ++k )
			{
				const std::uint32_t b = limits.to[k];
				const double strain = std::sqrt( ( at[b] - at[a] ).squaredNorm() / ( rest( b ) - rest( a ) ).squaredNorm() ) - 1.0;
				cellEnergy[a] += strain * strain;
				cellEnergy[b] += strain * strain;
			}
		}
		energy.assign( centre.size(), 0.0 );
		const double d = double( lattice.cellSize ), most = 0.5 * kLinkEnergyFactor * law.youngsModulus * d * d * d;
		for ( std::size_t cell = 0; cell < cells; ++cell )
		{
			const double links = double( lattice.linkStart[cell + 1] - lattice.linkStart[cell] );
			cellEnergy[cell] *= links > 0.0 ? most * double( lattice.fill[cell] ) / links : 0.0;
			energy[shard[cell]] += cellEnergy[cell];
		}
		left = energy;
	}

	std::uint32_t borderBetween( std::uint32_t a, std::uint32_t b )
	{
		for ( const std::uint32_t border : bordersOf[a] )
		{
			if ( borders[border].shard[0] == b || borders[border].shard[1] == b )
			{
				return border;
			}
		}
		const std::uint32_t border = std::uint32_t( borders.size() );
		borders.emplace_back();
		borders.back().shard[0] = std::min( a, b );
		borders.back().shard[1] = std::max( a, b );
		bordersOf[a].push_back( border );
		bordersOf[b].push_back( border );
		return border;
	}

	void findBorders()
	{
		bordersOf.resize( centre.size() );
		borderOfLink.assign( limits.to.size(), kNone );
		for ( std::uint32_t a = 0; a < std::uint32_t( shard.size() ); ++a )
		{
			for ( std::uint32_t k = limits.start[a]; k < limits.start[a + 1]; ++k )
			{
				const std::uint32_t b = limits.to[k];
				if ( shard[a] != shard[b] )
				{
					borderOfLink[k] = borderBetween( shard[a], shard[b] );
					addLink( borders[borderOfLink[k]], a, b, limits.toughness.empty() ? 1.0 : double( limits.toughness[k] ) );
				}
			}
		}
		for ( Border& border : borders )
		{
			border.deformation = border.now * inverseOfRest( border.rest );
			border.toughness /= std::max( 1, border.links );
		}
	}

	void addLink( Border& border, std::uint32_t a, std::uint32_t b, double toughness )
	{
		const Vec3d q = rest( b ) - rest( a ), p = at[b] - at[a];
		border.now += p * q.transpose();
		border.rest += q * q.transpose();
		const auto steps = lattice.coordinate[b].cast<int>() - lattice.coordinate[a].cast<int>();
		if ( steps.cwiseAbs().sum() == 1 )
		{
			const double d = double( lattice.cellSize ), fill = 0.5 * double( lattice.fill[a] + lattice.fill[b] );
			border.across += ( shard[a] == border.shard[0] ? d * d * fill : -d * d * fill ) * steps.cast<double>();
		}
		if ( std::isfinite( toughness ) )
		{
			border.middle = ( border.links * border.middle + 0.5 * ( rest( a ) + rest( b ) ) ) / ( border.links + 1.0 );
			border.toughness += toughness;
			++border.links;
		}
	}

	/// Stretch across a plane, in break strains of the border.
	double pullOn( const Border& border, const Vec3d& normal ) const
	{
		return ( ( border.deformation * normal ).norm() - 1.0 ) / ( double( law.breakStrain ) * border.toughness );
	}

	/// Whether the border opens in a crack across `normal`.
	bool opens( const Border& border, const Vec3d& normal ) const
	{
		return border.links > 0 && !border.isBroken && pullOn( border, normal ) > kOpensAt &&
			left[border.shard[0]] + left[border.shard[1]] > costOf( border );
	}

	double costOf( const Border& border ) const { return law.toughness * border.toughness * border.toughness * border.across.norm(); }

	void open( Border& border )
	{
		border.isBroken = true;
		double &a = left[border.shard[0]], &b = left[border.shard[1]];
		const double kept = std::max( 0.0, 1.0 - costOf( border ) / ( a + b ) ); // a + b > 0: it opens
		a *= kept;
		b *= kept;
	}

	/// A crack unloads the material beside it over a distance of its length, less where the load is many times what it takes.
	bool isShielded( const Overload& overload ) const
	{
		const Vec3d place = rest( overload.cell );
		const double excess = double( overload.excess );
		return std::any_of( cracks.begin(), cracks.end(), [&]( const Crack& crack ) {
			const double away = ( place - place.cwiseMax( crack.low ).cwiseMin( crack.high ) ).norm();
			return std::fabs( crack.normal.dot( overload.normal ) ) > kSameCrackCosine &&
				away * excess * excess < size + 0.5 * ( crack.high - crack.low ).norm();
		} );
	}

	/// The border of the cell's shard that lies best across the pull; kNone where none opens.
	std::uint32_t startOf( const Overload& overload ) const
	{
		std::uint32_t best = kNone;
		double most = 0.0;
		for ( const std::uint32_t b : bordersOf[shard[overload.cell]] )
		{
			const Border& border = borders[b];
			const double area = border.across.norm(), cosine = std::fabs( border.across.dot( overload.normal ) ) / std::max( area, 1e-300 );
			if ( cosine > kStartCosine && opens( border, overload.normal ) )
			{
				const double away = ( border.middle - rest( overload.cell ) ).norm();
				const double score = pullOn( border, overload.normal ) * cosine * cosine / ( 1.0 + away / size );
				best = score > most ? b : best;
				most = std::max( most, score );
			}
		}
		return best;
	}

	/// Opens borders between shards above and below the plane through the first one, the most stretched first, each connected to others by
	/// a shard.
	void runFrom( std::uint32_t start, const Vec3d& normal )
	{
		Crack crack{ borders[start].middle, normal, borders[start].middle, borders[start].middle };
		const unsigned visit = unsigned( cracks.size() ) + 1;
		std::priority_queue<std::pair<double, std::uint32_t>> front;
		front.emplace( pullOn( borders[start], normal ), ~start );
		borders[start].visit = visit;
		while ( !front.empty() )
		{
			const std::uint32_t b = ~front.top().second;
			front.pop();
			Border& border = borders[b];
			if ( !opens( border, normal ) )
			{
				continue; // its shards' energy has been used
			}
			open( border );
			crack.low = crack.low.cwiseMin( border.middle );
			crack.high = crack.high.cwiseMax( border.middle );
			for ( const std::uint32_t side : border.shard )
			{
				for ( const std::uint32_t next : bordersOf[side] )
				{
					if ( borders[next].visit != visit && isCrossed( borders[next], crack ) )
					{
						borders[next].visit = visit;
						front.emplace( pullOn( borders[next], normal ), ~next );
					}
				}
			}
		}
		cracks.push_back( crack );
	}

	bool isCrossed( const Border& border, const Crack& crack ) const
	{
		const double a = crack.normal.dot( centre[border.shard[0]] - crack.point );
		const double b = crack.normal.dot( centre[border.shard[1]] - crack.point );
		return ( a < 0.0 ) != ( b < 0.0 );
	}

	/// Cells that come off as crumbs: where the energy left suffices for a crumb's whole surface.
	std::vector<std::uint8_t> crumble( const std::vector<std::uint32_t>& crumb, const std::vector<Overload>& overloads, double& mass ) const
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
			own.energy += energy[shard[a]] > 0.0 ? cellEnergy[a] * left[shard[a]] / energy[shard[a]] : 0.0;
			own.mass += double( lattice.fill[a] );
			for ( std::uint32_t k = lattice.linkStart[a]; k < lattice.linkStart[a + 1]; ++k )
			{
				const std::uint32_t b = lattice.linkTo[k];
				const bool isFace = ( lattice.coordinate[a].cast<int>() - lattice.coordinate[b].cast<int>() ).cwiseAbs().sum() == 1;
				own.faces += isFace && crumb[b] != crumb[a] ? 0.5 * double( lattice.fill[a] + lattice.fill[b] ) : 0.0;
			}
		}
		for ( const Overload& overload : overloads )
		{
			all[crumb[overload.cell] - first].isOverloaded = true;
		}
		std::vector<std::pair<double, std::uint32_t>> order; // densest energy first
		const double face = double( lattice.cellSize ) * double( lattice.cellSize ) / kStairs;
		for ( std::uint32_t c = 0; c < std::uint32_t( all.size() ); ++c )
		{
			if ( all[c].isOverloaded && all[c].faces > 0.0 && all[c].energy > law.toughness * face * all[c].faces )
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
};

void ShardCracks::run( const Lattice& lattice, const LinkLimits& limits, const std::vector<Vec3d>& at, std::vector<CellLink>& broken )
{
	std::sort( m_overloads.begin(), m_overloads.end(),
		[]( const Overload& a, const Overload& b ) { return std::tie( b.excess, a.cell ) < std::tie( a.excess, b.cell ); } );
	if ( m_awaitsImpact )
	{
		divide( lattice, lattice.massCentre + lattice.restCentre[m_overloads.front().cell].cast<double>(), {} );
	}
	Event event( *this, lattice, limits, at );
	for ( const Overload& overload : m_overloads )
	{
		const std::uint32_t start = event.isShielded( overload ) ? Event::kNone : event.startOf( overload );
		if ( start != Event::kNone )
		{
			event.runFrom( start, overload.normal );
		}
	}
	std::vector<std::uint8_t> isCrumb;
	if ( !m_crumb.empty() && m_crumbMass > 0.0 )
	{
		isCrumb = event.crumble( m_crumb, m_overloads, m_crumbMass );
		for ( std::size_t cell = 0; cell < isCrumb.size(); ++cell )
		{
			m_shard[cell] = isCrumb[cell] != 0 ? m_crumb[cell] : m_shard[cell];
		}
		findOne();
	}
	for ( std::uint32_t a = 0; a < std::uint32_t( lattice.cellCount() ); ++a )
	{
		for ( std::uint32_t k = limits.start[a]; k < limits.start[a + 1]; ++k )
		{
			const std::uint32_t b = limits.to[k], border = event.borderOfLink[k];
			const bool isTough = !limits.toughness.empty() && std::isinf( limits.toughness[k] );
			const bool comesOff = !isCrumb.empty() && ( isCrumb[a] | isCrumb[b] ) != 0 && m_shard[a] != m_shard[b];
			if ( !isTough && ( comesOff || ( border != Event::kNone && event.borders[border].isBroken ) ) )
			{
				broken.push_back( CellLink{ a, b } );
			}
		}
	}
}

} // namespace pliant
