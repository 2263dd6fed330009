#include "demos/actors.h"

#include "demos/palette.h"

#include <tuple>

namespace pliant_demos {

namespace {

constexpr btScalar kWalkerRadius = btScalar( 0.3 ), kWalkerHeight = btScalar( 1 ); // m, of the capsule between its caps
constexpr btScalar kFootToMiddle = kWalkerRadius + kWalkerHeight / 2;
constexpr btScalar kStepHeight = btScalar( 0.35 ); // m
constexpr btScalar kWalkerGravity = 10;            // m/s^2
constexpr int kWalkerStepsPerSecond = 60;

constexpr btScalar kWheelRadius = btScalar( 0.3 ), kWheelWidth = btScalar( 0.2 ), kSuspension = btScalar( 0.4 ); // m
constexpr btScalar kChassisHeight = btScalar( 0.75 );                                                            // m, over the ground
constexpr btScalar kCarMass = 400;                                                                               // kg

pliant_glue::Vec3 plain( const btVector3& v )
{
	return { float( v.x() ), float( v.y() ), float( v.z() ) };
}

/// A ball stretched along its axes.
void addEgg( pliant_glue::DrawList& list, const btTransform& at, const btVector3& size, const pliant_glue::Colour& colour )
{
	const btMatrix3x3& axes = at.getBasis();
	list.spheres.push_back( { plain( axes.getColumn( 0 ) * size.x() ), plain( axes.getColumn( 1 ) * size.y() ),
		plain( axes.getColumn( 2 ) * size.z() ), plain( at.getOrigin() ), colour } );
}

} // namespace

Character::State Character::state() const
{
	return { m_verticalVelocity, m_verticalOffset, m_fallSpeed, m_jumpSpeed, m_currentStepOffset, m_walkDirection, m_normalizedDirection,
		m_AngVel, m_jumpPosition, m_jumpAxis, m_currentPosition, m_targetPosition, m_touchingNormal, m_currentOrientation,
		m_targetOrientation, m_touchingContact, m_wasOnGround, m_wasJumping, m_useWalkDirection, m_velocityTimeInterval };
}

void Character::restore( const State& state )
{
	std::tie( m_verticalVelocity, m_verticalOffset, m_fallSpeed, m_jumpSpeed, m_currentStepOffset ) = std::tie(
		state.fallVelocity, state.fallOffset, state.fallSpeed, state.jumpSpeed, state.stepOffset );
	std::tie( m_walkDirection, m_normalizedDirection, m_AngVel, m_jumpPosition, m_jumpAxis, m_currentPosition, m_targetPosition,
		m_touchingNormal ) = std::tie( state.walkDirection, state.normalizedDirection, state.turning, state.jumpPosition, state.jumpAxis,
		state.position, state.target, state.touchingNormal );
	std::tie( m_currentOrientation, m_targetOrientation ) = std::tie( state.orientation, state.targetOrientation );
	std::tie( m_touchingContact, m_wasOnGround, m_wasJumping, m_useWalkDirection, m_velocityTimeInterval ) = std::tie(
		state.touches, state.wasOnGround, state.wasJumping, state.usesWalkDirection, state.walksFor );
}

Walker::Walker( btDiscreteDynamicsWorld& world, const btVector3& foot ) :
	m_world( world ), m_capsule( kWalkerRadius, kWalkerHeight ), m_character( &m_ghost, &m_capsule, kStepHeight, btVector3( 0, 1, 0 ) )
{
	m_ghost.setCollisionShape( &m_capsule );
	m_ghost.setCollisionFlags( btCollisionObject::CF_CHARACTER_OBJECT ); // soft bodies then carry it as rigid ones do
	m_ghost.setWorldTransform( btTransform( btQuaternion::getIdentity(), foot + btVector3( 0, kFootToMiddle, 0 ) ) );
	world.addCollisionObject(
		&m_ghost, btBroadphaseProxy::CharacterFilter, btBroadphaseProxy::StaticFilter | btBroadphaseProxy::DefaultFilter );
	world.addAction( &m_character );
	m_character.setGravity( btVector3( 0, -kWalkerGravity, 0 ) );
}

Walker::~Walker()
{
	m_world.removeAction( &m_character );
	m_world.removeCollisionObject( &m_ghost );
}

btVector3 Walker::foot() const
{
	return m_ghost.getWorldTransform().getOrigin() - btVector3( 0, kFootToMiddle, 0 );
}

void Walker::walk( const btVector3& velocity )
{
	m_character.setWalkDirection( velocity / kWalkerStepsPerSecond ); // Bullet's is by the step
	m_heading = velocity.fuzzyZero() ? m_heading : velocity.normalized();
}

void Walker::jump( btScalar speed )
{
	if ( m_character.onGround() )
	{
		m_character.jump( btVector3( 0, speed, 0 ) );
	}
}

void Walker::draw( pliant_glue::DrawList& list ) const
{
	const btVector3 up( 0, 1, 0 ), side = m_heading.cross( up );
	const btMatrix3x3 axes( m_heading.x(), 0, side.x(), m_heading.y(), 1, side.y(), m_heading.z(), 0, side.z() );
	const auto egg = [&]( const btVector3& at, const btVector3& size, const pliant_glue::Colour& colour ) {
		addEgg( list, btTransform( axes, foot() + axes * at ), size, colour );
	};
	egg( btVector3( 0, btScalar( 0.60 ), 0 ), btVector3( btScalar( 0.52 ), btScalar( 0.95 ), btScalar( 0.60 ) ), kSlate );
	egg( btVector3( 0, btScalar( 1.30 ), 0 ), btVector3( btScalar( 0.50 ), btScalar( 0.56 ), btScalar( 0.50 ) ), kOchre );
	for ( const btScalar z : { btScalar( -0.15 ), btScalar( 0.15 ) } )
	{
		egg( btVector3( btScalar( 0.04 ), btScalar( 0.09 ), z ), btVector3( btScalar( 0.38 ), btScalar( 0.18 ), btScalar( 0.2 ) ), kPlum );
		egg( btVector3( btScalar( 0.21 ), btScalar( 1.36 ), z * btScalar( 0.6 ) ),
			btVector3( btScalar( 0.08 ), btScalar( 0.10 ), btScalar( 0.08 ) ), kPlum );
	}
}

Car::Car( Stage& stage, const btTransform& place, const pliant_glue::Colour& colour ) :
	m_world( stage.world() ), m_caster( stage.world() ),
	m_chassis( stage.addBox( btVector3( 1, btScalar( 0.4 ), 2 ),
		place * btTransform( btQuaternion::getIdentity(), btVector3( 0, kChassisHeight, 0 ) ), kCarMass, colour ) ),
	m_vehicle( m_tuning, m_chassis, &m_caster )
{
	m_chassis->setActivationState( DISABLE_DEACTIVATION );
	m_vehicle.setCoordinateSystem( 0, 1, 2 );
	for ( int k = 0; k < 4; ++k )
	{
		btWheelInfo& wheel = m_vehicle.addWheel(
			btVector3( k % 2 ? btScalar( 0.45 ) : btScalar( -0.45 ), btScalar( -0.1 ), k < 2 ? btScalar( 0.8 ) : btScalar( -0.8 ) ),
			btVector3( 0, -1, 0 ), btVector3( -1, 0, 0 ), kSuspension, kWheelRadius, m_tuning, k < 2 );
		wheel.m_suspensionStiffness = 40;
		wheel.m_wheelsDampingRelaxation = 4;
		wheel.m_wheelsDampingCompression = 4;
	}
	m_world.addVehicle( &m_vehicle );
	m_caster.setVehicle( &m_vehicle );
	m_world.addAction( &m_caster );
}

Car::~Car()
{
	m_world.removeAction( &m_caster );
	m_world.removeVehicle( &m_vehicle );
}

void Car::drive( btScalar force, btScalar brake, btScalar steer )
{
	for ( int w = 0; w < m_vehicle.getNumWheels(); ++w )
	{
		m_vehicle.applyEngineForce( force / btScalar( m_vehicle.getNumWheels() ), w );
		m_vehicle.setBrake( brake, w );
		m_vehicle.setSteeringValue( m_vehicle.getWheelInfo( w ).m_bIsFrontWheel ? steer : 0, w );
	}
}

Car::Wheels Car::wheels() const
{
	Wheels wheels;
	for ( int w = 0; w < m_vehicle.getNumWheels(); ++w )
	{
		wheels[std::size_t( w )] = m_vehicle.getWheelInfo( w );
		wheels[std::size_t( w )].m_raycastInfo.m_groundObject = nullptr; // found again in each step
	}
	return wheels;
}

void Car::restore( const Wheels& wheels )
{
	for ( int w = 0; w < m_vehicle.getNumWheels(); ++w )
	{
		m_vehicle.getWheelInfo( w ) = wheels[std::size_t( w )];
	}
}

void Car::draw( pliant_glue::DrawList& list ) const
{
	for ( int w = 0; w < m_vehicle.getNumWheels(); ++w )
	{
		const btTransform& at = m_vehicle.getWheelInfo( w ).m_worldTransform;
		addEgg( list, at, btVector3( kWheelWidth, 2 * kWheelRadius, 2 * kWheelRadius ), kStone );
	}
	const btTransform cabin = m_chassis->getWorldTransform() *
		btTransform( btQuaternion::getIdentity(), btVector3( 0, btScalar( 0.25 ), btScalar( -0.25 ) ) );
	addEgg( list, cabin, btVector3( btScalar( 0.85 ), btScalar( 0.6 ), btScalar( 1.1 ) ), kStone );
}

} // namespace pliant_demos
