// +-----------------------------------------------------------------------------------------------------------------+
// | robot_grip: a robot's arm, one btMultiBody in a world over btMultiBodyDynamicsWorld, with motors at its joints: it |
// | turns about its column, its boom slides up and down, and three fingers close around a soft ball.                   |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/must_succeed.h"
#include "demos/palette.h"
#include "demos/scene.h"
#include "demos/shapes.h"

#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyJointMotor.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace pliant_demos {

namespace {

constexpr btScalar kBall = btScalar( 0.32 );                                   // m, its diameter
constexpr btScalar kReach = btScalar( 0.8 ), kHeight = btScalar( 1.0 );        // m, of the boom's end
constexpr btScalar kHub = btScalar( 0.13 );                                    // m, from the boom's end to a finger's joint
constexpr btScalar kFingerLength = btScalar( 0.42 ), kDrop = btScalar( 0.58 ); // m; how far the boom goes down
constexpr btScalar kOpen = btScalar( 0.45 );                                   // rad
constexpr btScalar kPi = btScalar( 3.14159265 );
constexpr btScalar kTurn = -btScalar( 0.4 ) * kPi; // to the viewer

/// Targets of the joints, and the time until which they hold.
struct Order
{
	double until;          ///< s
	btScalar turn, height; ///< rad; m, of the boom
	bool isClosed;
};

constexpr Order kOrders[] = {
	{ 1.2, 0, -kDrop, false },
	{ 2.2, 0, -kDrop, true },
	{ 3.8, 0, 0, true },
	{ 5.8, kTurn, 0, true },
	{ 7.2, kTurn, -kDrop, true },
	{ 8.0, kTurn, -kDrop, false },
	{ 9.5, kTurn, 0, false },
};

enum Link
{
	Column,
	Boom,
	FirstFinger,
	Links = FirstFinger + 3
};

class RobotGrip : public Scene
{
public:
	bool init( Stage& stage ) override
	{
		m_stage = std::make_unique<Stage>( stage.options(), "arm", StageWorld::MultiBodies );
		m_stage->addGround( btScalar( 0.8 ) );
		makeArm();
		const pliant_glue::ModelMesh mesh = makeSphere( float( kBall ), 4 );
		SoftOrder order;
		order.name = "ball";
		order.mesh = &mesh;
		order.cells = 500;
		order.place = btTransform( btQuaternion::getIdentity(), btVector3( kReach, kBall / 2, 0 ) );
		order.material.youngsModulus = 1.2e4f;
		order.material.density = 60.0f;
		order.material.damping = 6.0f;
		order.friction = btScalar( 1 );
		order.colour = kTerracotta;
		m_ball = m_stage->addSoft( order );
		return m_ball != nullptr;
	}
	~RobotGrip() override
	{
		for ( const auto& motor : m_motors )
		{
			m_stage->multiBodyWorld().removeMultiBodyConstraint( motor.get() );
		}
		for ( const auto& part : m_parts )
		{
			m_stage->multiBodyWorld().removeCollisionObject( part.collider.get() );
		}
		if ( m_arm )
		{
			m_stage->multiBodyWorld().removeMultiBody( m_arm.get() );
		}
	}

	std::vector<Stage*> sideStages() override { return { m_stage.get() }; }

	void beforeStep( Stage&, double seconds ) override
	{
		const Order* now = std::begin( kOrders );
		while ( now + 1 != std::end( kOrders ) && seconds > now->until )
		{
			++now;
		}
		drive( Column, now->turn, btScalar( 1.2 ) );
		drive( Boom, now->height, btScalar( 0.6 ) );
		for ( int k = 0; k < 3; ++k )
		{
			now->isClosed ? m_motors[std::size_t( FirstFinger + k )]->setVelocityTarget( btScalar( -1.5 ) )
						  : drive( FirstFinger + k, kOpen, btScalar( 1.5 ) );
		}
	}

	void afterStep( Stage&, double seconds ) override
	{
		m_highest = std::max( m_highest, double( m_ball->massCentre().y() ) );
		if ( seconds < kOrders[3].until )
		{
			const btVector3 hub = m_parts[Boom].collider->getWorldTransform() * btVector3( kReach / 2, 0, 0 );
			m_below = double( hub.y() - m_ball->massCentre().y() );
			m_beside = double( ( hub - m_ball->massCentre() - btVector3( 0, btScalar( m_below ), 0 ) ).length() );
		}
	}

	void beforePicture( Stage&, pliant_glue::DrawList& list ) override
	{
		const auto add = [&list]( const btTransform& at, const btVector3& size, const pliant_glue::Colour& colour ) {
			const btMatrix3x3& axes = at.getBasis();
			const auto scaled = [&]( int k ) {
				const btVector3 axis = axes.getColumn( k ) * size[k];
				return pliant_glue::Vec3{ float( axis.x() ), float( axis.y() ), float( axis.z() ) };
			};
			const btVector3& p = at.getOrigin();
			list.boxes.push_back( { scaled( 0 ), scaled( 1 ), scaled( 2 ), { float( p.x() ), float( p.y() ), float( p.z() ) }, colour } );
		};
		for ( const Part& part : m_parts )
		{
			add( part.collider->getWorldTransform(), part.size, part.colour );
		}
		add( btTransform( btQuaternion::getIdentity(), btVector3( 0, btScalar( 0.04 ), 0 ) ),
			btVector3( btScalar( 0.5 ), btScalar( 0.08 ), btScalar( 0.5 ) ), kStone );
	}

	std::vector<FindingTable> findings( const Stage& ) const override
	{
		FindingTable table{ "the ball, m", { "lifted to", "below the hub", "beside it", "put down at x", "z" }, {} };
		const btVector3 at = m_ball->massCentre();
		table.rows.push_back( { "ball", { m_highest, m_below, m_beside, double( at.x() ), double( at.z() ) } } );
		return { table };
	}

	double duration() const override { return 10.0; }
	pliant_glue::DrawCamera camera( double ) const override { return { { 1.5f, 1.5f, 2.9f }, { 0.25f, 0.55f, -0.1f }, 36.0f }; }
	pliant_glue::DrawLight light() const override { return { { -0.4f, 0.8f, 0.55f }, { 0.3f, 0.5f, 0 }, 2.6f }; }

private:
	struct Part
	{
		std::unique_ptr<btBoxShape> shape;
		std::unique_ptr<btMultiBodyLinkCollider> collider;
		btVector3 size;
		pliant_glue::Colour colour;
	};

	void makeArm()
	{
		const btQuaternion unturned = btQuaternion::getIdentity();
		const btVector3 none( 0, 0, 0 ), up( 0, 1, 0 );
		const auto inertia = []( btScalar mass, const btVector3& size ) {
			btVector3 made;
			btBoxShape( size / 2 ).calculateLocalInertia( mass, made );
			return made;
		};
		const btVector3 column( btScalar( 0.16 ), btScalar( 1.25 ), btScalar( 0.16 ) ), boom( kReach, btScalar( 0.09 ), btScalar( 0.12 ) ),
			finger( btScalar( 0.035 ), kFingerLength, btScalar( 0.09 ) );
		m_arm = std::make_unique<btMultiBody>( Links, 0, none, true, false );
		m_arm->setupRevolute( Column, 10, inertia( 10, column ), -1, unturned, up, none, btVector3( 0, column.y() / 2, 0 ), true );
		m_arm->setupPrismatic(
			Boom, 4, inertia( 4, boom ), Column, unturned, up, btVector3( kReach / 2, kHeight - column.y() / 2, 0 ), none, true );
		for ( int k = 0; k < 3; ++k )
		{
			// The x axis of a finger points away from the hub's centre, and the finger rotates about its z axis: outwards for positive
			// angles.
			const btScalar around = 2 * kPi * btScalar( k ) / 3 + kPi / 3;
			const btQuaternion fromBoom( up, -around ), toBoom( up, around );
			const btVector3 joint = btVector3( kReach / 2, btScalar( -0.02 ), 0 ) + quatRotate( toBoom, btVector3( kHub, 0, 0 ) );
			m_arm->setupRevolute( FirstFinger + k, btScalar( 0.8 ), inertia( btScalar( 0.8 ), finger ), Boom, fromBoom,
				btVector3( 0, 0, 1 ), joint, btVector3( 0, -kFingerLength / 2, 0 ), true );
		}
		m_arm->finalizeMultiDof();
		m_arm->setCanSleep( false );
		btMultiBodyDynamicsWorld& world = m_stage->multiBodyWorld();
		world.addMultiBody( m_arm.get() );
		for ( int k = 0; k < 3; ++k )
		{
			m_arm->setJointPos( FirstFinger + k, kOpen );
		}
		addPart( Column, column, kStone );
		addPart( Boom, boom, kSlate );
		for ( int k = 0; k < 3; ++k )
		{
			addPart( FirstFinger + k, finger, kOchre );
		}
		btAlignedObjectArray<btQuaternion> rotations;
		btAlignedObjectArray<btVector3> positions;
		m_arm->forwardKinematics( rotations, positions );
		m_arm->updateCollisionObjectWorldTransforms( rotations, positions );
		constexpr btScalar kMotorImpulse[Links] = { 20, 20, btScalar( 0.12 ), btScalar( 0.12 ), btScalar( 0.12 ) }; // N m s or N s a step
		for ( int link = 0; link < Links; ++link )
		{
			m_motors.push_back( std::make_unique<btMultiBodyJointMotor>( m_arm.get(), link, btScalar( 0 ), kMotorImpulse[link] ) );
			world.addMultiBodyConstraint( m_motors.back().get() );
		}
	}

	void addPart( int link, const btVector3& size, const pliant_glue::Colour& colour )
	{
		Part part;
		part.shape = std::make_unique<btBoxShape>( size / 2 );
		part.size = size;
		part.colour = colour;
		part.collider = std::make_unique<btMultiBodyLinkCollider>( m_arm.get(), link );
		part.collider->setCollisionShape( part.shape.get() );
		part.collider->setFriction( btScalar( 1 ) );
		m_arm->getLink( link ).m_collider = part.collider.get();
		// The arm's own parts do not collide with one another.
		m_stage->multiBodyWorld().addCollisionObject(
			part.collider.get(), btBroadphaseProxy::CharacterFilter, btBroadphaseProxy::DefaultFilter );
		m_parts.push_back( std::move( part ) );
	}

	/// Towards a position, at most at the velocity `fastest`.
	void drive( int link, btScalar position, btScalar fastest )
	{
		const btScalar away = position - m_arm->getJointPos( link );
		m_motors[std::size_t( link )]->setVelocityTarget( btClamped( 6 * away, -fastest, fastest ) );
	}

	std::unique_ptr<Stage> m_stage;
	std::unique_ptr<btMultiBody> m_arm;
	std::vector<Part> m_parts;
	std::vector<std::unique_ptr<btMultiBodyJointMotor>> m_motors;
	pliant::SoftBody* m_ball = nullptr;
	double m_highest = 0, m_below = 0, m_beside = 0;
};

} // namespace

std::unique_ptr<Scene> makeRobotGrip()
{
	return std::make_unique<RobotGrip>();
}

} // namespace pliant_demos
