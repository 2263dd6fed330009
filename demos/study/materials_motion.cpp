// +-----------------------------------------------------------------------------------------------------------------+
// | M6, M7, M12: frequency and damping of a bar, and recovery of a body that was twisted or crushed.                 |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/study/materials.h"
#include "demos/study/theory.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <random>

namespace pliant_study {

namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kClampedRoot = 1.8751040687; // cos( root ) cosh( root ) = -1: held at one end, free at the other

/// The slowest bending mode of a beam of length 1 that is held at 0, 1 at its end; `y` above its middle, where sections rotate.
Eigen::Vector3d clampedMode( double s, double y )
{
	const double r = kClampedRoot, fraction = ( std::cosh( r ) + std::cos( r ) ) / ( std::sinh( r ) + std::sin( r ) );
	const double height = ( std::cosh( r * s ) - std::cos( r * s ) - fraction * ( std::sinh( r * s ) - std::sin( r * s ) ) ) / 2;
	const double slope = r * ( std::sinh( r * s ) + std::sin( r * s ) - fraction * ( std::cosh( r * s ) - std::cos( r * s ) ) ) / 2;
	return { -y * slope, height, 0 };
}

struct Swing
{
	double period = 0;          ///< s
	double first = 0, last = 0; ///< largest amplitude in the first and in the last oscillation
	double swings = 0;          ///< between them
};

/// Follows a value that oscillates about 0 for `swings` oscillations of about `period` s.
template <class Value>
Swing follow( Coupon& coupon, double period, int swings, const Value& value )
{
	const double h = coupon.order().gameStep;
	const int steps = int( swings * period / h ), aSwing = int( period / h );
	Swing found;
	double before = value(), firstCrossing = -1, lastCrossing = -1;
	int crossings = 0;
	for ( int k = 1; k <= steps && coupon.isHealthy(); ++k )
	{
		coupon.step();
		const double now = value();
		if ( before * now < 0 )
		{
			lastCrossing = ( k - now / ( now - before ) ) * h;
			firstCrossing = crossings++ == 0 ? lastCrossing : firstCrossing;
		}
		double& largest = k <= aSwing ? found.first : found.last;
		largest = k <= aSwing || k > steps - aSwing ? std::max( largest, std::abs( now ) ) : largest;
		before = now;
	}
	found.period = crossings > 1 ? 2 * ( lastCrossing - firstCrossing ) / ( crossings - 1 ) : 0;
	found.swings = swings - 1;
	return found;
}

CouponOrder silentOrder( int x, int y, int z )
{
	CouponOrder order;
	order.cells = { x, y, z };
	order.material.damping = 0;
	order.material.wobbleDamping = 0;
	return order;
}

/// One of a thousand crushed states of a body: its kind, and the body's orientation.
Field mangle( int kind, unsigned seed, const Coupon& coupon )
{
	std::mt19937 random( seed );
	const auto even = [&random] { return double( random() ) / 4294967296.0 - 0.5; };
	const Eigen::Quaterniond turn = Eigen::Quaterniond( even(), even(), even(), even() ).normalized();
	if ( kind == 1 )
	{
		std::vector<Eigen::Vector3d> positions = coupon.rest();
		for ( std::size_t k = positions.size() - 1; k > 0; --k )
		{
			std::swap( positions[k], positions[random() % ( k + 1 )] );
		}
		return [positions, k = std::size_t( 0 )]( const Eigen::Vector3d& ) mutable { return positions[k++]; };
	}
	const double squeeze[] = { 0.05, 1, 0, -1 }; // to a twentieth of its height, -, flat, inverted
	const Eigen::Vector3d scale( 1, squeeze[kind], 1 );
	return [turn, scale]( const Eigen::Vector3d& rest ) { return Eigen::Vector3d( turn * scale.cwiseProduct( turn.conjugate() * rest ) ); };
}

} // namespace

std::vector<MaterialRow> measureFrequency( bool isShort )
{
	std::vector<MaterialRow> rows;
	{
		const int swings = isShort ? 10 : 100;
		CouponOrder order = silentOrder( 40, 4, 1 );
		Coupon bar( order );
		const double d = order.cell, half = 20 * d, length = 39.5 * d, size = 0.01 * length;
		bar.hold( [&]( const Eigen::Vector3d& rest ) { return rest.x() < -half + d; } );
		const Field mode = [&]( const Eigen::Vector3d& rest ) {
			return clampedMode( ( rest.x() + half - d / 2 ) / length, rest.y() / length );
		};
		bar.put( [&]( const Eigen::Vector3d& rest ) { return Eigen::Vector3d( rest + size * mode( rest ) ); } );
		// omega = root^2 sqrt( E I / ( rho A ) ) / L^2, I / A = t^2 / 12
		const double omega = kClampedRoot * kClampedRoot * std::sqrt( bar.modulus() / double( order.material.density ) * 16 * d * d / 12 ) /
			( length * length );
		const Swing swing = follow( bar, 2 * kPi / omega, swings, [&] { return bar.along( mode ); } );
		rows.push_back( { "M6", "cantilever, L/t 10: first bending frequency", "Hz", 1 / swing.period, omega / ( 2 * kPi ), 0.05,
			Judge::Ratio, "Euler-Bernoulli" } );
		// Energy is proportional to the square of the amplitude.
		const double lost = 1 - std::pow( std::pow( swing.last / swing.first, 2 ), 100 / swing.swings );
		rows.push_back( { "M6", "the same without damping: energy lost in 100 periods", "", std::abs( lost ), 0, 0.05, Judge::AtMost,
			std::to_string( swings ) + " followed" } );
	}
	// A free bar stretched along its axis; its amplitude falls by exp( -2 pi zeta ) a period.
	const double zeta = 0.05;
	CouponOrder order = silentOrder( 40, 4, 4 );
	order.material.wobbleDamping = float( zeta );
	order.substeps = 1;
	order.gameStep = 1.0 / 240;
	Coupon bar( order );
	const double length = 40 * order.cell, omega = kPi * std::sqrt( bar.modulus() / double( order.material.density ) ) / length;
	bar.put( [&]( const Eigen::Vector3d& rest ) {
		return Eigen::Vector3d( rest + Eigen::Vector3d( 0.01 * length * std::sin( kPi * rest.x() / length ), 0, 0 ) );
	} );
	const auto isLast = [&]( const Eigen::Vector3d& rest ) { return rest.x() > length / 2 - order.cell; };
	const auto isFirst = [&]( const Eigen::Vector3d& rest ) { return rest.x() < -length / 2 + order.cell; };
	const Swing swing = follow( bar, 2 * kPi / omega, 6, [&] { return bar.meanMoved( isLast ).x() - bar.meanMoved( isFirst ).x(); } );
	// From the largest amplitude of the first oscillation to that of the last: both at half of their oscillation.
	rows.push_back(
		{ "M6", "free bar drawn along itself: frequency", "Hz", 1 / swing.period, omega / ( 2 * kPi ), 0.05, Judge::Ratio, "rod theory" } );
	rows.push_back( { "M6", "the same, wobbleDamping 0.05: damping ratio", "",
		std::log( swing.first / swing.last ) / ( 2 * kPi * swing.swings ), zeta, 0.01, Judge::Difference, "" } );
	return rows;
}

std::vector<MaterialRow> measureTwist( bool isShort )
{
	std::vector<MaterialRow> rows;
	for ( const double degrees : isShort ? std::vector<double>{ 270 } : std::vector<double>{ 270, 720 } )
	{
		CouponOrder order;
		order.cells = { 24, 6, 6 };
		order.reach = 0.5;
		Coupon bar( order );
		const double length = 24 * order.cell;
		bar.put( [&]( const Eigen::Vector3d& rest ) {
			return Eigen::Vector3d( Eigen::AngleAxisd( degrees * kPi / 180 * rest.x() / length, Eigen::Vector3d::UnitX() ) * rest );
		} );
		for ( int k = 0; k < 600 && bar.isHealthy(); ++k )
		{
			bar.step();
		}
		const double box = order.cell * order.cells.cast<double>().norm();
		rows.push_back( { "M7", "twisted by " + shortNumber( degrees ) + " degrees, let go: off its shape after 10 s", "bbox",
			bar.misfit() / box, 0, 1e-3, Judge::AtMost, "" } );
		rows.push_back( { "M7", "the same: inverted cells", "", bar.invertedFraction(), 0, 0, Judge::AtMost, "" } );
	}
	return rows;
}

std::vector<MaterialRow> measureSquash( bool isShort )
{
	const char* const kNames[] = { "squashed to 5 %", "scrambled", "flattened", "turned inside out" };
	const int each = isShort ? 5 : 250;
	std::vector<MaterialRow> rows;
	for ( int kind = 0; kind < 4; ++kind )
	{
		CouponOrder order;
		order.cells = { 6, 6, 6 };
		order.reach = 0;
		order.material.youngsModulus = 6e4f; // compressed by a tenth under its own weight
		Coupon cube( order );
		const double box = order.cell * order.cells.cast<double>().norm();
		int back = 0;
		for ( int k = 0; k < each && cube.isHealthy(); ++k )
		{
			cube.put( mangle( kind, unsigned( 1 + k ), cube ) );
			for ( int step = 0; step < 120; ++step )
			{
				cube.step();
			}
			back += cube.isHealthy() && cube.misfit() < 0.01 * box && cube.invertedFraction() == 0 ? 1 : 0;
			cube.put( []( const Eigen::Vector3d& rest ) { return rest; } );
		}
		rows.push_back( { "M12", std::string( kNames[kind] ) + ", let go: back within 2 s", "of " + std::to_string( each ), double( back ),
			double( each ), 0, Judge::Difference, "to 1 % of its box, nothing inverted" } );
	}
	return rows;
}

} // namespace pliant_study
