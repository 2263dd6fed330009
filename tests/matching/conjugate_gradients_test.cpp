// Conjugate gradients for several parts agree with those for one, and report each step to the system.

#include "matching/implicit/conjugate_gradients.h"

#include <gtest/gtest.h>

#include <cmath>

namespace pliant {
namespace {

/// A chain of springs on a soft foundation, with its diagonal as preconditioner.
class Chain : public LinearSystem
{
public:
	AlignedArray<float> gone = AlignedArray<float>( 64, 0.0f ); ///< A x minus its initial value

	int size() const override { return 64; }
	void apply( const float* v, float* to ) override
	{
		for ( int i = 0; i < size(); ++i )
		{
			m_last[std::size_t( i )] = to[i] = diagonal( i ) * v[i] - ( i > 0 ? v[i - 1] : 0.0f ) - ( i + 1 < size() ? v[i + 1] : 0.0f );
		}
	}
	void precondition( const float* r, float* z ) override
	{
		for ( int i = 0; i < size(); ++i )
		{
			z[i] = r[i] / diagonal( i );
		}
	}

	void moved( float by ) override
	{
		for ( std::size_t i = 0; i < gone.size(); ++i )
		{
			gone[i] += by * m_last[i];
		}
	}

private:
	AlignedArray<float> m_last = AlignedArray<float>( 64 );

	static float diagonal( int i ) { return 2.05f + 0.01f * float( i % 7 ); }
};

TEST( ConjugateGradients, GoOnWhereTheyStood )
{
	Chain chain, told;
	AlignedArray<float> b( 64 ), whole( 64, 0.0f ), parts( 64, 0.0f ), left( 64 );
	for ( std::size_t i = 0; i < b.size(); ++i )
	{
		b[i] = float( std::sin( 0.7 * double( i ) ) );
	}
	ConjugateGradients one, other;
	const int products = one.solve( chain, b.data(), whole.data(), GradientLimits{ 1e-8, 0.0, 200 } );
	other.begin( told, b.data() ); // the residual at 0
	int sum = 0;
	for ( const double fraction : { 1e-1, 1e-3, 1e-3, 1e-8 } )
	{
		const int own = other.iterate( told, parts.data(), GradientLimits{ fraction, 0.0, 200 } );
		sum += own;
		chain.apply( parts.data(), left.data() );
		for ( std::size_t i = 0; i < b.size(); ++i )
		{
			ASSERT_NEAR( told.gone[i], left[i], 1e-5f );
		}
	}
	EXPECT_EQ( sum, products );
	EXPECT_EQ( parts, whole );
}

} // namespace
} // namespace pliant
