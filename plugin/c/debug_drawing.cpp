// Debug drawing by a function of the program.

#include "c/handles.h"
#include "c/numbers.h"
#include "pliant/c/debug.h"
#include "pliant/game/debug_draw.h"

#include <LinearMath/btIDebugDraw.h>

#include <cmath>

namespace pliant::c {

namespace {

pliant_debug_drawing inC( const DebugDrawing& drawing )
{
	pliant_debug_drawing c{};
	c.bullet_mode = btIDebugDraw::DBG_DrawWireframe | btIDebugDraw::DBG_DrawConstraints;
	c.surface_links = drawing.surfaceLinks ? 1 : 0;
	c.links = drawing.links ? 1 : 0;
	c.cells = drawing.cells ? 1 : 0;
	c.strain = drawing.strain ? 1 : 0;
	c.levels = drawing.levels ? 1 : 0;
	c.regions = drawing.regions ? 1 : 0;
	c.pins = drawing.pins ? 1 : 0;
	c.attachments = drawing.attachments ? 1 : 0;
	c.contacts = drawing.contacts ? 1 : 0;
	c.full_strain = double( drawing.fullStrain );
	c.metres_per_newton = double( drawing.metresPerNewton );
	c.metres_per_impulse = double( drawing.metresPerImpulse );
	return c;
}

DebugDrawing inCpp( const pliant_debug_drawing& c )
{
	DebugDrawing drawing;
	drawing.surfaceLinks = c.surface_links != 0;
	drawing.links = c.links != 0;
	drawing.cells = c.cells != 0;
	drawing.strain = c.strain != 0;
	drawing.levels = c.levels != 0;
	drawing.regions = c.regions != 0;
	drawing.pins = c.pins != 0;
	drawing.attachments = c.attachments != 0;
	drawing.contacts = c.contacts != 0;
	drawing.fullStrain = btScalar( c.full_strain );
	drawing.metresPerNewton = btScalar( c.metres_per_newton );
	drawing.metresPerImpulse = btScalar( c.metres_per_impulse );
	return drawing;
}

/// Passes lines to a function of the program while it exists, and has the world's own settings back afterwards.
class Drawer : public btIDebugDraw
{
public:
	Drawer( SoftBodyHost& host, const pliant_debug_drawing& what, pliant_draw_line line, void* context ) :
		m_host( host ), m_before( host.debugDrawing() ), m_drawerBefore( host.bulletWorld().getDebugDrawer() ), m_mode( what.bullet_mode ),
		m_line( line ), m_context( context )
	{
		host.setDebugDrawing( inCpp( what ) );
		host.bulletWorld().setDebugDrawer( this );
	}
	~Drawer() override
	{
		m_host.bulletWorld().setDebugDrawer( m_drawerBefore );
		m_host.setDebugDrawing( m_before );
	}
	Drawer( const Drawer& ) = delete;
	Drawer& operator=( const Drawer& ) = delete;

	void drawLine( const btVector3& from, const btVector3& to, const btVector3& colour ) override
	{
		const double points[3][3] = { { double( from.x() ), double( from.y() ), double( from.z() ) },
			{ double( to.x() ), double( to.y() ), double( to.z() ) },
			{ double( colour.x() ), double( colour.y() ), double( colour.z() ) } };
		m_line( points[0], points[1], points[2], m_context );
	}
	void drawContactPoint( const btVector3& at, const btVector3& normal, btScalar, int, const btVector3& colour ) override
	{
		drawLine( at, at + normal * btScalar( kContactNormalLength ), colour );
	}
	void reportErrorWarning( const char* ) override {}
	void draw3dText( const btVector3&, const char* ) override {}
	void setDebugMode( int mode ) override { m_mode = mode; }
	int getDebugMode() const override { return m_mode; }

private:
	SoftBodyHost& m_host;
	const DebugDrawing m_before;
	btIDebugDraw* m_drawerBefore;
	int m_mode;
	pliant_draw_line m_line;
	void* m_context;
};

} // namespace

} // namespace pliant::c

using namespace pliant;
using namespace pliant::c;

pliant_result pliant_debug_drawing_init( pliant_debug_drawing* drawing, uint32_t size )
{
	return writeSized( inC( DebugDrawing{} ), drawing, size );
}

pliant_result pliant_world_draw( pliant_world* world, const pliant_debug_drawing* drawing, pliant_draw_line line, void* context )
{
	return withWorld( world, [&]( SoftBodyHost& host ) {
		pliant_debug_drawing full = inC( DebugDrawing{} );
		if ( !line )
		{
			return refuseNull();
		}
		if ( const pliant_result result = readSized( drawing, full ); result != PLIANT_OK )
		{
			return result;
		}
		if ( !( full.full_strain > 0 ) || !std::isfinite( full.full_strain ) || !std::isfinite( full.metres_per_newton ) ||
			!std::isfinite( full.metres_per_impulse ) )
		{
			return refuse( PLIANT_BAD_ARGUMENT, "The full strain must be above 0, and all lengths must be finite." );
		}
		const Drawer drawer( host, full, line, context );
		host.bulletWorld().debugDrawWorld();
		return pliant_result( PLIANT_OK );
	} );
}
