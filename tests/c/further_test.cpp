// The C face beyond bodies and contacts: poses, skins for renderers, surface queries, frames, single bodies as bytes, force fields.

#include "c/face.h"

#include "pliant/c/mix.h"
#include "pliant/game/skeleton.h"
#include "pliant/soft_body_host.h"

#include <array>

namespace pliant {
namespace {

using namespace test;

pliant_vec3 centreOf( const CScene& scene, pliant_id body )
{
	return scene.state( body ).mass_centre;
}

/// One bone that moves all 8 corners of the cube.
struct OneBone
{
	std::vector<std::int32_t> bones = std::vector<std::int32_t>( 8, 0 );
	std::vector<float> weights = std::vector<float>( 8, 1.0f );
	pliant_skin_weights view = initial( pliant_skin_weights_init );
	OneBone()
	{
		view.per_vertex = 1;
		view.bones = bones.data();
		view.weights = weights.data();
		view.vertex_count = 8;
		view.bone_count = 1;
	}
};

TEST( CFurther, ABodyFollowsABoneAsInCpp )
{
	const OneBone skin;
	auto settings = initial( pliant_pose_settings_init );
	EXPECT_EQ( settings.frequency, PoseSettings{}.frequency );
	settings.frequency = 6;
	settings.paint = []( const float* point, float* strength, float* largest, void* context ) {
		*strength = point[1] > 0 ? 1.0f : 0.5f;
		*largest = 0.3f;
		++*static_cast<int*>( context );
	};
	int painted = 0;
	settings.paint_context = &painted;
	CScene scene, twin;
	const pliant_id body = scene.add( pliant_vec3{ 0, 3, 0 } ), other = twin.add( pliant_vec3{ 0, 3, 0 } );
	ASSERT_EQ( pliant_body_follow_bones( scene.world, body, &skin.view, &settings ), PLIANT_OK ) << pliant_last_error();
	EXPECT_EQ( painted, 64 );
	PoseSettings same;
	same.frequency = 6;
	same.paint = []( const float* point, void* ) { return PosePaint{ point[1] > 0 ? 1.0f : 0.5f, 0.3f }; };
	SoftBody& soft = *SoftBody::upcast( objectOf( twin.world, other ) );
	ASSERT_TRUE( followBones( soft, SkinWeights{ skin.bones.data(), skin.weights.data(), 1, 8, 1 }, same ).ok() );
	for ( int k = 0; k <= 60; ++k )
	{
		const double bone[12] = { 1, 0, 0, 0.02 * k, 0, 1, 0, 3, 0, 0, 1, 0 };
		const btTransform inCpp( btMatrix3x3::getIdentity(), btVector3( btScalar( 0.02 * k ), 3, 0 ) );
		ASSERT_EQ( pliant_body_set_pose( scene.world, body, bone, 1, k == 0 ), PLIANT_OK ) << pliant_last_error();
		ASSERT_TRUE( setPose( soft, &inCpp, 1, k == 0 ).ok() );
		scene.step();
		twin.step();
	}
	EXPECT_EQ( scene.everything(), twin.everything() );
	EXPECT_NEAR( centreOf( scene, body ).x, 1.2, 0.1 );
	scene.step( 120 );
	pliant_vec3 force, target;
	std::int32_t isFollowing = 0;
	double blend = 0;
	ASSERT_EQ( pliant_body_get_pose_force( scene.world, body, &force, nullptr ), PLIANT_OK );
	EXPECT_NEAR( force.y, 9810, 500 ) << "it carries the weight of a ton";
	ASSERT_EQ( pliant_body_get_pose_target( scene.world, body, 0, &target ), PLIANT_OK );
	EXPECT_NEAR( target.x, 1.2 - 0.375, 1e-5 );
	ASSERT_EQ( pliant_body_set_pose_blend( scene.world, body, 0.5 ), PLIANT_OK );
	ASSERT_EQ( pliant_body_get_pose_blend( scene.world, body, &blend ), PLIANT_OK );
	EXPECT_EQ( blend, 0.5 );
	ASSERT_EQ( pliant_body_get_following( scene.world, body, &isFollowing ), PLIANT_OK );
	EXPECT_EQ( isFollowing, 1 );
	ASSERT_EQ( pliant_body_stop_following( scene.world, body ), PLIANT_OK );
	ASSERT_EQ( pliant_body_get_following( scene.world, body, &isFollowing ), PLIANT_OK );
	EXPECT_EQ( isFollowing, 0 );
	scene.step( 120 );
	EXPECT_LT( centreOf( scene, body ).y, 0.7 );
}

TEST( CFurther, ABodyFollowsTargets )
{
	CScene scene;
	const pliant_id body = scene.add( pliant_vec3{ 0, 3, 0 } );
	auto settings = initial( pliant_pose_settings_init );
	settings.frequency = float( kInfinite );
	ASSERT_EQ( pliant_body_follow_targets( scene.world, body, &settings ), PLIANT_OK );
	std::vector<double> targets( 3 * 64 );
	std::uint64_t nodes = 0;
	ASSERT_EQ( pliant_body_get_positions( scene.world, body, targets.data(), 64, &nodes ), PLIANT_OK );
	for ( std::size_t k = 0; k < targets.size(); k += 3 )
	{
		targets[k] += 2;
	}
	ASSERT_EQ( pliant_body_set_targets( scene.world, body, targets.data(), 64, 1 ), PLIANT_OK ) << pliant_last_error();
	scene.step( 30 );
	EXPECT_NEAR( centreOf( scene, body ).x, 2, 1e-3 );
	EXPECT_NEAR( centreOf( scene, body ).y, 3, 1e-2 );
}

/// The position of a vertex as a shader computes it.
std::array<double, 3> skinned( const pliant_gpu_surface& skin, std::uint32_t vertex )
{
	const auto& v = static_cast<const pliant_skin_vertex*>( skin.vertices.data )[vertex];
	std::array<double, 3> sum{};
	if ( v.count == 0 )
	{
		const auto& mix = static_cast<const pliant_skin_mix*>( skin.mixes.data )[v.first];
		for ( std::size_t k = 0; k < 3; ++k )
		{
			const auto corner = skinned( skin, mix.vertex[k] );
			for ( std::size_t i = 0; i < 3; ++i )
			{
				sum[i] += double( mix.weight[k] ) * corner[i];
			}
		}
		return sum;
	}
	for ( std::uint32_t k = v.first; k < v.first + v.count; ++k )
	{
		const auto& influence = static_cast<const pliant_skin_influence*>( skin.influences.data )[k];
		const bool isMapped = skin.node_of_cell.count > 0;
		const std::uint32_t node = isMapped ? static_cast<const std::uint32_t*>( skin.node_of_cell.data )[influence.cell] : influence.cell;
		const float* const m = skin.node_transforms + 12 * node;
		for ( std::size_t i = 0; i < 3; ++i )
		{
			const double row = double( m[4 * i] ) * double( v.rest[0] ) + double( m[4 * i + 1] ) * double( v.rest[1] ) +
				double( m[4 * i + 2] ) * double( v.rest[2] ) + double( m[4 * i + 3] );
			sum[i] += double( influence.weight ) * row;
		}
	}
	return sum;
}

// Of a body that bends, of one that is cut, and of a further mesh on both.
TEST( CFurther, TablesForTheGpuAreTheSkin )
{
	CScene scene;
	const pliant_id body = scene.add( pliant_vec3{ 0, 0.6, 0 } );
	const CubeMesh mesh;
	pliant_skin* skin = nullptr;
	ASSERT_EQ( pliant_skin_create( scene.cube, &mesh.view, &skin ), PLIANT_OK ) << pliant_last_error();
	for ( int isBroken = 0; isBroken < 2; ++isBroken )
	{
		scene.step( 20 );
		pliant_surface surface{}, further{};
		pliant_gpu_surface tables{}, ofSkin{};
		ASSERT_EQ( pliant_body_get_surface( scene.world, body, &surface, sizeof surface ), PLIANT_OK );
		ASSERT_EQ( pliant_body_get_gpu_surface( scene.world, body, &tables, sizeof tables ), PLIANT_OK ) << pliant_last_error();
		ASSERT_EQ( pliant_skin_get_surface( skin, scene.world, body, &further, sizeof further ), PLIANT_OK ) << pliant_last_error();
		ASSERT_EQ( pliant_skin_get_gpu_surface( skin, scene.world, body, &ofSkin, sizeof ofSkin ), PLIANT_OK );
		ASSERT_EQ( tables.vertices.count, surface.vertices );
		ASSERT_EQ( ofSkin.vertices.count, further.vertices );
		EXPECT_EQ( tables.indices.count, 3 * surface.triangles );
		EXPECT_EQ( tables.vertices.stride, int( sizeof( pliant_skin_vertex ) ) );
		EXPECT_EQ( tables.topology_version, surface.topology_version );
		EXPECT_EQ( surface.vertices > 8, isBroken == 1 );
		for ( int v = 0; v < surface.vertices; ++v )
		{
			const auto at = skinned( tables, std::uint32_t( v ) );
			for ( std::size_t k = 0; k < 3; ++k )
			{
				EXPECT_NEAR( at[k], double( surface.positions[3 * std::size_t( v ) + k] ), 1e-5 );
			}
		}
		for ( int v = 0; v < further.vertices; ++v )
		{
			EXPECT_NEAR( skinned( ofSkin, std::uint32_t( v ) )[1], double( further.positions[3 * std::size_t( v ) + 1] ), 1e-5 );
		}
		pliant_vertex_sources sources{}, sourcesOfSkin{};
		ASSERT_EQ( pliant_body_get_vertex_sources( scene.world, body, &sources, sizeof sources ), PLIANT_OK );
		ASSERT_EQ( pliant_skin_get_vertex_sources( skin, scene.world, body, &sourcesOfSkin, sizeof sourcesOfSkin ), PLIANT_OK );
		EXPECT_EQ( sources.vertices, surface.vertices );
		EXPECT_EQ( sourcesOfSkin.vertices, further.vertices );
		EXPECT_EQ( sources.sources != nullptr, isBroken == 1 );
		EXPECT_TRUE( !sources.sources || sources.sources[0].vertex[0] == 0 );
		if ( isBroken == 0 )
		{
			std::int32_t links = 0;
			ASSERT_EQ(
				pliant_body_cut_plane( scene.world, body, centreOf( scene, body ), pliant_vec3{ 1, 0, 0 }, kInfinite, &links ), PLIANT_OK );
			EXPECT_GT( links, 0 );
		}
	}
	pliant_skin* second = nullptr;
	ASSERT_EQ( pliant_skin_copy( skin, &second ), PLIANT_OK );
	pliant_skin_destroy( skin );
	pliant_surface ofFragment{};
	ASSERT_EQ( pliant_skin_get_surface( second, scene.world, scene.bodies().back(), &ofFragment, sizeof ofFragment ), PLIANT_OK );
	EXPECT_GT( ofFragment.vertices, 0 );
	pliant_skin_destroy( second );
}

TEST( CFurther, TangentsFollowTheTexture )
{
	CScene scene;
	CubeMesh mesh;
	std::vector<float> uv;
	for ( std::size_t v = 0; v < 8; ++v )
	{
		uv.insert( uv.end(), { mesh.positions[3 * v], mesh.positions[3 * v + 1] + 0.3f * mesh.positions[3 * v + 2] } );
	}
	mesh.view.texture_coordinates = uv.data();
	pliant_template* textured = nullptr;
	ASSERT_EQ( pliant_template_build( &mesh.view, nullptr, &textured ), PLIANT_OK );
	pliant_id body = 0;
	ASSERT_EQ( pliant_body_create( scene.world, textured, nullptr, &body ), PLIANT_OK );
	pliant_template_release( textured );
	pliant_pose turn = { { 0, 0, 0 }, { 0, 0, std::sqrt( 0.5 ), std::sqrt( 0.5 ) } }; // x to y
	ASSERT_EQ( pliant_body_teleport( scene.world, body, &turn ), PLIANT_OK );
	pliant_tangents now{}, rest{};
	ASSERT_EQ( pliant_body_get_tangents( scene.world, body, &now, sizeof now ), PLIANT_OK ) << pliant_last_error();
	const std::vector<float> turned( now.tangents, now.tangents + 4 * std::size_t( now.vertices ) );
	ASSERT_EQ( pliant_body_get_rest_tangents( scene.world, body, &rest, sizeof rest ), PLIANT_OK );
	ASSERT_EQ( now.vertices, 8 );
	ASSERT_EQ( rest.vertices, 8 );
	for ( std::size_t v = 0; v < 32; v += 4 )
	{
		EXPECT_NEAR( turned[v], -rest.tangents[v + 1], 1e-3 );
		EXPECT_NEAR( turned[v + 1], rest.tangents[v], 1e-3 );
		EXPECT_EQ( turned[v + 3], rest.tangents[v + 3] );
	}
}

TEST( CFurther, SurfaceQueriesAgreeWithTheShape )
{
	CScene scene;
	const pliant_id body = scene.add( pliant_vec3{ 0, 3, 0 } );
	pliant_query* query = nullptr;
	ASSERT_EQ( pliant_query_create( scene.world, body, &query ), PLIANT_OK );
	ASSERT_EQ( pliant_object_destroy( scene.world, body ), PLIANT_OK ) << "it goes on without the body";
	pliant_nearest_point nearest{};
	pliant_measures measures{};
	std::int32_t answer = 0;
	ASSERT_EQ( pliant_query_get_nearest( query, pliant_vec3{ 0.1, 5, 0.2 }, &nearest, sizeof nearest ), PLIANT_OK );
	EXPECT_NEAR( nearest.point.y, 3.5, 1e-5 );
	EXPECT_NEAR( nearest.distance, 1.5, 1e-5 );
	EXPECT_NEAR( nearest.normal.y, 1, 1e-5 );
	EXPECT_GE( nearest.triangle, 0 );
	ASSERT_EQ( pliant_query_get_inside( query, pliant_vec3{ 0.4, 3, 0 }, &answer ), PLIANT_OK );
	EXPECT_EQ( answer, 1 );
	ASSERT_EQ( pliant_query_get_touching( query, pliant_vec3{ 0, 4, 0 }, 0.4, &answer ), PLIANT_OK );
	EXPECT_EQ( answer, 0 );
	ASSERT_EQ( pliant_query_get_touching( query, pliant_vec3{ 0, 4, 0 }, 0.6, &answer ), PLIANT_OK );
	EXPECT_EQ( answer, 1 );
	ASSERT_EQ( pliant_query_get_measures( query, &measures, sizeof measures ), PLIANT_OK );
	EXPECT_NEAR( measures.volume, 1, 1e-4 );
	EXPECT_NEAR( measures.area, 6, 1e-4 );
	EXPECT_EQ( measures.is_drawn, 1 );
	pliant_query_destroy( query );
}

// The force is one and a half times the weight: the body rises with g / 2.
TEST( CFurther, ForcesOnAFrameLiftItsBody )
{
	CScene scene;
	const pliant_id body = scene.add( pliant_vec3{ 0, 3, 0 } );
	pliant_id frame = 0, owner = 0;
	ASSERT_EQ( pliant_frame_create( scene.world, body, pliant_vec3{ 0, 3, 0 }, 2, &frame ), PLIANT_OK ) << pliant_last_error();
	ASSERT_EQ( pliant_frame_get_body( scene.world, frame, &owner ), PLIANT_OK );
	EXPECT_EQ( owner, body );
	for ( int k = 0; k < 60; ++k )
	{
		ASSERT_EQ( pliant_rigid_apply_force( scene.world, frame, pliant_vec3{ 0, 1.5 * 9810, 0 }, centreOf( scene, body ) ), PLIANT_OK );
		scene.step();
	}
	EXPECT_NEAR( scene.state( body ).linear_velocity.y, 4.9, 0.1 );
	EXPECT_EQ( pliant_object_destroy( scene.world, frame ), PLIANT_BAD_ARGUMENT ) << "it has a call of its own";
	ASSERT_EQ( pliant_object_destroy( scene.world, body ), PLIANT_OK );
	ASSERT_EQ( pliant_frame_get_body( scene.world, frame, &owner ), PLIANT_OK );
	EXPECT_EQ( owner, 0u );
	ASSERT_EQ( pliant_frame_destroy( scene.world, frame ), PLIANT_OK );
	EXPECT_EQ( pliant_frame_destroy( scene.world, frame ), PLIANT_NO_SUCH_OBJECT );
}

TEST( CFurther, ABodyGoesToAnotherWorldAsBytes )
{
	CScene scene, other;
	const pliant_id body = scene.add( pliant_vec3{ 0, 2, 0 } );
	scene.step( 20 );
	pliant_buffer *whole = nullptr, *state = nullptr;
	ASSERT_EQ( pliant_buffer_create( &whole ), PLIANT_OK );
	ASSERT_EQ( pliant_buffer_create( &state ), PLIANT_OK );
	ASSERT_EQ( pliant_body_save( scene.world, body, PLIANT_SAVE_ALL, whole ), PLIANT_OK );
	ASSERT_EQ( pliant_body_save( scene.world, body, PLIANT_SAVE_STATE_ONLY, state ), PLIANT_OK );
	EXPECT_LT( pliant_buffer_size( state ), pliant_buffer_size( whole ) );
	auto settings = initial( pliant_body_settings_init );
	settings.user_data = 9;
	pliant_id made = 0;
	const auto load = [&]( const pliant_buffer* bytes, const pliant_template* const* templates, std::uint64_t count ) {
		return pliant_body_load(
			other.world, pliant_buffer_data( bytes ), pliant_buffer_size( bytes ), templates, count, &settings, &made );
	};
	EXPECT_EQ( load( state, nullptr, 0 ), PLIANT_BAD_SNAPSHOT ) << "its template is not there";
	const pliant_template* const known = scene.cube;
	ASSERT_EQ( load( state, &known, 1 ), PLIANT_OK ) << pliant_last_error();
	ASSERT_EQ( pliant_object_destroy( other.world, made ), PLIANT_OK );
	ASSERT_EQ( load( whole, nullptr, 0 ), PLIANT_OK ) << pliant_last_error();
	std::uint64_t data = 0;
	ASSERT_EQ( pliant_object_get_user_data( other.world, made, &data ), PLIANT_OK );
	EXPECT_EQ( data, 9u );
	EXPECT_EQ( centreOf( other, made ).y, centreOf( scene, body ).y );
	scene.step( 20 );
	other.step( 20 );
	EXPECT_EQ( centreOf( other, made ).y, centreOf( scene, body ).y );
	pliant_buffer_destroy( whole );
	pliant_buffer_destroy( state );
}

TEST( CFurther, AFieldOfTheGameAcceleratesSoftAndRigidBodies )
{
	CScene scene;
	ASSERT_EQ( pliant_world_set_gravity( scene.world, pliant_vec3{ 0, 0, 0 } ), PLIANT_OK );
	const pliant_id body = scene.add( pliant_vec3{ 0, 5, 0 } ), ball = scene.addBall( pliant_vec3{ 3, 5, 0 }, 2 );
	double strength = 3;
	const pliant_acceleration field = []( const double* at, double* acceleration, void* context ) {
		acceleration[2] = at[1] > 0 ? *static_cast<const double*>( context ) : 0;
	};
	ASSERT_EQ( pliant_world_set_acceleration( scene.world, field, &strength ), PLIANT_OK ) << pliant_last_error();
	scene.step( 60 );
	pliant_vec3 velocity;
	ASSERT_EQ( pliant_rigid_get_velocity( scene.world, ball, &velocity, nullptr ), PLIANT_OK );
	EXPECT_NEAR( velocity.z, 3, 1e-3 );
	EXPECT_NEAR( scene.state( body ).linear_velocity.z, 3, 1e-3 );
	const pliant_acceleration thrown = []( const double*, double*, void* ) { throw 7; };
	ASSERT_EQ( pliant_world_set_acceleration( scene.world, thrown, nullptr ), PLIANT_OK );
	scene.step( 10 );
	ASSERT_EQ( pliant_world_set_acceleration( scene.world, nullptr, nullptr ), PLIANT_OK );
	EXPECT_EQ( hostOf( scene.world )->forceFieldCount(), 0 );
	scene.step( 10 );
	EXPECT_NEAR( scene.state( body ).linear_velocity.z, 3, 1e-3 );
}

TEST( CFurther, AWallSheltersFromAnExplosion )
{
	CScene scene;
	ASSERT_EQ( pliant_world_set_gravity( scene.world, pliant_vec3{ 0, 0, 0 } ), PLIANT_OK );
	const pliant_id open = scene.add( pliant_vec3{ -2, 5, 0 } ), behind = scene.add( pliant_vec3{ 2, 5, 0 } );
	auto wall = initial( pliant_rigid_settings_init );
	wall.kind = PLIANT_RIGID_STATIC;
	wall.pose.position = pliant_vec3{ 1, 5, 0 };
	pliant_id made = 0;
	ASSERT_EQ( pliant_rigid_create_box( scene.world, pliant_vec3{ 0.1, 3, 3 }, &wall, &made ), PLIANT_OK );
	auto explosion = initial( pliant_explosion_init );
	explosion.centre = pliant_vec3{ 0, 5, 0 };
	explosion.impulse = 5000;
	explosion.is_sheltered = 1;
	std::int32_t pushed = 0;
	ASSERT_EQ( pliant_world_explode_as( scene.world, &explosion, &pushed ), PLIANT_OK ) << pliant_last_error();
	EXPECT_EQ( pushed, 1 );
	EXPECT_LT( scene.state( open ).linear_velocity.x, -1 );
	EXPECT_EQ( scene.state( behind ).linear_velocity.x, 0 );
}

TEST( CFurther, ABodyBecomesStaticKinematicAndDynamic )
{
	CScene scene;
	const pliant_id body = scene.add( pliant_vec3{ 0, 3, 0 } );
	for ( const std::int32_t kind : { PLIANT_RIGID_STATIC, PLIANT_RIGID_KINEMATIC } )
	{
		ASSERT_EQ( pliant_body_set_kind( scene.world, body, kind ), PLIANT_OK );
		scene.step( 20 );
		EXPECT_NEAR( centreOf( scene, body ).y, 3, 1e-6 );
	}
	ASSERT_EQ( pliant_body_set_kind( scene.world, body, PLIANT_RIGID_DYNAMIC ), PLIANT_OK );
	scene.step( 20 );
	EXPECT_LT( centreOf( scene, body ).y, 2.6 );
	std::int32_t node = 0;
	ASSERT_EQ( pliant_body_get_node_of_cell( scene.world, body, 63, &node ), PLIANT_OK );
	EXPECT_EQ( node, 63 );
	ASSERT_EQ( pliant_body_get_node_of_cell( scene.world, body, 64, &node ), PLIANT_OK );
	EXPECT_EQ( node, -1 );
	ASSERT_EQ( pliant_body_set_surface_tolerance( scene.world, body, 0.5 ), PLIANT_OK );
	EXPECT_EQ( SoftBody::upcast( objectOf( scene.world, body ) )->surfaceTolerance(), btScalar( 0.5 ) );
}

TEST( CFurther, GasHasAVolume )
{
	CScene scene;
	const CubeMesh mesh;
	auto lattice = initial( pliant_lattice_settings_init );
	lattice.cell_size = 0.125f;
	lattice.shell = PLIANT_SHELL_ALWAYS;
	pliant_template* hollow = nullptr;
	pliant_id body = 0;
	ASSERT_EQ( pliant_template_build( &mesh.view, &lattice, &hollow ), PLIANT_OK );
	ASSERT_EQ( pliant_body_create( scene.world, hollow, nullptr, &body ), PLIANT_OK );
	pliant_template_release( hollow );
	ASSERT_EQ( pliant_body_set_gas( scene.world, body, PLIANT_GAS_IDEAL, 1e3, 101325 ), PLIANT_OK ) << pliant_last_error();
	double volume = 0;
	ASSERT_EQ( pliant_body_get_gas_volume( scene.world, body, 0, &volume ), PLIANT_OK );
	EXPECT_NEAR( volume, 0.75 * 0.75 * 0.75, 0.05 );
	ASSERT_EQ( pliant_body_get_gas_volume( scene.world, body, 7, &volume ), PLIANT_OK );
	EXPECT_EQ( volume, 0 );
}

} // namespace
} // namespace pliant
