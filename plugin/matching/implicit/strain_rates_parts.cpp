// The implicit step's operator for a body in several unlinked parts.

#include "matching/implicit/strain_rates.h"

#include "matching/step/lattice_matcher.h"

#include <algorithm>

namespace pliant {

namespace {

Eigen::Vector3d at( const float* const* component, int i )
{
	return { double( component[0][i] ), double( component[1][i] ), double( component[2][i] ) };
}

} // namespace

void StrainRates::centreParts( const NodeState& nodes )
{
	const std::size_t padded = std::size_t( m_padded );
	m_positions.assign( 3 * padded, 0.0f );
	m_strained.assign( 3 * padded, 0.0f );
	for ( int p = 0; p < m_parts->count(); ++p )
	{
		m_parts->forNodes( p, nodes.count, [&]( int i ) {
			const Eigen::Vector3d arm = nodes.x.get( i ).cast<double>() - whole( p ).centre;
			for ( std::size_t k = 0; k < 3; ++k )
			{
				m_positions[k * padded + std::size_t( i )] = float( arm[Eigen::Index( k )] );
			}
		} );
	}
	for ( std::size_t k = 0; k < 3; ++k )
	{
		m_view.x[k] = m_positions.data() + k * padded;
	}
}

/// ( 1 - Q ) v, Q the projection onto the rigid motions of each part.
void StrainRates::removeRigidMotion( const float* const* from, float* const* to ) const
{
	const int count = m_view.nodeCount;
	for ( int p = 0; p < m_parts->count(); ++p )
	{
		const WholePart& part = whole( p );
		Eigen::Vector3d momentum = Eigen::Vector3d::Zero(), spin = Eigen::Vector3d::Zero();
		m_parts->forNodes( p, count, [&]( int i ) {
			const Eigen::Vector3d impulse = double( m_view.mass[i] ) * at( from, i );
			momentum += impulse;
			spin += at( m_view.x, i ).cross( impulse );
		} );
		const Eigen::Vector3d shift = momentum / part.mass, turn = part.inverseInertia * spin;
		m_parts->forNodes( p, count, [&]( int i ) {
			const Eigen::Vector3d remainder = at( from, i ) - shift - turn.cross( at( m_view.x, i ) );
			for ( int k = 0; k < 3; ++k )
			{
				to[k][i] = float( remainder[k] );
			}
		} );
	}
}

// ( 1 - Q )( 1 - P )( 1 - Q ): equal to 1 - P where no region's inertia was raised, and symmetric where some were.
void StrainRates::resistByPart( const float* v, float* to, TaskRunner* runner )
{
	const std::size_t padded = std::size_t( m_padded );
	const float* const velocity[3] = { v, v + padded, v + 2 * padded };
	float* const strained[3] = { m_strained.data(), m_strained.data() + padded, m_strained.data() + 2 * padded };
	float* const result[3] = { to, to + padded, to + 2 * padded };
	removeRigidMotion( velocity, strained );
	for ( int k = 0; k < 3; ++k )
	{
		m_rates.rate[k] = strained[k];
		m_rates.shift[k] = m_rates.turn[k] = 0.0f;
	}
	applyRegions( runner );
	for ( int begin = 0; begin < m_padded; begin += kTile )
	{
		m_kernels->resistPart( m_rates, begin, std::min( m_padded, begin + kTile ) );
	}
	removeRigidMotion( result, result );
	for ( int i = 0; i < m_padded; ++i )
	{
		const float mass = m_view.mass[i] * m_view.freedom[i];
		for ( int k = 0; k < 3; ++k )
		{
			result[k][i] = mass * ( velocity[k][i] + result[k][i] );
		}
	}
}

} // namespace pliant
