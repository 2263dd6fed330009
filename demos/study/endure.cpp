// +-----------------------------------------------------------------------------------------------------------------+
// | One cell of the stability matrix: the extreme case, and the judgement of the result.                             |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/study/measure.h"
#include "demos/study/stability.h"

#include <btBulletDynamicsCommon.h>

#include <Eigen/LU>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>
#include <random>

namespace pliant_study {

namespace {

constexpr double kDefaultSag = 0.1, kEarth = 9.81;
constexpr double kRecovered = 0.01;                     // of the diagonal
constexpr double kLastRecovery = 10, kSlowRecovery = 2; // s
constexpr double kMostInverted = 1e-3, kMostGrowth = 0.01, kMostDepth = 0.5;
constexpr int kMostSubsteps = 16;
constexpr int kLooks = 400; // number of moments at which the shape is examined
constexpr double kTwoTurns = 4 * 3.14159265358979323846;
constexpr double kGap = 1e-3; // of the diagonal, between a body and the object that it is placed on

class Ordeals
{
public:
	Ordeals( const StabilityCase& ordeal, const StabilityMethod& method, unsigned seed ) :
		m_case( ordeal ), m_method( method ), m_random( seed )
	{}

	~Ordeals()
	{
		for ( const auto& body : m_rigid )
		{
			m_subject->world().removeRigidBody( body.get() );
		}
	}

	Verdict run( int steps )
	{
		Verdict verdict;
		if ( !prepare( verdict.reason ) )
		{
			verdict.colour = Colour::None;
			return verdict;
		}
		deform();
		const int every = std::max( 1, steps / kLooks );
		const auto start = std::chrono::steady_clock::now();
		for ( int k = 1; k <= steps && m_isFinite; ++k )
		{
			if ( k == steps / 2 && !isFree() )
			{
				relent();
				m_relented = k * m_case.step;
			}
			m_subject->step( m_case.step );
			watch( k * m_case.step, k % every == 0 || k == steps, k <= steps / 2 );
		}
		verdict.microseconds = 1e6 * std::chrono::duration<double>( std::chrono::steady_clock::now() - start ).count() / steps;
		judge( verdict );
		return verdict;
	}

private:
	bool isFree() const { return m_case.ordeal >= Ordeal::Flat; }

	bool prepare( std::string& why )
	{
		pliant_glue::ModelMesh mesh;
		makeShape( m_case.shape, mesh );
		m_specimen = makeSpecimen( std::move( mesh ), m_case.diagonal );
		Subject::Order order;
		order.specimen = &m_specimen;
		order.candidate = m_method.candidate;
		order.candidate.cells = m_case.cells;
		pliant::Material& material = order.candidate.material;
		const double height = 2 * m_specimen.half.y();
		material.youngsModulus = float( m_case.modulus > 0 ? m_case.modulus : double( material.density ) * kEarth * height / kDefaultSag );
		if ( m_case.isRawAlpha )
		{
			material.stiffness = pliant::Stiffness::RawAlpha;
			material.alpha = 1;
		}
		if ( m_method.isPlastic )
		{
			material.yieldStrain = 0.1f;
		}
		if ( m_method.isFracturing )
		{
			order.fracture.rule = pliant::BreakRule::Plane;
		}
		const double above = m_case.ordeal == Ordeal::Load ? kGap * m_case.diagonal : height;
		order.place.setOrigin( toBullet( { m_case.far, m_specimen.half.y() + above, 0 } ) );
		m_subject = makeSubject( order, why );
		if ( !m_subject )
		{
			return false;
		}
		btDiscreteDynamicsWorld& world = m_subject->world();
		world.setGravity( toBullet( { 0, -m_case.gravity, 0 } ) );
		m_subject->cells( m_rest );
		m_cell = std::cbrt( m_specimen.volume / std::max<double>( 1, double( m_rest.cols() ) ) );
		if ( !isFree() )
		{
			addGround();
		}
		if ( m_case.ordeal == Ordeal::Load )
		{
			addLoad( height + above + kGap * m_case.diagonal );
		}
		m_subject->setVelocities(
			btVector3( 0, btScalar( -m_case.speed ), 0 ), m_case.ordeal == Ordeal::Spin ? btVector3( 1, 3, 2 ) : btVector3( 0, 0, 0 ) );
		m_first = mechanicalEnergy();
		return true;
	}

	void addGround()
	{
		m_shapes.push_back( std::make_unique<btStaticPlaneShape>( btVector3( 0, 1, 0 ), btScalar( 0 ) ) );
		m_rigid.push_back( std::make_unique<btRigidBody>( btScalar( 0 ), nullptr, m_shapes.back().get() ) );
		m_subject->world().addRigidBody( m_rigid.back().get() );
	}

	void addLoad( double from )
	{
		const Eigen::Vector3d half( m_specimen.half.x(), m_specimen.half.y() / 2, m_specimen.half.z() );
		m_shapes.push_back( std::make_unique<btBoxShape>( toBullet( half ) ) );
		const btScalar mass = btScalar( m_case.massRatio * m_subject->motion().mass );
		btVector3 inertia;
		m_shapes.back()->calculateLocalInertia( mass, inertia );
		m_rigid.push_back( std::make_unique<btRigidBody>( mass, nullptr, m_shapes.back().get(), inertia ) );
		m_rigid.back()->setWorldTransform( btTransform( btQuaternion::getIdentity(), toBullet( { m_case.far, from + half.y(), 0 } ) ) );
		m_rigid.back()->setInterpolationWorldTransform( m_rigid.back()->getWorldTransform() );
		m_subject->world().addRigidBody( m_rigid.back().get() );
	}

	/// The load is removed halfway: crushed bodies have to recover.
	void relent()
	{
		m_subject->world().setGravity( btVector3( 0, 0, 0 ) );
		if ( m_case.ordeal == Ordeal::Load )
		{
			m_subject->world().removeRigidBody( m_rigid.back().get() );
			m_rigid.pop_back();
		}
	}

	/// Moves the nodes to the initial positions of the case.
	void deform()
	{
		if ( !isFree() || m_case.ordeal == Ordeal::Spin )
		{
			return;
		}
		const btVector3 centre = toBullet( m_subject->motion().centre );
		const btScalar height = btScalar( 2 * m_specimen.half.y() );
		std::vector<btVector3> positions;
		m_subject->put(
			[&positions]( int, const btVector3& at ) {
				positions.push_back( at );
				return at;
			},
			m_case.step );
		std::shuffle( positions.begin(), positions.end(), m_random );
		m_subject->put(
			[&]( int node, const btVector3& at ) {
				btVector3 x = at - centre;
				switch ( m_case.ordeal )
				{
					case Ordeal::Flat: x.setY( 0 ); break;
					case Ordeal::Mirrored: x.setX( -x.x() ); break;
					case Ordeal::Scrambled: x = positions[std::size_t( node )] - centre; break;
					case Ordeal::Point: x.setZero(); break;
					case Ordeal::Stretched: x.setY( 1000 * x.y() ); break;
					default: x = x.rotate( btVector3( 0, 1, 0 ), btScalar( kTwoTurns ) * x.y() / height ); break;
				}
				return centre + x;
			},
			m_case.step );
	}

	double mechanicalEnergy() const
	{
		const Motion motion = m_subject->motion();
		return motion.kineticEnergy + motion.mass * m_case.gravity * motion.centre.y();
	}

	void watch( double now, bool looksAtShape, bool isFirstHalf )
	{
		m_subject->cells( m_now );
		m_isFinite = m_subject->isHealthy() && m_now.allFinite();
		m_hasBroken = m_hasBroken || m_subject->pieces() > 1;
		if ( !m_isFinite )
		{
			return;
		}
		if ( !isFree() )
		{
			m_lowest = std::min( m_lowest, m_now.row( 1 ).minCoeff() );
		}
		const Motion motion = m_subject->motion();
		double& most = isFirstHalf ? m_mostEarly : m_mostLate;
		most = std::max( most, motion.kineticEnergy );
		m_mostMechanical = m_relented > 0 ? m_mostMechanical : std::max( m_mostMechanical, mechanicalEnergy() );
		if ( looksAtShape && ( isFree() || m_relented > 0 ) && !m_hasBroken )
		{
			Points points = m_specimen.points;
			m_subject->vertices( points );
			const double shape = errorsOf( m_specimen, points, m_specimen.points ).shape;
			m_recovery = shape > kRecovered || !std::isfinite( shape ) ? now - m_relented : m_recovery;
			m_lastLook = now - m_relented;
		}
	}

	/// Of the cells that have three neighbours at rest, those for which the triad of edges to them is inverted.
	double invertedFraction() const
	{
		int inverted = 0, looked = 0;
		const double reach = 1.3 * m_cell, least = 0.5 * m_cell;
		for ( Eigen::Index i = 0; i < m_rest.cols(); ++i )
		{
			std::vector<Eigen::Index> near;
			for ( Eigen::Index j = 0; j < m_rest.cols() && near.size() < 3; ++j )
			{
				const Eigen::Vector3d edge = m_rest.col( j ) - m_rest.col( i );
				const bool isOther = std::all_of( near.begin(), near.end(), [&]( Eigen::Index k ) {
					return std::abs( edge.normalized().dot( ( m_rest.col( k ) - m_rest.col( i ) ).normalized() ) ) < 0.3;
				} );
				if ( j != i && edge.norm() < reach && edge.norm() > least && isOther )
				{
					near.push_back( j );
				}
			}
			if ( near.size() < 3 )
			{
				continue;
			}
			Eigen::Matrix3d rest, now;
			for ( int k = 0; k < 3; ++k )
			{
				rest.col( k ) = m_rest.col( near[std::size_t( k )] ) - m_rest.col( i );
				now.col( k ) = m_now.col( near[std::size_t( k )] ) - m_now.col( i );
			}
			++looked;
			// The cells of one coarse node have one position: nothing can be inverted.
			inverted += rest.determinant() * now.determinant() < 0 ? 1 : 0;
		}
		return looked > 0 ? double( inverted ) / looked : 0.0;
	}

	void judge( Verdict& verdict ) const
	{
		const auto blame = [&verdict]( Colour colour, const std::string& why ) {
			if ( int( colour ) > int( verdict.colour ) )
			{
				verdict.colour = colour;
				verdict.reason = why;
			}
		};
		if ( !m_isFinite )
		{
			blame( Colour::Red, "not finite, or stopped" );
			return;
		}
		// The energy of a fall needs a reference height; a body that is released strained starts with elastic energy.
		verdict.energyGrowth = isFree()                     ? m_mostLate / std::max( m_mostEarly, 1e-12 * m_subject->motion().mass ) - 1
			: m_case.ordeal == Ordeal::Load || m_first <= 0 ? 0.0
															: m_mostMechanical / m_first - 1;
		verdict.depth = isFree() ? 0.0 : std::max( 0.0, 0.5 - m_lowest / m_cell );
		const bool isElastic = !m_method.isPlastic && !m_hasBroken && m_case.ordeal != Ordeal::Spin;
		verdict.recovery = isElastic ? m_recovery : -1;
		verdict.inverted = m_hasBroken ? 0.0 : invertedFraction();
		if ( verdict.inverted > kMostInverted )
		{
			blame( Colour::Red, "cells inverted" );
		}
		if ( verdict.energyGrowth > kMostGrowth )
		{
			blame( Colour::Red, "energy grows" );
		}
		if ( !isFree() && m_lowest < 0 )
		{
			blame( Colour::Red, "through the plane" );
		}
		if ( verdict.recovery >= std::min( kLastRecovery, m_lastLook ) && isElastic )
		{
			blame( Colour::Red, "does not recover" );
		}
		if ( verdict.recovery > kSlowRecovery )
		{
			blame( Colour::Yellow, "recovers slowly" );
		}
		if ( verdict.depth > kMostDepth )
		{
			blame( Colour::Yellow, "sinks in" );
		}
		if ( m_subject->substepsNeeded() > kMostSubsteps )
		{
			blame( Colour::Yellow, "stiffness out of reach" );
		}
	}

	const StabilityCase& m_case;
	const StabilityMethod& m_method;
	std::mt19937 m_random;
	Specimen m_specimen;
	std::unique_ptr<Subject> m_subject;
	std::vector<std::unique_ptr<btCollisionShape>> m_shapes;
	std::vector<std::unique_ptr<btRigidBody>> m_rigid;
	Points m_rest, m_now;
	double m_cell = 1, m_first = 0;
	bool m_isFinite = true, m_hasBroken = false;
	double m_relented = 0; ///< s, when the load was removed; 0: not yet
	double m_lowest = 1e300, m_mostEarly = 0, m_mostLate = 0, m_mostMechanical = 0, m_recovery = 0, m_lastLook = 0;
};

} // namespace

Verdict endure( const StabilityCase& ordeal, const StabilityMethod& method, int steps, unsigned seed )
{
	return Ordeals( ordeal, method, seed ).run( steps );
}

} // namespace pliant_study
