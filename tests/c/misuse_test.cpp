// Every call of the C face with what it refuses: a code, a sentence, and nothing has changed.

#include "c/face.h"

#include <functional>
#include <string>

namespace pliant {
namespace {

using namespace test;

constexpr pliant_vec3 kZero = { 0, 0, 0 };
constexpr pliant_vec3 kUp = { 0, 1, 0 };
constexpr pliant_vec3 kBadVector = { 0, kBad, 0 };
constexpr pliant_vec3 kFar = { 0, 1e30, 0 };
constexpr pliant_pose kPose = { { 0, 0, 0 }, { 0, 0, 0, 1 } };
constexpr pliant_pose kBadPose = { { 0, kBad, 0 }, { 0, 0, 0, 1 } };
constexpr pliant_pose kNoTurn = { { 0, 0, 0 }, { 0, 0, 0, 0 } };
constexpr pliant_vec3 kBlade[4] = {};

struct Target
{
	pliant_world* world;
	pliant_id id;
};

using Call = std::function<pliant_result( const Target& )>;

/// A call on an object, with all else as it should be.
struct Named
{
	const char* name;
	Call call;
};

#define PLIANT_NAMED( ... )                                                                                                                \
	Named                                                                                                                                  \
	{                                                                                                                                      \
		#__VA_ARGS__, []( const Target& t ) { return __VA_ARGS__; }                                                                        \
	}

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

/// A soft body, a ball, and identities that name nothing any more.
struct MisuseScene : CScene
{
	pliant_id soft = add( pliant_vec3{ 0, 1, 0 } );
	pliant_id ball = addBall( pliant_vec3{ 0, 3, 0 }, 2 );
	pliant_id goneSoft = add( pliant_vec3{ 5, 1, 0 } ), goneBall = addBall( pliant_vec3{ 5, 3, 0 }, 2 );

	MisuseScene()
	{
		EXPECT_EQ( pliant_object_destroy( world, goneSoft ), PLIANT_OK );
		EXPECT_EQ( pliant_object_destroy( world, goneBall ), PLIANT_OK );
	}

	void expectRefused( pliant_result expected, const std::vector<Named>& calls, const Target& target )
	{
		const std::vector<double> before = everything();
		for ( const Named& each : calls )
		{
			EXPECT_EQ( each.call( target ), expected ) << each.name;
			EXPECT_GT( std::string( pliant_last_error() ).size(), 10u ) << each.name;
		}
		EXPECT_EQ( everything(), before );
	}
};

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
	const auto test = [&scene]( std::vector<Named> calls ) {
		scene.expectRefused( PLIANT_BAD_ARGUMENT, calls, Target{ scene.world, scene.soft } );
	};
	static std::int32_t number = 77;
	static std::uint64_t count = 77;
	static pliant_node node;
	static pliant_surface surface;
	static pliant_body_state state;
	static const pliant_vec3 badBlade[4] = { kZero, kUp, kBadVector, kZero };
	test( {
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
	} );
	EXPECT_EQ( number, 77 ) << "out parameters stay";
	EXPECT_EQ( count, 77u );
	EXPECT_EQ( scene.state( scene.soft ).links, scene.state( scene.soft ).links );
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

TEST( CMisuse, SettingsOfRigidBodies )
{
	MisuseScene scene;
	const auto refused = [&scene]( const std::function<void( pliant_rigid_settings& )>& spoil ) {
		auto settings = initial( pliant_rigid_settings_init );
		spoil( settings );
		pliant_id made = 0;
		EXPECT_EQ( pliant_rigid_create_sphere( scene.world, 1, &settings, &made ), PLIANT_BAD_SETTINGS );
		EXPECT_EQ( made, 0u );
	};
	const std::vector<double> before = scene.everything();
	refused( []( auto& s ) { s.kind = 3; } );
	refused( []( auto& s ) { s.mass = 0; } );
	refused( []( auto& s ) { s.mass = kBad; } );
	refused( []( auto& s ) { s.mass = 1e-300; } );
	refused( []( auto& s ) { s.pose = kBadPose; } );
	refused( []( auto& s ) { s.pose = kNoTurn; } );
	refused( []( auto& s ) { s.linear_velocity = kFar; } );
	refused( []( auto& s ) { s.angular_velocity = kBadVector; } );
	refused( []( auto& s ) { s.friction = -1; } );
	refused( []( auto& s ) { s.rolling_friction = kBad; } );
	refused( []( auto& s ) { s.restitution = 2; } );
	refused( []( auto& s ) { s.linear_damping = kBad; } );
	refused( []( auto& s ) { s.angular_damping = -1; } );
	EXPECT_EQ( scene.everything(), before );
}

TEST( CMisuse, ShapesOfRigidBodies )
{
	MisuseScene scene;
	const std::vector<double> before = scene.everything();
	pliant_world* const w = scene.world;
	pliant_id made = 0;
	auto settings = initial( pliant_rigid_settings_init );
	for ( const double bad : { 0.0, -1.0, kBad, kInfinite, 1e-300 } )
	{
		EXPECT_EQ( pliant_rigid_create_sphere( w, bad, nullptr, &made ), PLIANT_BAD_ARGUMENT );
		EXPECT_EQ( pliant_rigid_create_box( w, pliant_vec3{ 1, bad, 1 }, nullptr, &made ), PLIANT_BAD_ARGUMENT );
		EXPECT_EQ( pliant_rigid_create_capsule( w, bad, 1, nullptr, &made ), PLIANT_BAD_ARGUMENT );
		EXPECT_EQ( pliant_rigid_create_capsule( w, 1, bad, nullptr, &made ), PLIANT_BAD_ARGUMENT );
	}
	EXPECT_EQ( pliant_rigid_create_plane( w, kZero, nullptr, &made ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_rigid_create_plane( w, kBadVector, nullptr, &made ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_rigid_create_plane( w, kUp, &settings, &made ), PLIANT_BAD_SETTINGS ) << "a dynamic plane";
	const float points[] = { 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1 }, bad[] = { 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, float( kBad ) };
	const std::uint32_t triangle[] = { 0, 1, 2 }, wrong[] = { 0, 1, 4 };
	EXPECT_EQ( pliant_rigid_create_hull( w, nullptr, 4, nullptr, &made ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_rigid_create_hull( w, points, 3, nullptr, &made ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_rigid_create_hull( w, bad, 4, nullptr, &made ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_rigid_create_mesh( w, nullptr, 4, triangle, 1, nullptr, &made ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_rigid_create_mesh( w, points, 4, nullptr, 1, nullptr, &made ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_rigid_create_mesh( w, points, 4, triangle, 0, nullptr, &made ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_rigid_create_mesh( w, points, 0, triangle, 1, nullptr, &made ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_rigid_create_mesh( w, points, ~0ull, triangle, 1, nullptr, &made ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_rigid_create_mesh( w, bad, 4, triangle, 1, nullptr, &made ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_rigid_create_mesh( w, points, 4, wrong, 1, nullptr, &made ), PLIANT_INDEX_OUT_OF_RANGE );
	EXPECT_EQ( pliant_rigid_create_mesh( w, points, 4, triangle, 1, &settings, &made ), PLIANT_BAD_SETTINGS ) << "a dynamic mesh";
	EXPECT_EQ( pliant_rigid_create_sphere( nullptr, 1, nullptr, &made ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_rigid_create_sphere( w, 1, nullptr, nullptr ), PLIANT_BAD_ARGUMENT );
	settings.size = 1;
	EXPECT_EQ( pliant_rigid_create_sphere( w, 1, &settings, &made ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( made, 0u );
	EXPECT_EQ( scene.everything(), before );
}

TEST( CMisuse, Worlds )
{
	MisuseScene scene;
	const std::vector<double> before = scene.everything();
	pliant_world* const w = scene.world;
	pliant_world* made = nullptr;
	const auto refused = [&made]( const std::function<void( pliant_world_settings& )>& spoil ) {
		auto settings = initial( pliant_world_settings_init );
		spoil( settings );
		EXPECT_EQ( pliant_world_create( &settings, &made ), PLIANT_BAD_SETTINGS );
		EXPECT_EQ( made, nullptr );
	};
	refused( []( auto& s ) { s.threads = 0; } );
	refused( []( auto& s ) { s.threads = 65; } );
	refused( []( auto& s ) { s.gravity = kBadVector; } );
	refused( []( auto& s ) { s.soft_substeps = 0; } );
	refused( []( auto& s ) { s.max_soft_substeps = 65; } );
	EXPECT_EQ( pliant_world_create( nullptr, nullptr ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_world_wrap( nullptr, &made ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_world_wrap( w, nullptr ), PLIANT_BAD_ARGUMENT );
	for ( const double bad : { kBad, -1.0, kInfinite, 1e300 } )
	{
		EXPECT_EQ( pliant_world_step( w, bad, 1, kFrame, nullptr ), PLIANT_BAD_ARGUMENT );
		EXPECT_EQ( pliant_world_step( w, kFrame, 1, bad, nullptr ), PLIANT_BAD_ARGUMENT );
	}
	EXPECT_EQ( pliant_world_step( w, kFrame, 1, 0, nullptr ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_world_step( w, kFrame, -1, kFrame, nullptr ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_world_step( nullptr, kFrame, 1, kFrame, nullptr ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_world_set_gravity( w, kBadVector ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_world_set_gravity( w, kFar ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_world_get_gravity( w, nullptr ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_world_set_threads( w, 0 ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_world_set_soft_substeps( w, 0, 4 ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_world_set_soft_substeps( w, 4, 100 ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_world_set_debris_budget( w, nullptr ), PLIANT_BAD_ARGUMENT );
	auto budget = initial( pliant_debris_budget_init );
	budget.max_pieces = -1;
	EXPECT_EQ( pliant_world_set_debris_budget( w, &budget ), PLIANT_BAD_SETTINGS );
	EXPECT_EQ( pliant_world_set_interpolation( w, kBad ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_world_set_interpolation( w, 1.5 ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_world_shift_origin( w, kBadVector ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_world_shift_origin( w, kFar ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_world_explode( w, kZero, -1, 1, nullptr ), PLIANT_BAD_SETTINGS );
	EXPECT_EQ( pliant_world_explode( w, kBadVector, 1, 1, nullptr ), PLIANT_BAD_SETTINGS );
	std::uint64_t count = 77;
	EXPECT_EQ( pliant_world_get_bodies( w, nullptr, 1, &count ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_world_get_rigids( w, nullptr, 0, nullptr ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( count, 77u );
	pliant_step_report report;
	EXPECT_EQ( pliant_world_get_report( w, nullptr, sizeof report ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_world_get_report( w, &report, 12 ), PLIANT_BAD_ARGUMENT );
	pliant_world_destroy( nullptr );
	EXPECT_EQ( scene.everything(), before );
}

TEST( CMisuse, EventsRaysAndSnapshots )
{
	MisuseScene scene;
	pliant_world* const w = scene.world;
	std::uint64_t count = 0;
	pliant_fracture_event fracture;
	pliant_contact_event contact;
	pliant_attachment_event attachment;
	pliant_ray_hit hit;
	EXPECT_EQ( pliant_world_get_fracture_count( w, nullptr ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_world_get_contact_count( w, nullptr ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_world_get_broken_attachment_count( w, nullptr ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_world_get_fracture( w, 0, &fracture, sizeof fracture ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_world_get_fragments( w, 0, nullptr, 0, &count ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_world_get_contact( w, ~0ull, &contact, sizeof contact ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_world_get_broken_attachment( w, 0, &attachment, sizeof attachment ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_world_cast_ray( w, kBadVector, kZero, -1, -1, &hit, sizeof hit ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_world_cast_ray( w, kUp, kFar, -1, -1, &hit, sizeof hit ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_world_cast_ray( w, kUp, kZero, -1, -1, nullptr, sizeof hit ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_world_cast_ray( w, kUp, kZero, -1, -1, &hit, 7 ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_world_cast_ray( nullptr, kUp, kZero, -1, -1, &hit, sizeof hit ), PLIANT_BAD_ARGUMENT );

	pliant_buffer* bytes = nullptr;
	EXPECT_EQ( pliant_buffer_create( nullptr ), PLIANT_BAD_ARGUMENT );
	ASSERT_EQ( pliant_buffer_create( &bytes ), PLIANT_OK );
	EXPECT_EQ( pliant_buffer_data( bytes ), nullptr );
	EXPECT_EQ( pliant_buffer_data( nullptr ), nullptr );
	EXPECT_EQ( pliant_buffer_size( nullptr ), 0u );
	EXPECT_EQ( pliant_world_save( w, 8, bytes ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_world_save( w, 0, nullptr ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_world_save( nullptr, 0, bytes ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_buffer_size( bytes ), 0u );
	const char text[] = "no snapshot at all";
	const pliant_template* none = nullptr;
	EXPECT_EQ( pliant_world_restore( w, nullptr, 5, nullptr, 0 ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_world_restore( w, text, sizeof text, nullptr, 1 ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_world_restore( w, text, sizeof text, &none, 1 ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_world_restore( w, text, sizeof text, nullptr, 0 ), PLIANT_BAD_SNAPSHOT );
	pliant_template* loaded = nullptr;
	EXPECT_EQ( pliant_template_load( text, sizeof text, &loaded ), PLIANT_BAD_SNAPSHOT );
	EXPECT_EQ( pliant_template_load( nullptr, 4, &loaded ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_template_load( text, sizeof text, nullptr ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_template_save( nullptr, bytes ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_template_save( scene.cube, nullptr ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( loaded, nullptr );
	pliant_buffer_destroy( bytes );
	pliant_buffer_destroy( nullptr );
}

TEST( CMisuse, TemplatesAndBodies )
{
	MisuseScene scene;
	CubeMesh mesh;
	pliant_template* made = nullptr;
	EXPECT_EQ( pliant_template_build( nullptr, nullptr, &made ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_template_build( &mesh.view, nullptr, nullptr ), PLIANT_BAD_ARGUMENT );
	mesh.view.position_stride = 2;
	EXPECT_EQ( pliant_template_build( &mesh.view, nullptr, &made ), PLIANT_BAD_ARGUMENT );
	mesh.view.position_stride = 3;
	mesh.indices[5] = 8;
	EXPECT_EQ( pliant_template_build( &mesh.view, nullptr, &made ), PLIANT_INDEX_OUT_OF_RANGE );
	mesh.indices[5] = 3;
	auto lattice = initial( pliant_lattice_settings_init );
	lattice.threads = 0;
	EXPECT_EQ( pliant_template_build( &mesh.view, &lattice, &made ), PLIANT_BAD_SETTINGS );
	lattice.threads = 1;
	lattice.skinning = 3;
	EXPECT_EQ( pliant_template_build( &mesh.view, &lattice, &made ), PLIANT_BAD_SETTINGS );
	lattice.skinning = 0;
	lattice.cell_size = float( kBad );
	EXPECT_EQ( pliant_template_build( &mesh.view, &lattice, &made ), PLIANT_BAD_SETTINGS );
	mesh.view.size = 0;
	EXPECT_EQ( pliant_template_build( &mesh.view, nullptr, &made ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_template_scaled( scene.cube, 0, &made ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_template_scaled( nullptr, 1, &made ), PLIANT_BAD_ARGUMENT );
	pliant_template_info info;
	EXPECT_EQ( pliant_template_get_info( nullptr, &info, sizeof info ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_template_get_info( scene.cube, nullptr, sizeof info ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( made, nullptr );
	pliant_template_release( nullptr );

	const std::vector<double> before = scene.everything();
	pliant_id body = 0;
	auto settings = initial( pliant_body_settings_init );
	const auto refused = [&]( pliant_result expected ) {
		EXPECT_EQ( pliant_body_create( scene.world, scene.cube, &settings, &body ), expected );
		settings = initial( pliant_body_settings_init );
	};
	EXPECT_EQ( pliant_body_create( nullptr, scene.cube, nullptr, &body ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_body_create( scene.world, nullptr, nullptr, &body ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_body_create( scene.world, scene.cube, nullptr, nullptr ), PLIANT_BAD_ARGUMENT );
	settings.pose = kBadPose;
	refused( PLIANT_BAD_ARGUMENT );
	settings.friction = kBad;
	refused( PLIANT_BAD_SETTINGS );
	settings.restitution = 2;
	refused( PLIANT_BAD_SETTINGS );
	settings.stiffness = []( const float*, void* ) { return 2.0f; };
	refused( PLIANT_BAD_ARGUMENT );
	auto material = initial( pliant_material_init );
	material.density = 0;
	settings.material = &material;
	refused( PLIANT_BAD_MATERIAL );
	auto fracture = initial( pliant_fracture_init );
	fracture.rule = PLIANT_BREAK_DISTANCE;
	settings.fracture = &fracture;
	settings.toughness = []( const float*, const float*, void* ) { return -1.0f; };
	refused( PLIANT_BAD_ARGUMENT );
	fracture.break_strain = -1;
	settings.fracture = &fracture;
	refused( PLIANT_BAD_SETTINGS );
	auto adaptivity = initial( pliant_adaptivity_init );
	adaptivity.coarse_levels = 9;
	settings.adaptivity = &adaptivity;
	refused( PLIANT_BAD_SETTINGS );
	EXPECT_EQ( body, 0u );
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

TEST( CMisuse, NamesAndVersion )
{
	EXPECT_STREQ( pliant_result_name( PLIANT_TOO_MANY_CELLS ), "TooManyCells" );
	EXPECT_STREQ( pliant_result_name( PLIANT_NO_SUCH_OBJECT ), "NoSuchObject" );
	EXPECT_STREQ( pliant_result_name( -5 ), "unknown" );
	EXPECT_EQ( pliant_has_feature( -1 ), 0 );
	EXPECT_EQ( pliant_has_feature( 8 ), 0 );
	EXPECT_EQ( pliant_has_feature( PLIANT_FEATURE_FRACTURE ), 1 );
	EXPECT_GT( pliant_version(), 0u );
	EXPECT_TRUE( pliant_bullet_scalar_size() == 4 || pliant_bullet_scalar_size() == 8 );
}

} // namespace
} // namespace pliant
