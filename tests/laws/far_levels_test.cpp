// Far levels: bars stiffer than the reach of one substep of the finest level swing as in rod theory, at the same substep.

#include "support/block_body.h"
#include "support/explicit_material.h"
#include "support/inverted_fraction.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

namespace pliant {
namespace {

constexpr float kCell = 0.025f;        // m
constexpr float kStep = 1.0f / 240.0f; // s
constexpr double kPiD = 3.14159265358979323846;

/// `times`: Young's modulus over that of alpha = 1 without far levels.
Material stiff( double times, int farLevels )
{
	Material material = test::explicitMaterial();
	material.damping = 0.0f;
	material.wobbleDamping = 0.0f;
	material.farLevels = 0;
	const StiffnessPlan plan = planStiffness( material, kCell, kStep, 1 );
	material.youngsModulus = float( times * plan.reachedModulus / plan.alpha );
	material.farLevels = farLevels;
	return material;
}

/// The strongest period between half of `near` and twice it: the maximum of a windowed spectrum.
double periodOf( const std::vector<double>& values, double h, double near )
{
	const auto power = [&]( double period ) {
		double real = 0.0, imaginary = 0.0, mean = 0.0, weights = 0.0;
		const double count = double( values.size() );
		for ( int pass = 0; pass < 2; ++pass )
		{
			for ( std::size_t k = 0; k < values.size(); ++k )
			{
				const double window = 0.5 - 0.5 * std::cos( 2.0 * kPiD * ( double( k ) + 0.5 ) / count ),
							 angle = 2.0 * kPiD * double( k ) * h / period;
				( pass == 0 ? mean : real ) += window * ( pass == 0 ? values[k] : ( values[k] - mean ) * std::cos( angle ) );
				( pass == 0 ? weights : imaginary ) += window * ( pass == 0 ? 1.0 : ( values[k] - mean ) * std::sin( angle ) );
			}
			mean = pass == 0 ? mean / weights : mean;
		}
		return real * real + imaginary * imaginary;
	};
	double best = near, most = 0.0;
	for ( double ratio = 0.5; ratio < 2.0; ratio *= 1.003 )
	{
		const double found = power( ratio * near );
		best = found > most ? ratio * near : best;
		most = std::max( most, found );
	}
	return best;
}

struct BarCase
{
	int cells, width;
	double times;
	int farLevels;
	bool isHeld = true;
};

std::unique_ptr<Body> makeBar( const BarCase& bar )
{
	std::unique_ptr<Body> body = test::makeBlock( bar.width, bar.cells, bar.width, kCell, stiff( bar.times, bar.farLevels ) );
	NodeState& nodes = body->nodes();
	const float top = nodes.x0.y[nodes.count - 1];
	for ( int i = 0; i < nodes.count; ++i )
	{
		body->setPinned( i, bar.isHeld && nodes.x0.y[i] > top - 0.5f * kCell );
	}
	return body;
}

/// Releases the bar in the shape of its slowest mode and returns the period over theory's.
double ring( const BarCase& bar, double period, int axis, const std::function<double( double )>& shape )
{
	const std::unique_ptr<Body> body = makeBar( bar );
	NodeState& nodes = body->nodes();
	const StiffnessPlan plan = planStiffness( body->material(), kCell, kStep, 1 );
	const float top = nodes.x0.y[nodes.count - 1];
	const double length = ( bar.cells - ( bar.isHeld ? 0.5 : 1.0 ) ) * kCell, size = 0.002 * length;
	AlignedArray<float>& x = axis == 0 ? nodes.x.x : nodes.x.y;
	for ( int i = 0; i < nodes.count; ++i )
	{
		x[i] += float( size * shape( ( top - nodes.x0.y[i] ) / length ) );
	}
	const int every = std::max( 1, int( period / kStep / 100.0 ) ); // a hundred values a swing are enough
	std::vector<double> values( std::size_t( 5.0 * period / kStep / every ) );
	for ( double& value : values )
	{
		for ( int k = 0; k < every; ++k )
		{
			test::substep( *body, kStep, plan.alpha );
		}
		value = x[0];
	}
	const double measured = periodOf( values, kStep * every, period );
	std::printf( "bar %d x %d, E %.0f x, %d far levels (%s): period %+.1f %% of theory, reached E %.2f\n", bar.cells, bar.width, bar.times,
		bar.farLevels, axis == 0 ? "bending" : "stretch", 100.0 * ( measured / period - 1.0 ),
		double( plan.reachedModulus / body->material().youngsModulus ) );
	return measured / period;
}

double ringStretch( const BarCase& bar )
{
	// Rod held at one end: T = 4 L sqrt( rho / E ), u = sin( pi s / 2 L ).
	const Material material = stiff( bar.times, 0 );
	const double length = ( bar.cells - 0.5 ) * kCell;
	return ring( bar, 4.0 * length * std::sqrt( material.density / material.youngsModulus ), 1,
		[]( double s ) { return -std::sin( 0.5 * kPiD * s ); } );
}

double ringBend( const BarCase& bar )
{
	// Cantilever: omega = 1.8751^2 sqrt( E I / ( rho A ) ) / L^2, I / A = b^2 / 12.
	const Material material = stiff( bar.times, 0 );
	const double length = ( bar.cells - 0.5 ) * kCell, b = bar.width * kCell;
	const double omega = 1.8751 * 1.8751 * std::sqrt( material.youngsModulus * b * b / 12.0 / material.density ) / ( length * length );
	return ring( bar, 2.0 * kPiD / omega, 0, []( double s ) {
		const double a = 1.8751 * s, fraction = 0.7341;
		return 0.5 * ( std::cosh( a ) - std::cos( a ) - fraction * ( std::sinh( a ) - std::sin( a ) ) );
	} );
}

double ringFree( const BarCase& bar )
{
	// Free at both ends: omega = 4.7300^2 sqrt( E I / ( rho A ) ) / L^2.
	const Material material = stiff( bar.times, 0 );
	const double length = bar.cells * kCell, b = bar.width * kCell;
	const double omega = 4.73 * 4.73 * std::sqrt( material.youngsModulus * b * b / 12.0 / material.density ) / ( length * length );
	return ring( bar, 2.0 * kPiD / omega, 0, []( double s ) {
		const double a = 4.73 * s, fraction = 0.98250;
		return 0.5 * ( std::cosh( a ) + std::cos( a ) - fraction * ( std::sinh( a ) + std::sin( a ) ) );
	} );
}

class FarBar : public testing::TestWithParam<int> ///< cells across
{};

TEST_P( FarBar, HeldAtOneEndRingsAlongItselfAsRodTheorySays )
{
	for ( const double times : { 3.0, 10.0, 30.0, 60.0 } )
	{
		EXPECT_NEAR( ringStretch( { 64, GetParam(), times, 3 } ), 1.0, 0.1 ) << times;
	}
}

TEST_P( FarBar, HeldAtOneEndBendsAsBeamTheorySays )
{
	for ( const double times : { 10.0, 30.0 } )
	{
		EXPECT_NEAR( ringBend( { 64, GetParam(), times, 3 } ), 1.0, 0.1 ) << times;
	}
}

TEST_P( FarBar, FreeBendsAsBeamTheorySays )
{
	for ( const double times : { 3.0, 30.0 } )
	{
		EXPECT_NEAR( ringFree( { 64, GetParam(), times, 3, false } ), 1.0, 0.1 ) << times;
	}
}

TEST_P( FarBar, HangsAsRodTheorySays )
{
	for ( const double times : { 3.0, 10.0, 30.0, 60.0 } )
	{
		const float gravity = 0.02f * float( times );
		const std::unique_ptr<Body> body = makeBar( { 64, GetParam(), times, 3 } );
		Material material = body->material();
		material.damping = 20.0f;
		material.wobbleDamping = 1.0f;
		ASSERT_TRUE( body->setMaterial( material ).ok() );
		for ( int k = 0; k < 3000; ++k )
		{
			test::substep( *body, kStep, planStiffness( material, kCell, kStep, 1 ).alpha, Vec3( 0, -gravity, 0 ) );
		}
		// The lowest centres, s = L - d / 2 below the held ones: rho g ( L s - s^2 / 2 ) / E.
		const double length = 63.5 * kCell, s = 63.0 * kCell;
		const double sag = double( material.density ) * gravity * ( length * s - 0.5 * s * s ) / material.youngsModulus;
		const double measured = double( body->nodes().x0.y[0] ) - body->nodes().worldPosition( 0 ).y();
		std::printf( "bar 64 x %d, E %.0f x: sag %+.1f %% of theory\n", GetParam(), times, 100.0 * ( measured / sag - 1.0 ) );
		EXPECT_NEAR( measured / sag, 1.0, 0.25 );
	}
}

INSTANTIATE_TEST_SUITE_P( Widths, FarBar, testing::Values( 4, 8 ) );

/// The substep at which the far end of a bar of 64 cells has made half of a sudden displacement of its other end.
int arrival( double times, int farLevels )
{
	const std::unique_ptr<Body> body = makeBar( { 64, 4, times, farLevels, true } );
	NodeState& nodes = body->nodes();
	const float move = 0.1f * kCell;
	for ( int i = 0; i < nodes.count; ++i )
	{
		nodes.x.y[i] += nodes.freedom[i] == 0.0f ? move : 0.0f;
	}
	const double start = body->nodes().worldPosition( 0 ).y();
	int substeps = 0;
	while ( substeps < 1000 && body->nodes().worldPosition( 0 ).y() - start < 0.5 * double( move ) )
	{
		test::substep( *body, kStep, 1.0f );
		++substeps;
	}
	return substeps;
}

TEST( FarLevels, CarryAPushAlongABarInFewSubsteps )
{
	const int plain = arrival( 1.0, 0 ), one = arrival( 4.0, 1 ), two = arrival( 20.0, 2 ), three = arrival( 60.0, 3 );
	std::printf( "64 cells in %d substeps; with one, two, three far levels at work %d, %d, %d\n", plain, one, two, three );
	EXPECT_GT( plain, 60 ); // 64 cells at sqrt( 2 / 3 ) a substep
	EXPECT_LT( three, plain / 5 );
}

TEST( FarLevels, KeepBothMomentaInFreeFlight )
{
	const std::unique_ptr<Body> body = makeBar( { 48, 6, 30.0, 3, false } );
	NodeState& nodes = body->nodes();
	test::Seeded random( 3 );
	for ( int i = 0; i < nodes.count; ++i )
	{
		const Vec3 x = nodes.x.get( i );
		nodes.v.set( i, Vec3( 1, 2, -1 ) + Vec3( 1, 2, 3 ).cross( x ) + Vec3( 0.5f * x.x(), -0.7f * x.y(), x.x() * x.y() ) );
		nodes.x.set( i, x + random.inBox( 0.2f * kCell ) );
	}
	const BodySums before = body->sums();
	for ( int k = 0; k < 5000; ++k )
	{
		ASSERT_EQ( test::substep( *body, kStep, 1.0f ), BodyHealth::Good );
	}
	const BodySums after = body->sums();
	const double linear = ( after.momentum - before.momentum ).norm() / before.momentum.norm();
	const double angular = ( after.spin - before.spin ).norm() / before.spin.norm();
	std::printf( "5000 substeps of free flight with three far levels: linear %.1e, angular %.1e, energy %.3f of the first\n", linear,
		angular, after.kineticEnergy / before.kineticEnergy );
	EXPECT_LT( linear, 5e-4 );
	EXPECT_LT( angular, 5e-4 );
}

using Mangle = std::function<Vec3( const Vec3&, test::Seeded& )>;

/// Distorts a bar with three far levels near their limit, waits, and checks that it has recovered.
void expectReturn( int width, float damping, const Mangle& mangle )
{
	const std::unique_ptr<Body> body = makeBar( { 32, width, 60.0, 3, false } );
	Material material = body->material();
	material.damping = damping;
	material.wobbleDamping = 0.15f;
	ASSERT_TRUE( body->setMaterial( material ).ok() );
	NodeState& nodes = body->nodes();
	test::Seeded random( 11 );
	for ( int i = 0; i < nodes.count; ++i )
	{
		nodes.x.set( i, mangle( nodes.x.get( i ), random ) );
	}
	for ( int k = 0; k < 800; ++k )
	{
		ASSERT_EQ( test::substep( *body, kStep, 1.0f ), BodyHealth::Good );
	}
	EXPECT_LT( test::shapeError( *body ), 0.01 * kCell );
	EXPECT_EQ( test::invertedFraction( *body ), 0.0f );
}

TEST( FarLevels, ComeBackFromAnything )
{
	const Mangle mangles[] = { []( const Vec3& x, test::Seeded& ) { return Vec3( x.x(), 0.0f, x.z() ); },
		[]( const Vec3& x, test::Seeded& ) { return Vec3( x.x(), -x.y(), x.z() ); },
		[]( const Vec3&, test::Seeded& random ) { return random.inBox( 0.4f ); },
		[]( const Vec3&, test::Seeded& ) { return Vec3( 0, 0, 0 ); } };
	for ( const Mangle& mangle : mangles )
	{
		expectReturn( 6, 10.0f, mangle );
		expectReturn( 6, 1000.0f, mangle );
		expectReturn( 12, 10.0f, mangle );
	}
}

} // namespace
} // namespace pliant
