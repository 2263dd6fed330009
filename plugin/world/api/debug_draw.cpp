#include "world/api/debug_draw.h"

#include "body/levels/levels.h"
#include "world/bodies/soft_body_impl.h"
#include "world/step/soft_body_system.h"

#include <LinearMath/btIDebugDraw.h>

namespace pliant {

namespace {

const btVector3 kPinColour( btScalar( 1.0 ), btScalar( 0.3 ), btScalar( 0.2 ) );

/// Draws the links through faces between cells at the surface: the other links of a cell, and those inside, would only hide them.
void drawSurfaceLinks( const SoftBody::Impl& impl, const btVector3& colour, btIDebugDraw& drawer )
{
	const Levels* levels = impl.body->levels();
	const auto nodeOf = [levels]( int cell ) { return levels ? int( levels->cut().slotOfCell[std::size_t( cell )] ) : cell; };
	const Lattice& lattice = impl.body->lattice();
	for ( int i = 0; i < lattice.cellCount(); ++i )
	{
		for ( std::uint32_t k = lattice.linkStart[i]; k < lattice.linkStart[i + 1] && lattice.isSurface[i] != 0; ++k )
		{
			const int j = int( lattice.linkTo[k] );
			const auto step = lattice.coordinate[j] - lattice.coordinate[i];
			if ( j > i && lattice.isSurface[j] != 0 && step.cwiseAbs().sum() == 1 && nodeOf( i ) != nodeOf( j ) )
			{
				drawer.drawLine( impl.position( nodeOf( i ) ), impl.position( nodeOf( j ) ), colour );
			}
		}
	}
}

} // namespace

bool drawSoftBody( const SoftBodySystem& bodies, const btCollisionShape* shape, const btVector3& colour, btIDebugDraw& drawer )
{
	for ( const SoftBody* body : bodies.bodies() )
	{
		const SoftBody::Impl& impl = body->impl();
		if ( impl.queried.get() == shape )
		{
			if ( impl.body->nodeCount() == 1 )
			{
				drawer.drawSphere( impl.position( 0 ), impl.shape->largestRadius(), colour );
			}
			drawSurfaceLinks( impl, colour, drawer );
			return true;
		}
	}
	return false;
}

void drawPins( const SoftBodySystem& bodies, btIDebugDraw& drawer )
{
	for ( const SoftBody* body : bodies.bodies() )
	{
		const SoftBody::Impl& impl = body->impl();
		for ( std::size_t k = 0; k < impl.pins.size() && ( drawer.getDebugMode() & btIDebugDraw::DBG_DrawConstraints ) != 0; ++k )
		{
			const btVector3 at = impl.position( impl.pins[k].node );
			for ( int axis = 0; axis < 3; ++axis )
			{
				btVector3 arm( 0, 0, 0 );
				arm[axis] = impl.shape->sphereOfNode( impl.pins[k].node )->getRadius();
				drawer.drawLine( at - arm, at + arm, kPinColour );
			}
		}
	}
}

} // namespace pliant
