#pragma once

// Elastic energy of a soft body of one level without plastic flow, J.

#include "pliant/soft_body.h"

#include <Eigen/Dense>

#include <cstddef>
#include <vector>

namespace pliant::test {

/// The energy that shape matching restores: of a block's regions of half-width 1, computed independently from the node positions.
///
///   V = k / 2 sum over regions r and their nodes i of  m_i / n_i | x_i - c_r - R_r ( q_i - d_r ) |^2,   k = alpha / h^2,   n_i regions
///   that contain i
class StrainEnergy
{
public:
	StrainEnergy( const SoftBody& body, double cell, double k ) : m_k( k )
	{
		const int count = body.nodeCount();
		for ( int i = 0; i < count; ++i )
		{
			m_rest.push_back( positionOf( body, i ) );
			m_mass.push_back( double( body.nodeMass( i ) ) );
		}
		m_regions.resize( std::size_t( count ) );
		for ( int r = 0; r < count; ++r )
		{
			for ( int i = 0; i < count; ++i )
			{
				if ( ( m_rest[std::size_t( r )] - m_rest[std::size_t( i )] ).cwiseAbs().maxCoeff() < 1.5 * cell )
				{
					m_regions[std::size_t( r )].push_back( std::size_t( i ) );
				}
			}
		}
		// "Region r contains node i" is symmetric in r and i.
		for ( int i = 0; i < count; ++i )
		{
			m_mass[std::size_t( i )] /= double( m_regions[std::size_t( i )].size() );
		}
	}

	static std::vector<Eigen::Vector3d> positions( const SoftBody& body, double back )
	{
		std::vector<Eigen::Vector3d> x;
		for ( int i = 0; i < body.nodeCount(); ++i )
		{
			const btVector3 v = body.nodeVelocity( i );
			x.push_back( positionOf( body, i ) - back * Eigen::Vector3d( double( v.x() ), double( v.y() ), double( v.z() ) ) );
		}
		return x;
	}
	double at( const std::vector<Eigen::Vector3d>& x ) const
	{
		double sum = 0.0;
		for ( const std::vector<std::size_t>& region : m_regions )
		{
			double mass = 0.0, inner = 0.0, outer = 0.0;
			Eigen::Vector3d centre = Eigen::Vector3d::Zero(), restCentre = centre;
			for ( const std::size_t i : region )
			{
				mass += m_mass[i];
				centre += m_mass[i] * x[i];
				restCentre += m_mass[i] * m_rest[i];
			}
			Eigen::Matrix3d apq = Eigen::Matrix3d::Zero();
			for ( const std::size_t i : region )
			{
				const Eigen::Vector3d p = x[i] - centre / mass, q = m_rest[i] - restCentre / mass;
				apq += m_mass[i] * p * q.transpose();
				inner += m_mass[i] * q.squaredNorm();
				outer += m_mass[i] * p.squaredNorm();
			}
			// the minimum over R of sum m | p - R q |^2 = sum m ( p^2 + q^2 ) - 2 ( s0 + s1 +- s2 ), s the singular values of Apq
			const Eigen::Vector3d s = apq.jacobiSvd().singularValues();
			sum += inner + outer - 2.0 * ( s[0] + s[1] + ( apq.determinant() < 0.0 ? -s[2] : s[2] ) );
		}
		return 0.5 * m_k * sum;
	}

private:
	static Eigen::Vector3d positionOf( const SoftBody& body, int node )
	{
		const btVector3 x = body.nodePosition( node );
		return { double( x.x() ), double( x.y() ), double( x.z() ) };
	}

	double m_k;
	std::vector<Eigen::Vector3d> m_rest;
	std::vector<double> m_mass; ///< m_i / n_i
	std::vector<std::vector<std::size_t>> m_regions;
};

} // namespace pliant::test
