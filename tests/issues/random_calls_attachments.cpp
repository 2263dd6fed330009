#include "issues/random_calls.h"

namespace pliant::test {

void RandomCalls::attach()
{
	SoftBody *const body = someSoft(), *const other = someSoft();
	btRigidBody* const rigid = someRigid();
	if ( !body || !other || !rigid )
	{
		return;
	}
	SoftBodyWorld& world = someWorld();
	AttachmentSettings settings;
	settings.compliance = oneIn( 3 ) ? some( -1, 1 ) / 100 : btScalar( 0 );
	settings.breakingForce = oneIn( 3 ) ? some( -10, 1000 ) : SIMD_INFINITY;
	const btVector3 near = body->massCentre() + someVector( btScalar( 0.3 ) );
	switch ( below( 6 ) )
	{
		case 0: (void)world.attach( *body, someNode( *body ), *rigid, settings ); break;
		case 1: (void)world.attach( *body, near, *rigid, settings ); break;
		case 2: (void)world.attach( *body, *other, near, settings ); break;
		case 3: (void)world.weld( *body, *other, some( -1, 2 ) / 5, settings ); break;
		default: world.detach( below( 20 ) - 1 );
	}
	(void)world.attachmentForce( below( 20 ) - 1 );
	for ( const AttachmentEvent& event : world.attachmentEvents() )
	{
		m_calls += event.force.length() > 0 ? 0 : 1;
	}
}

} // namespace pliant::test
