#include "matching/reference/reference_level_matcher.h"

#include "matching/rotation.h"
#include "matching/step/plasticity.h"
#include "matching/volume_law.h"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>

namespace pliant {

ReferenceLevelMatcher::ReferenceLevelMatcher(
	const LevelBase& base, const Lattice& lattice, const Cut& cut, const Material& material, const Adaptivity& settings ) :
	m_base( base ),
	m_lattice( lattice ), m_cut( cut ), m_material( material ), m_settings( settings ),
	m_matrix( *buildLevelRegions( RegionInput{ base, lattice, material, settings }, cut ).matrix ), m_region( cut.node.size() ),
	m_residual( cut.node.size(), Vec3d::Zero() )
{
	for ( std::uint32_t r = 0; r < std::uint32_t( cut.count() ); ++r )
	{
		tune( r, m_region[r] );
	}
}

void ReferenceLevelMatcher::tune( std::uint32_t r, Region& region ) const
{
	const std::uint32_t node = m_cut.node[r];
	region.rest = measureRegion( m_base.octree, m_cut, m_matrix, r, m_lattice.cellSize );
	const double mass = m_base.octree.mass[node];
	switch ( m_settings.softening )
	{
		case Softening::None: break;
		case Softening::Ohta1D: region.beta = ohtaBeta( mass, m_material.regionHalfWidth, 1 ); break;
		case Softening::Ohta2D: region.beta = ohtaBeta( mass, m_material.regionHalfWidth, 2 ); break;
		case Softening::Ohta3D: region.beta = ohtaBeta( mass, m_material.regionHalfWidth, 3 ); break;
		default: region.beta = energyBeta( fineMoment( m_base.moments, node ), region.rest.moment ); break;
	}
	switch ( m_settings.residual )
	{
		case ResidualRule::Keep: break;
		case ResidualRule::Soften: region.eta = region.beta; break;
		default:
			region.eta = quadraticEta( m_base.octree, m_cut, m_matrix, r, m_base.moments, region.rest, m_lattice.cellSize, region.beta );
			region.eta = m_settings.residual == ResidualRule::Larger ? std::max( region.eta, region.beta ) : region.eta;
			break;
	}
	if ( node >= m_base.octree.levelStart[1] )
	{
		region.beta = 1.0 - ( 1.0 - region.beta ) * m_settings.coarseStiffness;
		region.eta = 1.0 - ( 1.0 - region.eta ) * m_settings.coarseStiffness;
	}
	region.blend = m_settings.softening == Softening::EnergyTensor ? energyBlend( fineMoment( m_base.moments, node ), region.rest.moment )
																   : Eigen::Matrix3d( ( 1.0 - region.beta ) * Eigen::Matrix3d::Identity() );
}

void ReferenceLevelMatcher::reset( const NodeState&, const Eigen::Quaterniond& rotation )
{
	m_bodyRotation = rotation;
	for ( Region& region : m_region )
	{
		region.rotation = rotation;
	}
	std::fill( m_residual.begin(), m_residual.end(), Vec3d::Zero() );
}

void ReferenceLevelMatcher::turn( const Eigen::Quaterniond& by )
{
	m_bodyRotation = by * m_bodyRotation;
	for ( Region& region : m_region )
	{
		region.rotation = by * region.rotation;
	}
	for ( Vec3d& residual : m_residual )
	{
		residual = by * residual;
	}
}

void ReferenceLevelMatcher::fit( const NodeState& nodes, const MatchStep& step, std::uint32_t r )
{
	// c_r = sum u x / M,  A_pq = sum u ( x - c ) ( x0 - c0 )^T,  F = A_pq J^+ + R ( 1 - J J^+ )
	Region& region = m_region[r];
	const double d = m_lattice.cellSize;
	region.centre.setZero();
	for ( std::uint32_t k = m_matrix.start[r]; k < m_matrix.start[r + 1]; ++k )
	{
		const std::uint32_t a = m_matrix.member[k];
		region.centre += m_matrix.mass[k] * m_matrix.unit[a] / region.rest.mass * nodes.x.get( int( a ) ).cast<double>();
	}
	Eigen::Matrix3d apq = Eigen::Matrix3d::Zero();
	for ( std::uint32_t k = m_matrix.start[r]; k < m_matrix.start[r + 1]; ++k )
	{
		const int a = int( m_matrix.member[k] );
		const Vec3d q = region.plastic * ( nodes.x0.get( a ).cast<double>() / d - region.rest.centre );
		apq += m_matrix.mass[k] * m_matrix.unit[std::size_t( a )] * ( nodes.x.get( a ).cast<double>() - region.centre ) / d * q.transpose();
	}
	// The plastic stretch defines the rest shape: J and J_fine between two S_p   (Steinemann et al. 2008, eq. 9-10)
	const bool isTensor = m_settings.softening == Softening::EnergyTensor;
	const Eigen::Matrix3d& s = region.plastic;
	const Eigen::Matrix3d moment = s * region.rest.moment * s;
	const Eigen::Matrix3d blend = isTensor ? energyBlend( s * fineMoment( m_base.moments, m_cut.node[r] ) * s, moment ) : region.blend;
	Eigen::Matrix3d outside;
	const Eigen::Matrix3d inverse = inverseInPlane( moment, kMomentFloor, outside );
	region.rotation = fitRotation( isTensor ? Eigen::Matrix3d( apq * blend ) : apq, region.rotation );
	const Eigen::Matrix3d rotation = region.rotation.toRotationMatrix();
	region.f = apq * inverse + rotation * outside;
	// L = F + ( R - F ) C^T, with C = 1 - beta where beta is a scalar: L = R + beta ( F - R )   (Ohta et al. 2009, eq. 5)
	region.l = region.f + ( rotation - region.f ) * blend.transpose();
	const double volumeKeeping = double( m_material.volumeKeeping ) * ( 1.0 - region.beta );
	const VolumeFit fit{ rotation, region.f, isTensor ? Eigen::Matrix3d( apq * blend ) : apq,
		isTensor ? Eigen::Matrix3d( rotation * blend.transpose() ) : rotation, inverse, region.rest.moment, 3.0 - outside.trace() };
	region.l -= volumeKeeping * volumeMatrix( fit, double( step.mostVolumeResponse ) );
	region.l *= s;
	region.f *= s;
	if ( step.plastic.yieldStrain > 0.0f )
	{
		const Eigen::Matrix3d back = region.plastic.inverse(), fine = back * moment * blend * back;
		const Eigen::Matrix3d resisting = isTensor ? Eigen::Matrix3d( 0.5 * ( fine + fine.transpose() ) ) : region.rest.moment;
		m_hasFlowed |= flowStretch( step.plastic, step.h,
			FlowingRegion{ region.f, rotation, resisting, region.plastic * inverse * region.plastic, Eigen::Matrix3d::Identity() - outside,
				isTensor ? volumeKeeping : double( m_material.volumeKeeping ) },
			region.plastic );
	}
}

Eigen::Quaterniond ReferenceLevelMatcher::fitBody( const NodeState& nodes ) const
{
	double mass = 0.0;
	Vec3d first = Vec3d::Zero();
	for ( int i = 0; i < nodes.count; ++i )
	{
		mass += nodes.mass[i];
		first += double( nodes.mass[i] ) * nodes.x.get( i ).cast<double>();
	}
	Eigen::Matrix3d moment = Eigen::Matrix3d::Zero();
	for ( int i = 0; i < nodes.count; ++i )
	{
		moment += double( nodes.mass[i] ) * ( nodes.x.get( i ).cast<double>() - first / mass ) *
			nodes.x0.get( i ).cast<double>().transpose();
	}
	return fitRotation( moment, m_bodyRotation );
}

// Goals and region damping only: no whole-body goal, no wobble damping, no correction of rounding errors, negligible in double.
void ReferenceLevelMatcher::accelerate( NodeState& nodes, const MatchStep& step, TaskRunner* )
{
	const Eigen::Quaterniond before = m_bodyRotation;
	m_bodyRotation = fitBody( nodes );
	const bool wasFlowing = m_hasFlowed; // the flow has moved the goals without any motion of the nodes
	m_hasFlowed = false;
	for ( std::uint32_t r = 0; r < std::uint32_t( m_region.size() ); ++r )
	{
		fit( nodes, step, r );
	}
	const double k = wasFlowing
		? 0.0
		: double( dampingFraction( double( step.damping ), double( step.h ), double( step.alpha ), double( m_material.volumeKeeping ) ) );
	for ( int i = 0; i < nodes.count; ++i )
	{
		const Vec3d x = nodes.x.get( i ).cast<double>();
		Vec3d goal = Vec3d::Zero();
		double cover = 0.0;
		for ( std::uint32_t m = m_matrix.start[i]; m < m_matrix.start[i + 1]; ++m )
		{
			// g = c + L q + eta ( x - c - F q )
			const Region& region = m_region[m_matrix.member[m]];
			const Vec3d q = nodes.x0.get( i ).cast<double>() - region.rest.centre * double( m_lattice.cellSize );
			const double fraction = m_matrix.fraction[m];
			goal += fraction * ( region.centre + region.l * q + region.eta * ( x - region.centre - region.f * q ) );
			cover += fraction;
		}
		const Vec3d last = m_bodyRotation * ( before.conjugate() * m_residual[std::size_t( i )] );
		const Vec3d residual = goal / cover - x;
		m_residual[std::size_t( i )] = residual;
		const Vec3d change = ( double( step.alpha ) * residual + k * ( residual - last ) ) / step.h;
		if ( nodes.freedom[i] != 0.0f )
		{
			nodes.v.set( i, ( nodes.v.get( i ).cast<double>() + change ).cast<float>() );
		}
	}
}

void ReferenceLevelMatcher::nodeRotations( const NodeState& nodes, float* quaternions ) const
{
	for ( int i = 0; i < nodes.count; ++i )
	{
		Eigen::Map<Eigen::Vector4f>( quaternions + 4 * i ) = m_region[std::size_t( i )].rotation.cast<float>().coeffs();
	}
}

} // namespace pliant
