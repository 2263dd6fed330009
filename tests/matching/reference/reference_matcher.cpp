#include "matching/reference/reference_matcher.h"

#include "matching/rotation.h"
#include "matching/step/plasticity.h"
#include "matching/volume_law.h"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>

namespace pliant {

namespace {

/// S_p after the substep, by singular values and bisection; the law is defined in plasticity.h. Does not check whether the energy rises.
Eigen::Matrix3d flowedByLaw( const MatchStep& step, const Eigen::Matrix3d& elastic, const Eigen::Matrix3d& before )
{
	const Eigen::Matrix3d one = Eigen::Matrix3d::Identity(), strain = 0.5 * ( elastic + elastic.transpose() ) - one;
	if ( strain.norm() <= double( step.plastic.yieldStrain ) )
	{
		return before;
	}
	const auto volumeOne = []( const Eigen::Matrix3d& m ) {
		const Eigen::JacobiSVD<Eigen::Matrix3d> svd( m, Eigen::ComputeFullU | Eigen::ComputeFullV );
		return Eigen::Matrix3d(
			svd.matrixV() * ( svd.singularValues() / std::cbrt( svd.singularValues().prod() ) ).asDiagonal() * svd.matrixV().transpose() );
	};
	const double fraction = std::min( { double( step.plastic.creep ) * step.h, 1.0, kLargestFlow / strain.norm() } );
	const Eigen::Matrix3d wanted = volumeOne( ( one + fraction * strain ) * before );
	const double limit = step.plastic.limit;
	if ( ( wanted - one ).norm() <= limit )
	{
		return wanted;
	}
	double inside = 0.0, beyond = 1.0;
	for ( int round = 0; round < 60; ++round )
	{
		const double t = 0.5 * ( inside + beyond );
		( ( volumeOne( one + t * ( wanted - one ) ) - one ).norm() <= limit ? inside : beyond ) = t;
	}
	return volumeOne( one + inside * ( wanted - one ) );
}

/// The same where it lowers the energy; otherwise the fallback of flowStretch.
Eigen::Matrix3d flowed( const MatchStep& step, const FlowingRegion& region, const Eigen::Matrix3d& before )
{
	Eigen::Matrix3d after = flowedByLaw( step, region.rotation.transpose() * region.total * before.inverse(), before );
	const Eigen::JacobiSVD<Eigen::Matrix3d> svd( region.total * region.moment * after, Eigen::ComputeFullU | Eigen::ComputeFullV );
	const double sign = ( svd.matrixU() * svd.matrixV().transpose() ).determinant();
	const Eigen::Matrix3d fitted = svd.matrixU() * Vec3d( 1.0, 1.0, sign ).asDiagonal() * svd.matrixV().transpose();
	if ( region.energy( fitted, after ) > region.energy( region.rotation, before ) )
	{
		after = before;
		flowStretch( step.plastic, step.h, region, after );
	}
	return after;
}

} // namespace

ReferenceMatcher::ReferenceMatcher( const Lattice& lattice, const Material& material, DampingForm dampingForm ) :
	m_lattice( lattice ), m_material( material ), m_dampingForm( dampingForm ),
	m_regions( buildRegions( lattice, material.regionHalfWidth ) ),
	m_moments( computeRegionMoments( lattice, m_regions, material.weights, true ) ), m_fits( lattice.cellCount() ),
	m_residual( lattice.cellCount(), Vec3d::Zero() ), m_residualBefore( lattice.cellCount(), Vec3d::Zero() )
{}

void ReferenceMatcher::reset( const NodeState&, const Eigen::Quaterniond& rotation )
{
	m_bodyRotation = rotation;
	for ( Fit& fit : m_fits )
	{
		fit.rotation = rotation;
	}
	std::fill( m_residual.begin(), m_residual.end(), Vec3d::Zero() );
}

void ReferenceMatcher::forgetFlow()
{
	for ( Fit& fit : m_fits )
	{
		fit.plastic.setIdentity();
	}
}

void ReferenceMatcher::turn( const Eigen::Quaterniond& by )
{
	m_bodyRotation = by * m_bodyRotation;
	for ( Fit& fit : m_fits )
	{
		fit.rotation = by * fit.rotation;
	}
	for ( Vec3d& residual : m_residual )
	{
		residual = by * residual;
	}
}

void ReferenceMatcher::fitRegions( const NodeState& nodes, const MatchStep& step )
{
	const double d = m_lattice.cellSize;
	for ( int r = 0; r < nodes.count; ++r )
	{
		Fit& fit = m_fits[r];
		fit.centre.setZero();
		fit.restCentre = Vec3d( m_moments.centre[0][r], m_moments.centre[1][r], m_moments.centre[2][r] ) * d;

		// c_r = sum a_i x_i / M_r,  A_pq = sum a_i (x_i - c_r)(x0_i - c0_r)^T   (Ohta et al. 2009, eq. 1)
		for ( std::uint32_t k = m_regions.start[r]; k < m_regions.start[r + 1]; ++k )
		{
			const std::uint32_t i = m_regions.member[k];
			fit.centre += double( m_moments.nodeWeight[i] ) * nodes.x.get( i ).cast<double>();
		}
		fit.centre *= m_moments.inverseMass[r];
		Eigen::Matrix3d apq = Eigen::Matrix3d::Zero(), aqq = Eigen::Matrix3d::Zero();
		for ( std::uint32_t k = m_regions.start[r]; k < m_regions.start[r + 1]; ++k )
		{
			const std::uint32_t i = m_regions.member[k];
			const Vec3d p = nodes.x.get( i ).cast<double>() - fit.centre;
			const Vec3d q = fit.plastic * ( nodes.x0.get( i ).cast<double>() - fit.restCentre ); // Steinemann et al. 2008, eq. 9-10
			apq += double( m_moments.nodeWeight[i] ) * p * q.transpose();
			aqq += double( m_moments.nodeWeight[i] ) * q * q.transpose();
		}
		Eigen::Matrix3d outside;
		const Eigen::Matrix3d inverse = inverseInPlane( aqq, kMomentFloor, outside );
		const Eigen::Matrix3d inPlane = apq * inverse;
		fit.rotation = fitRotation( m_material.rotationFrom == RotationFrom::F ? inPlane : apq, fit.rotation );
		const Eigen::Matrix3d rotation = fit.rotation.toRotationMatrix();
		const Eigen::Matrix3d f = inPlane + rotation * outside;

		// L = R + beta (F - R)   (Ohta et al. 2009, eq. 5)
		fit.linear = rotation + double( m_material.beta ) * ( f - rotation );
		const Eigen::Matrix3d unflowed = fit.plastic.inverse(), restMoment = unflowed * aqq * unflowed;
		fit.linear -= double( m_material.volumeKeeping ) * ( 1.0 - double( m_material.beta ) ) *
			volumeMatrix( { rotation, f, apq, rotation, inverse, restMoment, 3.0 - outside.trace() }, double( step.mostVolumeResponse ) );
		fit.linear *= fit.plastic;
		if ( step.plastic.yieldStrain > 0.0f )
		{
			const Eigen::Matrix3d back = fit.plastic.inverse(), before = fit.plastic;
			fit.plastic = flowed( step,
				FlowingRegion{ f * fit.plastic, rotation, back * aqq * back, fit.plastic * inverse * fit.plastic,
					Eigen::Matrix3d::Identity() - outside, double( m_material.volumeKeeping ) },
				before );
			m_hasFlowed = m_hasFlowed || fit.plastic != before;
		}
		if ( m_dampingForm == DampingForm::RegionVelocity )
		{
			fitMotion( nodes, r, fit );
		}
	}
}

void ReferenceMatcher::fitMotion( const NodeState& nodes, int region, Fit& fit ) const
{
	// v_r = sum a v / M,  omega = I^-1 sum a p x v,  I = sum a ( |p|^2 1 - p p^T )   (Rivers and James 2007, section 5)
	Vec3d momentum = Vec3d::Zero(), spin = Vec3d::Zero();
	Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
	for ( std::uint32_t k = m_regions.start[region]; k < m_regions.start[region + 1]; ++k )
	{
		const std::uint32_t i = m_regions.member[k];
		const double a = m_moments.nodeWeight[i];
		const Vec3d p = nodes.x.get( i ).cast<double>() - fit.centre;
		const Vec3d v = nodes.v.get( i ).cast<double>();
		momentum += a * v;
		spin += a * p.cross( v );
		inertia += a * ( p.squaredNorm() * Eigen::Matrix3d::Identity() - p * p.transpose() );
	}
	fit.velocity = momentum * m_moments.inverseMass[region];
	fit.spin = flooredInverse( inertia, kMomentFloor ) * spin;
}

Eigen::Quaterniond ReferenceMatcher::fitBody( const NodeState& nodes )
{
	Vec3d first = Vec3d::Zero();
	Eigen::Matrix3d moment = Eigen::Matrix3d::Zero();
	double mass = 0.0;
	for ( int i = 0; i < nodes.count; ++i )
	{
		mass += nodes.mass[i];
		first += double( nodes.mass[i] ) * nodes.x.get( i ).cast<double>();
	}
	m_bodyCentre = first / mass;
	for ( int i = 0; i < nodes.count; ++i )
	{
		const Vec3d p = nodes.x.get( i ).cast<double>() - m_bodyCentre;
		moment += double( nodes.mass[i] ) * p * nodes.x0.get( i ).cast<double>().transpose();
	}
	return fitRotation( moment, m_bodyRotation );
}

void ReferenceMatcher::accelerate( NodeState& nodes, const MatchStep& step, TaskRunner* )
{
	// The residual of the last substep rotates with the body; otherwise a spinning body would see its own stretch as motion.
	const Eigen::Quaterniond before = m_bodyRotation;
	m_bodyRotation = fitBody( nodes );
	for ( int i = 0; i < nodes.count; ++i )
	{
		m_residualBefore[i] = m_bodyRotation * ( before.conjugate() * m_residual[i] );
	}
	const bool wasFlowing = m_hasFlowed; // the flow has moved the goals without any motion of the nodes
	m_hasFlowed = false;
	fitRegions( nodes, step );

	const double k = wasFlowing
		? 0.0
		: double( dampingFraction( double( step.damping ), double( step.h ), double( step.alpha ), double( m_material.volumeKeeping ) ) );
	for ( int i = 0; i < nodes.count; ++i )
	{
		const Vec3d x = nodes.x.get( i ).cast<double>();
		const Vec3d x0 = nodes.x0.get( i ).cast<double>();
		Vec3d goal = Vec3d::Zero(), motion = Vec3d::Zero();
		for ( std::uint32_t m = m_regions.start[i]; m < m_regions.start[i + 1]; ++m )
		{
			const std::uint32_t r = m_regions.member[m];
			const Fit& fit = m_fits[r];
			const double b = m_moments.regionWeight.empty() ? 1.0 : m_moments.regionWeight[r];
			goal += b * ( fit.centre + fit.linear * ( x0 - fit.restCentre ) );
			motion += b * ( fit.velocity + fit.spin.cross( x - fit.centre ) );
		}
		m_residual[i] = goal * m_moments.inverseCover[i] - x;

		const Vec3d wholeBody = m_bodyRotation * x0 + m_bodyCentre;
		Vec3d change = ( ( 1.0 - step.bodyFraction ) * step.alpha * m_residual[i] + double( step.bodyFraction ) * ( wholeBody - x ) ) /
			step.h;
		if ( m_dampingForm == DampingForm::GoalRate )
		{
			change += k * ( m_residual[i] - m_residualBefore[i] ) / step.h;
		}
		else
		{
			change += k * ( motion * m_moments.inverseCover[i] - nodes.v.get( i ).cast<double>() );
		}
		if ( nodes.freedom[i] != 0.0f )
		{
			nodes.v.set( i, ( nodes.v.get( i ).cast<double>() + change ).cast<float>() );
		}
	}
}

void ReferenceMatcher::nodeRotations( const NodeState& nodes, float* quaternions ) const
{
	for ( int i = 0; i < nodes.count; ++i )
	{
		const Eigen::Quaternionf q = m_fits[i].rotation.cast<float>();
		quaternions[4 * i + 0] = q.x();
		quaternions[4 * i + 1] = q.y();
		quaternions[4 * i + 2] = q.z();
		quaternions[4 * i + 3] = q.w();
	}
}

} // namespace pliant
