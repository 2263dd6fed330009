#include "world/debug_draw.h"

#include "body/levels.h"
#include "world/soft_body_impl.h"
#include "world/soft_body_system.h"

#include <LinearMath/btIDebugDraw.h>

namespace pliant {

namespace {

const btVector3 kLinkColour( btScalar( 0.3 ), btScalar( 0.6 ), btScalar( 0.9 ) );
const btVector3 kPinColour( btScalar( 1.0 ), btScalar( 0.3 ), btScalar( 0.2 ) );

void drawLinks( const SoftBody::Impl& impl, btIDebugDraw& drawer )
{
	// The six face links only: all 26 hide one another.
	const Levels* levels = impl.body->levels();
	const auto nodeOf = [levels]( int cell ) { return levels ? int( levels->cut().slotOfCell[std::size_t( cell )] ) : cell; };
	const Lattice& lattice = impl.body->lattice();
	for ( int i = 0; i < lattice.cellCount(); ++i )
	{
		for ( std::uint32_t k = lattice.linkStart[i]; k < lattice.linkStart[i + 1]; ++k )
		{
			const int j = int( lattice.linkTo[k] );
			const auto step = lattice.coordinate[j] - lattice.coordinate[i];
			if ( j > i && step.cwiseAbs().sum() == 1 && nodeOf( i ) != nodeOf( j ) )
			{
				drawer.drawLine( impl.position( nodeOf( i ) ), impl.position( nodeOf( j ) ), kLinkColour );
			}
		}
	}
}

} // namespace

void drawSoftBodies( const SoftBodySystem& bodies, btIDebugDraw& drawer )
{
	const int mode = drawer.getDebugMode();
	for ( const SoftBody* body : bodies.bodies() )
	{
		const SoftBody::Impl& impl = body->impl();
		const bool isShown = ( body->getCollisionFlags() & btCollisionObject::CF_DISABLE_VISUALIZE_OBJECT ) == 0;
		if ( isShown && ( mode & btIDebugDraw::DBG_DrawWireframe ) != 0 )
		{
			drawLinks( impl, drawer );
		}
		if ( ( mode & btIDebugDraw::DBG_DrawConstraints ) != 0 )
		{
			for ( const Pin& pin : impl.pins )
			{
				drawer.drawSphere( impl.position( pin.node ), impl.shape->largestRadius(), kPinColour );
			}
		}
	}
}

} // namespace pliant
