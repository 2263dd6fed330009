// The calls of a game through the C face from the creation of bodies to their end, and the identities of the objects.

#include "c/face.h"

#include "pliant/c/mix.h"
#include "pliant/soft_body_host.h"

#include <algorithm>

namespace pliant {
namespace {

using namespace test;

struct Buffer
{
	pliant_buffer* bytes = nullptr;
	Buffer() { EXPECT_EQ( pliant_buffer_create( &bytes ), PLIANT_OK ); }
	~Buffer() { pliant_buffer_destroy( bytes ); }
	std::vector<unsigned char> copy() const
	{
		const auto* const first = static_cast<const unsigned char*>( pliant_buffer_data( bytes ) );
		return std::vector<unsigned char>( first, first + pliant_buffer_size( bytes ) );
	}
};

double heightOf( const CScene& scene, pliant_id body )
{
	return scene.state( body ).mass_centre.y;
}

TEST( CFace, ABodyFallsRestsAndIsPushed )
{
	CScene scene;
	const pliant_id body = scene.add( pliant_vec3{ 0, 1, 0 } );
	EXPECT_NEAR( scene.state( body ).mass, 1000, 1 );
	EXPECT_EQ( scene.state( body ).cells, 64 );
	scene.step( 120 );
	EXPECT_NEAR( heightOf( scene, body ), 0.4, 0.1 ); // it sags under its weight
	ASSERT_EQ( pliant_body_apply_impulse( scene.world, body, -1, pliant_vec3{ 0, 5000, 0 } ), PLIANT_OK );
	EXPECT_NEAR( scene.state( body ).linear_velocity.y, 5, 0.5 );
	scene.step( 10 );
	EXPECT_GT( heightOf( scene, body ), 0.8 );
	const pliant_vec3 up = { 0, 100, 0 };
	ASSERT_EQ( pliant_body_set_gravity( scene.world, body, &up ), PLIANT_OK );
	const double velocity = scene.state( body ).linear_velocity.y;
	scene.step( 6 );
	EXPECT_NEAR( scene.state( body ).linear_velocity.y, velocity + 10, 0.5 );
	ASSERT_EQ( pliant_body_set_gravity( scene.world, body, nullptr ), PLIANT_OK );
	pliant_pose away = { { 5, 2, 0 }, { 0, 0, 0, 2 } }; // a quaternion of any length
	ASSERT_EQ( pliant_body_reset( scene.world, body, &away ), PLIANT_OK );
	EXPECT_NEAR( scene.state( body ).mass_centre.x, 5, 1e-5 );
	EXPECT_NEAR( heightOf( scene, body ), 2, 1e-5 );
	ASSERT_EQ( pliant_body_teleport( scene.world, body, &away ), PLIANT_OK );
	EXPECT_NEAR( scene.state( body ).mass_centre.x, 10, 1e-5 );
	ASSERT_EQ( pliant_body_set_scale( scene.world, body, 2 ), PLIANT_OK ) << pliant_last_error();
	EXPECT_NEAR( scene.state( body ).mass, 8000, 10 );
	ASSERT_EQ( pliant_body_set_velocity( scene.world, body, pliant_vec3{ 1, 0, 0 }, pliant_vec3{ 0, 2, 0 } ), PLIANT_OK );
	EXPECT_NEAR( scene.state( body ).linear_velocity.x, 1, 1e-4 );
	EXPECT_NEAR( scene.state( body ).angular_velocity.y, 2, 1e-3 );
}

TEST( CFace, PinsAndAttachmentsHold )
{
	CScene scene;
	const pliant_id pinned = scene.add( pliant_vec3{ 0, 3, 0 } ), hung = scene.add( pliant_vec3{ 3, 3, 0 } );
	const pliant_id carrier = scene.addBall( pliant_vec3{ 3, 3.75, 0 }, 5000 );
	std::int32_t count = 0, attachment = -1, node = -1;
	ASSERT_EQ( pliant_body_pin_inside( scene.world, pinned, pliant_vec3{ -1, 3.3, -1 }, pliant_vec3{ 1, 4, 1 }, &count ), PLIANT_OK );
	EXPECT_EQ( count, 16 );
	ASSERT_EQ( pliant_attach_point( scene.world, hung, pliant_vec3{ 3, 3.5, 0 }, carrier, nullptr, &attachment ), PLIANT_OK )
		<< pliant_last_error();
	ASSERT_EQ( pliant_body_pin_to( scene.world, pinned, 0, scene.floor ), PLIANT_OK );
	ASSERT_EQ( pliant_body_get_nearest_node( scene.world, hung, pliant_vec3{ 3, 2, 0 }, &node ), PLIANT_OK );
	pliant_node low{};
	ASSERT_EQ( pliant_body_get_node( scene.world, hung, node, &low, sizeof low ), PLIANT_OK );
	EXPECT_LT( low.position.y, 3 );
	EXPECT_EQ( low.is_pinned, 0 );
	scene.step( 30 );
	EXPECT_GT( heightOf( scene, pinned ), 2.7 );
	EXPECT_NEAR( heightOf( scene, hung ), 1.8, 0.3 ) << "both fall together";
	ASSERT_EQ( pliant_world_get_attachment_count( scene.world, &count ), PLIANT_OK );
	EXPECT_EQ( count, 1 );
	ASSERT_EQ( pliant_detach( scene.world, attachment ), PLIANT_OK );
	EXPECT_EQ( pliant_detach( scene.world, attachment ), PLIANT_NO_SUCH_OBJECT );
	ASSERT_EQ( pliant_body_drive( scene.world, pinned, 1, pliant_vec3{ 0, 3, 0 } ), PLIANT_OK );
	for ( int k = 0; k < scene.state( pinned ).nodes; ++k )
	{
		ASSERT_EQ( pliant_body_release( scene.world, pinned, k ), PLIANT_OK );
	}
	scene.step( 60 );
	EXPECT_LT( heightOf( scene, pinned ), 1.5 );
}

TEST( CFace, AnAttachmentThatBreaksIsToldOf )
{
	CScene scene;
	const pliant_id body = scene.add( pliant_vec3{ 0, 3, 0 } ), other = scene.add( pliant_vec3{ 0, 4, 0 } );
	auto weak = initial( pliant_attachment_settings_init );
	weak.breaking_force = 200;
	std::int32_t made = -1, welds = 0;
	ASSERT_EQ( pliant_attach_node( scene.world, body, 0, scene.floor, &weak, &made ), PLIANT_OK ) << pliant_last_error();
	ASSERT_EQ( pliant_weld( scene.world, body, other, 0.3, nullptr, &welds ), PLIANT_OK ) << pliant_last_error();
	EXPECT_EQ( welds, 16 );
	std::uint64_t count = 0;
	for ( int k = 0; k < 60 && count == 0; ++k )
	{
		scene.step();
		ASSERT_EQ( pliant_world_get_broken_attachment_count( scene.world, &count ), PLIANT_OK );
	}
	ASSERT_EQ( count, 1u );
	pliant_attachment_event event{};
	ASSERT_EQ( pliant_world_get_broken_attachment( scene.world, 0, &event, sizeof event ), PLIANT_OK );
	EXPECT_EQ( event.attachment, made );
	EXPECT_EQ( event.body, body );
	EXPECT_EQ( event.other, scene.floor );
	EXPECT_GT( std::fabs( event.force.y ), 200 );
	ASSERT_EQ( pliant_object_destroy( scene.world, body ), PLIANT_OK );
	ASSERT_EQ( pliant_object_destroy( scene.world, scene.floor ), PLIANT_OK );
	ASSERT_EQ( pliant_world_get_broken_attachment_count( scene.world, &count ), PLIANT_OK );
	EXPECT_EQ( count, 0u ) << "events go with their bodies";
	EXPECT_EQ( pliant_world_get_broken_attachment( scene.world, 0, &event, sizeof event ), PLIANT_BAD_ARGUMENT );
}

TEST( CFace, ContactsAreToldOf )
{
	CScene scene;
	const pliant_id body = scene.add( pliant_vec3{ 0, 0.6, 0 } );
	ASSERT_EQ( pliant_body_set_contact_events( scene.world, body, 1 ), PLIANT_OK );
	double pushed = 0;
	int began = 0;
	for ( int k = 0; k < 60; ++k )
	{
		scene.step();
		std::uint64_t count = 0;
		ASSERT_EQ( pliant_world_get_contact_count( scene.world, &count ), PLIANT_OK );
		for ( std::uint64_t index = 0; index < count; ++index )
		{
			pliant_contact_event event{};
			ASSERT_EQ( pliant_world_get_contact( scene.world, index, &event, sizeof event ), PLIANT_OK );
			EXPECT_EQ( event.body, body );
			EXPECT_EQ( event.other, scene.floor );
			pushed += event.push.y;
			began += event.began;
		}
	}
	EXPECT_GE( began, 1 );
	EXPECT_NEAR( pushed, 1000 * 9.81 + scene.state( body ).mass * scene.state( body ).linear_velocity.y, 300 )
		<< "what gravity gave in a second";
}

TEST( CFace, ACutBodyFallsApartAndHeals )
{
	CScene scene;
	const pliant_id body = scene.add( pliant_vec3{ 0, 0.5, 0 } );
	ASSERT_EQ( pliant_body_prepare_cracks( scene.world, body ), PLIANT_OK );
	std::int32_t links = 0, healed = 0;
	ASSERT_EQ( pliant_body_cut_plane( scene.world, body, pliant_vec3{ 0.5, 0.6, 0 }, pliant_vec3{ 0, 0, 1 }, 0.4, &links ), PLIANT_OK );
	EXPECT_GT( links, 0 );
	scene.step();
	ASSERT_EQ( pliant_body_heal( scene.world, body, 1.2, &healed ), PLIANT_OK );
	EXPECT_EQ( healed, links );
	scene.step(); // so that a link exists that can be cut again after the restore
	const pliant_vec3 blade[4] = { { -1, 2, 0 }, { 1, 2, 0 }, { -1, -1, 0 }, { 1, -1, 0 } };
	ASSERT_EQ( pliant_body_cut_sweep( scene.world, body, blade, &links ), PLIANT_OK );
	EXPECT_GT( links, 16 );
	scene.step();
	ASSERT_EQ( scene.bodies().size(), 2u );
	pliant_fracture_event event{};
	ASSERT_EQ( pliant_world_get_fracture( scene.world, 0, &event, sizeof event ), PLIANT_OK );
	pliant_id piece = 0;
	std::uint64_t count = 0;
	ASSERT_EQ( pliant_world_get_fragments( scene.world, 0, &piece, 1, &count ), PLIANT_OK );
	EXPECT_EQ( event.body, body );
	EXPECT_EQ( piece, scene.bodies()[1] );
	EXPECT_NEAR( std::fabs( event.normal.z ), 1, 1e-3 );
	EXPECT_NEAR( event.area, 1, 0.01 );
	ASSERT_EQ( pliant_body_cut_plane( scene.world, piece, scene.state( piece ).mass_centre, pliant_vec3{ 1, 0, 0 }, kInfinite, &links ),
		PLIANT_OK );
	EXPECT_GT( links, 0 );
	ASSERT_EQ( pliant_body_cut_sphere( scene.world, piece, scene.state( piece ).mass_centre, 0.3, &links ), PLIANT_OK );
	EXPECT_GT( links, 0 );
	// A fragment can be removed as any other object, and the event reports it.
	ASSERT_EQ( pliant_object_destroy( scene.world, piece ), PLIANT_OK );
	ASSERT_EQ( pliant_world_get_fragments( scene.world, 0, &piece, 1, &count ), PLIANT_OK );
	EXPECT_EQ( piece, 0u );
	EXPECT_EQ( count, 1u );
	ASSERT_EQ( pliant_object_destroy( scene.world, body ), PLIANT_OK );
	EXPECT_EQ( scene.add( pliant_vec3{ 0, 1, 0 } ), 3 * 2u ) << "identities go on";
	ASSERT_EQ( pliant_world_get_fracture( scene.world, 0, &event, sizeof event ), PLIANT_OK );
	EXPECT_EQ( event.body, 0u );
}

TEST( CFace, PiecesThatFadeEndByThemselves )
{
	CScene scene;
	auto fracture = initial( pliant_fracture_init );
	fracture.small_pieces = PLIANT_PIECES_FADE;
	fracture.small_cells = 1000;
	fracture.fade_time = 0.1f;
	const pliant_id body = scene.add( pliant_vec3{ 0, 0.5, 0 }, &fracture );
	ASSERT_EQ( pliant_object_set_user_data( scene.world, body, 42 ), PLIANT_OK );
	ASSERT_EQ(
		pliant_body_cut_plane( scene.world, body, pliant_vec3{ 0.1, 0, 0 }, pliant_vec3{ 1, 0, 0 }, kInfinite, nullptr ), PLIANT_OK );
	scene.step();
	const std::vector<pliant_id> pieces = scene.bodies();
	ASSERT_EQ( pieces.size(), 2u );
	std::uint64_t data = 0;
	ASSERT_EQ( pliant_object_get_user_data( scene.world, pieces[1], &data ), PLIANT_OK );
	EXPECT_EQ( data, 42u );
	scene.step( 3 );
	EXPECT_LT( scene.state( pieces[1] ).fade_fraction, 1 );
	scene.step( 12 );
	EXPECT_EQ( pliant_object_wake( scene.world, pieces[1] ), PLIANT_NO_SUCH_OBJECT );
	pliant_step_report report{};
	ASSERT_EQ( pliant_world_get_report( scene.world, &report, sizeof report ), PLIANT_OK );
	EXPECT_EQ( report.soft_bodies, int( scene.bodies().size() ) );
	EXPECT_EQ( scene.bodies().front(), body ) << "the part that remains of the body itself stays";
}

TEST( CFace, ARestoredWorldHasItsIdentitiesAndGoesOnToTheSameBits )
{
	CScene scene;
	auto fracture = initial( pliant_fracture_init );
	fracture.rule = PLIANT_BREAK_PLANE;
	fracture.break_strain = 0.02f;
	const pliant_id body = scene.add( pliant_vec3{ 0, 0.5, 0 }, &fracture ), other = scene.add( pliant_vec3{ 3, 0.5, 0 } );
	scene.addBall( pliant_vec3{ 0, 1.5, 0 }, 500, pliant_vec3{ 0, -15, 0 } );
	Buffer before, after;
	ASSERT_EQ( pliant_world_save( scene.world, PLIANT_SAVE_STATE_ONLY, before.bytes ), PLIANT_OK );
	scene.step( 40 );
	const std::vector<pliant_id> broken = scene.bodies();
	ASSERT_GT( broken.size(), 2u );
	const std::vector<double> everything = scene.everything();
	ASSERT_EQ( pliant_world_save( scene.world, PLIANT_SAVE_ALL, after.bytes ), PLIANT_OK );

	// A destroyed body of the game's is restored with its identity, and does not count as debris.
	ASSERT_EQ( pliant_object_destroy( scene.world, other ), PLIANT_OK );
	scene.add( pliant_vec3{ 6, 0.5, 0 } );
	auto bytes = before.copy();
	ASSERT_EQ( pliant_world_restore( scene.world, bytes.data(), bytes.size(), &scene.cube, 1 ), PLIANT_OK ) << pliant_last_error();
	EXPECT_EQ( scene.bodies(), ( std::vector<pliant_id>{ body, other } ) );
	EXPECT_EQ( hostOf( scene.world )->fragmentCount(), 0 );
	scene.step( 40 );
	EXPECT_EQ( scene.bodies(), broken );
	EXPECT_EQ( scene.everything(), everything );

	// Into a world of the same rigid bodies, with the templates of the snapshot.
	CScene fresh;
	fresh.addBall( pliant_vec3{}, 500 );
	bytes = after.copy();
	ASSERT_EQ( pliant_world_restore( fresh.world, bytes.data(), bytes.size(), nullptr, 0 ), PLIANT_OK ) << pliant_last_error();
	EXPECT_EQ( fresh.everything(), everything );
	EXPECT_EQ( fresh.bodies(), broken );
	scene.step( 20 );
	fresh.step( 20 );
	EXPECT_EQ( fresh.everything(), scene.everything() );
	EXPECT_EQ( pliant_object_destroy( fresh.world, body ), PLIANT_OK );

	// Damaged: nothing changes.
	const std::vector<double> now = scene.everything();
	bytes[bytes.size() / 2] ^= 1;
	EXPECT_EQ( pliant_world_restore( scene.world, bytes.data(), bytes.size(), nullptr, 0 ), PLIANT_BAD_SNAPSHOT );
	EXPECT_EQ( pliant_world_restore( scene.world, bytes.data(), 3, nullptr, 0 ), PLIANT_BAD_SNAPSHOT );
	EXPECT_EQ( scene.everything(), now );
}

TEST( CFace, RigidBodiesOfAllShapesRestAndMove )
{
	CScene scene;
	const float hull[] = { -1, -1, -1, 1, -1, -1, 0, -1, 1, 0, 1, 0 }, ground[] = { -9, 5, -9, 9, 5, -9, 9, 5, 9, -9, 5, 9 };
	const std::uint32_t triangles[] = { 0, 2, 1, 0, 3, 2 };
	auto settings = initial( pliant_rigid_settings_init );
	pliant_id mesh = 0, capsule = 0, pyramid = 0, lift = 0;
	ASSERT_EQ( pliant_rigid_create_mesh( scene.world, ground, 4, triangles, 2, nullptr, &mesh ), PLIANT_OK ) << pliant_last_error();
	settings.pose.position = pliant_vec3{ 0, 6, 0 };
	settings.pose.rotation[2] = 1; // lies along x
	ASSERT_EQ( pliant_rigid_create_capsule( scene.world, 0.3, 1, &settings, &capsule ), PLIANT_OK ) << pliant_last_error();
	settings.pose.position = pliant_vec3{ 4, 7, 0 };
	settings.pose.rotation[2] = 0;
	ASSERT_EQ( pliant_rigid_create_hull( scene.world, hull, 4, &settings, &pyramid ), PLIANT_OK ) << pliant_last_error();
	settings.kind = PLIANT_RIGID_KINEMATIC;
	settings.pose.position = pliant_vec3{ 0, 0, 0 };
	ASSERT_EQ( pliant_rigid_create_box( scene.world, pliant_vec3{ 1, 0.1, 1 }, &settings, &lift ), PLIANT_OK );
	const pliant_id soft = scene.add( pliant_vec3{ 0, 0.7, 0 } );
	for ( int k = 0; k < 90; ++k )
	{
		settings.pose.position.y += kFrame;
		ASSERT_EQ( pliant_rigid_set_pose( scene.world, lift, &settings.pose ), PLIANT_OK );
		scene.step();
	}
	pliant_pose pose{};
	pliant_vec3 linear{}, angular{};
	double mass = 0;
	ASSERT_EQ( pliant_rigid_get_pose( scene.world, capsule, &pose ), PLIANT_OK );
	EXPECT_NEAR( pose.position.y, 5.3, 0.06 );
	ASSERT_EQ( pliant_rigid_get_pose( scene.world, pyramid, &pose ), PLIANT_OK );
	EXPECT_NEAR( pose.position.y, 6.04, 0.1 );
	ASSERT_EQ( pliant_rigid_get_velocity( scene.world, lift, &linear, &angular ), PLIANT_OK );
	EXPECT_NEAR( linear.y, 1, 1e-3 );
	EXPECT_NEAR( heightOf( scene, soft ), 1.5 + 0.6, 0.1 ) << "the lift carries it";
	ASSERT_EQ( pliant_rigid_get_mass( scene.world, capsule, &mass ), PLIANT_OK );
	EXPECT_NEAR( mass, 1, 1e-6 );
	ASSERT_EQ( pliant_rigid_apply_impulse( scene.world, capsule, pliant_vec3{ 3, 0, 0 }, pliant_vec3{ 0, 5.3, 0 } ), PLIANT_OK );
	ASSERT_EQ( pliant_rigid_get_velocity( scene.world, capsule, &linear, nullptr ), PLIANT_OK );
	EXPECT_NEAR( linear.x, 3, 0.1 );
	ASSERT_EQ( pliant_rigid_set_velocity( scene.world, capsule, pliant_vec3{}, pliant_vec3{} ), PLIANT_OK );
	ASSERT_EQ( pliant_rigid_apply_force( scene.world, capsule, pliant_vec3{ 0, 69.81, 0 }, pliant_vec3{ 0, 5.3, 0 } ), PLIANT_OK );
	scene.step();
	ASSERT_EQ( pliant_rigid_get_velocity( scene.world, capsule, &linear, nullptr ), PLIANT_OK );
	EXPECT_NEAR( linear.y, 1, 0.05 );
	settings.pose.position = pliant_vec3{ -4, 9, 0 };
	ASSERT_EQ( pliant_rigid_set_pose( scene.world, pyramid, &settings.pose ), PLIANT_OK );
	ASSERT_EQ( pliant_rigid_get_pose( scene.world, pyramid, &pose ), PLIANT_OK );
	EXPECT_EQ( pose.position.x, -4 );
}

TEST( CFace, WindBlowsWaterCarriesGasHolds )
{
	CScene scene;
	auto light = initial( pliant_material_init );
	light.density = 250;
	auto settings = initial( pliant_body_settings_init );
	settings.material = &light;
	settings.pose.position = pliant_vec3{ 0, 4, 0 };
	pliant_id body = 0;
	ASSERT_EQ( pliant_body_create( scene.world, scene.cube, &settings, &body ), PLIANT_OK );
	auto water = initial( pliant_water_init );
	water.surface.y = 4;
	ASSERT_EQ( pliant_world_set_water( scene.world, &water ), PLIANT_OK ) << pliant_last_error();
	scene.step( 240 );
	EXPECT_NEAR( heightOf( scene, body ), 4.25, 0.1 ) << "a quarter of it is under water";
	auto wind = initial( pliant_wind_init );
	wind.velocity.x = 30;
	ASSERT_EQ( pliant_world_set_wind( scene.world, &wind ), PLIANT_OK ) << pliant_last_error();
	scene.step( 30 );
	const double velocity = scene.state( body ).linear_velocity.x;
	EXPECT_GT( velocity, 0.3 );
	wind.velocity.x = -30; // changed in place
	ASSERT_EQ( pliant_world_set_wind( scene.world, &wind ), PLIANT_OK );
	scene.step( 30 );
	EXPECT_LT( scene.state( body ).linear_velocity.x, velocity );
	EXPECT_EQ( hostOf( scene.world )->forceFieldCount(), 2 );
	ASSERT_EQ( pliant_world_set_wind( scene.world, nullptr ), PLIANT_OK );
	ASSERT_EQ( pliant_world_set_water( scene.world, nullptr ), PLIANT_OK );
	EXPECT_EQ( hostOf( scene.world )->forceFieldCount(), 0 );
	scene.step( 120 );
	EXPECT_LT( heightOf( scene, body ), 1 ) << "it falls";
	double pressure = -1;
	EXPECT_EQ( pliant_body_set_gas( scene.world, body, PLIANT_GAS_CONSTANT, 100, 0 ), PLIANT_BAD_ARGUMENT ) << "it has no cavity";

	auto hollow = initial( pliant_lattice_settings_init );
	hollow.cell_size = 0.2f;
	hollow.shell = PLIANT_SHELL_ALWAYS;
	const CubeMesh mesh;
	pliant_template* box = nullptr;
	ASSERT_EQ( pliant_template_build( &mesh.view, &hollow, &box ), PLIANT_OK );
	ASSERT_EQ( pliant_body_create( scene.world, box, nullptr, &body ), PLIANT_OK );
	pliant_template_release( box );
	ASSERT_EQ( pliant_body_set_gas( scene.world, body, PLIANT_GAS_CONSTANT, 100, 0 ), PLIANT_OK ) << pliant_last_error();
	scene.step();
	ASSERT_EQ( pliant_body_get_gas_pressure( scene.world, body, 0, &pressure ), PLIANT_OK );
	EXPECT_NEAR( pressure, 100, 1e-3 );
	ASSERT_EQ( pliant_body_get_gas_pressure( scene.world, body, 9, &pressure ), PLIANT_OK );
	EXPECT_EQ( pressure, 0 );
	EXPECT_EQ( pliant_body_set_gas( scene.world, body, 3, 100, 0 ), PLIANT_BAD_SETTINGS );
	EXPECT_EQ( pliant_body_set_gas( scene.world, body, PLIANT_GAS_CONSTANT, kBad, 0 ), PLIANT_BAD_SETTINGS );
}

TEST( CFace, WorldsExplodeShiftAndKeepABudget )
{
	CScene scene;
	const pliant_id body = scene.add( pliant_vec3{ 0, 0.5, 0 } ), ball = scene.addBall( pliant_vec3{ 1, 0.25, 0 }, 1 );
	std::int32_t pushed = 0;
	ASSERT_EQ( pliant_world_explode( scene.world, pliant_vec3{ 2, 0.3, 0 }, 5, 20, &pushed ), PLIANT_OK );
	EXPECT_EQ( pushed, 2 );
	pliant_vec3 velocity{};
	ASSERT_EQ( pliant_rigid_get_velocity( scene.world, ball, &velocity, nullptr ), PLIANT_OK );
	EXPECT_LT( velocity.x, -0.5 );
	const double x = scene.state( body ).mass_centre.x;
	ASSERT_EQ( pliant_world_shift_origin( scene.world, pliant_vec3{ 16, 0, 0 } ), PLIANT_OK );
	EXPECT_EQ( scene.state( body ).mass_centre.x, x + 16 );
	auto budget = initial( pliant_debris_budget_init );
	budget.max_pieces = 1;
	ASSERT_EQ( pliant_world_set_debris_budget( scene.world, &budget ), PLIANT_OK );
	EXPECT_EQ( hostOf( scene.world )->debrisBudget().maxPieces, 1 );
	ASSERT_EQ( pliant_world_set_threads( scene.world, 2 ), PLIANT_OK );
	EXPECT_EQ( hostOf( scene.world )->threadCount(), 2 );
	ASSERT_EQ( pliant_world_set_soft_substeps( scene.world, 5, 9 ), PLIANT_OK );
	EXPECT_EQ( hostOf( scene.world )->maxSoftSubsteps(), 9 );
	ASSERT_EQ( pliant_world_set_gravity( scene.world, pliant_vec3{ 0, 2, 0 } ), PLIANT_OK );
	ASSERT_EQ( pliant_world_get_gravity( scene.world, &velocity ), PLIANT_OK );
	EXPECT_EQ( velocity.y, 2 );
	std::int32_t steps = -1;
	ASSERT_EQ( pliant_world_step( scene.world, 0.1, 3, kFrame, &steps ), PLIANT_OK );
	EXPECT_EQ( steps, 6 ) << "as Bullet counts them: those that were due";
}

} // namespace
} // namespace pliant
