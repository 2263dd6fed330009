#pragma once

// Contents of the scene game_playground: soft ground, things to push and to break, doors, a ball on a chain, a fan.

#include "demos/stage.h"

#include <BulletCollision/CollisionDispatch/btGhostObject.h>

namespace pliant_demos {

/// Kinds of soft bodies; pieces have the kind of their body (btCollisionObject::getUserIndex).
enum class PlaygroundThing : int
{
	Ground = 1,
	PushBlock,
	Door,
	Ball,
	Wall,
	Crate,
	Vase,
	Flag
};
PlaygroundThing thingOf( const btCollisionObject& object );

constexpr btScalar kWalkersLane = btScalar( 1.6 ), kCarsLane = btScalar( -2 ); // z, m
constexpr int kMostPlaygroundPieces = 40;                                      // the debris budget

/// Wind in front of a fan, for light objects.
class FanWind : public pliant::Wind
{
public:
	bool actsOn( const btCollisionObject& object ) const override;
	btVector3 velocityAt( const btVector3& position ) const override;
	bool isOn() const { return !settings().velocity.fuzzyZero(); }
	void switchOn();
};

class PlaygroundLevel
{
public:
	/// False if a body is refused; the stage's status has the reason.
	bool build( Stage& stage );
	PlaygroundLevel() = default;
	~PlaygroundLevel();
	PlaygroundLevel( const PlaygroundLevel& ) = delete;
	PlaygroundLevel& operator=( const PlaygroundLevel& ) = delete;

	/// rad, from closed.
	double gateAngle() const;
	double doorAngle() const;
	void openGate();
	/// State that the scene has changed since the level was built.
	struct Switches
	{
		btScalar gateMotor; ///< rad/s
		pliant::WindSettings wind;
	};
	Switches switches() const { return { m_gate->getMotorTargetVelocity(), fan.settings() }; }
	void restore( const Switches& switches );
	void draw( pliant_glue::DrawList& list, bool isFired, double seconds ) const;

	pliant::SoftBody *mat = nullptr, *pushBlock = nullptr, *door = nullptr, *ball = nullptr, *flag = nullptr;
	btGhostObject trigger;
	FanWind fan;
	int chain = -1; ///< the attachment of the ball

private:
	pliant::SoftBody* addThing( SoftOrder order, const pliant_glue::ModelMesh& mesh, PlaygroundThing thing, const btVector3& at );
	bool addGrounds();
	bool addDoors();
	bool addBallOnChain();
	bool addBreakables();
	bool addWall();
	bool addFlag();
	void addTrigger();

	Stage* m_stage = nullptr;
	btGhostPairCallback m_pairs;
	btBoxShape m_triggerShape = btBoxShape( btVector3( btScalar( 0.4 ), btScalar( 0.3 ), btScalar( 0.6 ) ) );
	btHingeConstraint* m_gate = nullptr;
};

} // namespace pliant_demos
