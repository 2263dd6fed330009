// +-----------------------------------------------------------------------------------------------------------------+
// | M8 to M11: large stretch, Cook's membrane, a plate and a rod of one cell.                                        |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/explicit_material.h"
#include "demos/shapes.h"
#include "demos/study/materials.h"
#include "demos/study/theory.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <cmath>

namespace pliant_study {

namespace {

constexpr int kMostShapeSteps = 40000;
constexpr double kMostPoisson = 0.49;    // at the largest Material::volumeKeeping
constexpr double kExplicitPoisson = 0.4; // above it the explicit step reaches small moduli only

/// kappa = nu / ( 1 - 2 nu ), up to its largest value; implicit where the explicit step does not reach the modulus.
void setPoisson( CouponOrder& order, double nu )
{
	const double most = std::min( nu, kMostPoisson );
	order.material.volumeKeeping = float( most / ( 1 - 2 * most ) );
	if ( nu > kExplicitPoisson )
	{
		order.material.elasticity = pliant::Elasticity::Implicit;
	}
}

CouponOrder calmOrder( int x, int y, int z )
{
	CouponOrder order;
	order.cells = { x, y, z };
	order.reach = 0.5;
	order.material.wobbleDamping = 0;
	order.material.damping = 5;
	return order;
}

/// The membrane with cells of edge `cell` and `unit` metres for each unit of length, and half a cell more at its left, so that the held
/// cells have their centres at x = 0.
pliant_glue::ModelMesh cookMesh( double cell, double unit, double depth )
{
	pliant_glue::ModelMesh mesh = pliant_demos::makeCube( 1.0f, 16 );
	for ( std::size_t k = 0; k < mesh.positions.size(); k += 3 )
	{
		const double v = double( mesh.positions[k + 1] ) + 0.5;
		const double x = -cell / 2 + ( double( mesh.positions[k] ) + 0.5 ) * ( 48 * unit + cell / 2 ),
					 u = std::max( 0.0, x / ( 48 * unit ) );
		mesh.positions[k] = float( x );
		mesh.positions[k + 1] = float( unit * ( 44 * v + u * ( 44 - 28 * v ) ) );
		mesh.positions[k + 2] *= float( depth );
	}
	return mesh;
}

} // namespace

std::vector<MaterialRow> measureStretch( bool isShort )
{
	struct Case
	{
		double stretch, nu;
	};
	std::vector<Case> cases = { { 2, 0.0 }, { 2, 0.3 }, { 2, 0.49 } };
	if ( !isShort )
	{
		cases.insert( cases.end(), { { 3, 0.0 }, { 3, 0.3 }, { 3, 0.49 } } );
	}
	std::vector<MaterialRow> rows;
	for ( const auto& [stretch, nu] : cases )
	{
		CouponOrder order = calmOrder( 30, 6, 6 );
		setPoisson( order, nu );
		Coupon bar( order );
		const double half = order.cell * 15;
		bar.hold( [&]( const Eigen::Vector3d& rest ) { return std::abs( rest.x() ) > half - order.cell; } );
		for ( int k = 1; k <= 60; ++k )
		{
			const double now = 1 + ( stretch - 1 ) * k / 60;
			bar.drive( [now]( const Eigen::Vector3d& rest ) { return Eigen::Vector3d( now * rest.x(), rest.y(), rest.z() ); } );
			bar.step();
		}
		bar.settle( kMostShapeSteps );
		const Eigen::Matrix3d f = bar.deformation( [half]( const Eigen::Vector3d& rest ) { return std::abs( rest.x() ) < half / 3; } );
		const double across = ( f.col( 1 ).norm() + f.col( 2 ).norm() ) / 2;
		const std::string name = "stretched " + shortNumber( stretch ) + " times, nu " + shortNumber( nu );
		rows.push_back( { "M8", name + ": width, Neo-Hookean", "", across / neoHookeanAcross( f.col( 0 ).norm(), nu ), 1, 0.1, Judge::Ratio,
			"no bound asked; 10 % taken" } );
		if ( nu > kExplicitPoisson )
		{
			rows.push_back( { "M8", name + ": volume", "", f.determinant(), 1, 0.01, Judge::Ratio, "" } );
		}
	}
	return rows;
}

std::vector<MaterialRow> measureCook( bool isShort )
{
	std::vector<MaterialRow> rows;
	for ( const double nu : { 0.3, 0.499 } )
	{
		for ( const int side : isShort ? std::vector<int>{ 8 } : std::vector<int>{ 8, 16 } )
		{
			CouponOrder order = calmOrder( 0, 0, 2 );
			setPoisson( order, nu );
			const double unit = order.cell * side / 48; // the membrane's border is a border of cells
			order.mesh = cookMesh( order.cell, unit, 2 * order.cell );
			Coupon slab( order );
			slab.hold( [&]( const Eigen::Vector3d& rest ) { return rest.x() < order.cell / 2; } );
			const double right = 48 * unit - order.cell;
			const Where edge = [right]( const Eigen::Vector3d& rest ) { return rest.x() > right; };
			// Up by 1 % of the left edge's height; v = P / ( E t ) times the displacement under a load of 1.
			const Eigen::Vector3d at = slab.meanRest( edge ) / unit;
			const double unitUp = cookDeflection( nu, at.x(), at.y() ), load = 0.01 * 44 * unit * slab.modulus() * 2 * order.cell / unitUp;
			slab.pushAt( edge, { 0, load, 0 } );
			slab.settle( kMostShapeSteps );
			rows.push_back( { "M9",
				"Cook's membrane, nu " + shortNumber( nu ) + ", " + std::to_string( side ) + " cells a side: edge up, over elements'", "",
				slab.meanMoved( edge ).y() / ( load * unitUp / ( slab.modulus() * 2 * order.cell ) ), 1, side == 8 ? 0.1 : 0.05,
				Judge::Ratio, nu > kMostPoisson ? "taken at nu 0.49, the most there is" : "plane stress" } );
		}
	}
	return rows;
}

std::vector<MaterialRow> measurePlate( bool isShort )
{
	const int free = isShort ? 20 : 40;
	CouponOrder order = calmOrder( free + 4, 1, free + 4 );
	Coupon plate( order );
	const double a = ( free + 1 ) * order.cell, d = order.cell;
	const auto middle = [d]( const Eigen::Vector3d& rest ) { return std::max( std::abs( rest.x() ), std::abs( rest.z() ) ) < d; };
	// Two rows are held: the inner one is where the beam neither moves nor rotates.
	plate.hold( [a, d]( const Eigen::Vector3d& rest ) { return std::max( std::abs( rest.x() ), std::abs( rest.z() ) ) > a / 2 - d / 2; } );
	// Clamped and square: w = 0.00126 q a^4 / D, D = E t^3 / 12 at nu = 0.
	const double stiff = plate.modulus() * d * d * d / 12, wanted = 0.1 * d, load = wanted * stiff / ( 0.00126 * std::pow( a, 4 ) );
	const double perMass = load / ( double( order.material.density ) * d );
	plate.push( [perMass]( const Eigen::Vector3d& ) { return Eigen::Vector3d( 0, -perMass, 0 ); } );
	plate.settle( kMostShapeSteps );
	return { { "M10", "plate of one cell, clamped, even load: middle down", "m", -plate.meanMoved( middle ).y(), wanted, 0.2, Judge::Ratio,
		std::to_string( free ) + " cells across; sag a tenth of its thickness" } };
}

std::vector<MaterialRow> measureRod( bool isShort )
{
	const int free = 24;
	CouponOrder order = calmOrder( free + 2, 1, 1 );
	std::vector<MaterialRow> rows;
	{
		Coupon rod( order );
		const double half = order.cells.x() * order.cell / 2, d = order.cell;
		rod.hold( [&]( const Eigen::Vector3d& rest ) { return rest.x() < -half + 2 * d; } );
		// Clamped at the inner of the two: w s^2 ( 6 L^2 - 4 L s + s^2 ) / ( 24 E I ), L to the rod's end and s to its last cell's centre.
		const double length = ( free + 0.5 ) * d, s = free * d, stiff = rod.modulus() * std::pow( d, 4 ) / 12;
		const double shape = s * s * ( 6 * length * length - 4 * length * s + s * s ) / 24, weight = 0.01 * length * stiff / shape;
		rod.push(
			[&]( const Eigen::Vector3d& ) { return Eigen::Vector3d( 0, -weight / ( double( order.material.density ) * d * d ), 0 ); } );
		rod.settle( kMostShapeSteps );
		rows.push_back( { "M11", "rod of one cell under its weight: tip down", "m",
			-rod.meanMoved( [&]( const Eigen::Vector3d& rest ) { return rest.x() > half - d; } ).y(), 0.01 * length, 0.2, Judge::Ratio,
			"" } );
	}
	// Bent to a half circle, twisted along its length, and released.
	order.material = pliant_demos::explicitMaterial();
	order.reach = 0.5;
	Coupon rod( order );
	const double radius = order.cells.x() * order.cell / 3.14159265358979;
	rod.put( [radius]( const Eigen::Vector3d& rest ) {
		const double angle = rest.x() / radius;
		return Eigen::Vector3d( radius * std::sin( angle ), radius * ( 1 - std::cos( angle ) ) * std::cos( angle ),
			radius * ( 1 - std::cos( angle ) ) * std::sin( angle ) );
	} );
	for ( int k = 0; k < ( isShort ? 1800 : 18000 ) && rod.isHealthy(); ++k )
	{
		rod.step();
	}
	rows.push_back( { "M11", "rod bent and twisted to a screw, let whirl: off its shape", "L",
		rod.isHealthy() ? rod.misfit() / ( order.cells.x() * order.cell ) : HUGE_VAL, 0, 1e-3, Judge::AtMost,
		isShort ? "7 200 substeps" : "72 000 substeps" } );
	return rows;
}

} // namespace pliant_study
