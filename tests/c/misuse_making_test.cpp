// Creation of worlds, templates and bodies, events and snapshots, and refusals: a code, a sentence, and nothing has changed.

#include "c/misuse.h"

#include "pliant/c/mix.h"
#include "pliant/soft_body_host.h"

#include <thread>

namespace pliant {
namespace {

using namespace test;

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

TEST( CMisuse, WindAndWater )
{
	MisuseScene scene;
	EXPECT_EQ( pliant_wind_init( nullptr, sizeof( pliant_wind ) ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_water_init( nullptr, sizeof( pliant_water ) ), PLIANT_BAD_ARGUMENT );
	auto wind = initial( pliant_wind_init );
	auto water = initial( pliant_water_init );
	EXPECT_EQ( pliant_world_set_wind( nullptr, &wind ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_world_set_water( nullptr, &water ), PLIANT_BAD_ARGUMENT );
	wind.velocity = kBadVector;
	water.up = kZero;
	EXPECT_EQ( pliant_world_set_wind( scene.world, &wind ), PLIANT_BAD_SETTINGS );
	EXPECT_EQ( pliant_world_set_water( scene.world, &water ), PLIANT_BAD_SETTINGS );
	wind.size = water.size = 5;
	EXPECT_EQ( pliant_world_set_wind( scene.world, &wind ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_world_set_water( scene.world, &water ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( hostOf( scene.world )->forceFieldCount(), 0 );
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

TEST( CMisuse, Templates )
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
}

TEST( CMisuse, SettingsOfSoftBodies )
{
	MisuseScene scene;
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

TEST( CMisuse, EachThreadHasASentenceOfItsOwn )
{
	EXPECT_EQ( pliant_world_set_threads( nullptr, 0 ), PLIANT_BAD_ARGUMENT );
	const std::string mine = pliant_last_error();
	std::string before, other;
	std::thread( [&] {
		before = pliant_last_error();
		EXPECT_EQ( pliant_template_load( "none", 4, nullptr ), PLIANT_BAD_ARGUMENT );
		pliant_template* loaded = nullptr;
		EXPECT_EQ( pliant_template_load( "none", 4, &loaded ), PLIANT_BAD_SNAPSHOT );
		other = pliant_last_error();
	} ).join();
	EXPECT_EQ( before, "" );
	EXPECT_NE( other, mine );
	EXPECT_EQ( pliant_last_error(), mine );
}

// A callback in C++ may throw, although it should not: the exception must not leave the call.
TEST( CMisuse, NothingIsThrownAcross )
{
	MisuseScene scene;
	auto settings = initial( pliant_body_settings_init );
	settings.stiffness = []( const float*, void* ) -> float { throw std::string( "thrown" ); };
	pliant_id made = 0;
	EXPECT_EQ( pliant_body_create( scene.world, scene.cube, &settings, &made ), PLIANT_BAD_ARGUMENT );
	settings.stiffness = []( const float*, void* ) -> float { throw std::bad_alloc(); };
	EXPECT_EQ( pliant_body_create( scene.world, scene.cube, &settings, &made ), PLIANT_OUT_OF_MEMORY );
	EXPECT_EQ( made, 0u );
	EXPECT_EQ( scene.bodies().size(), 1u );
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
