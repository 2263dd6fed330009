#include "body/implicit_motion.h"

#include "matching/lattice_matcher.h"
#include "matching/region_moments.h"

namespace pliant {

namespace {

Eigen::Vector3d at( const float* v, int padded, int i )
{
	return { double( v[i] ), double( v[padded + i] ), double( v[2 * padded + i] ) };
}

} // namespace

void ImplicitMotion::measureHeld()
{
	m_hasHeldNodes = false;
	for ( int i = 0; i < m_nodes->count; ++i )
	{
		m_hasHeldNodes = m_hasHeldNodes || m_nodes->freedom[i] == 0.0f;
	}
}

void ImplicitMotion::begin( LatticeMatcher& matcher, NodeState& nodes, const float* pushed, const ImplicitStep& step, TaskRunner* runner )
{
	m_nodes = &nodes;
	m_rates.prepare( matcher, nodes, runner );
	m_centre = m_rates.centre();
	m_inertia = m_rates.inertia();
	m_mass = m_rates.mass();
	measureHeld();

	// Kept volume answers pressing 1 + 3 kappa times as hard as pulling: all of it is made as stiff here, so that the step stays safe.
	const float elastic = step.alpha * ( 1.0f + 3.0f * step.volumeKeeping ), sigma = step.numericalDamping;
	const float gamma = 0.5f * ( 1.0f + sigma );
	m_stiffness = gamma * elastic + step.h * step.damping;

	const int padded = nodes.padded;
	m_rightSide.assign( std::size_t( size() ), 0.0f );
	if ( gamma > sigma )
	{
		// m ( 1 + G' ( 1 - P ) ) v* less m v*
		AlignedArray<float> free( static_cast<std::size_t>( size() ) );
		copySpeeds( free.data() );
		m_rates.resist( free.data(), ( gamma - sigma ) * elastic, m_rightSide.data(), runner );
		for ( int k = 0; k < size(); ++k )
		{
			m_rightSide[k] -= nodes.mass[k % padded] * nodes.freedom[k % padded] * free[k];
		}
	}
	for ( int k = 0; k < size(); ++k )
	{
		m_rightSide[k] += nodes.mass[k % padded] * nodes.freedom[k % padded] * pushed[k];
	}
}

void ImplicitMotion::beginFree( NodeState& nodes )
{
	m_nodes = &nodes;
	m_stiffness = 0.0f;
	measureHeld();
	m_rates.measureBody( nodes );
	m_centre = m_rates.centre();
	m_inertia = m_rates.inertia();
	m_mass = m_rates.mass();
	m_rightSide.resize( std::size_t( size() ) );
	copySpeeds( m_rightSide.data() );
	for ( int k = 0; k < size(); ++k )
	{
		m_rightSide[k] *= nodes.mass[k % nodes.padded] * nodes.freedom[k % nodes.padded];
	}
}

void ImplicitMotion::apply( const float* v, float* to, TaskRunner* runner )
{
	if ( m_stiffness > 0.0f )
	{
		m_rates.resist( v, m_stiffness, to, runner );
		return;
	}
	const int padded = m_nodes->padded;
	for ( int k = 0; k < size(); ++k )
	{
		to[k] = m_nodes->mass[k % padded] * m_nodes->freedom[k % padded] * v[k];
	}
}

float ImplicitMotion::diagonal( int node ) const
{
	return m_nodes->mass[node] * ( m_stiffness > 0.0f ? 1.0f + m_stiffness * m_rates.diagonal()[std::size_t( node )] : 1.0f );
}

Matrix6 ImplicitMotion::rigidMass() const
{
	Matrix6 mass = Matrix6::Zero();
	mass.topLeftCorner<3, 3>() = m_mass * Eigen::Matrix3d::Identity();
	// A rod has no inertia about its own axis, and nothing there to be turned.
	mass.bottomRightCorner<3, 3>() = m_inertia + kInertiaFloor * m_inertia.trace() * Eigen::Matrix3d::Identity();
	return mass;
}

Vector6 ImplicitMotion::rigidSums( const float* r ) const
{
	const NodeState& nodes = *m_nodes;
	Vector6 sum = Vector6::Zero();
	for ( int i = 0; i < nodes.count; ++i )
	{
		const Eigen::Vector3d value = at( r, nodes.padded, i );
		sum.head<3>() += value;
		sum.tail<3>() += ( nodes.x.get( i ).cast<double>() - m_centre ).cross( value );
	}
	return sum;
}

void ImplicitMotion::addRigid( const Vector6& motion, float* z ) const
{
	const NodeState& nodes = *m_nodes;
	const int padded = nodes.padded;
	const Eigen::Vector3d v = motion.head<3>(), w = motion.tail<3>();
	for ( int i = 0; i < nodes.count; ++i )
	{
		const Eigen::Vector3d arm = nodes.x.get( i ).cast<double>() - m_centre;
		const Eigen::Vector3d move = double( nodes.freedom[i] ) * ( v + w.cross( arm ) );
		z[i] += float( move.x() );
		z[padded + i] += float( move.y() );
		z[2 * padded + i] += float( move.z() );
	}
}

Vector6 ImplicitMotion::missingMomentum() const
{
	const NodeState& nodes = *m_nodes;
	AlignedArray<float> missing( static_cast<std::size_t>( size() ) );
	copySpeeds( missing.data() );
	for ( int k = 0; k < size(); ++k )
	{
		missing[k] = m_rightSide[k] - nodes.mass[k % nodes.padded] * missing[k];
	}
	return rigidSums( missing.data() );
}

void ImplicitMotion::addMotion( const Vector6& motion )
{
	AlignedArray<float> v( static_cast<std::size_t>( size() ) );
	copySpeeds( v.data() );
	addRigid( motion, v.data() );
	setSpeeds( v.data() );
}

void ImplicitMotion::keepMomentum()
{
	if ( !m_hasHeldNodes )
	{
		addMotion( rigidMass().inverse() * missingMomentum() );
	}
}

void ImplicitMotion::copySpeeds( float* v ) const
{
	const int padded = m_nodes->padded;
	std::copy( m_nodes->v.x.begin(), m_nodes->v.x.begin() + padded, v );
	std::copy( m_nodes->v.y.begin(), m_nodes->v.y.begin() + padded, v + padded );
	std::copy( m_nodes->v.z.begin(), m_nodes->v.z.begin() + padded, v + 2 * padded );
}

void ImplicitMotion::setSpeeds( const float* v )
{
	NodeState& nodes = *m_nodes;
	for ( int i = 0; i < nodes.count; ++i )
	{
		if ( nodes.freedom[i] != 0.0f )
		{
			nodes.v.set( i, at( v, nodes.padded, i ).cast<float>() );
		}
	}
}

} // namespace pliant
