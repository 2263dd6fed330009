// Structures of the C face: defaults, conversion of every field in both directions, and growth in later versions.

#include "c/face.h"

#include "c/call.h"
#include "pliant/c/mix.h"
#include "pliant/pliant.h"

#include <cstring>

namespace pliant {

namespace test {

/// A structure that had one field in its first version.
struct Grown
{
	std::uint32_t size;
	std::int32_t first, second;
};

} // namespace test

template <>
inline constexpr std::uint32_t c::kFirstSize<test::Grown> = 8;

namespace {

using namespace test;

template <class T>
bool areEqual( const T& a, const T& b )
{
	return std::memcmp( &a, &b, sizeof( T ) ) == 0;
}

pliant_material oddMaterial()
{
	auto m = initial( pliant_material_init );
	m.density = 700;
	m.youngs_modulus = 3e4f;
	m.alpha = 0.75f;
	m.beta = 0.25f;
	m.volume_keeping = 0.125f;
	m.plastic_creep = 5;
	m.plastic_limit = 0.375f;
	m.region_half_width = 2;
	m.damping = 3;
	m.wobble_damping = 0.0625f;
	m.elasticity = PLIANT_ELASTICITY_AUTOMATIC;
	m.numerical_damping = 0.5f;
	m.rigid_strain = 0.01f;
	m.cluster_mode = PLIANT_CLUSTER_QUADRATIC;
	m.cluster_edge = 6;
	m.yield_strain = 0.03125f;
	return m;
}

TEST( CSettings, AMaterialComesBackAsItWasSet )
{
	CScene scene;
	const pliant_id body = scene.add( pliant_vec3{ 0, 1, 0 } );
	pliant_material read = initial( pliant_material_init ), defaults = read;
	ASSERT_EQ( pliant_body_get_material( scene.world, body, &read, sizeof read ), PLIANT_OK );
	EXPECT_EQ( read.youngs_modulus, defaultYoungsModulus( read.density, 1.0f ) ) << "of a cube of 1 m";
	defaults.youngs_modulus = read.youngs_modulus;
	EXPECT_TRUE( areEqual( read, defaults ) );
	const pliant_material odd = oddMaterial();
	ASSERT_EQ( pliant_body_set_material( scene.world, body, &odd ), PLIANT_OK ) << pliant_last_error();
	ASSERT_EQ( pliant_body_get_material( scene.world, body, &read, sizeof read ), PLIANT_OK );
	EXPECT_TRUE( areEqual( read, odd ) );
	const auto* const soft = static_cast<SoftBody*>( objectOf( scene.world, body ) );
	EXPECT_EQ( soft->material().density, 700 );
	EXPECT_EQ( soft->material().elasticity, Elasticity::Automatic );
	// Fields that contradict others.
	pliant_material other = defaults;
	other.stiffness = PLIANT_STIFFNESS_RAW_ALPHA;
	other.method = PLIANT_METHOD_CLUSTERS;
	other.weights = 1;
	other.rotation_from = 1;
	ASSERT_EQ( pliant_body_set_material( scene.world, body, &other ), PLIANT_OK ) << pliant_last_error();
	EXPECT_EQ( soft->material().stiffness, Stiffness::RawAlpha );
	EXPECT_EQ( soft->material().method, Method::Clusters );
	EXPECT_EQ( soft->material().weights, Weights::Literal );
	EXPECT_EQ( soft->material().rotationFrom, RotationFrom::F );
	ASSERT_EQ( pliant_body_get_material( scene.world, body, &read, sizeof read ), PLIANT_OK );
	EXPECT_TRUE( areEqual( read, other ) );
}

TEST( CSettings, AFractureComesBackAsItWasSet )
{
	CScene scene;
	const pliant_id body = scene.add( pliant_vec3{ 0, 1, 0 } );
	auto f = initial( pliant_fracture_init );
	f.rule = PLIANT_BREAK_SHARDS;
	f.break_strain = 0.25f;
	f.strength = 1e5f;
	f.cool_down = 0.5f;
	f.growth_fraction = 0.75f;
	f.shard_size = 0.6f;
	f.toughness = 10;
	f.crumb_fraction = 0.125f;
	f.shard_seed = 9;
	f.shard_pattern = PLIANT_SHARDS_RINGS;
	f.grain[0] = 1;
	f.grain[1] = 2;
	f.grain[2] = 3;
	f.grain_length = 5;
	f.small_cells = 3;
	f.small_pieces = PLIANT_PIECES_FADE;
	f.fade_time = 4;
	f.max_pieces = 70;
	ASSERT_EQ( pliant_body_set_fracture( scene.world, body, &f ), PLIANT_OK ) << pliant_last_error();
	auto read = initial( pliant_fracture_init );
	ASSERT_EQ( pliant_body_get_fracture( scene.world, body, &read, sizeof read ), PLIANT_OK );
	EXPECT_TRUE( areEqual( read, f ) );
	const Fracture cpp = static_cast<SoftBody*>( objectOf( scene.world, body ) )->fracture();
	EXPECT_EQ( cpp.grain[2], 3 );
	EXPECT_EQ( cpp.smallPieces, SmallPieces::Fade );
	EXPECT_EQ( cpp.maxPieces, 70 );
}

TEST( CSettings, LevelsComeBackAsTheyWereSet )
{
	CScene scene;
	auto a = initial( pliant_adaptivity_init );
	a.coarse_levels = 2;
	a.keep_mass = 0.75f;
	a.is_surface_fine = 1;
	a.regions = 2;
	a.softening = 3;
	a.residual = 1;
	a.coarse_stiffness = 0.5f;
	a.interval_slack = 1;
	a.hierarchical_sums = 0;
	a.refine_strain = 0.25f;
	a.merge_fraction = 0.125f;
	a.merge_delay = 2;
	a.refines_on_contact = 1;
	a.nodes_per_step = 99;
	auto settings = initial( pliant_body_settings_init );
	settings.adaptivity = &a;
	pliant_id body = 0;
	ASSERT_EQ( pliant_body_create( scene.world, scene.cube, &settings, &body ), PLIANT_OK ) << pliant_last_error();
	auto read = initial( pliant_adaptivity_init );
	ASSERT_EQ( pliant_body_get_adaptivity( scene.world, body, &read, sizeof read ), PLIANT_OK );
	EXPECT_TRUE( areEqual( read, a ) );
	EXPECT_EQ( static_cast<SoftBody*>( objectOf( scene.world, body ) )->adaptivity().softening, Softening::Ohta3D );
	EXPECT_EQ( pliant_body_set_finest_level( scene.world, body, 2 ), PLIANT_OK );
	EXPECT_EQ( pliant_body_set_finest_level( scene.world, body, 3 ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_body_set_finest_level( scene.world, body, -1 ), PLIANT_BAD_ARGUMENT );
}

TEST( CSettings, ATemplateIsWhatCppBuilds )
{
	const CubeMesh mesh;
	auto lattice = initial( pliant_lattice_settings_init );
	lattice.cell_size = 0.25f;
	lattice.threads = 2;
	lattice.shell = PLIANT_SHELL_ALWAYS;
	lattice.noise_amplitude = 0.1f;
	std::vector<float> told;
	lattice.progress = []( float done, void* context ) {
		static_cast<std::vector<float>*>( context )->push_back( done );
		return std::int32_t( 1 );
	};
	lattice.progress_context = &told;
	pliant_template* made = nullptr;
	ASSERT_EQ( pliant_template_build( &mesh.view, &lattice, &made ), PLIANT_OK ) << pliant_last_error();
	EXPECT_FALSE( told.empty() );
	LatticeSettings cpp;
	cpp.cellSize = 0.25f;
	cpp.shell = Shell::Always;
	cpp.cracks.noiseAmplitude = 0.1f;
	const auto same = BodyTemplate::build( MeshView{ mesh.positions.data(), 8, 3, mesh.indices.data(), 12 }, cpp ).value;
	pliant_buffer* bytes = nullptr;
	ASSERT_EQ( pliant_buffer_create( &bytes ), PLIANT_OK );
	ASSERT_EQ( pliant_template_save( made, bytes ), PLIANT_OK );
	pliant_template* loaded = nullptr;
	ASSERT_EQ( pliant_template_load( pliant_buffer_data( bytes ), pliant_buffer_size( bytes ), &loaded ), PLIANT_OK );
	pliant_template *scaled = nullptr, *wrapped = nullptr;
	ASSERT_EQ( wrapTemplate( same, &wrapped ), PLIANT_OK );
	ASSERT_EQ( pliant_template_scaled( loaded, 2, &scaled ), PLIANT_OK );
	pliant_template_info info{}, infoOfSame{}, infoOfScaled{};
	ASSERT_EQ( pliant_template_get_info( loaded, &info, sizeof info ), PLIANT_OK );
	ASSERT_EQ( pliant_template_get_info( wrapped, &infoOfSame, sizeof info ), PLIANT_OK );
	ASSERT_EQ( pliant_template_get_info( scaled, &infoOfScaled, sizeof info ), PLIANT_OK );
	EXPECT_TRUE( areEqual( info, infoOfSame ) );
	EXPECT_EQ( info.shell_cells, info.cells );
	EXPECT_EQ( info.vertices, 8 );
	EXPECT_EQ( infoOfScaled.cell_size, 0.5f );

	lattice.progress = []( float, void* ) { return std::int32_t( 0 ); };
	pliant_template* const before = made;
	EXPECT_EQ( pliant_template_build( &mesh.view, &lattice, &made ), PLIANT_CANCELLED );
	EXPECT_EQ( made, before );
	for ( pliant_template* each : { made, loaded, scaled, wrapped } )
	{
		pliant_template_release( each );
	}
	pliant_buffer_destroy( bytes );
}

TEST( CSettings, SizesThatAreNotKnownAreRefused )
{
	pliant_material material;
	std::memset( &material, 0x5a, sizeof material );
	const pliant_material before = material;
	EXPECT_EQ( pliant_material_init( &material, sizeof material - 4 ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_material_init( &material, sizeof material + 4 ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_material_init( nullptr, sizeof material ), PLIANT_BAD_ARGUMENT );
	EXPECT_TRUE( areEqual( material, before ) );
	EXPECT_EQ( pliant_fracture_init( nullptr, sizeof( pliant_fracture ) ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_adaptivity_init( nullptr, sizeof( pliant_adaptivity ) ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_debris_budget_init( nullptr, sizeof( pliant_debris_budget ) ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_attachment_settings_init( nullptr, sizeof( pliant_attachment_settings ) ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_lattice_settings_init( nullptr, sizeof( pliant_lattice_settings ) ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_mesh_init( nullptr, sizeof( pliant_mesh ) ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_world_settings_init( nullptr, sizeof( pliant_world_settings ) ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_rigid_settings_init( nullptr, sizeof( pliant_rigid_settings ) ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( pliant_body_settings_init( nullptr, sizeof( pliant_body_settings ) ), PLIANT_BAD_ARGUMENT );
	CScene scene;
	const pliant_id body = scene.add( pliant_vec3{ 0, 1, 0 } );
	material = initial( pliant_material_init );
	material.size = 0; // never initialised
	EXPECT_EQ( pliant_body_set_material( scene.world, body, &material ), PLIANT_BAD_ARGUMENT );
	EXPECT_NE( std::strstr( pliant_last_error(), "_init" ), nullptr );
	auto settings = initial( pliant_body_settings_init );
	settings.size = 3;
	pliant_id made = 0;
	EXPECT_EQ( pliant_body_create( scene.world, scene.cube, &settings, &made ), PLIANT_BAD_ARGUMENT );
	EXPECT_EQ( made, 0u );
}

TEST( CSettings, CallersOfAnOlderVersionGoOn )
{
	Grown full{ 0, 1, 2 };
	const Grown old{ 8, 5, 99 };
	EXPECT_EQ( c::call( [&]() { c::readSized( &old, full ); } ), PLIANT_OK );
	EXPECT_EQ( full.first, 5 );
	EXPECT_EQ( full.second, 2 ) << "the default of what the caller does not know";
	Grown out{ 0, 0, 77 };
	EXPECT_EQ( c::initSized( Grown{ 0, 3, 4 }, &out, 8 ), PLIANT_OK );
	EXPECT_EQ( out.size, 8u );
	EXPECT_EQ( out.first, 3 );
	EXPECT_EQ( out.second, 77 ) << "nothing is written behind the caller's structure";
	EXPECT_EQ( c::initSized( Grown{ 0, 3, 4 }, &out, 12 ), PLIANT_OK );
	EXPECT_EQ( out.second, 4 );
	for ( const std::uint32_t size : { 0u, 4u, 13u, 16u } )
	{
		EXPECT_EQ( c::initSized( Grown{}, &out, size ), PLIANT_BAD_ARGUMENT );
	}
}

TEST( CSettings, NumbersThatAreNoEnumeratorsAreRefused )
{
	CScene scene;
	const pliant_id body = scene.add( pliant_vec3{ 0, 1, 0 } );
	const auto tryMaterial = [&]( std::int32_t pliant_material::*field, std::int32_t value ) {
		auto material = initial( pliant_material_init );
		material.*field = value;
		return pliant_body_set_material( scene.world, body, &material );
	};
	for ( const auto field : { &pliant_material::stiffness, &pliant_material::elasticity, &pliant_material::method,
			  &pliant_material::cluster_mode, &pliant_material::weights, &pliant_material::rotation_from } )
	{
		EXPECT_EQ( tryMaterial( field, -1 ), PLIANT_BAD_MATERIAL );
		EXPECT_EQ( tryMaterial( field, 7 ), PLIANT_BAD_MATERIAL );
	}
	for ( const auto field : { &pliant_fracture::rule, &pliant_fracture::shard_pattern, &pliant_fracture::small_pieces } )
	{
		auto fracture = initial( pliant_fracture_init );
		fracture.*field = 9;
		EXPECT_EQ( pliant_body_set_fracture( scene.world, body, &fracture ), PLIANT_BAD_SETTINGS );
	}
	for ( const auto field : { &pliant_adaptivity::regions, &pliant_adaptivity::softening, &pliant_adaptivity::residual } )
	{
		auto adaptivity = initial( pliant_adaptivity_init );
		adaptivity.*field = 9;
		auto settings = initial( pliant_body_settings_init );
		settings.adaptivity = &adaptivity;
		pliant_id made = 0;
		EXPECT_EQ( pliant_body_create( scene.world, scene.cube, &settings, &made ), PLIANT_BAD_SETTINGS );
	}
}

} // namespace
} // namespace pliant
