/* A small game in plain C: a soft block on a floor, hit by a ball, that breaks; a save before and a restore after. Returns 0 where all of it
   goes as it should. */
#include "pliant/c/pliant.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static int failures = 0;

static void expect( int is_true, const char* what )
{
	if ( !is_true )
	{
		printf( "FAILED: %s (%s)\n", what, pliant_last_error() );
		++failures;
	}
}

static void must( pliant_result result, const char* what )
{
	if ( result != PLIANT_OK )
	{
		printf( "FAILED: %s: %s: %s\n", what, pliant_result_name( result ), pliant_last_error() );
		++failures;
	}
}

static pliant_vec3 vec( double x, double y, double z )
{
	pliant_vec3 v;
	v.x = x;
	v.y = y;
	v.z = z;
	return v;
}

static pliant_template* make_block( void )
{
	static const float corners[] = { 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1 };
	static const uint32_t triangles[] = {
		2, 1, 0, 3, 2, 0, 4, 5, 6, 4, 6, 7, 0, 1, 5, 0, 5, 4, 2, 3, 7, 2, 7, 6, 1, 2, 6, 1, 6, 5, 0, 4, 7, 0, 7, 3 };
	pliant_mesh mesh;
	pliant_lattice_settings lattice;
	pliant_template* made = NULL;
	must( pliant_mesh_init( &mesh, sizeof mesh ), "mesh" );
	mesh.positions = corners;
	mesh.vertex_count = 8;
	mesh.indices = triangles;
	mesh.triangle_count = 12;
	must( pliant_lattice_settings_init( &lattice, sizeof lattice ), "lattice" );
	lattice.cell_size = 0.2f;
	must( pliant_template_build( &mesh, &lattice, &made ), "template" );
	return made;
}

static pliant_id make_body( pliant_world* world, const pliant_template* block )
{
	pliant_material material;
	pliant_fracture fracture;
	pliant_body_settings settings;
	pliant_id body = 0;
	must( pliant_material_init( &material, sizeof material ), "material" );
	material.youngs_modulus = 1e5f;
	material.volume_keeping = 0.5f;
	must( pliant_fracture_init( &fracture, sizeof fracture ), "fracture" );
	fracture.rule = PLIANT_BREAK_PLANE;
	fracture.break_strain = 0.1f;
	must( pliant_body_settings_init( &settings, sizeof settings ), "settings" );
	settings.pose.position = vec( 0, 0.05, 0 );
	settings.material = &material;
	settings.fracture = &fracture;
	settings.user_data = 7;
	must( pliant_body_create( world, block, &settings, &body ), "body" );
	return body;
}

/* Steps until something comes off; returns the number of steps, -1 where nothing does. */
static int step_until_broken( pliant_world* world, int most )
{
	int k;
	for ( k = 0; k < most; ++k )
	{
		uint64_t events = 0, index, fragments = 0;
		must( pliant_world_step( world, 1.0 / 60.0, 1, 1.0 / 60.0, NULL ), "step" );
		must( pliant_world_get_fracture_count( world, &events ), "events" );
		for ( index = 0; index < events; ++index )
		{
			pliant_fracture_event event;
			must( pliant_world_get_fracture( world, index, &event, sizeof event ), "event" );
			fragments += event.fragments;
		}
		if ( fragments > 0 )
		{
			return k + 1;
		}
	}
	return -1;
}

static void check_fragments( pliant_world* world, pliant_id body )
{
	pliant_id fragments[64];
	uint64_t count = 0, data = 0;
	pliant_fracture_event event;
	pliant_body_state state;
	must( pliant_world_get_fracture( world, 0, &event, sizeof event ), "event" );
	expect( event.body == body && event.links > 0 && event.area > 0, "the event names the body" );
	must( pliant_world_get_fragments( world, 0, fragments, 64, &count ), "fragments" );
	expect( count == event.fragments && count > 0, "as many fragments as the event says" );
	must( pliant_body_get_state( world, fragments[0], &state, sizeof state ), "state of a fragment" );
	expect( state.nodes > 0 && state.mass > 0 && isfinite( state.mass_centre.y ), "a fragment has mass" );
	must( pliant_object_get_user_data( world, fragments[0], &data ), "user data" );
	expect( data == 7, "a fragment has the user data of its body" );
}

static void check_ray( pliant_world* world, pliant_id body, pliant_id floor )
{
	pliant_ray_hit hit;
	must( pliant_world_cast_ray( world, vec( 0.45, 5, 0.55 ), vec( 0.45, -5, 0.55 ), -1, -1, &hit, sizeof hit ), "ray" );
	expect( hit.object == body && hit.node >= 0 && fabs( hit.point.y - 1 ) < 0.2 && hit.normal.y > 0.9, "a ray meets the body" );
	must( pliant_world_cast_ray( world, vec( 9, 5, 9 ), vec( 9, -5, 9 ), -1, -1, &hit, sizeof hit ), "ray" );
	expect( hit.object == floor && hit.node == -1 && fabs( hit.point.y ) < 1e-3, "a ray meets the floor" );
	must( pliant_world_cast_ray( world, vec( 9, 5, 9 ), vec( 9, 4, 9 ), -1, -1, &hit, sizeof hit ), "ray" );
	expect( hit.object == 0 && hit.fraction == 1, "a ray meets nothing" );
}

static double sum_of_positions( pliant_world* world )
{
	pliant_id bodies[64];
	uint64_t count = 0, k;
	double sum = 0;
	must( pliant_world_get_bodies( world, bodies, 64, &count ), "bodies" );
	for ( k = 0; k < count && k < 64; ++k )
	{
		uint64_t nodes = 0, n;
		double* positions;
		must( pliant_body_get_positions( world, bodies[k], NULL, 0, &nodes ), "number of nodes" );
		positions = (double*)malloc( (size_t)( 3 * nodes ) * sizeof( double ) );
		must( pliant_body_get_positions( world, bodies[k], positions, nodes, &nodes ), "positions" );
		for ( n = 0; n < 3 * nodes; ++n )
		{
			sum += positions[n] * (double)( n % 7 + 1 );
		}
		free( positions );
	}
	return sum;
}

static void check_surface( pliant_world* world, pliant_id body )
{
	pliant_surface surface;
	int32_t k;
	must( pliant_body_get_surface( world, body, &surface, sizeof surface ), "surface" );
	expect( surface.vertices > 8 && surface.triangles > 12, "a broken body has crack faces" );
	for ( k = 0; k < 3 * surface.triangles; ++k )
	{
		expect( surface.indices[k] < (uint32_t)surface.vertices, "an index is that of a vertex" );
	}
	expect( isfinite( surface.origin.x + surface.positions[0] + surface.normals[0] ), "vertices are numbers" );
}

int main( void )
{
	pliant_world* world = NULL;
	pliant_template* block = make_block();
	pliant_buffer* bytes = NULL;
	pliant_rigid_settings ball;
	pliant_step_report report;
	pliant_id floor = 0, hammer = 0, body;
	double first, second;
	int steps;

	must( pliant_world_create( NULL, &world ), "world" );
	must( pliant_rigid_create_plane( world, vec( 0, 1, 0 ), NULL, &floor ), "floor" );
	body = make_body( world, block );
	pliant_template_release( block );
	must( pliant_world_step( world, 1.0 / 60.0, 1, 1.0 / 60.0, NULL ), "step" );
	check_ray( world, body, floor );
	must( pliant_rigid_settings_init( &ball, sizeof ball ), "ball" );
	ball.mass = 200;
	ball.pose.position = vec( 0.5, 1.6, 0.5 );
	ball.linear_velocity = vec( 0, -15, 0 );
	must( pliant_rigid_create_sphere( world, 0.3, &ball, &hammer ), "hammer" );

	must( pliant_buffer_create( &bytes ), "buffer" );
	must( pliant_world_save( world, PLIANT_SAVE_STATE_ONLY, bytes ), "save" );
	steps = step_until_broken( world, 120 );
	expect( steps > 0, "the block breaks" );
	check_fragments( world, body );
	check_surface( world, body );
	first = sum_of_positions( world );
	must( pliant_world_restore( world, pliant_buffer_data( bytes ), pliant_buffer_size( bytes ), NULL, 0 ), "restore" );
	expect( step_until_broken( world, 120 ) == steps, "it breaks again in the same step" );
	second = sum_of_positions( world );
	expect( first == second, "to the same bits" );
	must( pliant_world_get_report( world, &report, sizeof report ), "report" );
	expect( report.soft_bodies > 0 && report.fragments > 0 && report.broken_links > 0 && report.milliseconds > 0 && report.quarantined == 0, "the report says so" );
	printf( "pliant %x in C: %d pieces came off in step %d, %d links broke, %.3f ms\n", pliant_version(), report.fragments, steps, report.broken_links, report.milliseconds );

	must( pliant_object_destroy( world, body ), "destroy" );
	expect( pliant_object_wake( world, body ) == PLIANT_NO_SUCH_OBJECT, "its identity names nothing any more" );
	pliant_buffer_destroy( bytes );
	pliant_world_destroy( world );
	return failures == 0 ? 0 : 1;
}
