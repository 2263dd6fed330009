#include "body/implicit_motion.h"

#include "matching/conjugate_gradients.h"
#include "matching/lattice_matcher.h"
#include "matching/region_moments.h"

namespace pliant {

namespace {

/// Least inertia of a body, in units of what its regions have as full ones about their own middles: all nodes in one point have none.
constexpr double kLeastInertia = 1e-12;
/// And of a body of one node, m^2 per mass: it has none, and nothing there to be turned.
constexpr double kPointInertia = 1e-12;

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
	// In one point nothing can be turned, whatever its inertia is taken for.
	const double least = kLeastInertia * m_mass * step.secondMoment;
	if ( m_inertia.trace() < least )
	{
		m_inertia = least / 3.0 * Eigen::Matrix3d::Identity();
	}
	measureHeld();
	m_freeMomentum = momentum();

	// Kept volume answers pressing 1 + 3 kappa times as hard as pulling: all of it is made as stiff here, so that the step stays safe.
	const float elastic = step.alpha * ( 1.0f + 3.0f * step.volumeKeeping ), sigma = step.numericalDamping;
	const float gamma = 0.5f * ( 1.0f + sigma );
	m_stiffness = gamma * elastic + step.h * step.damping;
	m_affineMass = double( m_stiffness ) * m_mass * step.secondMoment;
	measureArms();

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
	if ( m_inertia.trace() < kPointInertia * m_mass )
	{
		m_inertia = kPointInertia * m_mass * Eigen::Matrix3d::Identity();
	}
	m_freeMomentum = momentum();
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

Vector6 ImplicitMotion::momentum() const
{
	const NodeState& nodes = *m_nodes;
	Vector6 sum = Vector6::Zero();
	for ( int i = 0; i < nodes.count; ++i )
	{
		const Eigen::Vector3d value = double( nodes.mass[i] ) * nodes.v.get( i ).cast<double>();
		sum.head<3>() += value;
		sum.tail<3>() += ( nodes.x.get( i ).cast<double>() - m_centre ).cross( value );
	}
	return sum;
}

void ImplicitMotion::measureArms()
{
	const NodeState& nodes = *m_nodes;
	m_arms.assign( std::size_t( size() ), 0.0f );
	for ( int i = 0; i < nodes.count; ++i )
	{
		const Eigen::Vector3f own = ( nodes.x.get( i ).cast<double>() - m_centre ).cast<float>() * nodes.freedom[i];
		for ( int k = 0; k < 3; ++k )
		{
			m_arms[std::size_t( k * nodes.padded + i )] = own[k];
		}
	}
}

Eigen::Vector3d ImplicitMotion::arm( int node ) const
{
	return at( m_arms.data(), m_nodes->padded, node );
}

// Masses: sum m ( 1, p )( 1, p )^T for each component of v. Elasticity: every region of a full lattice resists the symmetric part S of L with
// its second moment, together G m mu d^2 |S|^2, and |S|^2 = sum over k, j of ( L_kj^2 + L_kj L_jk ) / 2.
Matrix12 ImplicitMotion::affineMatrix() const
{
	const Eigen::Matrix3d second = 0.5 * m_inertia.trace() * Eigen::Matrix3d::Identity() - m_inertia;
	Matrix12 matrix = Matrix12::Zero();
	for ( int k = 0; k < 3; ++k )
	{
		matrix( k, k ) = m_mass;
		for ( int j = 0; j < 3; ++j )
		{
			for ( int i = 0; i < 3; ++i )
			{
				matrix( 3 + 3 * j + k, 3 + 3 * i + k ) += second( j, i );
			}
			matrix( 3 + 3 * j + k, 3 + 3 * j + k ) += 0.5 * m_affineMass + kInertiaFloor * m_inertia.trace();
			matrix( 3 + 3 * j + k, 3 + 3 * k + j ) += 0.5 * m_affineMass;
		}
	}
	if ( m_hasHeldNodes )
	{
		addHeld( matrix );
	}
	return matrix;
}

// What is held does not come along: its neighbours resist that with as much as they would its own going away.
void ImplicitMotion::addHeld( Matrix12& matrix ) const
{
	Eigen::Matrix4d sum = Eigen::Matrix4d::Zero();
	for ( int i = 0; i < m_nodes->count; ++i )
	{
		if ( m_nodes->freedom[i] == 0.0f )
		{
			Eigen::Vector4d arm;
			arm << 1.0, m_nodes->x.get( i ).cast<double>() - m_centre;
			sum += double( diagonal( i ) - m_nodes->mass[i] ) * arm * arm.transpose();
		}
	}
	for ( int j = 0; j < 4; ++j )
	{
		for ( int i = 0; i < 4; ++i )
		{
			matrix.block<3, 3>( 3 * i, 3 * j ).diagonal().array() += sum( i, j );
		}
	}
}

Vector12 ImplicitMotion::affineSums( const float* r ) const
{
	Vector12 sums;
	bestKernels().affineSums( r, m_arms.data(), m_nodes->freedom.data(), m_nodes->padded, sums.data() );
	return sums;
}

void ImplicitMotion::addAffine( const Vector12& motion, float* z ) const
{
	const Eigen::Matrix<float, 12, 1> rounded = motion.cast<float>();
	bestKernels().addAffine( rounded.data(), m_arms.data(), m_nodes->freedom.data(), m_nodes->padded, z );
}

// Qt b = Qt m v*, but b holds elastic kicks that cancel in the sum, and in float do not quite: v* says it better.
Vector6 ImplicitMotion::missingMomentum() const
{
	return m_freeMomentum - momentum();
}

void ImplicitMotion::addMotion( const Vector6& motion )
{
	NodeState& nodes = *m_nodes;
	const Eigen::Vector3d shift = motion.head<3>(), turn = motion.tail<3>();
	for ( int i = 0; i < nodes.count; ++i )
	{
		const Eigen::Vector3d place = nodes.x.get( i ).cast<double>() - m_centre;
		const Eigen::Vector3d speed = nodes.v.get( i ).cast<double>() + double( nodes.freedom[i] ) * ( shift + turn.cross( place ) );
		nodes.v.set( i, speed.cast<float>() );
	}
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
