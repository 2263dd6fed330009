#include "body/implicit/implicit_motion.h"

#include "body/constants.h"
#include "matching/constants.h"
#include "matching/implicit/conjugate_gradients.h"
#include "matching/regions/region_moments.h"
#include "matching/step/lattice_matcher.h"

#include <algorithm>

namespace pliant {

void ImplicitMotion::measurePinned()
{
	m_hasHeldNodes = false;
	m_isHeld.assign( std::size_t( parts().count() ), 0 );
	for ( int i = 0; i < m_nodes->count; ++i )
	{
		if ( isHeldNode( i ) )
		{
			m_hasHeldNodes = true;
			m_isHeld[std::size_t( parts().partOf( i ) )] = 1;
		}
	}
}

/// Sets the parts' inertias; those below `least`( mass ), kg m^2, are replaced by `point`( mass ) about any axis.
template <class Least, class Point>
void ImplicitMotion::raiseInertias( const Least& least, const Point& point )
{
	m_inertias.resize( std::size_t( parts().count() ) );
	for ( int p = 0; p < parts().count(); ++p )
	{
		Eigen::Matrix3d& inertia = m_inertias[std::size_t( p )];
		inertia = m_rates.whole( p ).inertia;
		if ( inertia.trace() < least( m_rates.whole( p ).mass ) )
		{
			inertia = point( m_rates.whole( p ).mass ) * Eigen::Matrix3d::Identity();
		}
	}
}

void ImplicitMotion::keepFreeMomentum()
{
	m_freeMomentum.resize( std::size_t( parts().count() ) );
	for ( int p = 0; p < parts().count(); ++p )
	{
		m_freeMomentum[std::size_t( p )] = momentum( p );
	}
}

void ImplicitMotion::begin(
	LatticeMatcher& matcher, NodeState& nodes, const float* pushed, const ImplicitStep& step, const NodePull& pull, TaskRunner* runner )
{
	m_nodes = &nodes;
	m_tablesVersion = matcher.tablesVersion() + 1;
	m_areSegmentsMeasured = false;
	m_pull = pull.isOn() ? &pull : nullptr;
	// Volume conservation also has the derivative kappa b m d^2 m, of either sign and about kappa | m | times the stiffness of shape.
	const float pressed = step.volumeKeeping * matcher.mostVolumeChange();
	const float elastic = step.alpha * ( 1.0f + pressed );
	const float sigma = step.numericalDamping;
	const float gamma = 0.5f * ( 1.0f + sigma );
	m_gamma = gamma;
	m_stiffness = gamma * elastic + step.h * step.damping;
	m_volume = step.volumeKeeping * gamma * step.alpha / m_stiffness;
	m_soundSquare = double( step.alpha ) * step.secondMoment;
	m_rates.prepare( matcher, nodes, runner, m_stiffness );
	m_arcs.reserve( std::size_t( parts().count() ) );
	measurePinned();
	// Nodes in one point cannot rotate, for any inertia.
	const auto least = [&]( double mass ) { return kLeastBodyInertia * mass * step.secondMoment; };
	raiseInertias( least, [&]( double mass ) { return least( mass ) / 3.0; } );
	keepFreeMomentum();
	m_secondMoment = step.secondMoment;
	m_cellMoment = step.cellMoment;
	measureArms();

	const int padded = nodes.padded;
	m_rightSide.assign( std::size_t( size() ), 0.0f );
	if ( gamma > sigma )
	{
		// m ( 1 + G' ( 1 - P + volume V ) ) v* less m v*
		AlignedArray<float> free( static_cast<std::size_t>( size() ) );
		copyVelocities( free.data() );
		m_rates.resist( free.data(), ( gamma - sigma ) * elastic, m_rightSide.data(), runner, step.volumeKeeping / ( 1.0f + pressed ) );
		for ( int k = 0; k < size(); ++k )
		{
			m_rightSide[k] -= nodes.mass[k % padded] * nodes.freedom[k % padded] * free[k];
		}
	}
	for ( int k = 0; k < size(); ++k )
	{
		m_rightSide[k] += nodes.mass[k % padded] * nodes.freedom[k % padded] * pushed[k];
	}
	for ( int i = 0; m_pull && i < nodes.count; ++i )
	{
		for ( int k = 0; k < 3; ++k )
		{
			m_rightSide[k * padded + i] += nodes.mass[i] * nodes.freedom[i] * gainOf( i ) * m_pull->velocity.get( i )[k];
		}
	}
}

void ImplicitMotion::beginFree( NodeState& nodes )
{
	m_nodes = &nodes;
	m_pull = nullptr; // an explicit body's nodes have been drawn already
	m_stiffness = m_volume = 0.0f;
}

void ImplicitMotion::measureRigid( NodeState& nodes, const ConnectedParts* parts )
{
	beginFree( nodes );
	m_rates.measureBody( nodes, parts );
	measurePinned();
	const auto least = []( double mass ) { return kLeastPointInertia * mass; };
	raiseInertias( least, least );
}

void ImplicitMotion::measureFree( NodeState& nodes, const ConnectedParts* parts )
{
	measureRigid( nodes, parts );
	keepFreeMomentum();
	measureArms();
	m_rightSide.resize( std::size_t( size() ) );
	copyVelocities( m_rightSide.data() );
	for ( int k = 0; k < size(); ++k )
	{
		m_rightSide[k] *= nodes.mass[k % nodes.padded] * nodes.freedom[k % nodes.padded];
	}
}

void ImplicitMotion::apply( const float* v, float* to, TaskRunner* runner )
{
	const int padded = m_nodes->padded;
	if ( m_stiffness > 0.0f )
	{
		m_rates.resist( v, m_stiffness, to, runner, m_volume );
	}
	else
	{
		for ( int k = 0; k < size(); ++k )
		{
			to[k] = m_nodes->mass[k % padded] * m_nodes->freedom[k % padded] * v[k];
		}
	}
	for ( int k = 0; m_pull && k < size(); ++k )
	{
		to[k] += m_nodes->mass[k % padded] * m_nodes->freedom[k % padded] * m_pull->gain[std::size_t( k % padded )] * v[k];
	}
}

const Segments* ImplicitMotion::segments( const Lattice& lattice )
{
	if ( m_stiffness < kLeastDividedStiffness || m_nodes->count < kLeastDividedNodes || parts().areSeveral() )
	{
		return nullptr;
	}
	if ( m_laidOutVersion != m_tablesVersion )
	{
		m_segments.layOut( lattice );
		m_laidOutVersion = m_tablesVersion;
	}
	if ( m_segments.count() < kLeastSegments )
	{
		return nullptr;
	}
	if ( !m_areSegmentsMeasured )
	{
		m_segments.measure( *m_nodes, double( lattice.cellSize ), m_rates.diagonal().data(), double( m_stiffness ) );
		for ( int i = 0; m_hasHeldNodes && i < m_nodes->count; ++i )
		{
			if ( isHeldNode( i ) )
			{
				m_segments.hold( i, double( heldResistance( i ) ) );
			}
		}
		m_areSegmentsMeasured = true;
	}
	return &m_segments;
}

float ImplicitMotion::diagonal( int node ) const
{
	const float own = m_nodes->mass[node] * ( m_stiffness > 0.0f ? 1.0f + m_stiffness * m_rates.diagonal()[std::size_t( node )] : 1.0f );
	return m_pull ? own + m_nodes->mass[node] * gainOf( node ) : own;
}

/// Resistance that a held node adds to the motions of its body's other nodes, kg.
float ImplicitMotion::heldResistance( int node ) const
{
	return m_nodes->freedom[node] == 0.0f ? diagonal( node ) - m_nodes->mass[node] : m_nodes->mass[node] * gainOf( node );
}

void ImplicitMotion::measureArms()
{
	const NodeState& nodes = *m_nodes;
	m_arms.assign( std::size_t( size() ), 0.0f );
	for ( int i = 0; i < nodes.count; ++i )
	{
		const Eigen::Vector3f own = ( nodes.x.get( i ).cast<double>() - centre( parts().partOf( i ) ) ).cast<float>() * nodes.freedom[i];
		for ( int k = 0; k < 3; ++k )
		{
			m_arms[std::size_t( k * nodes.padded + i )] = own[k];
		}
	}
}

Eigen::Vector3d ImplicitMotion::arm( int node ) const
{
	return nodeVector( m_arms.data(), m_nodes->padded, node );
}

// Masses: sum m ( 1, p )( 1, p )^T for each component of v. Elasticity: every region of a full lattice resists the symmetric part S of L
// with its second moment, together G m mu d^2 |S|^2, and |S|^2 = sum over k, j of ( L_kj^2 + L_kj L_jk ) / 2. Volume conservation resists
// its trace: G volume m mu d^2 tr^2 S.
Matrix12 ImplicitMotion::affineMatrix( int part ) const
{
	const double mass = m_rates.whole( part ).mass, affineMass = double( m_stiffness ) * mass * m_secondMoment,
				 floor = kInertiaFloor * trace( part );
	const Eigen::Matrix3d second = 0.5 * trace( part ) * Eigen::Matrix3d::Identity() - m_inertias[std::size_t( part )];
	Matrix12 matrix = Matrix12::Zero();
	for ( int k = 0; k < 3; ++k )
	{
		matrix( k, k ) = mass;
		for ( int j = 0; j < 3; ++j )
		{
			for ( int i = 0; i < 3; ++i )
			{
				matrix( 3 + 3 * j + k, 3 + 3 * i + k ) += second( j, i );
			}
			matrix( 3 + 3 * j + k, 3 + 3 * j + k ) += 0.5 * affineMass + floor;
			matrix( 3 + 3 * j + k, 3 + 3 * k + j ) += 0.5 * affineMass;
			matrix( 3 + 4 * j, 3 + 4 * k ) += double( m_volume ) * affineMass;
		}
	}
	if ( isHeld( part ) )
	{
		addPinned( matrix, part );
	}
	return matrix;
}

// Pinned nodes do not follow: their neighbours resist the relative motion as they would resist their own. Nodes that are drawn resist by
// their gain.
void ImplicitMotion::addPinned( Matrix12& matrix, int part ) const
{
	Eigen::Matrix4d sum = Eigen::Matrix4d::Zero();
	parts().forNodes( part, m_nodes->count, [&]( int i ) {
		if ( isHeldNode( i ) )
		{
			Eigen::Vector4d arm;
			arm << 1.0, m_nodes->x.get( i ).cast<double>() - centre( part );
			sum += double( heldResistance( i ) ) * arm * arm.transpose();
		}
	} );
	for ( int j = 0; j < 4; ++j )
	{
		for ( int i = 0; i < 4; ++i )
		{
			matrix.block<3, 3>( 3 * i, 3 * j ).diagonal().array() += sum( i, j );
		}
	}
}

Vector12 ImplicitMotion::affineSums( const float* r, int part ) const
{
	Vector12 sums = Vector12::Zero();
	if ( !parts().areSeveral() )
	{
		bestKernels().affineSums( r, m_arms.data(), m_nodes->freedom.data(), m_nodes->padded, sums.data() );
		return sums;
	}
	parts().forNodes( part, m_nodes->count, [&]( int i ) {
		const Eigen::Vector3d own = nodeVector( r, m_nodes->padded, i ) * double( m_nodes->freedom[i] ), from = arm( i );
		sums.head<3>() += own;
		for ( int j = 0; j < 3; ++j )
		{
			sums.segment<3>( 3 + 3 * j ) += from[j] * own;
		}
	} );
	return sums;
}

void ImplicitMotion::addAffine( const Vector12& motion, float* z, int part ) const
{
	const int padded = m_nodes->padded;
	if ( !parts().areSeveral() )
	{
		const Eigen::Matrix<float, 12, 1> rounded = motion.cast<float>();
		bestKernels().addAffine( rounded.data(), m_arms.data(), m_nodes->freedom.data(), padded, z );
		return;
	}
	parts().forNodes( part, m_nodes->count, [&]( int i ) {
		const Eigen::Vector3d from = arm( i );
		const Eigen::Vector3d velocity = motion.head<3>() + from[0] * motion.segment<3>( 3 ) + from[1] * motion.segment<3>( 6 ) +
			from[2] * motion.segment<3>( 9 );
		for ( int k = 0; k < 3; ++k )
		{
			z[k * padded + i] += m_nodes->freedom[i] * float( velocity[k] );
		}
	} );
}

void ImplicitMotion::copyVelocities( float* v ) const
{
	const int padded = m_nodes->padded;
	std::copy( m_nodes->v.x.begin(), m_nodes->v.x.begin() + padded, v );
	std::copy( m_nodes->v.y.begin(), m_nodes->v.y.begin() + padded, v + padded );
	std::copy( m_nodes->v.z.begin(), m_nodes->v.z.begin() + padded, v + 2 * padded );
}

void ImplicitMotion::setNodeVelocities( const float* v )
{
	NodeState& nodes = *m_nodes;
	for ( int i = 0; i < nodes.count; ++i )
	{
		if ( nodes.freedom[i] != 0.0f )
		{
			nodes.v.set( i, nodeVector( v, nodes.padded, i ).cast<float>() );
		}
	}
}

} // namespace pliant
