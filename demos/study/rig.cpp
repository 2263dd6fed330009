// +-----------------------------------------------------------------------------------------------------------------+
// | The scenes of the study.                                                                                         |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/study/rig.h"

#include <btBulletDynamicsCommon.h>

#include <chrono>
#include <cmath>
#include <random>

namespace pliant_study {

namespace {

constexpr double kGravity = 9.81;      // m/s^2
constexpr double kDropHeight = 0.3;    // D, under the lowest point
constexpr double kHeldFraction = 0.15; // of the height, at each held end
constexpr double kQuarter = 1.5707963267948966;
constexpr double kTwistTime = 2.0, kTwistHeld = 3.0;                     // sqrt( D / g )
constexpr double kPushTime = 1.5, kPushDepth = 0.15, kBallRadius = 0.15; // D
constexpr double kImpactSpeed = 1.0, kImpactMass = 0.5;                  // sqrt( g D ), of the body's mass
constexpr double kPull = 0.14; // g: from rest, so that no sudden acceleration tears off the held ends
constexpr float kBreakStrain = 0.3f;
constexpr double kSpinSpeed = 3.0; // radians per sqrt( D / g )
constexpr double kRigGap = 0.01;   // D, between a ball and the body at first
constexpr btScalar kFriction = btScalar( 0.5 );

/// A rotation that is the same for the same number on every system (Shoemake's, from three uniform numbers).
Eigen::Quaterniond orientationOf( int number )
{
	if ( number == 0 )
	{
		return Eigen::Quaterniond::Identity();
	}
	std::mt19937 random( 7919u + unsigned( number ) );
	const auto fraction = [&random] { return double( random() ) / 4294967296.0; };
	const double a = fraction(), b = 4 * kQuarter * fraction(), c = 4 * kQuarter * fraction();
	return { std::sqrt( 1 - a ) * std::sin( b ), std::sqrt( 1 - a ) * std::cos( b ), std::sqrt( a ) * std::sin( c ),
		std::sqrt( a ) * std::cos( c ) };
}

/// From 0 to 1 with continuous velocity at both ends.
double smooth( double fraction )
{
	const double s = std::fmin( 1.0, std::fmax( 0.0, fraction ) );
	return s * s * ( 3 - 2 * s );
}

} // namespace

const std::vector<SceneInfo>& sceneInfos()
{
	static const std::vector<SceneInfo> kScenes = {
		{ SceneKind::Drop, "drop", "falls on the ground", 2.5, true, false, true, true, 3 },
		{ SceneKind::Hang, "hang", "held at its top, under its own weight", 6.0, true, false, true, true, 3 },
		{ SceneKind::Twist, "twist", "one end turned by 90 degrees against the other, then let go", 5.0, false, false, false, true, 3 },
		{ SceneKind::Push, "push", "a ball pushed into its side and taken away", 4.5, true, false, false, true, 3 },
		{ SceneKind::Impact, "impact", "hit by a ball of half its mass", 3.0, false, true, true, true, 3 },
		{ SceneKind::Tear, "tear", "pulled until it breaks", 2.5, false, false, false, false, 1 },
		{ SceneKind::Fly, "fly", "spins freely", 4.0, false, true, true, true, 3 },
	};
	return kScenes;
}

const SceneInfo* findSceneInfo( const std::string& name )
{
	for ( const SceneInfo& scene : sceneInfos() )
	{
		if ( name == scene.name )
		{
			return &scene;
		}
	}
	return nullptr;
}

Rig::Rig( const SceneInfo& scene, const Specimen& specimen ) :
	m_scene( scene ), m_specimen( specimen ), m_unit( std::sqrt( specimen.diagonal / kGravity ) ),
	m_frames( int( std::ceil( scene.length * m_unit / kGameStep ) ) ), m_ballRadius( kBallRadius * specimen.diagonal )
{}

Rig::~Rig()
{
	for ( const auto& body : m_rigid )
	{
		m_subject->world().removeRigidBody( body.get() );
	}
}

std::unique_ptr<Rig> Rig::create(
	const SceneInfo& scene, const Specimen& specimen, const Candidate& candidate, int orientation, std::string& why )
{
	std::unique_ptr<Rig> rig( new Rig( scene, specimen ) );
	Subject::Order order;
	order.specimen = &specimen;
	order.candidate = candidate;
	order.lattice = orientationOf( orientation );
	const double drop = scene.kind == SceneKind::Drop ? kDropHeight * specimen.diagonal : 0.0;
	order.place.setOrigin( toBullet( { 0, specimen.half.y() + drop, 0 } ) ); // its box stands on y = 0
	if ( scene.kind == SceneKind::Tear )
	{
		order.fracture.rule = pliant::BreakRule::Plane;
		order.fracture.breakStrain = kBreakStrain;
	}
	rig->m_subject = makeSubject( order, why );
	if ( !rig->m_subject )
	{
		return nullptr;
	}
	if ( !rig->furnish() )
	{
		why = "too coarse: no node is where it is to be held";
		return nullptr;
	}
	return rig;
}

void Rig::addBall( double mass, const Eigen::Vector3d& place )
{
	m_shapes.push_back( std::make_unique<btSphereShape>( btScalar( m_ballRadius ) ) );
	btVector3 inertia( 0, 0, 0 );
	if ( mass > 0 )
	{
		m_shapes.back()->calculateLocalInertia( btScalar( mass ), inertia );
	}
	m_rigid.push_back( std::make_unique<btRigidBody>( btScalar( mass ), nullptr, m_shapes.back().get(), inertia ) );
	m_ball = m_rigid.back().get();
	m_ball->setWorldTransform( btTransform( btQuaternion::getIdentity(), toBullet( place ) ) );
	m_ball->setInterpolationWorldTransform( m_ball->getWorldTransform() );
	m_ball->setDamping( 0, 0 );
	m_ball->setActivationState( DISABLE_DEACTIVATION );
	if ( mass == 0 )
	{
		m_ball->setCollisionFlags( m_ball->getCollisionFlags() | btCollisionObject::CF_KINEMATIC_OBJECT );
	}
	m_subject->world().addRigidBody( m_ball );
}

bool Rig::furnish()
{
	btDiscreteDynamicsWorld& world = m_subject->world();
	const double d = m_specimen.diagonal, height = 2 * m_specimen.half.y();
	const auto hold = [&]( double low, double high ) {
		return m_subject->hold( toBullet( { -d, low, -d } ), toBullet( { d, high, d } ) ) > 0;
	};
	const bool holdsFoot = m_scene.kind == SceneKind::Twist || m_scene.kind == SceneKind::Push || m_scene.kind == SceneKind::Tear;
	const bool holdsTop = m_scene.kind == SceneKind::Twist || m_scene.kind == SceneKind::Hang || m_scene.kind == SceneKind::Tear;
	if ( ( holdsFoot && !hold( -d, kHeldFraction * height ) ) || ( holdsTop && !hold( ( 1 - kHeldFraction ) * height, 2 * d ) ) )
	{
		return false;
	}
	const Eigen::Vector3d beside( m_specimen.half.x() + m_ballRadius + kRigGap * d, 0.6 * height, 0 );
	if ( m_scene.kind == SceneKind::Drop )
	{
		m_shapes.push_back( std::make_unique<btStaticPlaneShape>( btVector3( 0, 1, 0 ), btScalar( 0 ) ) );
		m_rigid.push_back( std::make_unique<btRigidBody>( btScalar( 0 ), nullptr, m_shapes.back().get() ) );
		m_rigid.back()->setFriction( kFriction );
		world.addRigidBody( m_rigid.back().get() );
	}
	else if ( m_scene.kind == SceneKind::Push )
	{
		addBall( 0, beside );
	}
	else if ( m_scene.kind == SceneKind::Impact )
	{
		addBall( kImpactMass * m_subject->motion().mass, beside );
		m_ball->setLinearVelocity( toBullet( { -kImpactSpeed * std::sqrt( kGravity * d ), 0, 0 } ) );
	}
	else if ( m_scene.kind == SceneKind::Fly )
	{
		const double speed = kSpinSpeed / m_unit;
		m_subject->setVelocities(
			toBullet( { 0.1 * d / m_unit, 0.05 * d / m_unit, 0 } ), toBullet( { 0.3 * speed, 0.9 * speed, 0.2 * speed } ) );
	}
	world.setGravity( toBullet( { 0, m_scene.hasGravity ? -kGravity : 0, 0 } ) ); // last: holding may take a step
	return true;
}

/// Moves the driven objects to their positions at the end of this step.
void Rig::drive()
{
	const double now = seconds() / m_unit, then = ( seconds() + kGameStep ) / m_unit, height = 2 * m_specimen.half.y();
	if ( m_scene.kind == SceneKind::Twist && now < kTwistHeld )
	{
		const double turn = kQuarter * ( smooth( then / kTwistTime ) - smooth( now / kTwistTime ) );
		const btMatrix3x3 by( btQuaternion( btVector3( 0, 1, 0 ), btScalar( turn ) ) );
		m_subject->drive( true, height / 2, [&by]( const btVector3& at ) { return by * at; } );
		if ( then >= kTwistHeld )
		{
			m_subject->release();
		}
	}
	else if ( m_scene.kind == SceneKind::Tear )
	{
		const btVector3 way( 0, btScalar( kPull * m_specimen.diagonal * ( then * then - now * now ) ), 0 );
		m_subject->drive( true, height / 2, [&way]( const btVector3& at ) { return at + way; } );
	}
	else if ( m_scene.kind == SceneKind::Push )
	{
		const double depth = kPushDepth * m_specimen.diagonal * ( smooth( then / kPushTime ) - smooth( ( then - kPushTime ) / kPushTime ) );
		btTransform place = m_ball->getWorldTransform();
		place.getOrigin().setX( btScalar( m_specimen.half.x() + m_ballRadius + kRigGap * m_specimen.diagonal - depth ) );
		m_ball->setWorldTransform( place );
	}
}

double Rig::step()
{
	drive();
	const auto start = std::chrono::steady_clock::now();
	m_subject->step( kGameStep );
	++m_frame;
	return std::chrono::duration<double>( std::chrono::steady_clock::now() - start ).count();
}

Motion Rig::motion() const
{
	Motion sum = m_subject->motion();
	if ( m_ball != nullptr && m_ball->getInvMass() > 0 )
	{
		const double mass = 1.0 / double( m_ball->getInvMass() );
		const Eigen::Vector3d x = toEigen( m_ball->getWorldTransform().getOrigin() ), v = toEigen( m_ball->getLinearVelocity() );
		const btVector3 turning = m_ball->getInvInertiaTensorWorld().inverse() * m_ball->getAngularVelocity();
		sum.centre = ( sum.mass * sum.centre + mass * x ) / ( sum.mass + mass );
		sum.mass += mass;
		sum.momentum += mass * v;
		sum.spin += x.cross( mass * v ) + toEigen( turning );
		sum.kineticEnergy += 0.5 * mass * v.squaredNorm() + 0.5 * double( turning.dot( m_ball->getAngularVelocity() ) );
	}
	return sum;
}

double Rig::mechanicalEnergy() const
{
	const Motion sum = motion();
	return sum.kineticEnergy + ( m_scene.hasGravity ? sum.mass * kGravity * sum.centre.y() : 0.0 );
}

bool Rig::ball( Eigen::Vector3d& middle, double& radius ) const
{
	if ( m_ball == nullptr )
	{
		return false;
	}
	middle = toEigen( m_ball->getWorldTransform().getOrigin() );
	radius = m_ballRadius;
	return true;
}

} // namespace pliant_study
