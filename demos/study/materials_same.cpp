// +-----------------------------------------------------------------------------------------------------------------+
// | M13 to M15: parameters that must not matter: level of detail, step, and orientation of the lattice.              |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/study/materials.h"
#include "demos/study/theory.h"

#include <Eigen/LU>

#include <cmath>

namespace pliant_study {

namespace {

constexpr double kFreeRoot = 4.730040745; // cos( root ) cosh( root ) = 1: free at both ends
constexpr int kMostSameSteps = 20000;
constexpr double kSmallSameStrain = 0.01;

CouponOrder sameOrder( int x, int y, int z )
{
	CouponOrder order;
	order.cells = { x, y, z };
	order.material.wobbleDamping = 0;
	order.material.damping = 5;
	return order;
}

/// u = a + b x + c x^2 by least squares by mass over the selected nodes: c, and b in the middle.
struct Curve
{
	double slope = 0, half = 0; ///< b, c
};

Curve curveOf( const Coupon& bar, Eigen::Index component, double reach )
{
	Eigen::Matrix3d own = Eigen::Matrix3d::Zero();
	Eigen::Vector3d sum = Eigen::Vector3d::Zero();
	for ( int i = 0; i < bar.count(); ++i )
	{
		const double x = bar.rest( i ).x();
		if ( std::abs( x ) < reach )
		{
			const Eigen::Vector3d powers( 1, x, x * x );
			own += bar.mass( i ) * powers * powers.transpose();
			sum += bar.mass( i ) * bar.moved( i )[component] * powers;
		}
	}
	const Eigen::Vector3d fit = own.inverse() * sum;
	return { fit[1], fit[2] };
}

Where endOf( double half, double grip, double sign )
{
	return [=]( const Eigen::Vector3d& rest ) { return sign * rest.x() > half - grip; };
}

/// E I over the beam's, from the curvature of a bar between two couples at its ends.
double bendingStiffness( Coupon& bar, double grip )
{
	const Eigen::Vector3d edges = bar.order().cell * bar.order().cells.cast<double>();
	const double stiff = bar.modulus() * edges.z() * std::pow( edges.y(), 3 ) / 12, curvature = 2 * kSmallSameStrain / edges.y();
	bar.clearForces();
	for ( const double sign : { -1.0, 1.0 } )
	{
		bar.bend( endOf( edges.x() / 2, grip, sign ), sign * curvature * stiff );
	}
	bar.settle( kMostSameSteps );
	return curvature / ( 2 * curveOf( bar, 1, edges.x() / 4 ).half );
}

/// The stretch of a hanging bar across its middle under its own weight, over rho g s / E; its upper end is held by an equal force.
double sag( Coupon& bar, double grip )
{
	const CouponOrder& order = bar.order();
	const double length = order.cell * order.cells.x(), half = length / 2, density = double( order.material.density );
	const double gravity = 2 * kSmallSameStrain * bar.modulus() / ( density * length );
	bar.push( [gravity]( const Eigen::Vector3d& ) { return Eigen::Vector3d( -gravity, 0, 0 ); } );
	double mass = 0;
	for ( int i = 0; i < bar.count(); ++i )
	{
		mass += bar.mass( i );
	}
	bar.pushAt( endOf( half, grip, 1 ), { mass * gravity, 0, 0 } );
	bar.settle( kMostSameSteps );
	// In the middle half of its weight is below: rho g L / ( 2 E ).
	return curveOf( bar, 0, half / 2 ).slope / ( density * gravity * half / bar.modulus() );
}

/// Frequency of the slowest bending of a free bar, 1/s.
double bendingFrequency( Coupon& bar )
{
	const CouponOrder& order = bar.order();
	const double length = order.cell * order.cells.x(), k = kFreeRoot / length, c = std::cos( kFreeRoot / 2 ) / std::cosh( kFreeRoot / 2 );
	const Field shape = [&]( const Eigen::Vector3d& rest ) {
		const double s = rest.x();
		return Eigen::Vector3d(
			k * rest.y() * ( std::sin( k * s ) - std::sinh( k * s ) * c ), std::cos( k * s ) + std::cosh( k * s ) * c, 0 );
	};
	bar.clearForces();
	bar.put( [&]( const Eigen::Vector3d& rest ) { return Eigen::Vector3d( rest + 1e-3 * length * shape( rest ) ); } );
	double before = 1, first = 0, last = 0;
	int crossings = 0;
	for ( int step = 1; step < kMostSameSteps && crossings < 5; ++step )
	{
		bar.step();
		const double now = bar.along( shape );
		if ( before * now < 0 )
		{
			last = ( step - now / ( now - before ) ) * order.gameStep;
			first = crossings++ == 0 ? last : first;
		}
		before = now;
	}
	return crossings > 1 ? ( crossings - 1 ) / ( 2 * ( last - first ) ) : 0;
}

} // namespace

std::vector<MaterialRow> measureLevels( bool isShort )
{
	const int high = isShort ? 8 : 16, most = isShort ? 1 : 3;
	std::vector<double> modulus, stiffness, weights, frequency;
	std::vector<MaterialRow> rows;
	for ( int level = 0; level <= most + 1; ++level )
	{
		CouponOrder order = sameOrder( 4 * high, high, high );
		order.adaptivity.coarseLevels = std::min( level, most );
		order.adaptivity.isSurfaceFine = level > most; // mixed: fine nodes at the surface, coarse ones inside
		const double grip = order.cell * ( 1 << most );
		Coupon drawn( order ), bent( order ), hung( order );
		modulus.push_back( drawBar( drawn, kSmallSameStrain, grip ).modulus / drawn.modulus() );
		stiffness.push_back( bendingStiffness( bent, grip ) );
		weights.push_back( sag( hung, grip ) );
		order.material.damping = 0;
		order.substeps = 1;
		order.gameStep /= 4;
		Coupon swinging( order );
		frequency.push_back( bendingFrequency( swinging ) );
		const std::string name = ( level > most ? std::string( "mixed levels" ) : "level " + std::to_string( level ) ) + ", " +
			std::to_string( drawn.count() ) + " nodes: ";
		rows.push_back( { "M13", name + "E", "", modulus.back(), 1, 0.1, Judge::Ratio, "" } );
		rows.push_back( { "M13", name + "bending stiffness", "", stiffness.back(), 1, 0.1, Judge::Ratio, "couples at the ends" } );
		rows.push_back( { "M13", name + "sag under its weight", "", weights.back(), 1, 0.1, Judge::Ratio, "" } );
		rows.push_back(
			{ "M13", name + "bending frequency, over level 0's", "", frequency.back() / frequency.front(), 1, 0.1, Judge::Ratio, "" } );
	}
	rows.push_back( spreadRow( "M13", "over all levels: E", "", modulus, 0.1 ) );
	rows.push_back( spreadRow( "M13", "over all levels: bending stiffness", "", stiffness, 0.1 ) );
	rows.push_back( spreadRow( "M13", "over all levels: sag under its weight", "", weights, 0.1 ) );
	rows.push_back( spreadRow( "M13", "over all levels: bending frequency", "Hz", frequency, 0.1 ) );
	return rows;
}

std::vector<MaterialRow> measureSteps( bool isShort )
{
	struct Step
	{
		double rate;
		int substeps;
	};
	std::vector<Step> steps = { { 60, 1 }, { 60, 8 }, { 480, 1 } };
	if ( !isShort )
	{
		steps = { { 30, 2 }, { 60, 1 }, { 60, 2 }, { 60, 4 }, { 60, 8 }, { 120, 1 }, { 240, 1 }, { 480, 1 } };
	}
	std::vector<double> modulus, tips;
	std::vector<MaterialRow> rows;
	for ( const Step& step : steps )
	{
		CouponOrder order = sameOrder( 30, 6, 6 );
		order.gameStep = 1.0 / 60;
		order.substeps = 1;
		order.material.youngsModulus = float( modulusWithin( order, 0.9 ) );
		order.reach = 0;
		order.gameStep = 1 / step.rate;
		order.substeps = step.substeps;
		Coupon drawn( order );
		modulus.push_back( drawBar( drawn, kSmallSameStrain, order.cell ).modulus );
		order.cells = { 40, 4, 1 };
		Coupon laden( order );
		tips.push_back( loadedTip( laden ) );
		const std::string name = "step 1/" + shortNumber( step.rate ) + " s, " + std::to_string( step.substeps ) + " substeps: ";
		rows.push_back( { "M14", name + "E", "Pa", modulus.back(), drawn.modulus(), 0.05, Judge::Ratio, "" } );
		rows.push_back( { "M14", name + "cantilever's tip over theory", "", tips.back(), 1, 0.1, Judge::Ratio, "" } );
	}
	rows.push_back( spreadRow( "M14", "over all steps: E", "Pa", modulus, 0.05 ) );
	rows.push_back( spreadRow( "M14", "over all steps: cantilever's tip", "", tips, 0.05 ) );
	return rows;
}

std::vector<MaterialRow> measureTurned( bool isShort )
{
	std::vector<double> modulus, stiffness, weights;
	std::vector<MaterialRow> rows;
	for ( const double degrees : isShort ? std::vector<double>{ 0, 45 } : std::vector<double>{ 0, 10, 20, 30, 40, 45 } )
	{
		CouponOrder order = sameOrder( 48, 12, 4 );
		order.degrees = degrees;
		const double grip = 4 * order.cell;
		Coupon drawn( order ), bent( order ), hung( order );
		modulus.push_back( drawBar( drawn, kSmallSameStrain, grip ).modulus / drawn.modulus() );
		stiffness.push_back( bendingStiffness( bent, grip ) );
		weights.push_back( sag( hung, grip ) );
		const std::string name = "lattice at " + shortNumber( degrees ) + " degrees: ";
		rows.push_back( { "M15", name + "E", "", modulus.back(), 1, 0.1, Judge::Ratio, "" } );
		rows.push_back( { "M15", name + "bending stiffness", "", stiffness.back(), 1, 0.1, Judge::Ratio, "" } );
		rows.push_back( { "M15", name + "sag under its weight", "", weights.back(), 1, 0.1, Judge::Ratio, "" } );
	}
	rows.push_back( spreadRow( "M15", "over all angles: E", "", modulus, 0.1 ) );
	rows.push_back( spreadRow( "M15", "over all angles: bending stiffness", "", stiffness, 0.1 ) );
	rows.push_back( spreadRow( "M15", "over all angles: sag under its weight", "", weights, 0.1 ) );
	return rows;
}

} // namespace pliant_study
