#pragma once

// Objects that a player moves: Bullet's own character and car, in a world with soft bodies.

#include "demos/stage.h"

#include <pliant/vehicle_raycaster.h>

#include <BulletCollision/CollisionDispatch/btGhostObject.h>
#include <BulletDynamics/Character/btKinematicCharacterController.h>
#include <BulletDynamics/Vehicle/btRaycastVehicle.h>

#include <array>

namespace pliant_demos {

/// Bullet's character, with access to its fall and its position between two steps, so that a game can save them.
class Character : public btKinematicCharacterController
{
public:
	using btKinematicCharacterController::btKinematicCharacterController;

	/// State that it carries from step to step in addition to its ghost.
	struct State
	{
		btScalar fallVelocity, fallOffset, fallSpeed, jumpSpeed, stepOffset;
		btVector3 walkDirection, normalizedDirection, turning, jumpPosition, jumpAxis, position, target, touchingNormal;
		btQuaternion orientation, targetOrientation;
		bool touches, wasOnGround, wasJumping, usesWalkDirection;
		btScalar walksFor;
	};
	State state() const;
	void restore( const State& state );
};

/// A character that walks, steps up and jumps. The world needs a btGhostPairCallback.
class Walker
{
public:
	Walker( btDiscreteDynamicsWorld& world, const btVector3& foot );
	~Walker();
	Walker( const Walker& ) = delete;
	Walker& operator=( const Walker& ) = delete;

	btVector3 foot() const;
	bool isOnGround() const { return m_character.onGround(); }
	/// m/s, along the ground; until the next call.
	void walk( const btVector3& velocity );
	/// m/s, upwards; ignored in the air.
	void jump( btScalar speed );
	void draw( pliant_glue::DrawList& list ) const;
	Character::State state() const { return m_character.state(); }
	void restore( const Character::State& state ) { m_character.restore( state ); }

private:
	btDiscreteDynamicsWorld& m_world;
	btCapsuleShape m_capsule;
	btPairCachingGhostObject m_ghost;
	Character m_character;
	btVector3 m_heading = btVector3( 1, 0, 0 );
};

/// A car of 400 kg, 2 m long, whose wheels press on soft bodies.
class Car
{
public:
	/// Its wheels stand on the ground at `place`; its z axis points forward.
	Car( Stage& stage, const btTransform& place, const pliant_glue::Colour& colour );
	~Car();
	Car( const Car& ) = delete;
	Car& operator=( const Car& ) = delete;

	btRigidBody* chassis() const { return m_chassis; }
	btVector3 position() const { return m_chassis->getWorldTransform().getOrigin(); }
	/// Until the next call. `force`: N, of all wheels; `brake`: N s a step, of each wheel; `steer`: rad, to the left.
	void drive( btScalar force, btScalar brake, btScalar steer );
	void draw( pliant_glue::DrawList& list ) const;
	/// State of the vehicle in addition to that of its chassis.
	using Wheels = std::array<btWheelInfo, 4>;
	Wheels wheels() const;
	void restore( const Wheels& wheels );

private:
	btDiscreteDynamicsWorld& m_world;
	pliant::VehicleRaycaster m_caster;
	btRigidBody* m_chassis;
	btRaycastVehicle::btVehicleTuning m_tuning;
	btRaycastVehicle m_vehicle;
};

} // namespace pliant_demos
