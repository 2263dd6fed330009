#include "world/api/debug_draw.h"

#include "body/levels/levels.h"
#include "world/bodies/soft_body_impl.h"
#include "world/step/soft_body_system.h"

#include <BulletDynamics/Dynamics/btRigidBody.h>
#include <LinearMath/btIDebugDraw.h>

#include <algorithm>
#include <iterator>

namespace pliant {

namespace {

const btVector3 kPinColour( btScalar( 1.0 ), btScalar( 0.3 ), btScalar( 0.2 ) );
const btVector3 kLinkColour( btScalar( 0.4 ), btScalar( 0.4 ), btScalar( 0.4 ) );
const btVector3 kCellColour( 1, 1, 1 );
const btVector3 kAttachmentColour( 1, 1, 0 );
const btVector3 kImpulseColour( 1, 0, 1 );
/// By level: red, yellow, green, blue.
const btVector3 kLevelColours[] = { btVector3( 1, 0, 0 ), btVector3( 1, 1, 0 ), btVector3( 0, 1, 0 ), btVector3( 0, 0, 1 ) };
constexpr int kLevelColourCount = int( std::size( kLevelColours ) );

int nodeOf( const SoftBody::Impl& impl, std::uint32_t cell )
{
	return impl.body->nodeOfCell( cell );
}

/// Calls draw( cell, neighbour ) for each link between two nodes.
template <class F>
void forLinks( const SoftBody::Impl& impl, F&& draw )
{
	const Lattice& lattice = impl.body->lattice();
	for ( std::uint32_t i = 0; i < std::uint32_t( lattice.cellCount() ); ++i )
	{
		for ( std::uint32_t k = lattice.linkStart[i]; k < lattice.linkStart[i + 1]; ++k )
		{
			const std::uint32_t j = lattice.linkTo[k];
			if ( j > i && nodeOf( impl, i ) != nodeOf( impl, j ) )
			{
				draw( i, j );
			}
		}
	}
}

/// Links through faces between cells at the surface: the other links of a cell, and those inside, would only hide them.
bool isAtSurface( const Lattice& lattice, std::uint32_t i, std::uint32_t j )
{
	const auto step = lattice.coordinate[j] - lattice.coordinate[i];
	return lattice.isSurface[i] != 0 && lattice.isSurface[j] != 0 && step.cwiseAbs().sum() == 1;
}

btVector3 colourOf( double stretch )
{
	const btScalar most = btScalar( std::clamp( std::fabs( stretch ), 0.0, 1.0 ) );
	return stretch < 0.0 ? btVector3( 0, 1 - most, most ) : btVector3( most, 1 - most, 0 );
}

void drawLinks( const SoftBody::Impl& impl, const btVector3& colour, btIDebugDraw& drawer, const DebugDrawing& what )
{
	const NodeState& nodes = impl.body->nodes();
	const double full = double( what.fullStrain );
	forLinks( impl, [&]( std::uint32_t i, std::uint32_t j ) {
		const int a = nodeOf( impl, i ), b = nodeOf( impl, j );
		const bool isDrawn = ( what.surfaceLinks || what.strain ) && isAtSurface( impl.body->lattice(), i, j );
		if ( isDrawn && what.strain )
		{
			const double rest = double( ( nodes.x0.get( b ) - nodes.x0.get( a ) ).norm() );
			const double now = double( ( nodes.x.get( b ) - nodes.x.get( a ) ).norm() );
			drawer.drawLine( impl.position( a ), impl.position( b ), colourOf( ( now / rest - 1.0 ) / full ) );
		}
		else if ( isDrawn || what.links )
		{
			drawer.drawLine( impl.position( a ), impl.position( b ), isDrawn ? colour : kLinkColour );
		}
	} );
}

void drawCells( const SoftBody::Impl& impl, btIDebugDraw& drawer )
{
	BodyBoundary boundary;
	boundary.update( *impl.body, impl.fractureVersion );
	const btVector3 origin = impl.worldOrigin();
	for ( const std::array<std::uint32_t, 4>& quad : boundary.cells().quads )
	{
		for ( std::size_t k = 0; k < 4; ++k )
		{
			drawer.drawLine( origin + toBt( boundary.position( int( quad[k] ) ) ),
				origin + toBt( boundary.position( int( quad[( k + 1 ) % 4] ) ) ), kCellColour );
		}
	}
}

void drawNodes( const SoftBody::Impl& impl, const SoftBody& body, btIDebugDraw& drawer, const DebugDrawing& what )
{
	std::vector<float> rotations( what.regions ? 4 * std::size_t( body.nodeCount() ) : 0 );
	if ( what.regions )
	{
		impl.body->nodeRotations( rotations.data() );
	}
	for ( int i = 0; i < body.nodeCount(); ++i )
	{
		if ( what.levels )
		{
			drawer.drawSphere(
				impl.position( i ), body.nodeRadius( i ), kLevelColours[std::min( body.nodeLevel( i ), kLevelColourCount - 1 )] );
		}
		if ( what.regions )
		{
			const float* const q = rotations.data() + 4 * std::size_t( i );
			drawer.drawTransform( btTransform( btQuaternion( q[0], q[1], q[2], q[3] ), impl.position( i ) ), body.nodeRadius( i ) );
		}
	}
}

void drawPins( const SoftBody::Impl& impl, btIDebugDraw& drawer )
{
	for ( const Pin& pin : impl.pins )
	{
		const btVector3 at = impl.position( pin.node );
		for ( int axis = 0; axis < 3; ++axis )
		{
			btVector3 arm( 0, 0, 0 );
			arm[axis] = impl.shape->sphereOfNode( pin.node )->getRadius();
			drawer.drawLine( at - arm, at + arm, kPinColour );
		}
	}
}

void drawAttachments( const Attachments& attachments, btIDebugDraw& drawer, const DebugDrawing& what )
{
	for ( const Attachment& attachment : attachments.all() )
	{
		const btVector3 first = toBt( positionOf( attachment.first ) );
		const btVector3 second = attachment.rigid ? attachment.rigid->getWorldTransform() * toBt( attachment.rigidPoint )
												  : toBt( positionOf( attachment.second ) );
		drawer.drawLine( first, second, kAttachmentColour );
		drawer.drawLine( first, first + toBt( attachment.force ) * what.metresPerNewton, kImpulseColour );
	}
}

void drawContacts( btDispatcher& dispatcher, btIDebugDraw& drawer, const DebugDrawing& what )
{
	for ( int m = 0; m < dispatcher.getNumManifolds(); ++m )
	{
		const btPersistentManifold& manifold = *dispatcher.getManifoldByIndexInternal( m );
		const bool isFirst = isContactProxy( manifold.getBody0() );
		for ( int k = 0; k < manifold.getNumContacts() && ( isFirst || isContactProxy( manifold.getBody1() ) ); ++k )
		{
			const btManifoldPoint& point = manifold.getContactPoint( k );
			const btScalar length = ( isFirst ? what.metresPerImpulse : -what.metresPerImpulse ) * point.getAppliedImpulse();
			const btVector3& at = point.getPositionWorldOnB();
			drawer.drawLine( at, at + length * point.m_normalWorldOnB, kImpulseColour );
		}
	}
}

} // namespace

bool drawSoftBody(
	const SoftBodySystem& bodies, const btCollisionShape* shape, const btVector3& colour, btIDebugDraw& drawer, const DebugDrawing& what )
{
	const auto found = std::find_if(
		bodies.bodies().begin(), bodies.bodies().end(), [shape]( const SoftBody* body ) { return body->impl().queried.get() == shape; } );
	if ( found == bodies.bodies().end() )
	{
		return false;
	}
	const SoftBody::Impl& impl = ( *found )->impl();
	if ( impl.body->nodeCount() == 1 )
	{
		drawer.drawSphere( impl.position( 0 ), impl.shape->largestRadius(), colour );
	}
	if ( what.surfaceLinks || what.strain || what.links )
	{
		drawLinks( impl, colour, drawer, what );
	}
	if ( what.cells )
	{
		drawCells( impl, drawer );
	}
	if ( what.levels || what.regions )
	{
		drawNodes( impl, **found, drawer, what );
	}
	return true;
}

void drawBetweenBodies( const SoftBodySystem& bodies, btIDebugDraw& drawer, const DebugDrawing& what )
{
	const int mode = drawer.getDebugMode();
	const bool drawsJoints = ( mode & btIDebugDraw::DBG_DrawConstraints ) != 0;
	for ( std::size_t k = 0; k < bodies.bodies().size() && drawsJoints && what.pins; ++k )
	{
		drawPins( bodies.bodies()[k]->impl(), drawer );
	}
	if ( drawsJoints && what.attachments )
	{
		drawAttachments( bodies.attachments, drawer, what );
	}
	if ( ( mode & btIDebugDraw::DBG_DrawContactPoints ) != 0 && what.contacts )
	{
		drawContacts( *const_cast<btDiscreteDynamicsWorld&>( bodies.world() ).getDispatcher(), drawer, what );
	}
}

} // namespace pliant
