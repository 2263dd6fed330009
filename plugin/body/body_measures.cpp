// Sums and measures over a body's nodes, in double and in a fixed order.

#include "body/body.h"
#include "body/constants.h"
#include "body/levels/levels.h"

#include "matching/constants.h"
#include "matching/matcher.h"
#include "matching/regions/region_moments.h"
#include "matching/rotation.h"

#include <algorithm>
#include <cmath>

namespace pliant {

BodySums Body::sums() const
{
	BodySums sums;
	for ( int i = 0; i < m_nodes.count; ++i )
	{
		const double m = m_nodes.mass[i];
		sums.mass += m;
		sums.centre += m * m_nodes.x.get( i ).cast<double>();
		sums.momentum += m * m_nodes.v.get( i ).cast<double>();
		sums.kineticEnergy += 0.5 * m * m_nodes.v.get( i ).cast<double>().squaredNorm();
	}
	sums.centre /= sums.mass;
	for ( int i = 0; i < m_nodes.count; ++i )
	{
		const Vec3d arm = m_nodes.x.get( i ).cast<double>() - sums.centre;
		sums.spin += double( m_nodes.mass[i] ) * arm.cross( m_nodes.v.get( i ).cast<double>() );
	}
	return sums;
}

Eigen::Matrix3d Body::inertiaAbout( const Vec3d& point ) const
{
	Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
	for ( int i = 0; i < m_nodes.count; ++i )
	{
		const Vec3d arm = m_nodes.x.get( i ).cast<double>() - point;
		second += double( m_nodes.mass[i] ) * arm * arm.transpose();
	}
	return second.trace() * Eigen::Matrix3d::Identity() - second;
}

// Without a least inertia about any axis three nodes at rest that were nearly in line had 94 rad/s about it. Nodes in one point have none.
Eigen::Matrix3d Body::inverseInertia( const BodySums& whole ) const
{
	const Eigen::Matrix3d inertia = inertiaAbout( whole.centre );
	if ( !( inertia.trace() > 0.0 ) )
	{
		return Eigen::Matrix3d::Zero();
	}
	const double cell = double( m_lattice->cellSize ), least = kLeastTurningInertia * whole.mass * cell * cell;
	return flooredInverse( inertia, std::max( kInertiaFloor, least / ( 0.5 * inertia.trace() ) ) );
}

Vec3d Body::angularVelocity() const
{
	const BodySums whole = sums();
	return inverseInertia( whole ) * whole.spin;
}

Vec3d Body::angularVelocityOf( const Vec3d& spin ) const
{
	return inverseInertia( sums() ) * spin;
}

// w^2 L / g of the angular velocity w across `up`, of which 2 v / d is a bound: v the root mean square of the nodes' velocities, d the cell
// size. A rotation about `up`, as on a turntable, changes no strain of a body that lies on something.
double Body::turnFreedom( const Vec3d& up ) const
{
	const double cell = double( m_lattice->cellSize ), least = kRockingTurn * kStandardGravity * m_motion.mass * cell * cell;
	if ( !( 4.0 * m_motion.squareSpeed * m_restLength > least ) || !m_isOnePart || m_nodes.hasHeldNodes() )
	{
		return 0.0;
	}
	return pliant::turnFreedom( angularVelocity(), up, m_restLength );
}

double turnFreedom( const Vec3d& turn, const Vec3d& up, double length )
{
	const double measure = ( turn - turn.dot( up ) * up ).squaredNorm() * length / kStandardGravity;
	const double above = std::clamp( ( measure - kRockingTurn ) / ( kFreeTurn - kRockingTurn ), 0.0, 1.0 );
	return above * above * ( 3.0 - 2.0 * above ); // smooth at both ends
}

// | ( v_j - v_i ) . e | / l,   e the direction from node i to node j, l their distance at rest
double Body::stretchRate( double least ) const
{
	const auto [low, high] = m_nodes.velocityBounds();
	if ( !( double( ( high - low ).norm() ) > least * double( m_lattice->cellSize ) ) )
	{
		return 0.0;
	}
	float most = 0.0f;
	for ( int cell = 0; cell < m_lattice->cellCount(); ++cell )
	{
		const int i = nodeOfCell( std::uint32_t( cell ) );
		for ( std::uint32_t k = m_lattice->linkStart[cell]; k < m_lattice->linkStart[cell + 1]; ++k )
		{
			const int j = nodeOfCell( m_lattice->linkTo[k] );
			if ( j > i )
			{
				const Vec3 apart = m_nodes.x.get( j ) - m_nodes.x.get( i ), velocity = m_nodes.v.get( j ) - m_nodes.v.get( i );
				const float along = velocity.dot( apart );
				most = std::max(
					most, along * along / ( apart.squaredNorm() * ( m_nodes.x0.get( j ) - m_nodes.x0.get( i ) ).squaredNorm() ) );
			}
		}
	}
	return std::sqrt( double( most ) );
}

Placement Body::bestFit( const Eigen::Quaterniond& guess ) const
{
	const BodySums whole = sums();
	Eigen::Matrix3d moment = Eigen::Matrix3d::Zero();
	for ( int i = 0; i < m_nodes.count; ++i )
	{
		const Vec3d p = m_nodes.x.get( i ).cast<double>() - whole.centre;
		moment += double( m_nodes.mass[i] ) * p * m_nodes.x0.get( i ).cast<double>().transpose();
	}
	return Placement{ fitRotation( moment, guess ), m_nodes.origin + whole.centre };
}

std::uint32_t Body::ownCell( std::uint32_t first ) const
{
	if ( m_firstCell.empty() )
	{
		return int( first ) < m_lattice->cellCount() ? first : kNoNode;
	}
	const auto found = std::lower_bound( m_firstCell.begin(), m_firstCell.end(), first );
	return found != m_firstCell.end() && *found == first ? std::uint32_t( found - m_firstCell.begin() ) : kNoNode;
}

std::uint32_t Body::firstCellOfNode( int node ) const
{
	std::uint32_t cell = std::uint32_t( node );
	if ( m_levels )
	{
		const Octree& octree = m_levels->octree();
		const std::uint32_t above = m_levels->cut().node[std::size_t( node )];
		const auto begin = octree.cells.begin() + octree.cellStart[above];
		cell = *std::min_element( begin, begin + octree.cellCount[above] );
	}
	return m_firstCell.empty() ? cell : m_firstCell[cell];
}

int Body::nodeOfCell( std::uint32_t cell ) const
{
	return m_levels ? int( m_levels->cut().slotOfCell[cell] ) : int( cell );
}

std::vector<Vec3d> Body::cellPositions() const
{
	std::vector<Vec3d> positions( m_lattice->fill.size() );
	if ( !m_levels )
	{
		for ( int i = 0; i < m_nodes.count; ++i )
		{
			positions[std::size_t( i )] = m_nodes.x.get( i ).cast<double>();
		}
		return positions;
	}
	// x_c = x_a + F_a ( x0_c - x0_a ), a the node above cell c. A node of one cell has that cell's position.
	const Octree& octree = m_levels->octree();
	const std::vector<std::uint32_t>& above = m_levels->cut().node;
	std::vector<std::uint32_t> coarse;
	for ( std::uint32_t i = 0; i < std::uint32_t( above.size() ); ++i )
	{
		if ( octree.cellCount[above[i]] > 1 )
		{
			coarse.push_back( i );
			continue;
		}
		positions[octree.cells[octree.cellStart[above[i]]]] = m_nodes.x.get( int( i ) ).cast<double>();
	}
	std::vector<float> gradients( coarse.size() * 9 );
	nodeDeformationsOf( coarse, gradients.data() );
	for ( std::size_t b = 0; b < coarse.size(); ++b )
	{
		const std::uint32_t node = above[coarse[b]];
		const Eigen::Map<const Eigen::Matrix<float, 3, 3, Eigen::RowMajor>> f( gradients.data() + 9 * b );
		for ( std::uint32_t k = octree.cellStart[node]; k < octree.cellStart[node] + octree.cellCount[node]; ++k )
		{
			const Vec3 arm = m_lattice->restCentre[octree.cells[k]] - m_nodes.x0.get( int( coarse[b] ) );
			positions[octree.cells[k]] = ( m_nodes.x.get( int( coarse[b] ) ) + f * arm ).cast<double>();
		}
	}
	return positions;
}

void Body::nodeRotations( float* quaternions ) const
{
	m_matcher->nodeRotations( m_nodes, quaternions );
}

bool Body::hasFlowed() const
{
	return m_matcher->hasFlowed();
}

void Body::nodeFlow( float* stretches ) const
{
	m_matcher->nodeFlow( m_nodes.count, stretches );
}

} // namespace pliant
