#include "issues/random_calls.h"

#include <pliant/game/queries.h>

namespace pliant::test {

// Calls that touch soft bodies alone: the bystanders are compared bit for bit.
void RandomCalls::game()
{
	SoftBody* const body = someSoft();
	SoftBodyWorld& world = someWorld();
	if ( !body )
	{
		return;
	}
	switch ( below( 10 ) )
	{
		case 0: (void)world.addForceField( m_wind ); break;
		case 1: (void)world.addForceField( m_water ); break;
		case 2: world.removeForceField( oneIn( 2 ) ? static_cast<ForceField&>( m_wind ) : m_water ); break;
		case 3: (void)m_wind.set( WindSettings{ someVector( 20 ), some( -1, 3 ), some( -1, 3 ), some( 0, 2 ) } ); break;
		case 4: m_water.wake(); break;
		case 5: (void)body->setGas( Gas{ GasLaw( below( 3 ) ), some( -1e4f, 1e5f ), some( 0, 1e5f ) } ); break;
		case 6: {
			const SurfaceQuery query( *body );
			m_calls += query.isInside( body->massCentre() ) || query.nearest( someVector( 2 ) ).node >= 0 ? 1 : 0;
			break;
		}
		default: body->setContactEvents( oneIn( 2 ) );
	}
	for ( const ContactEvent& event : world.contactEvents() )
	{
		m_calls += event.body && event.body->nodeCount() > 0 && event.other && event.other->getCollisionShape() ? 1 : 0;
	}
	m_calls += body->gasVolume() > 0 ? 1 : 0;
}

} // namespace pliant::test
