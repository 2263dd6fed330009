// Joints and debug drawing in C: they act as in C++, and misuse is refused.

#include "c/misuse.h"

#include "pliant/c/mix.h"
#include "pliant/soft_body_host.h"

#include <LinearMath/btIDebugDraw.h>

#include <array>
#include <cmath>

namespace pliant {
namespace {

using namespace test;

struct JointScene : CScene
{
	pliant_id box( pliant_vec3 at, double mass )
	{
		auto settings = initial( pliant_rigid_settings_init );
		settings.kind = mass > 0 ? PLIANT_RIGID_DYNAMIC : PLIANT_RIGID_STATIC;
		settings.mass = mass > 0 ? mass : 1;
		settings.pose.position = at;
		pliant_id made = 0;
		EXPECT_EQ( pliant_rigid_create_box( world, pliant_vec3{ 0.1, 0.1, 0.1 }, &settings, &made ), PLIANT_OK ) << pliant_last_error();
		return made;
	}

	pliant_id join( pliant_id first, pliant_id second, const pliant_joint_settings& settings )
	{
		pliant_id made = 0;
		EXPECT_EQ( pliant_joint_create( world, first, second, &settings, &made ), PLIANT_OK ) << pliant_last_error();
		return made;
	}

	pliant_joint_state stateOf( pliant_id joint )
	{
		pliant_joint_state state{};
		EXPECT_EQ( pliant_joint_get_state( world, joint, &state, sizeof state ), PLIANT_OK ) << pliant_last_error();
		return state;
	}

	pliant_pose poseOf( pliant_id rigid )
	{
		pliant_pose pose{};
		EXPECT_EQ( pliant_rigid_get_pose( world, rigid, &pose ), PLIANT_OK );
		return pose;
	}
};

pliant_joint_settings joint( int kind, pliant_vec3 at )
{
	auto settings = initial( pliant_joint_settings_init );
	settings.kind = kind;
	settings.pose.position = at;
	return settings;
}

TEST( CJoints, APendulumKeepsItsLengthAndItsJointCarriesItsWeight )
{
	JointScene t;
	const pliant_id post = t.box( pliant_vec3{ 0, 2, 0 }, 0 ), bob = t.box( pliant_vec3{ 0, 1, 0 }, 3 );
	const pliant_id made = t.join( post, bob, joint( PLIANT_JOINT_POINT, pliant_vec3{ 0, 2, 0 } ) );
	t.step( 120 );
	EXPECT_NEAR( t.poseOf( bob ).position.y, 1, 0.01 );
	const pliant_joint_state state = t.stateOf( made );
	EXPECT_EQ( state.first, post );
	EXPECT_EQ( state.second, bob );
	ASSERT_EQ( pliant_rigid_set_velocity( t.world, bob, pliant_vec3{ 2, 0, 0 }, pliant_vec3{ 0, 0, 0 } ), PLIANT_OK );
	for ( int k = 0; k < 60; ++k )
	{
		t.step( 1 );
		const pliant_vec3 at = t.poseOf( bob ).position;
		ASSERT_NEAR( std::hypot( at.x, at.y - 2, at.z ), 1, 0.02 );
	}
	ASSERT_EQ( pliant_joint_destroy( t.world, made ), PLIANT_OK );
	t.step( 60 );
	EXPECT_LT( t.poseOf( bob ).position.y, 0.2 ) << "it lies on the floor";
}

// A hinge about y, so that gravity does not act on it. A positive velocity is a right-handed rotation of the second body.
TEST( CJoints, AMotorTurnsAHingeToItsLimitAndAFrameTurnsTheSoftBody )
{
	JointScene t;
	const pliant_id post = t.box( pliant_vec3{ 0, 2, 0 }, 0 ), door = t.box( pliant_vec3{ 0.5, 2, 0 }, 1 );
	auto settings = joint( PLIANT_JOINT_HINGE, pliant_vec3{ 0, 2, 0 } );
	const double half = std::sqrt( 0.5 );
	settings.pose.rotation[2] = half; // x becomes y
	settings.pose.rotation[3] = half;
	settings.low = -0.5;
	settings.high = 1;
	settings.motor_velocity = 1;
	settings.motor_force = 100;
	const pliant_id made = t.join( post, door, settings );
	t.step( 30 );
	EXPECT_NEAR( t.stateOf( made ).position, 0.5, 0.06 );
	EXPECT_LT( t.poseOf( door ).position.z, -0.2 );
	t.step( 60 );
	EXPECT_NEAR( t.stateOf( made ).position, 1, 0.05 );
	ASSERT_EQ( pliant_joint_set_motor( t.world, made, -2, 100 ), PLIANT_OK );
	t.step( 90 );
	EXPECT_NEAR( t.stateOf( made ).position, -0.5, 0.05 );
	EXPECT_EQ( t.stateOf( made ).motor_velocity, -2 );

	// The same with a cube in the door's place.
	const pliant_id cube = t.add( pliant_vec3{ 4, 2, 0 } ), pillar = t.box( pliant_vec3{ 3, 2, 0 }, 0 );
	pliant_id frame = 0;
	ASSERT_EQ( pliant_frame_create( t.world, cube, pliant_vec3{ 4, 2, 0 }, 0.4, &frame ), PLIANT_OK ) << pliant_last_error();
	settings.pose.position = pliant_vec3{ 3, 2, 0 };
	settings.low = 1;
	settings.high = -1;
	settings.motor_force = 1e6; // the cube has a ton
	const pliant_id hinge = t.join( pillar, frame, settings );
	t.step( 90 );
	EXPECT_NEAR( t.stateOf( hinge ).position, 1.5, 0.15 );
	EXPECT_LT( t.state( cube ).mass_centre.z, -0.8 );
	EXPECT_NEAR( t.state( cube ).mass_centre.y, 2, 0.1 );
}

TEST( CJoints, ASliderMovesBetweenItsLimitsAndAFixedJointBreaksByItsLoad )
{
	JointScene t;
	const pliant_id post = t.box( pliant_vec3{ 0, 2, 0 }, 0 ), sledge = t.box( pliant_vec3{ 0.5, 2, 0 }, 1 );
	auto settings = joint( PLIANT_JOINT_SLIDER, pliant_vec3{ 0, 2, 0 } );
	settings.low = 0;
	settings.high = 0.3;
	settings.motor_velocity = 1;
	settings.motor_force = 50;
	const pliant_id slider = t.join( post, sledge, settings );
	t.step( 90 );
	EXPECT_NEAR( t.stateOf( slider ).position, 0.3, 0.02 );
	EXPECT_NEAR( t.poseOf( sledge ).position.x, 0.8, 0.02 );
	EXPECT_NEAR( t.poseOf( sledge ).position.y, 2, 0.02 );

	auto fixed = joint( PLIANT_JOINT_FIXED, pliant_vec3{ 2, 2, 0 } );
	fixed.breaking_impulse = 2; // in a step of 1/60 s: 120 N
	const pliant_id held = t.box( pliant_vec3{ 2, 2, 0 }, 1 ), weld = t.join( held, 0, fixed );
	t.step( 60 );
	EXPECT_EQ( t.stateOf( weld ).is_broken, 0 );
	EXPECT_EQ( t.stateOf( weld ).second, 0u );
	EXPECT_NEAR( t.poseOf( held ).position.y, 2, 0.01 );
	ASSERT_EQ( pliant_rigid_apply_impulse( t.world, held, pliant_vec3{ 0, -10, 0 }, pliant_vec3{ 2, 2, 0 } ), PLIANT_OK );
	t.step( 60 );
	EXPECT_EQ( t.stateOf( weld ).is_broken, 1 );
	EXPECT_LT( t.poseOf( held ).position.y, 0.2 ) << "it lies on the floor";
}

TEST( CJoints, EndWithTheirBodies )
{
	JointScene t;
	const pliant_id post = t.box( pliant_vec3{ 0, 2, 0 }, 0 ), bob = t.box( pliant_vec3{ 0, 1, 0 }, 3 );
	const pliant_id cube = t.add( pliant_vec3{ 4, 2, 0 } );
	pliant_id frame = 0;
	ASSERT_EQ( pliant_frame_create( t.world, cube, pliant_vec3{ 4, 2, 0 }, 0.4, &frame ), PLIANT_OK );
	const pliant_id first = t.join( post, bob, joint( PLIANT_JOINT_POINT, pliant_vec3{ 0, 2, 0 } ) );
	const pliant_id second = t.join( frame, bob, joint( PLIANT_JOINT_FIXED, pliant_vec3{ 0, 2, 0 } ) );
	const pliant_id third = t.join( frame, 0, joint( PLIANT_JOINT_POINT, pliant_vec3{ 4, 2, 0 } ) );
	btDynamicsWorld& world = hostOf( t.world )->bulletWorld();
	t.step( 2 );
	EXPECT_EQ( world.getNumConstraints(), 3 );
	ASSERT_EQ( pliant_object_destroy( t.world, bob ), PLIANT_OK );
	EXPECT_EQ( world.getNumConstraints(), 1 );
	pliant_joint_state state{};
	EXPECT_EQ( pliant_joint_get_state( t.world, first, &state, sizeof state ), PLIANT_NO_SUCH_OBJECT );
	EXPECT_EQ( pliant_joint_get_state( t.world, second, &state, sizeof state ), PLIANT_NO_SUCH_OBJECT );
	ASSERT_EQ( pliant_frame_destroy( t.world, frame ), PLIANT_OK );
	EXPECT_EQ( pliant_joint_get_state( t.world, third, &state, sizeof state ), PLIANT_NO_SUCH_OBJECT );
	EXPECT_EQ( world.getNumConstraints(), 0 );
	t.join( post, t.box( pliant_vec3{ 0, 1, 0 }, 1 ), joint( PLIANT_JOINT_POINT, pliant_vec3{ 0, 2, 0 } ) );
	t.step( 2 ); // the scene's end ends the joint
}

TEST( CToolsMisuse, InvalidJoints )
{
	MisuseScene scene;
	static pliant_joint_settings unsized = initial( pliant_joint_settings_init ), kind = unsized, pose = unsized, low = unsized,
								 wide = unsized, motor = unsized, breaking = unsized;
	static pliant_id made = 0, point = 0;
	static pliant_joint_state state{};
	unsized.size = 3;
	kind.kind = 4;
	pose.pose = kBadPose;
	low.low = kBad;
	wide.kind = PLIANT_JOINT_HINGE;
	wide.low = -4;
	wide.high = 1;
	motor.motor_force = -1;
	breaking.breaking_impulse = -1;
	ASSERT_EQ( pliant_joint_create( scene.world, scene.ball, 0, nullptr, &point ), PLIANT_OK ) << pliant_last_error();
	scene.expectRefused( PLIANT_BAD_ARGUMENT,
		{
			PLIANT_NAMED( pliant_joint_settings_init( nullptr, sizeof unsized ) ),
			PLIANT_NAMED( pliant_joint_create( nullptr, t.id, 0, nullptr, &made ) ),
			PLIANT_NAMED( pliant_joint_create( t.world, t.id, 0, nullptr, nullptr ) ),
			PLIANT_NAMED( pliant_joint_create( t.world, t.id, t.id, nullptr, &made ) ),
			PLIANT_NAMED( pliant_joint_create( t.world, t.id, 0, &unsized, &made ) ),
			PLIANT_NAMED( pliant_joint_create( t.world, t.id, 0, &pose, &made ) ),
			PLIANT_NAMED( pliant_joint_destroy( nullptr, point ) ),
			PLIANT_NAMED( pliant_joint_set_motor( nullptr, point, 1, 1 ) ),
			PLIANT_NAMED( pliant_joint_set_motor( t.world, point, 1, 1 ) ), // no hinge
			PLIANT_NAMED( pliant_joint_get_state( nullptr, point, &state, sizeof state ) ),
			PLIANT_NAMED( pliant_joint_get_state( t.world, point, nullptr, sizeof state ) ),
			PLIANT_NAMED( pliant_joint_get_state( t.world, point, &state, 2 ) ),
		},
		Target{ scene.world, scene.ball } );
	scene.expectRefused( PLIANT_BAD_SETTINGS,
		{
			PLIANT_NAMED( pliant_joint_create( t.world, t.id, 0, &kind, &made ) ),
			PLIANT_NAMED( pliant_joint_create( t.world, t.id, 0, &low, &made ) ),
			PLIANT_NAMED( pliant_joint_create( t.world, t.id, 0, &wide, &made ) ),
			PLIANT_NAMED( pliant_joint_create( t.world, t.id, 0, &motor, &made ) ),
			PLIANT_NAMED( pliant_joint_create( t.world, t.id, 0, &breaking, &made ) ),
		},
		Target{ scene.world, scene.ball } );
	scene.expectRefused( PLIANT_BAD_ARGUMENT, { PLIANT_NAMED( pliant_joint_create( t.world, t.id, 0, nullptr, &made ) ) },
		Target{ scene.world, scene.soft } );
	scene.expectRefused( PLIANT_NO_SUCH_OBJECT,
		{
			PLIANT_NAMED( pliant_joint_create( t.world, t.id, 0, nullptr, &made ) ),
			PLIANT_NAMED( pliant_joint_destroy( t.world, t.id ) ),
			PLIANT_NAMED( pliant_joint_set_motor( t.world, t.id, 1, 1 ) ),
			PLIANT_NAMED( pliant_joint_get_state( t.world, t.id, &state, sizeof state ) ),
		},
		Target{ scene.world, scene.goneBall } );
}

struct Lines
{
	std::vector<std::array<double, 9>> lines;
	static void add( const double* from, const double* to, const double* colour, void* context )
	{
		std::array<double, 9> line;
		for ( std::size_t k = 0; k < 3; ++k )
		{
			line[k] = from[k];
			line[k + 3] = to[k];
			line[k + 6] = colour[k];
		}
		static_cast<Lines*>( context )->lines.push_back( line );
	}
};

TEST( CTools, DrawsTheLinesThatCppDraws )
{
	struct Drawer : btIDebugDraw
	{
		Lines drawn;
		void drawLine( const btVector3& a, const btVector3& b, const btVector3& c ) override
		{
			const double p[9] = { double( a.x() ), double( a.y() ), double( a.z() ), double( b.x() ), double( b.y() ), double( b.z() ),
				double( c.x() ), double( c.y() ), double( c.z() ) };
			Lines::add( p, p + 3, p + 6, &drawn );
		}
		void drawContactPoint( const btVector3&, const btVector3&, btScalar, int, const btVector3& ) override {}
		void reportErrorWarning( const char* ) override {}
		void draw3dText( const btVector3&, const char* ) override {}
		void setDebugMode( int ) override {}
		int getDebugMode() const override { return DBG_DrawWireframe | DBG_DrawConstraints; }
	} drawer;
	CScene scene;
	scene.add( pliant_vec3{ 0, 1, 0 } );
	scene.addBall( pliant_vec3{ 0, 3, 0 }, 2 );
	Lines usual, all;
	ASSERT_EQ( pliant_world_draw( scene.world, nullptr, Lines::add, &usual ), PLIANT_OK ) << pliant_last_error();
	auto what = initial( pliant_debug_drawing_init );
	what.links = what.cells = 1;
	ASSERT_EQ( pliant_world_draw( scene.world, &what, Lines::add, &all ), PLIANT_OK ) << pliant_last_error();
	EXPECT_GT( all.lines.size(), usual.lines.size() );
	btDynamicsWorld& world = hostOf( scene.world )->bulletWorld();
	EXPECT_EQ( world.getDebugDrawer(), nullptr ) << "the call leaves the world as it was";
	world.setDebugDrawer( &drawer );
	world.debugDrawWorld();
	world.setDebugDrawer( nullptr );
	EXPECT_FALSE( usual.lines.empty() );
	EXPECT_EQ( usual.lines, drawer.drawn.lines );
}

TEST( CToolsMisuse, InvalidDrawing )
{
	MisuseScene scene;
	static const pliant_draw_line line = []( const double*, const double*, const double*, void* ) {};
	static pliant_debug_drawing unsized = initial( pliant_debug_drawing_init ), flat = unsized, bad = unsized;
	unsized.size = 3;
	flat.full_strain = 0;
	bad.metres_per_newton = kBad;
	scene.expectRefused( PLIANT_BAD_ARGUMENT,
		{
			PLIANT_NAMED( pliant_debug_drawing_init( nullptr, sizeof unsized ) ),
			PLIANT_NAMED( pliant_debug_drawing_init( &unsized, 3 ) ),
			PLIANT_NAMED( pliant_world_draw( nullptr, nullptr, line, nullptr ) ),
			PLIANT_NAMED( pliant_world_draw( t.world, nullptr, nullptr, nullptr ) ),
			PLIANT_NAMED( pliant_world_draw( t.world, &unsized, line, nullptr ) ),
			PLIANT_NAMED( pliant_world_draw( t.world, &flat, line, nullptr ) ),
			PLIANT_NAMED( pliant_world_draw( t.world, &bad, line, nullptr ) ),
		},
		Target{ scene.world, scene.soft } );
}

} // namespace
} // namespace pliant
