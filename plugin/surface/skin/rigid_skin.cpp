#include "surface/skin/rigid_skin.h"

#include "matching/rotation.h"
#include "surface/constants.h"
#include "threads/parallel.h"

#include <algorithm>

namespace pliant {

namespace {

/// Vector extension of all supported compilers, for unaligned memory.
using Unaligned4 = float __attribute__( ( vector_size( 16 ), aligned( 4 ), may_alias ) );

Unaligned4 loadUnaligned4( const float* p )
{
	return *reinterpret_cast<const Unaligned4*>( p );
}

void storeUnaligned4( float* p, Unaligned4 a )
{
	*reinterpret_cast<Unaligned4*>( p ) = a;
}

/// R p + t of four consecutive vertices, as three times four numbers: x0 y0 z0 x1 | y1 z1 x2 y2 | z2 x3 y3 z3. Each number is multiplied by
/// its row's diagonal entry, and the next two in the cycle x y z x by the other entries.
struct Turn
{
	Unaligned4 own[3], next[3], last[3], shift[3];

	Turn( const Eigen::Matrix3f& r, const Eigen::Vector3f& t )
	{
		for ( int k = 0; k < 12; ++k )
		{
			const int row = k % 3;
			own[k / 4][k % 4] = r( row, row );
			next[k / 4][k % 4] = r( row, ( row + 1 ) % 3 );
			last[k / 4][k % 4] = r( row, ( row + 2 ) % 3 );
			shift[k / 4][k % 4] = t[row];
		}
	}

	void four( const float* from, float* to ) const
	{
		const Unaligned4 a = loadUnaligned4( from ), b = loadUnaligned4( from + 4 ), c = loadUnaligned4( from + 8 );
		const Unaligned4 na = __builtin_shufflevector( a, b, 1, 2, 0, 4 ), la = __builtin_shufflevector( a, b, 2, 0, 1, 5 );
		const Unaligned4 nb = __builtin_shufflevector( __builtin_shufflevector( a, b, 3, 5, 7, -1 ), c, 1, 0, 2, 4 );
		const Unaligned4 lb = __builtin_shufflevector( __builtin_shufflevector( a, b, 3, 4, 6, -1 ), c, 0, 1, 4, 2 );
		const Unaligned4 nc = __builtin_shufflevector( b, c, 2, 6, 7, 5 ), lc = __builtin_shufflevector( b, c, 3, 7, 5, 6 );
		storeUnaligned4( to, ( ( own[0] * a + next[0] * na ) + last[0] * la ) + shift[0] );
		storeUnaligned4( to + 4, ( ( own[1] * b + next[1] * nb ) + last[1] * lb ) + shift[1] );
		storeUnaligned4( to + 8, ( ( own[2] * c + next[2] * nc ) + last[2] * lc ) + shift[2] );
	}
};

/// Transforms groups first to last - 1 of four vertices; the last group may have fewer.
void turnGroups( const Turn& turn, const std::vector<float>& from, std::vector<float>& to, int first, int last )
{
	for ( int group = first; group < last; ++group )
	{
		const std::size_t at = 12 * std::size_t( group );
		if ( at + 12 <= from.size() )
		{
			turn.four( from.data() + at, to.data() + at );
			continue;
		}
		float in[12] = {}, out[12];
		std::copy( from.begin() + std::ptrdiff_t( at ), from.end(), in );
		turn.four( in, out );
		std::copy( out, out + ( from.size() - at ), to.begin() + std::ptrdiff_t( at ) );
	}
}

Eigen::Vector3d positionIn( const std::vector<float>& positions, int i )
{
	return Eigen::Map<const Eigen::Vector3f>( positions.data() + 3 * std::size_t( i ) ).cast<double>();
}

} // namespace

void RigidSkin::keep( const NodeState& nodes, const float* rotations, const float* flow, bool hasGradients )
{
	const std::size_t count = std::size_t( nodes.count );
	m_position.resize( 3 * count );
	for ( int i = 0; i < nodes.count; ++i )
	{
		Eigen::Map<Eigen::Vector3f>( m_position.data() + 3 * std::size_t( i ) ) = nodes.x.get( i );
	}
	m_rotation.assign( rotations, rotations + 4 * count );
	m_flow.clear();
	if ( flow )
	{
		m_flow.assign( flow, flow + 9 * count );
	}
	m_origin = nodes.origin;
	m_shown = Motion{};
	m_isKept = true;
	m_comparesRotations = !hasGradients || areCollinear( nodes );
}

/// True also for coincident nodes: in both cases positions do not determine the rotation.
bool RigidSkin::areCollinear( const NodeState& nodes ) const
{
	Eigen::Vector3d centre = Eigen::Vector3d::Zero();
	for ( int i = 0; i < nodes.count; ++i )
	{
		centre += positionIn( m_position, i ) / double( nodes.count );
	}
	Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
	for ( int i = 0; i < nodes.count; ++i )
	{
		second += ( positionIn( m_position, i ) - centre ) * ( positionIn( m_position, i ) - centre ).transpose();
	}
	// Of eigenvalues a >= b >= c: a b + a c + b c, against ( a + b + c )^2
	const double size = second.trace();
	return !( 0.5 * ( size * size - second.squaredNorm() ) > kLineExtent * size * size );
}

/// The best-fitting rigid motion: R nearest to sum m ( x - c )( p - cp )^T, t = c - R cp.
RigidSkin::Motion RigidSkin::fit( const NodeState& nodes, const float* rotations ) const
{
	Eigen::Vector3d now = Eigen::Vector3d::Zero(), before = Eigen::Vector3d::Zero();
	double mass = 0.0;
	for ( int i = 0; i < nodes.count; ++i )
	{
		const double m = double( nodes.mass[i] );
		mass += m;
		now += m * nodes.x.get( i ).cast<double>();
		before += m * positionIn( m_position, i );
	}
	now /= mass;
	before /= mass;
	Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
	for ( int i = 0; i < nodes.count; ++i )
	{
		sum += double( nodes.mass[i] ) * ( nodes.x.get( i ).cast<double>() - now ) * ( positionIn( m_position, i ) - before ).transpose();
	}
	// Coincident or collinear nodes leave the rotation undetermined: that of the first node is used.
	const Eigen::Quaternionf own( rotations ), kept( m_rotation.data() );
	Motion motion;
	motion.turn = fitRotation( sum, ( own.cast<double>() * kept.cast<double>().conjugate() ).normalized() );
	motion.shift = now - motion.turn * before;
	return motion;
}

bool RigidSkin::follows( const Motion& motion, const NodeState& nodes, const float* rotations, double tolerance, double cell ) const
{
	const double off = kRigidSkinNodeFraction * tolerance, angle = off / cell;
	const Eigen::Matrix3d r = motion.turn.toRotationMatrix();
	for ( int i = 0; i < nodes.count; ++i )
	{
		if ( !( ( r * positionIn( m_position, i ) + motion.shift - nodes.x.get( i ).cast<double>() ).squaredNorm() <= off * off ) )
		{
			return false;
		}
	}
	for ( std::size_t i = 0; m_comparesRotations && i < std::size_t( nodes.count ); ++i )
	{
		// | q - p |^2 = 4 sin^2( angle / 4 ), for the nearer of p and -p
		const Eigen::Quaterniond q( Eigen::Map<const Eigen::Quaternionf>( rotations + 4 * i ).cast<double>() );
		const Eigen::Quaterniond p = motion.turn *
			Eigen::Quaterniond( Eigen::Map<const Eigen::Quaternionf>( m_rotation.data() + 4 * i ).cast<double>() );
		const double apart = std::min( ( q.coeffs() - p.coeffs() ).squaredNorm(), ( q.coeffs() + p.coeffs() ).squaredNorm() );
		if ( !( 4.0 * apart <= angle * angle ) )
		{
			return false;
		}
	}
	return true;
}

RigidSkin::Change RigidSkin::classify( const NodeState& nodes, const float* rotations, const float* flow, double tolerance, double cell )
{
	const std::size_t flowed = flow ? 9 * std::size_t( nodes.count ) : 0;
	const bool isComparable = m_isKept && m_position.size() == 3 * std::size_t( nodes.count ) && m_origin == nodes.origin &&
		m_flow.size() == flowed && std::equal( m_flow.begin(), m_flow.end(), flow );
	if ( !isComparable || !( tolerance > 0.0 ) )
	{
		return Change::Bent;
	}
	if ( follows( m_shown, nodes, rotations, tolerance, cell ) )
	{
		return Change::Still;
	}
	const Motion motion = fit( nodes, rotations );
	if ( !follows( motion, nodes, rotations, tolerance, cell ) )
	{
		return Change::Bent;
	}
	m_shown = motion;
	return Change::Moved;
}

void RigidSkin::turn( const std::vector<float>& positions, const std::vector<float>& normals, std::vector<float>& positionsNow,
	std::vector<float>& normalsNow, TaskRunner* runner ) const
{
	const Eigen::Matrix3f r = m_shown.turn.toRotationMatrix().cast<float>();
	const Turn position( r, m_shown.shift.cast<float>() ), direction( r, Eigen::Vector3f::Zero() );
	positionsNow.resize( positions.size() );
	normalsNow.resize( normals.size() );
	const int groups = int( ( positions.size() + 11 ) / 12 );
	auto task = [&]( int chunk ) {
		const int first = chunk * kSkinGroupsPerTask, last = std::min( groups, first + kSkinGroupsPerTask );
		turnGroups( position, positions, positionsNow, first, last );
		turnGroups( direction, normals, normalsNow, first, last );
	};
	runTasks( runner, ( groups + kSkinGroupsPerTask - 1 ) / kSkinGroupsPerTask, task );
}

} // namespace pliant
