// Calls on objects, and refusals: a code, a sentence, and nothing has changed.

#include "c/misuse.h"

#include "pliant/c/mix.h"
#include "pliant/soft_body.h"

#include <BulletCollision/CollisionDispatch/btCollisionObject.h>

namespace pliant {
namespace {

using namespace test;

const std::vector<Named>& softCalls()
{
	static std::int32_t number;
	static std::uint64_t count;
	static double values[3];
	static pliant_body_state state;
	static pliant_node node;
	static pliant_surface surface;
	static pliant_material material = initial( pliant_material_init );
	static pliant_fracture fracture = initial( pliant_fracture_init );
	static pliant_adaptivity adaptivity = initial( pliant_adaptivity_init );
	static const std::vector<Named> calls = {
		PLIANT_NAMED( pliant_body_get_state( t.world, t.id, &state, sizeof state ) ),
		PLIANT_NAMED( pliant_body_get_node( t.world, t.id, 0, &node, sizeof node ) ),
		PLIANT_NAMED( pliant_body_get_positions( t.world, t.id, values, 1, &count ) ),
		PLIANT_NAMED( pliant_body_get_velocities( t.world, t.id, values, 1, &count ) ),
		PLIANT_NAMED( pliant_body_get_nearest_node( t.world, t.id, kZero, &number ) ),
		PLIANT_NAMED( pliant_body_get_surface( t.world, t.id, &surface, sizeof surface ) ),
		PLIANT_NAMED( pliant_body_set_velocity( t.world, t.id, kZero, kZero ) ),
		PLIANT_NAMED( pliant_body_apply_impulse( t.world, t.id, 0, kZero ) ),
		PLIANT_NAMED( pliant_body_apply_force( t.world, t.id, 0, kZero ) ),
		PLIANT_NAMED( pliant_body_set_gravity( t.world, t.id, nullptr ) ),
		PLIANT_NAMED( pliant_body_teleport( t.world, t.id, &kPose ) ),
		PLIANT_NAMED( pliant_body_reset( t.world, t.id, &kPose ) ),
		PLIANT_NAMED( pliant_body_set_scale( t.world, t.id, 1 ) ),
		PLIANT_NAMED( pliant_body_set_material( t.world, t.id, &material ) ),
		PLIANT_NAMED( pliant_body_get_material( t.world, t.id, &material, sizeof material ) ),
		PLIANT_NAMED( pliant_body_set_fracture( t.world, t.id, &fracture ) ),
		PLIANT_NAMED( pliant_body_get_fracture( t.world, t.id, &fracture, sizeof fracture ) ),
		PLIANT_NAMED( pliant_body_prepare_cracks( t.world, t.id ) ),
		PLIANT_NAMED( pliant_body_get_adaptivity( t.world, t.id, &adaptivity, sizeof adaptivity ) ),
		PLIANT_NAMED( pliant_body_request_refinement( t.world, t.id, kZero, kUp ) ),
		PLIANT_NAMED( pliant_body_set_finest_level( t.world, t.id, 0 ) ),
		PLIANT_NAMED( pliant_body_set_self_collision( t.world, t.id, 0 ) ),
		PLIANT_NAMED( pliant_body_set_contact_events( t.world, t.id, 0 ) ),
		PLIANT_NAMED( pliant_body_set_interpolation( t.world, t.id, 0 ) ),
		PLIANT_NAMED( pliant_body_set_kept( t.world, t.id, 0 ) ),
		PLIANT_NAMED( pliant_body_cut_plane( t.world, t.id, pliant_vec3{ 0, -9, 0 }, kUp, 1, &number ) ),
		PLIANT_NAMED( pliant_body_cut_sphere( t.world, t.id, kZero, 1e-3, &number ) ),
		PLIANT_NAMED( pliant_body_cut_sweep( t.world, t.id, kBlade, &number ) ),
		PLIANT_NAMED( pliant_body_heal( t.world, t.id, 1, &number ) ),
		PLIANT_NAMED( pliant_body_get_gas_pressure( t.world, t.id, 0, values ) ),
		PLIANT_NAMED( pliant_body_set_gas( t.world, t.id, PLIANT_GAS_NONE, 0, 0 ) ),
		PLIANT_NAMED( pliant_body_pin( t.world, t.id, 0 ) ),
		PLIANT_NAMED( pliant_body_drive( t.world, t.id, 0, kUp ) ),
		PLIANT_NAMED( pliant_body_release( t.world, t.id, 0 ) ),
		PLIANT_NAMED( pliant_body_pin_inside( t.world, t.id, kFar, kFar, &number ) ),
	};
	return calls;
}

const std::vector<Named>& rigidCalls()
{
	static pliant_pose pose;
	static pliant_vec3 vector;
	static double number;
	static const std::vector<Named> calls = {
		PLIANT_NAMED( pliant_rigid_get_pose( t.world, t.id, &pose ) ),
		PLIANT_NAMED( pliant_rigid_set_pose( t.world, t.id, &kPose ) ),
		PLIANT_NAMED( pliant_rigid_get_velocity( t.world, t.id, &vector, &vector ) ),
		PLIANT_NAMED( pliant_rigid_set_velocity( t.world, t.id, kZero, kZero ) ),
		PLIANT_NAMED( pliant_rigid_apply_impulse( t.world, t.id, kZero, kZero ) ),
		PLIANT_NAMED( pliant_rigid_apply_force( t.world, t.id, kZero, kZero ) ),
		PLIANT_NAMED( pliant_rigid_get_mass( t.world, t.id, &number ) ),
	};
	return calls;
}

const std::vector<Named>& objectCalls()
{
	static std::int32_t number;
	static double friction;
	static std::uint64_t data;
	static const std::vector<Named> calls = {
		PLIANT_NAMED( pliant_object_get_kind( t.world, t.id, &number ) ),
		PLIANT_NAMED( pliant_object_set_contact( t.world, t.id, 0.5, 0 ) ),
		PLIANT_NAMED( pliant_object_get_contact( t.world, t.id, &friction, nullptr ) ),
		PLIANT_NAMED( pliant_object_wake( t.world, t.id ) ),
		PLIANT_NAMED( pliant_object_get_awake( t.world, t.id, &number ) ),
		PLIANT_NAMED( pliant_object_set_user_data( t.world, t.id, 0 ) ),
		PLIANT_NAMED( pliant_object_get_user_data( t.world, t.id, &data ) ),
		PLIANT_NAMED( pliant_object_destroy( t.world, t.id ) ),
	};
	return calls;
}

TEST( CMisuse, NullWorldsAndIdentitiesOfNothing )
{
	MisuseScene scene;
	std::vector<Named> all = softCalls();
	all.insert( all.end(), rigidCalls().begin(), rigidCalls().end() );
	all.insert( all.end(), objectCalls().begin(), objectCalls().end() );
	scene.expectRefused( PLIANT_BAD_ARGUMENT, all, Target{ nullptr, scene.soft } );
	for ( const pliant_id id : { pliant_id( 0 ), scene.goneSoft, scene.goneBall, pliant_id( 1 ), ~pliant_id( 0 ), ~pliant_id( 1 ) } )
	{
		scene.expectRefused( PLIANT_NO_SUCH_OBJECT, all, Target{ scene.world, id } );
	}
	EXPECT_EQ( pliant_object_destroy( scene.world, scene.goneSoft ), PLIANT_NO_SUCH_OBJECT ) << "not twice";
}

TEST( CMisuse, ObjectsOfTheOtherKind )
{
	MisuseScene scene;
	scene.expectRefused( PLIANT_BAD_ARGUMENT, softCalls(), Target{ scene.world, scene.ball } );
	scene.expectRefused( PLIANT_BAD_ARGUMENT, rigidCalls(), Target{ scene.world, scene.soft } );
	for ( const Named& each : softCalls() )
	{
		EXPECT_EQ( each.call( Target{ scene.world, scene.soft } ), PLIANT_OK ) << each.name << ": " << pliant_last_error();
	}
	for ( const Named& each : rigidCalls() )
	{
		EXPECT_EQ( each.call( Target{ scene.world, scene.ball } ), PLIANT_OK ) << each.name << ": " << pliant_last_error();
	}
}

TEST( CMisuse, BadNumbersForASoftBody )
{
	MisuseScene scene;
	static std::int32_t number = 77;
	static std::uint64_t count = 77;
	static pliant_node node;
	static pliant_surface surface;
	static pliant_body_state state;
	scene.expectRefused( PLIANT_BAD_ARGUMENT,
		{
			PLIANT_NAMED( pliant_body_get_state( t.world, t.id, nullptr, sizeof state ) ),
			PLIANT_NAMED( pliant_body_get_state( t.world, t.id, &state, 8 ) ),
			PLIANT_NAMED( pliant_body_get_node( t.world, t.id, -1, &node, sizeof node ) ),
			PLIANT_NAMED( pliant_body_get_node( t.world, t.id, 64, &node, sizeof node ) ),
			PLIANT_NAMED( pliant_body_get_node( t.world, t.id, 0, nullptr, sizeof node ) ),
			PLIANT_NAMED( pliant_body_get_positions( t.world, t.id, nullptr, 1, &count ) ),
			PLIANT_NAMED( pliant_body_get_velocities( t.world, t.id, nullptr, 0, nullptr ) ),
			PLIANT_NAMED( pliant_body_get_nearest_node( t.world, t.id, kBadVector, &number ) ),
			PLIANT_NAMED( pliant_body_get_nearest_node( t.world, t.id, kZero, nullptr ) ),
			PLIANT_NAMED( pliant_body_get_surface( t.world, t.id, nullptr, sizeof surface ) ),
			PLIANT_NAMED( pliant_body_get_surface( t.world, t.id, &surface, sizeof surface + 1 ) ),
			PLIANT_NAMED( pliant_body_set_velocity( t.world, t.id, kBadVector, kZero ) ),
			PLIANT_NAMED( pliant_body_set_velocity( t.world, t.id, kZero, kFar ) ),
			PLIANT_NAMED( pliant_body_apply_impulse( t.world, t.id, -2, kZero ) ),
			PLIANT_NAMED( pliant_body_apply_impulse( t.world, t.id, 64, kZero ) ),
			PLIANT_NAMED( pliant_body_apply_impulse( t.world, t.id, -1, kFar ) ),
			PLIANT_NAMED( pliant_body_apply_force( t.world, t.id, 64, kZero ) ),
			PLIANT_NAMED( pliant_body_apply_force( t.world, t.id, -1, kBadVector ) ),
			PLIANT_NAMED( pliant_body_set_gravity( t.world, t.id, &kBadVector ) ),
			PLIANT_NAMED( pliant_body_teleport( t.world, t.id, &kBadPose ) ),
			PLIANT_NAMED( pliant_body_teleport( t.world, t.id, nullptr ) ),
			PLIANT_NAMED( pliant_body_reset( t.world, t.id, &kNoTurn ) ),
			PLIANT_NAMED( pliant_body_set_scale( t.world, t.id, kBad ) ),
			PLIANT_NAMED( pliant_body_set_scale( t.world, t.id, 1e4 ) ),
		},
		Target{ scene.world, scene.soft } );
	EXPECT_EQ( number, 77 ) << "out parameters stay";
	EXPECT_EQ( count, 77u );
}

TEST( CMisuse, BadChangesOfASoftBody )
{
	MisuseScene scene;
	static std::int32_t number = 77;
	static const pliant_vec3 badBlade[4] = { kZero, kUp, kBadVector, kZero };
	const std::int32_t links = scene.state( scene.soft ).links;
	scene.expectRefused( PLIANT_BAD_ARGUMENT,
		{
			PLIANT_NAMED( pliant_body_get_gas_pressure( t.world, t.id, 0, nullptr ) ),
			PLIANT_NAMED( pliant_body_set_material( t.world, t.id, nullptr ) ),
			PLIANT_NAMED( pliant_body_set_fracture( t.world, t.id, nullptr ) ),
			PLIANT_NAMED( pliant_body_get_material( t.world, t.id, nullptr, sizeof( pliant_material ) ) ),
			PLIANT_NAMED( pliant_body_get_fracture( t.world, t.id, nullptr, sizeof( pliant_fracture ) ) ),
			PLIANT_NAMED( pliant_body_get_adaptivity( t.world, t.id, nullptr, sizeof( pliant_adaptivity ) ) ),
			PLIANT_NAMED( pliant_body_request_refinement( t.world, t.id, kBadVector, kUp ) ),
			PLIANT_NAMED( pliant_body_set_finest_level( t.world, t.id, 1 ) ),
			PLIANT_NAMED( pliant_body_cut_plane( t.world, t.id, kBadVector, kUp, 1, &number ) ),
			PLIANT_NAMED( pliant_body_cut_plane( t.world, t.id, kZero, kZero, 1, &number ) ),
			PLIANT_NAMED( pliant_body_cut_plane( t.world, t.id, kUp, kUp, kBad, &number ) ),
			PLIANT_NAMED( pliant_body_cut_sphere( t.world, t.id, kUp, 0, &number ) ),
			PLIANT_NAMED( pliant_body_cut_sphere( t.world, t.id, kUp, kInfinite, &number ) ),
			PLIANT_NAMED( pliant_body_cut_sweep( t.world, t.id, badBlade, &number ) ),
			PLIANT_NAMED( pliant_body_cut_sweep( t.world, t.id, nullptr, &number ) ),
			PLIANT_NAMED( pliant_body_heal( t.world, t.id, -1, &number ) ),
			PLIANT_NAMED( pliant_body_pin( t.world, t.id, 64 ) ),
			PLIANT_NAMED( pliant_body_drive( t.world, t.id, 0, kBadVector ) ),
			PLIANT_NAMED( pliant_body_drive( t.world, t.id, 0, kFar ) ),
			PLIANT_NAMED( pliant_body_release( t.world, t.id, -1 ) ),
			PLIANT_NAMED( pliant_body_pin_inside( t.world, t.id, kBadVector, kUp, &number ) ),
			PLIANT_NAMED( pliant_body_pin_to( t.world, t.id, 0, t.id ) ),
			PLIANT_NAMED( pliant_attach_node( t.world, t.id, 0, t.id, nullptr, &number ) ),
			PLIANT_NAMED( pliant_attach_point( t.world, t.id, kUp, t.id, nullptr, &number ) ),
			PLIANT_NAMED( pliant_weld( t.world, t.id, t.id, 0.1, nullptr, &number ) ),
		},
		Target{ scene.world, scene.soft } );
	EXPECT_EQ( number, 77 ) << "out parameters stay";
	EXPECT_EQ( scene.state( scene.soft ).links, links );
}

TEST( CMisuse, BadNumbersForARigidBody )
{
	MisuseScene scene;
	const std::vector<double> before = scene.everything();
	pliant_world* const w = scene.world;
	EXPECT_EQ( pliant_rigid_get_pose( w, scene.ball, nullptr ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_rigid_set_pose( w, scene.ball, nullptr ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_rigid_set_pose( w, scene.ball, &kBadPose ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_rigid_set_pose( w, scene.ball, &kNoTurn ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_rigid_set_velocity( w, scene.ball, kBadVector, kZero ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_rigid_set_velocity( w, scene.ball, kZero, kFar ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_rigid_set_velocity( w, scene.floor, kUp, kZero ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_rigid_apply_impulse( w, scene.ball, kBadVector, kZero ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_rigid_apply_impulse( w, scene.ball, kUp, kFar ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_rigid_apply_impulse( w, scene.ball, pliant_vec3{ 0, 1e7, 0 }, kZero ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_rigid_apply_impulse( w, scene.floor, kUp, kZero ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_rigid_apply_force( w, scene.ball, kBadVector, kZero ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_rigid_apply_force( w, scene.floor, kUp, kZero ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_rigid_get_mass( w, scene.ball, nullptr ), PLIANT_BAD_ARGUMENT );
	for ( const double friction : { kBad, -1.0, kInfinite } )
	{
		EXPECT_EQ( pliant_object_set_contact( w, scene.ball, friction, 0 ), PLIANT_BAD_ARGUMENT );
		EXPECT_EQ( pliant_object_set_contact( w, scene.soft, 0.5, friction ), PLIANT_BAD_ARGUMENT );
	}
	EXPECT_EQ( pliant_object_get_kind( w, scene.ball, nullptr ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_object_get_awake( w, scene.ball, nullptr ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_object_get_user_data( w, scene.ball, nullptr ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( scene.everything(), before );
}

TEST( CMisuse, Attachments )
{
	MisuseScene scene;
	pliant_world* const w = scene.world;
	std::int32_t made = 77;
	auto settings = initial( pliant_attachment_settings_init );
	EXPECT_EQ( pliant_attach_node( w, scene.soft, 64, scene.ball, nullptr, &made ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_attach_node( w, scene.soft, 0, scene.goneBall, nullptr, &made ), PLIANT_NO_SUCH_OBJECT );
	EXPECT_EQ( pliant_attach_node( nullptr, scene.soft, 0, scene.ball, nullptr, &made ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_attach_point( w, scene.soft, kBadVector, scene.ball, nullptr, &made ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_attach_point( w, scene.ball, kUp, scene.ball, nullptr, &made ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_weld( w, scene.soft, scene.ball, 1, nullptr, &made ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_body_pin_to( w, scene.soft, 0, scene.goneBall ), PLIANT_NO_SUCH_OBJECT );
	EXPECT_EQ( pliant_body_pin_to( w, scene.soft, 64, scene.ball ), PLIANT_BAD_ARGUMENT );
	settings.compliance = kBad;
	EXPECT_EQ( pliant_attach_node( w, scene.soft, 0, scene.ball, &settings, &made ), PLIANT_BAD_SETTINGS );
	settings.size = 9;
	EXPECT_EQ( pliant_attach_node( w, scene.soft, 0, scene.ball, &settings, &made ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( made, 77 );
	EXPECT_EQ( pliant_detach( nullptr, 1 ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_detach( w, -1 ), PLIANT_NO_SUCH_OBJECT );
	EXPECT_EQ( pliant_world_get_attachment_count( w, nullptr ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_attachment_get_force( w, 1, nullptr ), PLIANT_BAD_ARGUMENT );
	pliant_vec3 force = kUp;
	EXPECT_EQ( pliant_attachment_get_force( w, 1, &force ), PLIANT_OK );
	EXPECT_EQ( force.y, 0 );
	ASSERT_EQ( pliant_world_get_attachment_count( w, &made ), PLIANT_OK );
	EXPECT_EQ( made, 0 );
}

TEST( CMisuse, CallsThatMixTheFaces )
{
	MisuseScene scene;
	{
		SCOPED_TRACE( "wrapWorld" );
		EXPECT_EQ( wrapWorld( *hostOf( scene.world ), nullptr ), PLIANT_BAD_ARGUMENT );
	}
	{
		SCOPED_TRACE( "wrapTemplate" );
		pliant_template* made = nullptr;
		EXPECT_EQ( wrapTemplate( nullptr, &made ), PLIANT_BAD_ARGUMENT );
		EXPECT_EQ( made, nullptr );
	}
	{
		SCOPED_TRACE( "hostOf" );
		EXPECT_EQ( hostOf( nullptr ), nullptr );
	}
	{
		SCOPED_TRACE( "objectOf" );
		EXPECT_EQ( objectOf( nullptr, scene.soft ), nullptr );
		EXPECT_EQ( objectOf( scene.world, scene.goneSoft ), nullptr );
		EXPECT_EQ( objectOf( scene.world, ~pliant_id( 0 ) ), nullptr );
	}
	{
		SCOPED_TRACE( "idOf" );
		const btCollisionObject alone;
		EXPECT_EQ( idOf( nullptr, &alone ), 0u );
		EXPECT_EQ( idOf( scene.world, nullptr ), 0u );
		EXPECT_EQ( idOf( scene.world, &alone ), 0u );
	}
}

} // namespace
} // namespace pliant
