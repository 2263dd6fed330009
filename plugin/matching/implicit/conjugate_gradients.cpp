#include "matching/implicit/conjugate_gradients.h"

#include "matching/kernels/kernels.h"

namespace pliant {

double dot( const float* a, const float* b, int size )
{
	return bestKernels().dot( a, b, size );
}

int ConjugateGradients::solve( LinearSystem& system, const float* b, float* x, const GradientLimits& limits )
{
	const int size = system.size();
	m_r.resize( std::size_t( size ) );
	m_ap.resize( std::size_t( size ) );
	system.apply( x, m_ap.data() );
	for ( int i = 0; i < size; ++i )
	{
		m_r[std::size_t( i )] = b[i] - m_ap[std::size_t( i )];
	}
	beginFromResidual( system );
	return iterate( system, x, limits );
}

void ConjugateGradients::begin( LinearSystem& system, const float* r )
{
	m_r.assign( r, r + system.size() );
	beginFromResidual( system );
}

void ConjugateGradients::beginFromResidual( LinearSystem& system )
{
	const int size = system.size();
	for ( AlignedArray<float>* array : { &m_z, &m_p, &m_ap } )
	{
		array->resize( std::size_t( size ) );
	}
	system.precondition( m_r.data(), m_z.data() );
	m_rz = m_rzFirst = dot( m_r.data(), m_z.data(), size );
	std::copy( m_z.begin(), m_z.begin() + size, m_p.begin() );
}

int ConjugateGradients::iterate( LinearSystem& system, float* x, const GradientLimits& limits )
{
	const int size = system.size();
	float *const r = m_r.data(), *const z = m_z.data(), *const p = m_p.data(), *const ap = m_ap.data();
	const double tolerance = std::max( limits.relative * m_rzFirst, limits.absolute );
	int count = 0;
	while ( count < limits.maxProducts && m_rz > tolerance )
	{
		system.apply( p, ap );
		++count;
		const double curvature = dot( p, ap, size );
		if ( !( curvature > 0.0 ) )
		{
			break;
		}
		const float step = float( m_rz / curvature );
		for ( int i = 0; i < size; ++i )
		{
			x[i] += step * p[i];
			r[i] -= step * ap[i];
		}
		system.moved( step );
		system.precondition( r, z );
		const double next = dot( r, z, size );
		const float fraction = float( next / m_rz );
		m_rz = next;
		for ( int i = 0; i < size; ++i )
		{
			p[i] = z[i] + fraction * p[i];
		}
	}
	return count;
}

} // namespace pliant
