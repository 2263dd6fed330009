#pragma once

// A bar at an angle to its lattice, held at both ends and stretched until it breaks: the strain and the plane of the crack.

#include "body/body.h"
#include "body/breaking.h"
#include "body/levels/levels.h"
#include "support/explicit_material.h"
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
	double degrees = 0.0; ///< between the bar and the lattice's x axis
	int coarseLevels = 0;
	BreakRule rule = BreakRule::Plane;
	float breakStrain = 0.1f;
	bool rings = false;     ///< without Material::wobbleDamping, so that oscillations after a change of levels persist
	float shardSize = 0.2f; ///< m, BreakRule::Shards; a cell is .05
};

struct PullResult
{
	double firstStrain = 0.0;  ///< strain of the bar between its grips when the first links broke; 0: never
	double partedStrain = 0.0; ///< strain when it was in two pieces
	double tilt = 0.0;         ///< between the plane of the crack and the plane across the bar, degrees
	int links = 0;             ///< in the crack
	int pieces = 0;
};

/// Fits a plane to the midpoints of the links that are connected to the first of them; returns its angle with `along`, degrees.
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

/// The specimen in its testing machine.
class PullTest
{
public:
	explicit PullTest( const PulledBar& bar ) :
		m_angle( bar.degrees * 3.14159265358979323846 / 180.0 ), m_along( std::cos( m_angle ), std::sin( m_angle ), 0.0 )
	{
		const Vec3d across( -std::sin( m_angle ), std::cos( m_angle ), 0.0 );
		const int scratch = 48;
		const auto isInside = [&]( int x, int y, int ) {
			const Vec3d p( x + 0.5 - scratch / 2, y + 0.5 - scratch / 2, 0.0 );
			return std::fabs( p.dot( m_along ) ) < kLength / 2 && std::fabs( p.dot( across ) ) < kHeight / 2;
		};
		const auto lattice = std::make_shared<const Lattice>(
			makeShapeLattice( { scratch, scratch, int( kHeight ) }, float( kCell ), isInside ) );
		Material material = test::explicitMaterial();
		material.youngsModulus = 1e5f;
		material.wobbleDamping = bar.rings ? 0.0f : material.wobbleDamping;
		m_alpha = planStiffness( material, float( kCell ), 4.0f * kStep, 4 ).alpha;
		Adaptivity levels;
		levels.coarseLevels = bar.coarseLevels;
		m_body = std::move( Body::create( lattice, material, {}, nullptr, levels ).value );
		takeHold( bar.coarseLevels );
		setFracture( bar );
		for ( int i = 0; i < m_body->nodeCount(); ++i )
		{
			m_body->nodes().v.set( i, ( m_along * kRate * std::clamp( positionAlong( i ), -kFree, kFree ) ).cast<float>() );
		}
	}

	PullResult run()
	{
		PullResult result;
		std::vector<Vec3d> middles;
		for ( int step = 1; step < 2400 && result.pieces < 2; ++step )
		{
			draw();
			if ( m_body->hasBrokenLinks() )
			{
				const double strain = kRate * double( kStep ) * step;
				result.firstStrain = result.firstStrain == 0.0 ? strain : result.firstStrain;
				result.partedStrain = strain;
				result.pieces = breakApart( middles );
			}
		}
		if ( !middles.empty() )
		{
			result.tilt = crackTilt( middles, 1.5 * kCell, m_along, result.links );
		}
		return result;
	}

private:
	static constexpr double kLength = 40.0, kHeight = 8.0, kGrip = 4.0, kShoulder = 4.0; // cells
	static constexpr double kCell = 0.05;                                                // m
	static constexpr double kFree = ( kLength / 2 - kGrip ) * kCell;                     // m, from the middle to a grip
	static constexpr double kRate = 0.05; // strain per second; sound takes 0.2 s from end to end
	static constexpr float kStep = 1.0f / 240.0f;

	double positionAlong( int node ) const { return m_body->nodes().x0.get( node ).cast<double>().dot( m_along ); }

	// A node is pinned as a whole. One that reached out of its grip would shorten the free length on which the strain is based, and release
	// it with a jerk when split.
	void takeHold( int coarseLevels )
	{
		const double reach = std::fabs( m_along.x() ) + std::fabs( m_along.y() ); // half extent of a block along the bar, in edges
		for ( int round = 0; round < coarseLevels; ++round )
		{
			for ( int i = 0; i < m_body->nodeCount(); ++i )
			{
				const double half = 0.5 * kCell * double( 1 << m_body->levels()->levelOf( i ) ) * reach;
				if ( std::fabs( std::fabs( positionAlong( i ) ) - kFree ) < half )
				{
					m_body->requestSplit( i );
				}
			}
			m_body->adaptLevels( kStep );
		}
	}

	// As in a testing machine, where the specimen is thicker at its ends, so that it does not break at the grips.
	void setFracture( const PulledBar& bar )
	{
		struct Shoulders
		{
			Vec3 along;
			float middle, from; // m along the bar, in the mesh's coordinates
		} shoulders{ m_along.cast<float>(), float( m_along.dot( m_body->lattice().massCentre ) ), float( kFree - kShoulder * kCell ) };
		ToughnessField field;
		field.context = &shoulders;
		field.fraction = []( const float* point, const float*, void* context ) {
			const Shoulders& s = *static_cast<const Shoulders*>( context );
			return std::fabs( s.along.dot( Vec3( point[0], point[1], point[2] ) ) - s.middle ) > s.from
				? std::numeric_limits<float>::infinity()
				: 1.0f;
		};
		Fracture fracture;
		fracture.rule = bar.rule;
		fracture.breakStrain = bar.breakStrain;
		fracture.shardSize = bar.shardSize;
		static_cast<void>( m_body->setFracture( fracture, field ) );
	}

	void draw()
	{
		for ( int i = 0; i < m_body->nodeCount(); ++i )
		{
			if ( std::fabs( positionAlong( i ) ) > kFree )
			{
				m_body->setPinned( i, true );
				m_body->nodes().v.set( i, ( m_along * kRate * std::copysign( kFree, positionAlong( i ) ) ).cast<float>() );
			}
		}
		m_body->adaptLevels( kStep );
		m_body->accelerateTowardGoals( kStep, m_alpha, nullptr );
		m_body->integrate( kStep );
		m_body->testLinks( kStep );
	}

	int breakApart( std::vector<Vec3d>& middles )
	{
		while ( m_body->mustRefineToBreak() )
		{
			m_body->refineToBreak();
		}
		for ( const CellLink& link : m_body->breaking()->broken )
		{
			const Lattice& now = m_body->lattice();
			middles.push_back( 0.5 * ( now.restCentre[link.a] + now.restCentre[link.b] ).cast<double>() );
		}
		BreakReport report;
		std::vector<BodyPiece> pieces = m_body->breakApart( report, 1000 );
		m_body = std::move( pieces[0].body );
		return int( pieces.size() );
	}

	double m_angle;
	Vec3d m_along;
	float m_alpha = 0.0f;
	std::unique_ptr<Body> m_body;
};

inline PullResult pullBar( const PulledBar& bar )
{
	return PullTest( bar ).run();
}

} // namespace pliant::test
