// Misuse of poses, skins, queries, frames, saved bodies and fields: a code, a sentence, and nothing has changed.

#include "c/misuse.h"

#include <cstring>

namespace pliant {
namespace {

using namespace test;

const std::int32_t kBones[8] = { 0, 0, 0, 0, 0, 0, 0, 0 };
const float kOnes[8] = { 1, 1, 1, 1, 1, 1, 1, 1 };
const double kBone[12] = { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0 };

pliant_skin_weights& oneBone()
{
	static pliant_skin_weights weights = initial( pliant_skin_weights_init );
	weights.per_vertex = 1;
	weights.bones = kBones;
	weights.weights = kOnes;
	weights.vertex_count = 8;
	weights.bone_count = 1;
	return weights;
}

/// A cube with skins and a buffer as targets of the calls.
struct Outs
{
	static inline pliant_gpu_surface tables{};
	static inline pliant_surface surface{};
	static inline pliant_vertex_sources sources{};
	static inline pliant_tangents tangents{};
	static inline pliant_vec3 vector{};
	static inline double number = 0;
	static inline std::int32_t flag = 0;
	static inline pliant_id id = 0;
	static inline pliant_query* query = nullptr;
	static inline pliant_buffer* buffer = nullptr;
	static inline pliant_skin* skin = nullptr;
};

const std::vector<Named>& furtherCalls()
{
	using O = Outs;
	static const std::vector<Named> calls = {
		PLIANT_NAMED( pliant_body_follow_targets( t.world, t.id, nullptr ) ),
		PLIANT_NAMED( pliant_body_stop_following( t.world, t.id ) ),
		PLIANT_NAMED( pliant_body_get_following( t.world, t.id, &O::flag ) ),
		PLIANT_NAMED( pliant_body_follow_bones( t.world, t.id, &oneBone(), nullptr ) ),
		PLIANT_NAMED( pliant_body_set_pose_blend( t.world, t.id, 0 ) ),
		PLIANT_NAMED( pliant_body_set_pose( t.world, t.id, kBone, 1, 0 ) ),
		PLIANT_NAMED( pliant_body_get_pose_target( t.world, t.id, 0, &O::vector ) ),
		PLIANT_NAMED( pliant_body_get_pose_blend( t.world, t.id, &O::number ) ),
		PLIANT_NAMED( pliant_body_get_pose_force( t.world, t.id, &O::vector, &O::vector ) ),
		PLIANT_NAMED( pliant_body_get_gpu_surface( t.world, t.id, &O::tables, sizeof O::tables ) ),
		PLIANT_NAMED( pliant_body_get_vertex_sources( t.world, t.id, &O::sources, sizeof O::sources ) ),
		PLIANT_NAMED( pliant_body_get_tangents( t.world, t.id, &O::tangents, sizeof O::tangents ) ),
		PLIANT_NAMED( pliant_body_get_rest_tangents( t.world, t.id, &O::tangents, sizeof O::tangents ) ),
		PLIANT_NAMED( pliant_skin_get_surface( O::skin, t.world, t.id, &O::surface, sizeof O::surface ) ),
		PLIANT_NAMED( pliant_skin_get_gpu_surface( O::skin, t.world, t.id, &O::tables, sizeof O::tables ) ),
		PLIANT_NAMED( pliant_skin_get_vertex_sources( O::skin, t.world, t.id, &O::sources, sizeof O::sources ) ),
		PLIANT_NAMED( pliant_body_get_node_of_cell( t.world, t.id, 0, &O::flag ) ),
		PLIANT_NAMED( pliant_body_get_gas_volume( t.world, t.id, 0, &O::number ) ),
		PLIANT_NAMED( pliant_body_set_surface_tolerance( t.world, t.id, 0 ) ),
		PLIANT_NAMED( pliant_body_set_kind( t.world, t.id, PLIANT_RIGID_DYNAMIC ) ),
		PLIANT_NAMED( pliant_body_save( t.world, t.id, PLIANT_SAVE_ALL, O::buffer ) ),
		PLIANT_NAMED( pliant_frame_create( t.world, t.id, pliant_vec3{ 0, 1, 0 }, 1, &O::id ) ),
	};
	return calls;
}

struct FurtherMisuse : testing::Test
{
	MisuseScene scene;
	CubeMesh mesh;
	FurtherMisuse()
	{
		EXPECT_EQ( pliant_skin_create( scene.cube, &mesh.view, &Outs::skin ), PLIANT_OK );
		EXPECT_EQ( pliant_buffer_create( &Outs::buffer ), PLIANT_OK );
	}
	~FurtherMisuse() override
	{
		pliant_skin_destroy( Outs::skin );
		pliant_buffer_destroy( Outs::buffer );
		Outs::query = nullptr;
	}
};

TEST_F( FurtherMisuse, MissingObjectsAndObjectsOfAnotherKind )
{
	scene.expectRefused( PLIANT_BAD_ARGUMENT, furtherCalls(), Target{ nullptr, scene.soft } );
	scene.expectRefused( PLIANT_BAD_ARGUMENT, furtherCalls(), Target{ scene.world, scene.ball } );
	for ( const pliant_id id : { pliant_id( 0 ), scene.goneSoft, scene.goneBall, ~pliant_id( 0 ), ~pliant_id( 1 ) } )
	{
		scene.expectRefused( PLIANT_NO_SUCH_OBJECT, furtherCalls(), Target{ scene.world, id } );
	}
	for ( const Named& each : furtherCalls() )
	{
		EXPECT_EQ( each.call( Target{ scene.world, scene.soft } ), PLIANT_OK ) << each.name << ": " << pliant_last_error();
	}
}

TEST_F( FurtherMisuse, InvalidPoses )
{
	static std::vector<double> targets( 3 * 64, 0.0 ), bad = targets, far = targets;
	bad[7] = kBad;
	far[7] = 1e12;
	static const double badBone[12] = { 1, 0, 0, kBad, 0, 1, 0, 0, 0, 0, 1, 0 };
	static pliant_skin_weights fewer = oneBone(), wrongSize = oneBone();
	fewer.vertex_count = 7;
	wrongSize.size = 5;
	static pliant_pose_settings still = initial( pliant_pose_settings_init ), painted = still, unsized = still;
	still.frequency = 0;
	painted.paint = []( const float*, float* strength, float*, void* ) { *strength = 2; };
	unsized.size = 3;
	scene.expectRefused( PLIANT_BAD_ARGUMENT,
		{
			PLIANT_NAMED( pliant_body_set_pose( t.world, t.id, kBone, 1, 0 ) ), // it follows nothing yet
			PLIANT_NAMED( pliant_body_set_targets( t.world, t.id, targets.data(), 64, 0 ) ),
			PLIANT_NAMED( pliant_body_set_pose_blend( t.world, t.id, 1 ) ),
			PLIANT_NAMED( pliant_body_follow_bones( t.world, t.id, nullptr, nullptr ) ),
			PLIANT_NAMED( pliant_body_follow_bones( t.world, t.id, &fewer, nullptr ) ),
			PLIANT_NAMED( pliant_body_follow_bones( t.world, t.id, &wrongSize, nullptr ) ),
			PLIANT_NAMED( pliant_body_follow_targets( t.world, t.id, &unsized ) ),
			PLIANT_NAMED( pliant_body_get_following( t.world, t.id, nullptr ) ),
			PLIANT_NAMED( pliant_body_get_pose_target( t.world, t.id, 0, nullptr ) ),
			PLIANT_NAMED( pliant_body_get_pose_blend( t.world, t.id, nullptr ) ),
		},
		Target{ scene.world, scene.soft } );
	scene.expectRefused( PLIANT_BAD_SETTINGS,
		{
			PLIANT_NAMED( pliant_body_follow_targets( t.world, t.id, &still ) ),
			PLIANT_NAMED( pliant_body_follow_targets( t.world, t.id, &painted ) ),
			PLIANT_NAMED( pliant_body_follow_bones( t.world, t.id, &oneBone(), &still ) ),
		},
		Target{ scene.world, scene.soft } );
	std::int32_t isFollowing = 1;
	ASSERT_EQ( pliant_body_get_following( scene.world, scene.soft, &isFollowing ), PLIANT_OK );
	EXPECT_EQ( isFollowing, 0 );
	ASSERT_EQ( pliant_body_follow_bones( scene.world, scene.soft, &oneBone(), nullptr ), PLIANT_OK );
	scene.expectRefused( PLIANT_BAD_ARGUMENT,
		{
			PLIANT_NAMED( pliant_body_set_pose( t.world, t.id, nullptr, 1, 0 ) ),
			PLIANT_NAMED( pliant_body_set_pose( t.world, t.id, kBone, 2, 0 ) ),
			PLIANT_NAMED( pliant_body_set_pose( t.world, t.id, kBone, INT32_MAX, 0 ) ), // not read
			PLIANT_NAMED( pliant_body_set_pose( t.world, t.id, badBone, 1, 0 ) ),
			PLIANT_NAMED( pliant_body_set_pose_blend( t.world, t.id, kBad ) ),
			PLIANT_NAMED( pliant_body_set_pose_blend( t.world, t.id, 1.5 ) ),
		},
		Target{ scene.world, scene.soft } );
	ASSERT_EQ( pliant_body_follow_targets( scene.world, scene.soft, nullptr ), PLIANT_OK );
	scene.expectRefused( PLIANT_BAD_ARGUMENT,
		{
			PLIANT_NAMED( pliant_body_set_targets( t.world, t.id, nullptr, 64, 0 ) ),
			PLIANT_NAMED( pliant_body_set_targets( t.world, t.id, targets.data(), 63, 0 ) ),
			PLIANT_NAMED( pliant_body_set_targets( t.world, t.id, targets.data(), -1, 0 ) ),
			PLIANT_NAMED( pliant_body_set_targets( t.world, t.id, bad.data(), 64, 0 ) ),
			PLIANT_NAMED( pliant_body_set_targets( t.world, t.id, far.data(), 64, 0 ) ),
		},
		Target{ scene.world, scene.soft } );
}

TEST_F( FurtherMisuse, InvalidSkinsAndNumbers )
{
	static pliant_mesh noMesh = initial( pliant_mesh_init );
	using O = Outs;
	static MisuseScene* where = &scene;
	where = &scene;
	static pliant_skin* made = nullptr;
	scene.expectRefused( PLIANT_BAD_ARGUMENT,
		{
			PLIANT_NAMED( pliant_body_get_gpu_surface( t.world, t.id, nullptr, sizeof O::tables ) ),
			PLIANT_NAMED( pliant_body_get_gpu_surface( t.world, t.id, &O::tables, 4 ) ),
			PLIANT_NAMED( pliant_body_get_vertex_sources( t.world, t.id, nullptr, sizeof O::sources ) ),
			PLIANT_NAMED( pliant_body_get_vertex_sources( t.world, t.id, &O::sources, 4 ) ),
			PLIANT_NAMED( pliant_body_get_tangents( t.world, t.id, nullptr, sizeof O::tangents ) ),
			PLIANT_NAMED( pliant_body_get_rest_tangents( t.world, t.id, &O::tangents, 4 ) ),
			PLIANT_NAMED( pliant_skin_create( nullptr, &noMesh, &made ) ),
			PLIANT_NAMED( pliant_skin_create( where->cube, nullptr, &made ) ),
			PLIANT_NAMED( pliant_skin_create( where->cube, &noMesh, nullptr ) ),
			PLIANT_NAMED( pliant_skin_copy( nullptr, &made ) ),
			PLIANT_NAMED( pliant_skin_copy( O::skin, nullptr ) ),
			PLIANT_NAMED( pliant_skin_get_surface( nullptr, t.world, t.id, &O::surface, sizeof O::surface ) ),
			PLIANT_NAMED( pliant_skin_get_surface( O::skin, t.world, t.id, &O::surface, 4 ) ),
			PLIANT_NAMED( pliant_skin_get_gpu_surface( nullptr, t.world, t.id, &O::tables, sizeof O::tables ) ),
			PLIANT_NAMED( pliant_skin_get_gpu_surface( O::skin, t.world, t.id, nullptr, sizeof O::tables ) ),
			PLIANT_NAMED( pliant_skin_get_vertex_sources( nullptr, t.world, t.id, &O::sources, sizeof O::sources ) ),
			PLIANT_NAMED( pliant_skin_get_vertex_sources( O::skin, t.world, t.id, nullptr, sizeof O::sources ) ),
			PLIANT_NAMED( pliant_body_get_node_of_cell( t.world, t.id, 0, nullptr ) ),
			PLIANT_NAMED( pliant_body_get_gas_volume( t.world, t.id, 0, nullptr ) ),
			PLIANT_NAMED( pliant_body_set_surface_tolerance( t.world, t.id, kBad ) ),
			PLIANT_NAMED( pliant_body_set_surface_tolerance( t.world, t.id, -1 ) ),
			PLIANT_NAMED( pliant_body_set_kind( t.world, t.id, -1 ) ),
			PLIANT_NAMED( pliant_body_set_kind( t.world, t.id, 3 ) ),
		},
		Target{ scene.world, scene.soft } );
	scene.expectRefused(
		PLIANT_EMPTY_MESH, { PLIANT_NAMED( pliant_skin_create( where->cube, &noMesh, &made ) ) }, Target{ scene.world, scene.soft } );
	EXPECT_EQ( made, nullptr );
}

TEST_F( FurtherMisuse, InvalidQueries )
{
	using O = Outs;
	static pliant_nearest_point nearest{};
	static pliant_measures measures{};
	ASSERT_EQ( pliant_query_create( scene.world, scene.soft, &O::query ), PLIANT_OK );
	scene.expectRefused( PLIANT_BAD_ARGUMENT,
		{
			PLIANT_NAMED( pliant_query_create( t.world, t.id, nullptr ) ),
			PLIANT_NAMED( pliant_query_create( nullptr, t.id, &O::query ) ),
			PLIANT_NAMED( pliant_query_get_nearest( nullptr, kZero, &nearest, sizeof nearest ) ),
			PLIANT_NAMED( pliant_query_get_nearest( O::query, kBadVector, &nearest, sizeof nearest ) ),
			PLIANT_NAMED( pliant_query_get_nearest( O::query, kZero, nullptr, sizeof nearest ) ),
			PLIANT_NAMED( pliant_query_get_nearest( O::query, kZero, &nearest, 1 ) ),
			PLIANT_NAMED( pliant_query_get_inside( nullptr, kZero, &O::flag ) ),
			PLIANT_NAMED( pliant_query_get_inside( O::query, kBadVector, &O::flag ) ),
			PLIANT_NAMED( pliant_query_get_inside( O::query, kZero, nullptr ) ),
			PLIANT_NAMED( pliant_query_get_touching( nullptr, kZero, 1, &O::flag ) ),
			PLIANT_NAMED( pliant_query_get_touching( O::query, kBadVector, 1, &O::flag ) ),
			PLIANT_NAMED( pliant_query_get_touching( O::query, kZero, kBad, &O::flag ) ),
			PLIANT_NAMED( pliant_query_get_touching( O::query, kZero, -1, &O::flag ) ),
			PLIANT_NAMED( pliant_query_get_touching( O::query, kZero, 1, nullptr ) ),
			PLIANT_NAMED( pliant_query_get_measures( nullptr, &measures, sizeof measures ) ),
			PLIANT_NAMED( pliant_query_get_measures( O::query, nullptr, sizeof measures ) ),
			PLIANT_NAMED( pliant_query_get_measures( O::query, &measures, 1 ) ),
		},
		Target{ scene.world, scene.soft } );
	scene.expectRefused(
		PLIANT_BAD_ARGUMENT, { PLIANT_NAMED( pliant_query_create( t.world, t.id, &O::query ) ) }, Target{ scene.world, scene.ball } );
	scene.expectRefused(
		PLIANT_NO_SUCH_OBJECT, { PLIANT_NAMED( pliant_query_create( t.world, t.id, &O::query ) ) }, Target{ scene.world, scene.goneSoft } );
	pliant_query_destroy( O::query );
	pliant_query_destroy( nullptr );
	pliant_skin_destroy( nullptr );
}

TEST_F( FurtherMisuse, InvalidFramesBytesAndFields )
{
	using O = Outs;
	static pliant_explosion explosion = initial( pliant_explosion_init ), unsized = explosion;
	unsized.size = 1;
	static const char text[] = "no snapshot, but long enough to have a header, a version and a checksum";
	static const pliant_template* const none = nullptr;
	scene.expectRefused( PLIANT_BAD_ARGUMENT,
		{
			PLIANT_NAMED( pliant_frame_create( t.world, t.id, kBadVector, 1, &O::id ) ),
			PLIANT_NAMED( pliant_frame_create( t.world, t.id, kUp, 0, &O::id ) ),
			PLIANT_NAMED( pliant_frame_create( t.world, t.id, kUp, 1e-3, &O::id ) ),
			PLIANT_NAMED( pliant_frame_create( t.world, t.id, kUp, 1, nullptr ) ),
			PLIANT_NAMED( pliant_frame_destroy( t.world, t.id ) ), // a soft body
			PLIANT_NAMED( pliant_frame_get_body( t.world, t.id, &O::id ) ),
			PLIANT_NAMED( pliant_body_save( t.world, t.id, PLIANT_SAVE_ALL, nullptr ) ),
			PLIANT_NAMED( pliant_body_save( t.world, t.id, PLIANT_SAVE_FOR_COMPARISON, O::buffer ) ),
			PLIANT_NAMED( pliant_body_load( nullptr, text, sizeof text, nullptr, 0, nullptr, &O::id ) ),
			PLIANT_NAMED( pliant_body_load( t.world, nullptr, 9, nullptr, 0, nullptr, &O::id ) ),
			PLIANT_NAMED( pliant_body_load( t.world, text, sizeof text, nullptr, 1, nullptr, &O::id ) ),
			PLIANT_NAMED( pliant_body_load( t.world, text, sizeof text, &none, 1, nullptr, &O::id ) ),
			PLIANT_NAMED( pliant_body_load( t.world, text, sizeof text, nullptr, 0, nullptr, nullptr ) ),
			PLIANT_NAMED( pliant_world_set_acceleration( nullptr, nullptr, nullptr ) ),
			PLIANT_NAMED( pliant_world_explode_as( nullptr, &explosion, &O::flag ) ),
			PLIANT_NAMED( pliant_world_explode_as( t.world, nullptr, &O::flag ) ),
			PLIANT_NAMED( pliant_world_explode_as( t.world, &unsized, &O::flag ) ),
			PLIANT_NAMED( pliant_explosion_init( nullptr, sizeof( pliant_explosion ) ) ),
			PLIANT_NAMED( pliant_pose_settings_init( nullptr, sizeof( pliant_pose_settings ) ) ),
			PLIANT_NAMED( pliant_skin_weights_init( nullptr, sizeof( pliant_skin_weights ) ) ),
		},
		Target{ scene.world, scene.soft } );
	scene.expectRefused( PLIANT_BAD_SNAPSHOT,
		{ PLIANT_NAMED( pliant_body_load( t.world, text, sizeof text, nullptr, 0, nullptr, &O::id ) ) },
		Target{ scene.world, scene.soft } );
	scene.expectRefused(
		PLIANT_BAD_ARGUMENT, { PLIANT_NAMED( pliant_frame_destroy( t.world, t.id ) ) }, Target{ scene.world, scene.ball } );
	explosion.radius = 0;
	scene.expectRefused( PLIANT_BAD_SETTINGS, { PLIANT_NAMED( pliant_world_explode_as( t.world, &explosion, &O::flag ) ) },
		Target{ scene.world, scene.soft } );
	EXPECT_EQ( scene.bodies().size(), 1u );
}

// A field may read the world, but not change it, as in C++.
TEST_F( FurtherMisuse, AFieldThatChangesTheWorld )
{
	struct Context
	{
		MisuseScene* scene;
		pliant_result results[3];
	} context = { &scene, { PLIANT_OK, PLIANT_OK, PLIANT_OK } };
	const pliant_acceleration field = []( const double*, double*, void* given ) {
		Context& c = *static_cast<Context*>( given );
		c.results[0] = pliant_body_set_kind( c.scene->world, c.scene->soft, 9 );
		c.results[1] = pliant_world_set_acceleration( c.scene->world, nullptr, nullptr );
		c.results[2] = pliant_body_apply_impulse( c.scene->world, c.scene->soft, -1, kUp );
	};
	ASSERT_EQ( pliant_world_set_acceleration( scene.world, field, &context ), PLIANT_OK );
	scene.step( 2 );
	for ( const pliant_result result : context.results )
	{
		EXPECT_EQ( result, PLIANT_BAD_ARGUMENT );
	}
}

} // namespace
} // namespace pliant
