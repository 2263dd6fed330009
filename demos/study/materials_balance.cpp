// +-----------------------------------------------------------------------------------------------------------------+
// | M1 to M5: bars in equilibrium under small and large loads, against the theory of elasticity.                     |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/study/materials.h"
#include "demos/study/theory.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace pliant_study {

namespace {

constexpr int kMostSteps = 40000;
constexpr double kSmallStrain = 0.01;
constexpr double kCalm = 5; // 1/s: damps fast vibrations

CouponOrder barOrder( int x, int y, int z )
{
	CouponOrder order;
	order.cells = { x, y, z };
	order.material.wobbleDamping = 0;
	order.material.damping = float( kCalm );
	return order;
}

/// The middle third of the box along x.
Where middleThird( const Coupon& coupon )
{
	const double half = coupon.order().cells.x() * coupon.order().cell / 6;
	return [half]( const Eigen::Vector3d& rest ) { return std::abs( rest.x() ) < half; };
}

Where beyond( Eigen::Index axis, double from, double sign )
{
	return [axis, from, sign]( const Eigen::Vector3d& rest ) { return sign * rest[axis] > from; };
}

} // namespace

TensionResult drawBar( Coupon& bar, double strain, double grip )
{
	const CouponOrder& order = bar.order();
	const Eigen::Vector3d edges = order.cell * order.cells.cast<double>();
	const double stress = strain * bar.modulus(), force = stress * edges.y() * edges.z();
	bar.clearForces();
	for ( const double sign : { -1.0, 1.0 } )
	{
		bar.pushAt( beyond( 0, edges.x() / 2 - grip, sign ), { sign * force, 0, 0 } );
	}
	bar.settle( kMostSteps );
	// E = sigma / e_x, nu = -e_y / e_x; the symmetric part, since rotation is no strain.
	const Eigen::Matrix3d f = bar.deformation( middleThird( bar ) );
	const Eigen::Matrix3d e = ( f + f.transpose() ) / 2 - Eigen::Matrix3d::Identity();
	return { stress / e( 0, 0 ), -( e( 1, 1 ) + e( 2, 2 ) ) / 2 / e( 0, 0 ) };
}

std::vector<MaterialRow> measureTension( bool isShort )
{
	struct Case
	{
		double strain, volumeKeeping;
		int halfWidth;
	};
	std::vector<Case> cases = { { kSmallStrain, 0, 1 }, { kSmallStrain, 1, 1 } };
	if ( !isShort )
	{
		cases = { { kSmallStrain, 0, 1 }, { -kSmallStrain, 0, 1 }, { kSmallStrain, 0, 2 }, { kSmallStrain, 0, 3 }, { kSmallStrain, 0.5, 1 },
			{ kSmallStrain, 1, 1 }, { -kSmallStrain, 1, 1 }, { kSmallStrain, 2, 1 } };
	}
	std::vector<MaterialRow> rows;
	for ( const Case& one : cases )
	{
		CouponOrder order = barOrder( 30, 6, 6 );
		order.reach = 0.5;
		order.material.regionHalfWidth = one.halfWidth;
		order.material.volumeKeeping = float( one.volumeKeeping );
		Coupon bar( order );
		const TensionResult found = drawBar( bar, one.strain, order.cell );
		const std::string name = std::string( one.strain > 0 ? "tension" : "compression" ) + ", w " + std::to_string( one.halfWidth ) +
			", kept volume " + shortNumber( one.volumeKeeping );
		rows.push_back( { "M1", name + ": E", "Pa", found.modulus, bar.modulus(), 0.05, Judge::Ratio, "" } );
		// nu = kappa / ( 2 kappa + 1 )
		rows.push_back(
			{ "M1", name + ": nu", "", found.poisson, one.volumeKeeping / ( 2 * one.volumeKeeping + 1 ), 0.02, Judge::Difference, "" } );
	}
	return rows;
}

std::vector<MaterialRow> measureShear( bool isShort )
{
	std::vector<MaterialRow> rows;
	for ( const double volumeKeeping : isShort ? std::vector<double>{ 0 } : std::vector<double>{ 0, 1 } )
	{
		CouponOrder order = barOrder( 18, 18, 6 );
		order.reach = 0.5;
		order.material.volumeKeeping = float( volumeKeeping );
		Coupon block( order );
		const double edge = order.cell * 18, area = ( edge - order.cell ) * order.cell * 6;
		const double nu = volumeKeeping / ( 2 * volumeKeeping + 1 ), stress = kSmallStrain * block.modulus() / 2;
		// The same shear stress on all four sides, so that there is no torque. Forces act on the centres of the outer cells: these are
		// the sides.
		for ( const double sign : { -1.0, 1.0 } )
		{
			block.pushAt( beyond( 0, edge / 2 - order.cell, sign ), { 0, sign * stress * area, 0 } );
			block.pushAt( beyond( 1, edge / 2 - order.cell, sign ), { sign * stress * area, 0, 0 } );
		}
		block.settle( kMostSteps );
		const Eigen::Matrix3d f = block.deformation(
			[edge]( const Eigen::Vector3d& rest ) { return rest.cwiseAbs().head<2>().maxCoeff() < edge / 6; } );
		rows.push_back( { "M2", "pure shear, kept volume " + shortNumber( volumeKeeping ) + ": G", "Pa", stress / ( f( 0, 1 ) + f( 1, 0 ) ),
			block.modulus() / ( 2 * ( 1 + nu ) ), 0.08, Judge::Ratio, "" } );
	}
	return rows;
}

double loadedTip( Coupon& bar )
{
	const CouponOrder& order = bar.order();
	const Eigen::Vector3d edges = order.cell * order.cells.cast<double>();
	const Where first = beyond( 0, edges.x() / 2 - order.cell, -1 ), last = beyond( 0, edges.x() / 2 - order.cell, 1 );
	bar.hold( first );
	// From the centres of the held cells to those of the loaded cells: P s^3 / ( 3 E I ) + P s / ( 5/6 G A ), nu = 0.
	const double s = bar.meanRest( last ).x() - bar.meanRest( first ).x(), area = edges.y() * edges.z();
	const double stiff = bar.modulus() * area * edges.y() * edges.y() / 12, shear = 5.0 / 6 * bar.modulus() / 2 * area;
	const double load = 0.05 * s * 3 * stiff / ( s * s * s );
	bar.pushAt( last, { 0, -load, 0 } );
	bar.settle( kMostSteps );
	return -bar.meanMoved( last ).y() / ( load * s * s * s / ( 3 * stiff ) + load * s / shear );
}

std::vector<MaterialRow> measureCantilever( bool isShort )
{
	struct Case
	{
		int thick;
		double bound;
	};
	std::vector<Case> cases = { { 2, 0.25 }, { 4, 0.1 }, { 8, 0.05 } };
	if ( isShort )
	{
		cases.pop_back();
	}
	std::vector<MaterialRow> rows;
	std::vector<double> errors;
	for ( const Case& one : cases )
	{
		Coupon bar( barOrder( 10 * one.thick, one.thick, 2 ) );
		const double ratio = loadedTip( bar );
		rows.push_back( { "M3", "cantilever, L/t 10, " + std::to_string( one.thick ) + " cells thick: tip over theory", "", ratio, 1,
			one.bound, Judge::Ratio, one.thick == 2 ? "no bound asked; 25 % taken" : "" } );
		errors.push_back( std::abs( ratio - 1 ) );
	}
	double rise = 0;
	for ( std::size_t k = 1; k < errors.size(); ++k )
	{
		rise = std::max( rise, errors[k] - errors[k - 1] );
	}
	rows.push_back( { "M3", "error falls with every halving of the cells: most that it rises", "", rise, 0, 0.005, Judge::AtMost,
		"balance is found to half a percent" } );
	return rows;
}

std::vector<MaterialRow> measureHeavyCantilever( bool )
{
	constexpr double kLoad = 5; // w L^3 / ( E I )
	std::vector<MaterialRow> rows;
	CouponOrder order = barOrder( 40, 4, 2 );
	Coupon bar( order );
	const Eigen::Vector3d edges = order.cell * order.cells.cast<double>();
	const Where first = beyond( 0, edges.x() / 2 - order.cell, -1 ), last = beyond( 0, edges.x() / 2 - order.cell, 1 );
	bar.hold( first );
	const double length = edges.x() - order.cell / 2, s = edges.x() - order.cell;
	// w = rho g A, I = A t^2 / 12
	const double gravity = kLoad * bar.modulus() * edges.y() * edges.y() /
		( 12 * double( order.material.density ) * length * length * length );
	bar.push( [gravity]( const Eigen::Vector3d& ) { return Eigen::Vector3d( 0, -gravity, 0 ); } );
	bar.settle( kMostSteps );
	const Eigen::Vector2d theory = length * heavyElastica( kLoad, s / length );
	const Eigen::Vector3d found = bar.meanMoved( last );
	const Eigen::Vector2d place( s + found.x(), -found.y() );
	rows.push_back( { "M4", "cantilever under its weight, w L^3 / E I = 5: tip down", "L", place.y() / length, theory.y() / length, 0.05,
		Judge::Difference, "" } );
	rows.push_back( { "M4", "the same: tip along", "L", place.x() / length, theory.x() / length, 0.05, Judge::Difference, "" } );
	return rows;
}

std::vector<MaterialRow> measureCircle( bool isShort )
{
	const int cells = isShort ? 40 : 80, thick = isShort ? 2 : 4, stages = 8;
	CouponOrder order = barOrder( cells, thick, 1 );
	order.material.damping = 20;
	Coupon bar( order );
	const Eigen::Vector3d edges = order.cell * order.cells.cast<double>();
	const Where ends[] = { beyond( 0, edges.x() / 2 - order.cell, -1 ), beyond( 0, edges.x() / 2 - order.cell, 1 ) };
	// M = 2 pi E I / s: one turn from end to end.
	const double s = edges.x() - order.cell, moment = 2 * std::numbers::pi * bar.modulus() * edges.z() * std::pow( edges.y(), 3 ) / 12 / s;
	for ( int k = 1; k <= stages; ++k )
	{
		bar.clearForces();
		bar.bend( ends[0], -moment * k / stages );
		bar.bend( ends[1], moment * k / stages );
		bar.settle( kMostSteps / 4 );
	}
	const Eigen::Vector3d a = bar.meanRest( ends[0] ) + bar.meanMoved( ends[0] ), b = bar.meanRest( ends[1] ) + bar.meanMoved( ends[1] );
	return { { "M5", "end moments that bend a bar to a circle, L/t 20: gap", "L", ( a - b ).norm() / s, 0, 0.1, Judge::AtMost,
		"a free bar, both ends turned" } };
}

} // namespace pliant_study
