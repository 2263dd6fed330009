/* The same project's part in C: a soft cube falls, by the installed library's headers for C alone. */
#include <pliant/c/pliant.h>

#include <stdio.h>

int main( void )
{
	static const float corners[] = { 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1 };
	static const uint32_t triangles[] = {
		2, 1, 0, 3, 2, 0, 4, 5, 6, 4, 6, 7, 0, 1, 5, 0, 5, 4, 2, 3, 7, 2, 7, 6, 1, 2, 6, 1, 6, 5, 0, 4, 7, 0, 7, 3 };
	pliant_world* world = NULL;
	pliant_template* cube = NULL;
	pliant_id body = 0;
	pliant_mesh mesh;
	pliant_body_state before, after;
	int step, failed = 0;

	failed |= pliant_mesh_init( &mesh, sizeof mesh );
	mesh.positions = corners;
	mesh.vertex_count = 8;
	mesh.indices = triangles;
	mesh.triangle_count = 12;
	failed |= pliant_template_build( &mesh, NULL, &cube );
	failed |= pliant_world_create( NULL, &world );
	failed |= pliant_body_create( world, cube, NULL, &body );
	pliant_template_release( cube );
	failed |= pliant_body_get_state( world, body, &before, sizeof before );
	for ( step = 0; step < 60; ++step )
		failed |= pliant_world_step( world, 1.0 / 60.0, 1, 1.0 / 60.0, NULL );
	failed |= pliant_body_get_state( world, body, &after, sizeof after );
	pliant_world_destroy( world );
	if ( failed )
	{
		printf( "%s\n", pliant_last_error() );
		return 1;
	}
	printf( "pliant %u in C: %d nodes fell %.3f m in 1 s\n", (unsigned)pliant_version(), after.nodes, before.mass_centre.y - after.mass_centre.y );
	return before.mass_centre.y - after.mass_centre.y > 4.5 ? 0 : 1; /* g / 2 is 4.9 m */
}
