#include "matching/conjugate_gradients.h"

#include "matching/kernels/kernels.h"

namespace pliant {

double dot( const float* a, const float* b, int size )
{
	return bestKernels().dot( a, b, size );
}

int ConjugateGradients::solve( LinearSystem& system, const float* b, float* x, const GradientLimits& limits )
{
	const int size = system.size();
	for ( AlignedArray<float>* array : { &m_r, &m_z, &m_p, &m_ap } )
	{
		array->resize( std::size_t( size ) );
	}
	float *const r = m_r.data(), *const z = m_z.data(), *const p = m_p.data(), *const ap = m_ap.data();
	system.apply( x, ap );
	for ( int i = 0; i < size; ++i )
	{
		r[i] = b[i] - ap[i];
	}
	system.precondition( r, z );
	double rz = dot( r, z, size );
	const double enough = std::max( limits.relative * rz, limits.absolute );
	std::copy( z, z + size, p );
	int count = 0;
	while ( count < limits.most && rz > enough )
	{
		system.apply( p, ap );
		++count;
		const double curvature = dot( p, ap, size );
		if ( !( curvature > 0.0 ) )
		{
			break;
		}
		const float step = float( rz / curvature );
		for ( int i = 0; i < size; ++i )
		{
			x[i] += step * p[i];
			r[i] -= step * ap[i];
		}
		system.precondition( r, z );
		const double next = dot( r, z, size );
		const float share = float( next / rz );
		rz = next;
		for ( int i = 0; i < size; ++i )
		{
			p[i] = z[i] + share * p[i];
		}
	}
	return count;
}

} // namespace pliant
