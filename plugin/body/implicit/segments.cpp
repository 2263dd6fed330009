#include "body/implicit/segments.h"

#include "body/constants.h"
#include "lattice/axis_neighbours.h"
#include "lattice/union_find.h"
#include "matching/rotation.h"

#include <algorithm>
#include <array>

namespace pliant {

void Segments::layOut( const Lattice& lattice )
{
	int edge = kLeastSegmentEdge;
	do
	{
		divide( lattice, edge++ );
		listLinks( lattice );
	} while ( int( m_pairs.size() ) > kMostSegmentPairs && edge <= kLargestSegmentEdge );
	m_runs.clear();
	for ( int i = 0; i < lattice.cellCount(); ++i )
	{
		if ( m_runs.empty() || m_runs.back().segment != of( i ) )
		{
			m_runs.push_back( Run{ i, i, of( i ) } );
		}
		m_runs.back().end = i + 1;
	}
}

void Segments::divide( const Lattice& lattice, int edge )
{
	const std::uint32_t cells = std::uint32_t( lattice.cellCount() );
	std::vector<Eigen::Vector3i> cube( cells );
	for ( std::uint32_t i = 0; i < cells; ++i )
	{
		cube[i] = lattice.coordinate[i].cast<int>() / edge;
	}
	UnionFind groups( cells );
	for ( std::uint32_t i = 0; i < cells; ++i )
	{
		for ( std::uint32_t k = lattice.linkStart[i]; k < lattice.linkStart[i + 1] && lattice.linkTo[k] < i; ++k )
		{
			if ( cube[i] == cube[lattice.linkTo[k]] )
			{
				groups.join( i, lattice.linkTo[k] );
			}
		}
	}
	m_count = 0;
	m_of.assign( cells, -1 );
	for ( std::uint32_t i = 0; i < cells; ++i )
	{
		const std::uint32_t lowest = groups.find( i );
		m_of[i] = lowest == i ? m_count++ : m_of[lowest];
	}
}

void Segments::listLinks( const Lattice& lattice )
{
	struct Link
	{
		int first, second;
		bool isDiagonal;
		int i, j;
	};
	std::vector<Link> links;
	for ( std::uint32_t i = 0; i < std::uint32_t( lattice.cellCount() ); ++i )
	{
		for ( std::uint32_t k = lattice.linkStart[i]; k < lattice.linkStart[i + 1]; ++k )
		{
			const std::uint32_t j = lattice.linkTo[k];
			if ( m_of[i] > m_of[j] )
			{
				links.push_back( Link{ m_of[i], m_of[j], !shareFace( lattice, i, j ), int( i ), int( j ) } );
			}
		}
	}
	std::stable_sort( links.begin(), links.end(), []( const Link& a, const Link& b ) {
		return std::array<int, 3>{ a.second, a.first, a.isDiagonal } < std::array<int, 3>{ b.second, b.first, b.isDiagonal };
	} );
	m_links.clear();
	m_pairs.clear();
	bool hasFaces = false;
	for ( const Link& link : links )
	{
		if ( m_pairs.empty() || m_pairs.back().first != link.first || m_pairs.back().second != link.second )
		{
			m_pairs.push_back( Pair{ link.first, link.second, int( m_links.size() ), int( m_links.size() ) } );
			hasFaces = !link.isDiagonal;
		}
		if ( !link.isDiagonal || !hasFaces ) // diagonal links count only where there are no others
		{
			m_links.emplace_back( link.i, link.j );
			m_pairs.back().linkEnd = int( m_links.size() );
		}
	}
}

// D = V_a + W_a x r_a - V_b - W_b x r_b
void Segments::measure( const NodeState& nodes, double cellSize, const float* resistance, double stiffness )
{
	const double square = cellSize * cellSize;
	std::vector<double> mass( std::size_t( m_count ), 0.0 );
	m_centre.assign( std::size_t( m_count ), Eigen::Vector3d::Zero() );
	m_own.assign( std::size_t( m_count ), Matrix6::Zero() );
	for ( int i = 0; i < nodes.count; ++i )
	{
		const std::size_t s = std::size_t( m_of[std::size_t( i )] );
		mass[s] += double( nodes.mass[i] );
		m_centre[s] += double( nodes.mass[i] ) * nodes.x.get( i ).cast<double>();
	}
	for ( int s = 0; s < m_count; ++s )
	{
		m_centre[std::size_t( s )] /= mass[std::size_t( s )];
		m_own[std::size_t( s )].diagonal() << Eigen::Vector3d::Constant( mass[std::size_t( s )] ),
			Eigen::Vector3d::Constant( kLeastSegmentMoment * square * mass[std::size_t( s )] );
	}
	for ( AlignedArray<float>& arms : m_arm )
	{
		arms.resize( std::size_t( nodes.padded ) );
	}
	for ( int i = 0; i < nodes.count; ++i )
	{
		const std::size_t s = std::size_t( m_of[std::size_t( i )] );
		const Eigen::Vector3d arm = nodes.x.get( i ).cast<double>() - m_centre[s];
		for ( int k = 0; k < 3; ++k )
		{
			m_arm[k][std::size_t( i )] = float( arm[k] );
		}
		m_own[s].bottomRightCorner<3, 3>() += double( nodes.mass[i] ) *
			( arm.squaredNorm() * Eigen::Matrix3d::Identity() - arm * arm.transpose() );
	}
	for ( Pair& pair : m_pairs )
	{
		const std::size_t a = std::size_t( pair.first ), b = std::size_t( pair.second );
		pair.coupling.setZero();
		for ( int k = pair.linkStart; k < pair.linkEnd; ++k )
		{
			const auto [i, j] = m_links[std::size_t( k )];
			const double s = kLinkResistance * stiffness * double( nodes.mass[i] * resistance[i] + nodes.mass[j] * resistance[j] );
			const Eigen::Vector3d middle = 0.5 * ( nodes.x.get( i ) + nodes.x.get( j ) ).cast<double>();
			const Eigen::Matrix3d ra = crossMatrix( middle - m_centre[a] ), rb = crossMatrix( middle - m_centre[b] );
			const Eigen::Matrix3d twist = ( s * kSegmentTwist * square ) * Eigen::Matrix3d::Identity();
			// J = ( 1, -[r] ):   J_a^T J_b = ( 1, -[r_b]; [r_a], -[r_a] [r_b] )
			const auto add = [s]( Matrix6& to, double sign, const Eigen::Matrix3d& r, const Eigen::Matrix3d& q,
								 const Eigen::Matrix3d& own ) {
				to.topLeftCorner<3, 3>().diagonal().array() += sign * s;
				to.topRightCorner<3, 3>() -= ( sign * s ) * q;
				to.bottomLeftCorner<3, 3>() += ( sign * s ) * r;
				to.bottomRightCorner<3, 3>() += sign * ( own - s * r * q );
			};
			add( m_own[a], 1.0, ra, ra, twist );
			add( m_own[b], 1.0, rb, rb, twist );
			add( pair.coupling, -1.0, ra, rb, twist );
		}
	}
}

void Segments::hold( int node, double resistance )
{
	const std::size_t i = std::size_t( node );
	const Eigen::Matrix3d r = crossMatrix( Eigen::Vector3f( m_arm[0][i], m_arm[1][i], m_arm[2][i] ).cast<double>() );
	Matrix6& own = m_own[std::size_t( of( node ) )];
	own.topLeftCorner<3, 3>().diagonal().array() += resistance;
	own.topRightCorner<3, 3>() -= resistance * r;
	own.bottomLeftCorner<3, 3>() += resistance * r;
	own.bottomRightCorner<3, 3>() -= resistance * r * r;
}

void Segments::sum( const NodeState& nodes, const float* r, double* sums ) const
{
	std::fill_n( sums, 6 * m_count, 0.0 );
	const float *const rx = r, *const ry = r + nodes.padded, *const rz = r + 2 * nodes.padded;
	for ( const Run& run : m_runs )
	{
		double f[3] = {}, t[3] = {};
		for ( int i = run.begin; i < run.end; ++i )
		{
			const double free = double( nodes.freedom[i] );
			const double x = free * double( rx[i] ), y = free * double( ry[i] ), z = free * double( rz[i] );
			const double a = double( m_arm[0][i] ), b = double( m_arm[1][i] ), c = double( m_arm[2][i] );
			f[0] += x;
			f[1] += y;
			f[2] += z;
			t[0] += b * z - c * y;
			t[1] += c * x - a * z;
			t[2] += a * y - b * x;
		}
		double* const to = sums + 6 * run.segment;
		for ( int k = 0; k < 3; ++k )
		{
			to[k] += f[k];
			to[3 + k] += t[k];
		}
	}
}

void Segments::addMotions( const NodeState& nodes, const double* motions, float* z ) const
{
	float *const zx = z, *const zy = z + nodes.padded, *const zz = z + 2 * nodes.padded;
	for ( const Run& run : m_runs )
	{
		float v[6];
		std::transform( motions + 6 * run.segment, motions + 6 * run.segment + 6, v, []( double each ) { return float( each ); } );
		for ( int i = run.begin; i < run.end; ++i )
		{
			const float free = nodes.freedom[i], a = m_arm[0][i], b = m_arm[1][i], c = m_arm[2][i];
			zx[i] += free * ( v[0] + ( v[4] * c - v[5] * b ) );
			zy[i] += free * ( v[1] + ( v[5] * a - v[3] * c ) );
			zz[i] += free * ( v[2] + ( v[3] * b - v[4] * a ) );
		}
	}
}

} // namespace pliant
