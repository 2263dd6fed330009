// A free bar on levels 0 to 3, lying in the lattice at 0 to 45 degrees: Young's modulus from the period of its slowest longitudinal
// vibration, and the period of its slowest bending. Ohta et al. 2009 aim at equal stiffness on every level.

#include "body/body.h"
#include "body/levels/levels.h"
#include "experiments/experiments.h"
#include "support/explicit_material.h"
#include "support/shapes.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace pliant::experiment {

namespace {

constexpr double kPiHere = 3.14159265358979323846;
constexpr double kRoot = 4.730040745;                  // cos( root ) cosh( root ) = 1
constexpr double kBarLength = 96.0, kBarHeight = 24.0; // cells
constexpr float kBarStep = 0.01f;                      // s

struct Bar
{
	std::shared_ptr<const Lattice> lattice;
	Vec3d along, across;
};

Bar makeBar( double degrees )
{
	Bar bar;
	const double angle = degrees * kPiHere / 180.0;
	bar.along = Vec3d( std::cos( angle ), std::sin( angle ), 0.0 );
	bar.across = Vec3d( -std::sin( angle ), std::cos( angle ), 0.0 );
	const int scratch = 104;
	const auto isInside = [&]( int x, int y, int ) {
		const Vec3d p( x + 0.5 - scratch / 2, y + 0.5 - scratch / 2, 0.0 );
		return std::abs( p.dot( bar.along ) ) < kBarLength / 2 && std::abs( p.dot( bar.across ) ) < kBarHeight / 2;
	};
	bar.lattice = std::make_shared<const Lattice>( test::makeShapeLattice( { scratch, scratch, int( kBarHeight ) }, 1.0f, isInside ) );
	return bar;
}

Vec3d modeShape( const Bar& bar, bool bends, const Vec3d& at )
{
	const double s = at.dot( bar.along ), t = at.dot( bar.across ), k = kRoot / kBarLength;
	if ( !bends )
	{
		return bar.along * std::sin( kPiHere * s / kBarLength );
	}
	const double c = std::cos( kRoot / 2 ) / std::cosh( kRoot / 2 );
	const double height = std::cos( k * s ) + std::cosh( k * s ) * c, slope = k * ( -std::sin( k * s ) + std::sinh( k * s ) * c );
	return bar.across * height - bar.along * ( t * slope );
}

/// Vibrations a step, from the moments at which the amplitude passes zero.
double frequency( const Bar& bar, int level, int halfWidth, bool bends )
{
	Material material = test::explicitMaterial();
	material.density = 1.0f;
	material.stiffness = Stiffness::RawAlpha;
	material.regionHalfWidth = halfWidth;
	material.damping = 0.0f;
	material.wobbleDamping = 0.0f;
	Adaptivity settings;
	settings.coarseLevels = level;
	const std::unique_ptr<Body> body = std::move( Body::create( bar.lattice, material, {}, nullptr, settings ).value );
	NodeState& nodes = body->nodes();
	std::vector<Vec3d> shape;
	double norm = 0.0;
	const double size = 1e-3;
	for ( int i = 0; i < nodes.count; ++i )
	{
		shape.push_back( modeShape( bar, bends, nodes.x0.get( i ).cast<double>() ) );
		nodes.x.set( i, ( nodes.x0.get( i ).cast<double>() + size * shape.back() ).cast<float>() );
		norm += double( nodes.mass[i] ) * shape.back().squaredNorm() * size;
	}
	std::vector<double> crossings;
	double before = 1.0;
	for ( int step = 1; step < 4000 && crossings.size() < 5; ++step )
	{
		body->accelerateTowardGoals( kBarStep, 1.0f, nullptr );
		body->integrate( kBarStep );
		double amplitude = 0.0;
		for ( int i = 0; i < nodes.count; ++i )
		{
			amplitude += double( nodes.mass[i] ) *
				shape[std::size_t( i )].dot( nodes.worldPosition( i ) - nodes.x0.get( i ).cast<double>() ) / norm;
		}
		if ( before * amplitude < 0.0 )
		{
			crossings.push_back( step - amplitude / ( amplitude - before ) );
		}
		before = amplitude;
	}
	return crossings.size() < 2 ? 0.0 : double( crossings.size() - 1 ) / ( 2.0 * ( crossings.back() - crossings.front() ) );
}

} // namespace

void barExperiment()
{
	std::printf( "Bar of %.0f x %.0f x %.0f cells; E over rod theory, and the bending frequency over that of level 0 at 0 degrees\n\n"
				 "| w | angle | level 0 | level 1 | level 2 | level 3 |\n|---|---|---|---|---|---|\n",
		kBarLength, kBarHeight, kBarHeight );
	double lowE = 1e9, highE = 0.0, lowBend = 1e9, highBend = 0.0;
	for ( int w = 1; w <= 2; ++w )
	{
		double reference = 0.0;
		for ( const double degrees : { 0.0, 15.0, 30.0, 45.0 } )
		{
			const Bar bar = makeBar( degrees );
			std::printf( "| %d | %.0f |", w, degrees );
			for ( int level = 0; level <= 3; ++level )
			{
				// c = sqrt( w ( w + 1 ) / 3 ) cells a step; stretching: f = c / ( 2 L )
				const double stretch = frequency( bar, level, w, false ) * 2.0 * kBarLength / std::sqrt( w * ( w + 1 ) / 3.0 );
				const double bend = frequency( bar, level, w, true );
				reference = reference == 0.0 ? bend : reference;
				std::printf( " E %.3f, bend %.3f |", stretch * stretch, bend / reference );
				lowE = std::min( lowE, stretch * stretch );
				highE = std::max( highE, stretch * stretch );
				lowBend = std::min( lowBend, bend / reference );
				highBend = std::max( highBend, bend / reference );
			}
			std::printf( "\n" );
		}
	}
	std::printf( "\nE %.3f to %.3f, bending %.3f to %.3f\n", lowE, highE, lowBend, highBend );
}

} // namespace pliant::experiment
