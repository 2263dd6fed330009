// The implicit substep of a body without contacts.

#include "body/implicit/implicit_motion.h"
#include "matching/constants.h"
#include "support/block_body.h"
#include "support/clamped_bar.h"
#include "support/explicit_material.h"
#include "support/inverted_fraction.h"
#include "support/solve_alone.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <utility>
#include <vector>

namespace pliant {
namespace {

constexpr float kFrame = 1.0f / 60.0f;

/// An elastic material with about this alpha at a sixtieth of a second and cells of 0.1 m.
Material implicitMaterial( float alpha, float numericalDamping, int halfWidth = 1 )
{
	Material m = test::explicitMaterial();
	m.elasticity = Elasticity::Implicit;
	m.numericalDamping = numericalDamping;
	m.damping = 0.0f;
	m.wobbleDamping = 0.0f;
	m.regionHalfWidth = halfWidth;
	m.youngsModulus = alpha * m.density * 0.01f * float( halfWidth * ( halfWidth + 1 ) ) / ( 3.0f * kFrame * kFrame );
	return m;
}

int implicitSubstep( Body& body, float h, const Vec3& gravity = Vec3::Zero() )
{
	const StiffnessPlan plan = planStiffness( body.material(), body.lattice().cellSize, h, 1 );
	body.pushImplicitly( h, plan.alpha, gravity, nullptr );
	const int products = test::solveAlone( body );
	EXPECT_EQ( body.integrate( h ), BodyHealth::Good );
	return products;
}

/// Bounds the elastic energy, in units of the masses' energy at G: alpha / ( 2 h^2 ) sum a |x - goal|^2 is not accessible, but the nodes'
/// distance from the best rigid placement bounds it. The kinetic energy is exact.
double stretch( const Body& body )
{
	return test::shapeError( body );
}

TEST( ImplicitBody, ComesToRestFromAnyStretchAndNeverGainsEnergy )
{
	for ( const float alpha : { 0.5f, 30.0f, 3000.0f } )
	{
		for ( const int w : { 1, 2 } )
		{
			auto body = test::makeBlock( 6, 6, 6, 0.1f, implicitMaterial( alpha, 1.0f, w ) );
			for ( int i = 0; i < body->nodeCount(); ++i )
			{
				body->nodes().x.set( i, body->nodes().x0.get( i ).cwiseProduct( Vec3( 1.5f, 0.7f, 1.0f ) ) );
			}
			const double first = stretch( *body );
			double most = 0.0;
			for ( int k = 0; k < 240; ++k )
			{
				implicitSubstep( *body, kFrame );
				most = std::max( most, stretch( *body ) );
			}
			EXPECT_LE( most, first * 1.0001 ) << alpha << " w " << w;
			EXPECT_LT( stretch( *body ), 1e-4 ) << alpha << " w " << w;
			EXPECT_LT( body->sums().kineticEnergy, 1e-4 ) << alpha;
		}
	}
}

TEST( ImplicitBody, RecoversFromASinglePoint )
{
	for ( const float alpha : { 0.5f, 300.0f } )
	{
		auto body = test::makeBlock( 6, 6, 6, 0.1f, implicitMaterial( alpha, 1.0f ) );
		for ( int i = 0; i < body->nodeCount(); ++i )
		{
			body->nodes().x.set( i, Vec3( 0.3f, 0.1f, 0.7f ) );
		}
		for ( int k = 0; k < 600; ++k )
		{
			implicitSubstep( *body, kFrame );
		}
		EXPECT_LT( stretch( *body ), 1e-3 ) << alpha;
		EXPECT_EQ( test::invertedFraction( *body ), 0.0f ) << alpha;
	}
}

TEST( ImplicitBody, KeepsMomentumAndSpinInFreeFlight )
{
	for ( const float alpha : { 0.5f, 30.0f, 3000.0f } )
	{
		for ( const float sigma : { 0.0f, 1.0f } )
		{
			auto body = test::makeBlock( 6, 4, 5, 0.1f, implicitMaterial( alpha, sigma ) );
			for ( int i = 0; i < body->nodeCount(); ++i )
			{
				body->nodes().v.set( i, Vec3( 1, 2, -1 ) + Vec3( 0.5f, 2.0f, 1.0f ).cross( body->nodes().x.get( i ) ) );
			}
			const BodySums before = body->sums();
			for ( int k = 0; k < 600; ++k )
			{
				implicitSubstep( *body, kFrame );
			}
			const BodySums after = body->sums();
			EXPECT_LT( ( after.momentum - before.momentum ).norm() / before.momentum.norm(), 1e-5 ) << alpha << " " << sigma;
			EXPECT_LT( ( after.spin - before.spin ).norm() / before.spin.norm(), 1e-4 ) << alpha << " " << sigma;
			std::printf( "alpha %6.1f sigma %.0f: momentum %.1e spin %.1e stretch %.1e m\n", double( alpha ), double( sigma ),
				( after.momentum - before.momentum ).norm() / before.momentum.norm(),
				( after.spin - before.spin ).norm() / before.spin.norm(), stretch( *body ) );
		}
	}
}

/// Returns the largest and the last shape error of a block that is compressed by a fifth from all sides and released.
std::pair<double, double> ringing( const Material& m )
{
	auto body = test::makeBlock( 6, 6, 6, 0.1f, m );
	for ( int i = 0; i < body->nodeCount(); ++i )
	{
		body->nodes().x.set( i, 0.8f * body->nodes().x0.get( i ) );
	}
	double most = 0.0, last = 0.0;
	for ( int k = 0; k < 120; ++k )
	{
		implicitSubstep( *body, kFrame );
		most = std::max( most, stretch( *body ) );
		last = k >= 100 ? std::max( last, stretch( *body ) ) : 0.0;
	}
	return { most, last };
}

TEST( ImplicitBody, HasTheSetDamping )
{
	Material m = implicitMaterial( 0.5f, 0.0f );
	const double undamped = ringing( m ).second;
	m.damping = 10.0f;
	const double damped = ringing( m ).second;
	std::printf( "left after two seconds: %.4f m, with damping %.4f m\n", undamped, damped );
	EXPECT_GT( undamped, 0.01 );
	EXPECT_LT( damped, 0.3 * undamped );
}

TEST( ImplicitBody, WithKeptVolumeIsSafeHoweverStiff )
{
	for ( const float alpha : { 0.5f, 30.0f, 3000.0f } )
	{
		for ( const float kappa : { 2.0f, kLargestVolumeKeeping } )
		{
			Material m = implicitMaterial( alpha, 0.0f );
			m.volumeKeeping = kappa;
			const double first = 0.2 * std::sqrt( 3.0 * 35.0 / 12.0 ) * 0.1; // compressed by a fifth, times the rms arm of 6 cells
			// The energy of volume, 1 + 3 kappa times as much, may become one of shape.
			const double most = kappa > 2.0f ? std::sqrt( 1.0 + 3.0 * double( kappa ) ) : 1.5;
			EXPECT_LT( ringing( m ).first, most * first ) << alpha << " " << kappa;
		}
	}
}

// Rubber between two clamps: stretched to s times its length its width is s^-nu, pressed it buckles; neither may gain energy. With an
// operator that was not the derivative of the force it reached thousands of m/s.
TEST( ImplicitBody, OfRubberIsPulledAndPressedSafely )
{
	for ( const float alpha : { 6.0f, 3000.0f } )
	{
		for ( const double stretch : { 0.5, 2.0, 3.0 } )
		{
			Material m = implicitMaterial( alpha, 1.0f );
			m.volumeKeeping = kLargestVolumeKeeping;
			m.damping = 10.0f;
			test::ClampedBar bar( m );
			double fastest = 0.0;
			bar.pull( stretch, 240, [&] {
				for ( int i = 0; i < bar.nodes().count; ++i )
				{
					fastest = std::max( fastest, double( bar.nodes().v.get( i ).norm() ) );
				}
				implicitSubstep( bar.body(), kFrame );
			} );
			const Vec3d stretches = test::middleStretch( bar.nodes() );
			const double thin = std::pow( stretches.x(), -0.49 );
			std::printf( "alpha %4.0f, stretched %.2f times: width %.3f (%.3f), %.1f m/s at most\n", double( alpha ), stretches.x(),
				stretches.y(), thin, fastest );
			EXPECT_LT( fastest, 20.0 );
			if ( stretch > 1.0 )
			{
				EXPECT_NEAR( stretches.y() / thin, 1.0, 0.05 );
			}
		}
	}
}

TEST( ImplicitBody, SagsByTheoryAtAnyStep )
{
	// A bar of 16 cells, held at its top layer; sag of the free end rho g L^2 / ( 2 E ).
	for ( const int w : { 1, 2 } )
	{
		for ( const float step : { 1.0f / 30.0f, 1.0f / 60.0f, 1.0f / 240.0f } )
		{
			Material m = implicitMaterial( 40.0f, 1.0f, w );
			m.damping = 10.0f;
			m.youngsModulus = 1e6f;
			auto body = test::makeBlock( 4, 16, 4, 0.1f, m );
			for ( int i = 0; i < body->nodeCount(); ++i )
			{
				body->setPinned( i, body->nodes().x0.y[i] > 0.7f );
			}
			const auto lowest = [&] {
				double sum = 0.0;
				int count = 0;
				for ( int i = 0; i < body->nodeCount(); ++i )
				{
					if ( body->nodes().x0.y[i] < -0.7f )
					{
						sum += body->nodes().worldPosition( i ).y();
						++count;
					}
				}
				return sum / count;
			};
			const double before = lowest();
			for ( int k = 0; k < int( 4.0f / step ); ++k )
			{
				implicitSubstep( *body, step, Vec3( 0, -9.81f, 0 ) );
			}
			const double length = 1.5,
						 sag = 1000.0 * 9.81 * ( length * 1.55 - 0.5 * length * length ) / 1e6; // at the middle of the last layer
			std::printf( "w %d h 1/%.0f: sag %.5f of %.5f, %+.1f %%\n", w, 1.0 / double( step ), before - lowest(), sag,
				100.0 * ( ( before - lowest() ) / sag - 1.0 ) );
			EXPECT_NEAR( ( before - lowest() ) / sag, 1.0, w == 1 ? 0.02 : 0.06 );
		}
	}
}

TEST( ImplicitBody, OscillatesFreelyWithoutDamping )
{
	// Free bending of a bar: the remaining amplitude after five periods, and the period.
	for ( const float sigma : { 0.0f, 1.0f } )
	{
		Material m = implicitMaterial( 1.0f, sigma );
		m.youngsModulus = 6e4f;
		auto body = test::makeBlock( 16, 4, 4, 0.1f, m );
		const auto shape = [&]( int i ) {
			const double x = double( body->nodes().x0.x[i] ) / 1.6;
			return std::cos( 4.73 * x ) / std::cos( 2.365 ) + std::cosh( 4.73 * x ) / std::cosh( 2.365 );
		};
		for ( int i = 0; i < body->nodeCount(); ++i )
		{
			body->nodes().x.y[i] += 0.01f * float( shape( i ) );
		}
		// Deflection of both ends against the middle.
		const auto bend = [&] {
			double ends = 0.0, middle = 0.0;
			for ( int i = 0; i < body->nodeCount(); ++i )
			{
				const double x = double( body->nodes().x0.x[i] ),
							 y = body->nodes().worldPosition( i ).y() - double( body->nodes().x0.y[i] );
				ends += std::abs( x ) > 0.7 ? y / 32.0 : 0.0;
				middle += std::abs( x ) < 0.1 ? y / 32.0 : 0.0;
			}
			return ends - middle;
		};
		std::vector<double> at;
		for ( int k = 0; k < 400; ++k )
		{
			at.push_back( bend() );
			implicitSubstep( *body, kFrame );
		}
		int crossings = 0;
		double first = -1.0, last = -1.0, tail = 0.0;
		for ( std::size_t k = 1; k < at.size() && crossings < 11; ++k )
		{
			if ( at[k - 1] * at[k] < 0.0 )
			{
				last = double( k - 1 ) + at[k - 1] / ( at[k - 1] - at[k] );
				first = first < 0.0 ? last : first;
				++crossings;
			}
			if ( crossings >= 9 )
			{
				tail = std::max( tail, std::abs( at[k] ) );
			}
		}
		std::printf( "sigma %.0f: period %.3f s, left after five %.2f\n", double( sigma ),
			2.0 * ( last - first ) / std::max( 1, crossings - 1 ) * double( kFrame ), tail / at[0] );
		if ( sigma == 0.0f )
		{
			EXPECT_GE( tail / at[0], 0.7 );
			EXPECT_LE( tail / at[0], 1.1 );
		}
		else
		{
			EXPECT_LT( tail / at[0], 0.5 );
		}
	}
}

TEST( ImplicitBody, IsRefusedWhereThereIsNothingToLinearise )
{
	Material m = implicitMaterial( 1.0f, 1.0f );
	m.method = Method::SingleCluster;
	EXPECT_FALSE( check( m ).ok() );
	m = implicitMaterial( 1.0f, 1.5f );
	EXPECT_FALSE( check( m ).ok() );
	m = implicitMaterial( 1.0f, 1.0f );
	m.farLevels = 1;
	EXPECT_FALSE( check( m ).ok() );
	m = implicitMaterial( 1.0f, 1.0f );
	EXPECT_TRUE( check( m ).ok() );
}

} // namespace
} // namespace pliant
