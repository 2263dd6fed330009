#pragma once

// A bar that lies in its lattice at an angle, held at both ends and drawn out until it parts: at what strain, and along which plane.

#include "body/body.h"
#include "body/breaking.h"
#include "body/levels.h"
#include "support/shapes.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

namespace pliant::test {

struct PulledBar
{
	double degrees = 0.0;   ///< between the bar and the lattice's x axis
	int coarseLevels = 0;
	BreakRule rule = BreakRule::Plane;
	float breakStrain = 0.1f;
};

struct PullResult
{
	double firstStrain = 0.0;  ///< of the bar between its grips, when the first links broke; 0: never
	double partedStrain = 0.0; ///< when it was in two
	double tilt = 0.0;         ///< between the crack's plane and the plane across the bar, degrees
	int links = 0;             ///< of the crack
	int pieces = 0;
};

/// The plane that fits the middles of the links that hang together with the first of them; its angle with `along`, degrees.
inline double crackTilt( const std::vector<Vec3d>& middles, double reach, const Vec3d& along, int& count )
{
	std::vector<char> isIn( middles.size(), 0 );
	std::vector<std::size_t> front( 1, 0 );
	isIn[0] = 1;
	Vec3d sum = Vec3d::Zero();
	for ( std::size_t k = 0; k < front.size(); ++k )
	{
		sum += middles[front[k]];
		for ( std::size_t j = 0; j < middles.size(); ++j )
		{
			if ( isIn[j] == 0 && ( middles[j] - middles[front[k]] ).norm() < reach )
			{
				isIn[j] = 1;
				front.push_back( j );
			}
		}
	}
	const Vec3d centre = sum / double( front.size() );
	Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
	for ( const std::size_t k : front )
	{
		spread += ( middles[k] - centre ) * ( middles[k] - centre ).transpose();
	}
	const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver( spread );
	count = int( front.size() );
	return std::acos( std::min( 1.0, std::fabs( solver.eigenvectors().col( 0 ).dot( along ) ) ) ) * 180.0 / 3.14159265358979323846;
}

inline PullResult pullBar( const PulledBar& bar )
{
	const double length = 40.0, height = 8.0, grip = 4.0, shoulder = 4.0, cell = 0.05; // cells, m
	const double angle = bar.degrees * 3.14159265358979323846 / 180.0;
	const Vec3d along( std::cos( angle ), std::sin( angle ), 0.0 ), across( -std::sin( angle ), std::cos( angle ), 0.0 );
	const int room = 48;
	const auto isInside = [&]( int x, int y, int ) {
		const Vec3d p( x + 0.5 - room / 2, y + 0.5 - room / 2, 0.0 );
		return std::fabs( p.dot( along ) ) < length / 2 && std::fabs( p.dot( across ) ) < height / 2;
	};
	const auto lattice = std::make_shared<const Lattice>( makeShapeLattice( { room, room, int( height ) }, float( cell ), isInside ) );
	Material material;
	material.youngsModulus = 1e5f;
	material.wobbleDamping = 0.0f;
	Adaptivity levels;
	levels.coarseLevels = bar.coarseLevels;
	std::unique_ptr<Body> body = std::move( Body::create( lattice, material, {}, nullptr, levels ).value );
	Fracture fracture;
	fracture.rule = bar.rule;
	fracture.breakStrain = bar.breakStrain;
	// As in a testing machine, where the specimen is thicker at its ends: what the grips do there is not what is asked about.
	struct Shoulders
	{
		Vec3 along;
		float middle, from; // m along the bar, in the mesh's coordinates
	} shoulders{ along.cast<float>(), float( along.dot( lattice->massCentre ) ), float( ( length / 2 - grip - shoulder ) * cell ) };
	ToughnessField field;
	field.context = &shoulders;
	field.share = []( const float* point, const float*, void* context ) {
		const Shoulders& s = *static_cast<const Shoulders*>( context );
		return std::fabs( s.along.dot( Vec3( point[0], point[1], point[2] ) ) - s.middle ) > s.from ? std::numeric_limits<float>::infinity() : 1.0f;
	};
	body->setFracture( fracture, field );

	const float h = 1.0f / 240.0f, alpha = planStiffness( material, float( cell ), 4.0f * h, 4 ).alpha;
	const double rate = 0.05; // strain a second; sound takes 0.2 s from end to end
	const double free = ( length / 2 - grip ) * cell;
	for ( int i = 0; i < body->nodeCount(); ++i )
	{
		const double s = body->nodes().x0.get( i ).cast<double>().dot( along );
		body->nodes().v.set( i, ( along * rate * std::clamp( s, -free, free ) ).cast<float>() );
	}
	PullResult result;
	std::vector<Vec3d> middles;
	for ( int step = 1; step < 2400 && result.pieces < 2; ++step )
	{
		for ( int i = 0; i < body->nodeCount(); ++i )
		{
			const double s = body->nodes().x0.get( i ).cast<double>().dot( along );
			if ( std::fabs( s ) > free )
			{
				body->setPinned( i, true );
				body->nodes().v.set( i, ( along * rate * std::copysign( free, s ) ).cast<float>() );
			}
		}
		body->adaptLevels( h );
		body->accelerateTowardGoals( h, alpha, nullptr );
		body->integrate( h );
		body->testLinks( h );
		if ( !body->hasBrokenLinks() )
		{
			continue;
		}
		while ( body->mustRefineToBreak() )
		{
			body->refineToBreak();
		}
		const double strain = rate * h * step;
		result.firstStrain = result.firstStrain == 0.0 ? strain : result.firstStrain;
		for ( const CellLink& link : body->breaking()->broken )
		{
			const Lattice& now = body->lattice();
			middles.push_back( 0.5 * ( now.restCentre[link.a] + now.restCentre[link.b] ).cast<double>() );
		}
		BreakReport report;
		std::vector<BodyPiece> pieces = body->breakApart( report, 1000 );
		result.pieces = int( pieces.size() );
		result.partedStrain = strain;
		body = std::move( pieces[0].body );
	}
	if ( !middles.empty() )
	{
		result.tilt = crackTilt( middles, 1.5 * cell, along, result.links );
	}
	return result;
}

} // namespace pliant::test
