// Debug drawing by a function of the program.

#include "c/handles.h"
#include "c/numbers.h"
#include "c/settings.h"
#include "pliant/c/debug.h"
#include "pliant/game/debug_draw.h"

#include <LinearMath/btIDebugDraw.h>

#include <cmath>

namespace pliant::c {

template <class F>
void fields( F& f, pliant_debug_drawing& c, DebugDrawing& m )
{
	f( c.surface_links, m.surfaceLinks );
	f( c.links, m.links );
	f( c.cells, m.cells );
	f( c.strain, m.strain );
	f( c.levels, m.levels );
	f( c.regions, m.regions );
	f( c.pins, m.pins );
	f( c.attachments, m.attachments );
	f( c.contacts, m.contacts );
	f( c.full_strain, m.fullStrain );
	f( c.metres_per_newton, m.metresPerNewton );
	f( c.metres_per_impulse, m.metresPerImpulse );
}

namespace {

pliant_debug_drawing defaultDrawing()
{
	auto drawing = inC<pliant_debug_drawing>( DebugDrawing{} );
	drawing.bullet_mode = btIDebugDraw::DBG_DrawWireframe | btIDebugDraw::DBG_DrawConstraints;
	return drawing;
}

/// Passes lines to a function of the program while it exists, and has the world's own settings back afterwards.
class Drawer : public btIDebugDraw
{
public:
	Drawer( SoftBodyHost& host, const DebugDrawing& what, int mode, pliant_draw_line line, void* context ) :
		m_host( host ), m_before( host.debugDrawing() ), m_drawerBefore( host.bulletWorld().getDebugDrawer() ), m_mode( mode ),
		m_line( line ), m_context( context )
	{
		host.setDebugDrawing( what );
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
	return initSized( defaultDrawing(), drawing, size );
}

pliant_result pliant_world_draw( pliant_world* world, const pliant_debug_drawing* drawing, pliant_draw_line line, void* context )
{
	return withWorld( world, [&]( SoftBodyHost& host ) {
		requirePointers( line );
		pliant_debug_drawing full = defaultDrawing();
		const auto what = take<DebugDrawing>( drawing, full );
		rejectIf( !( full.full_strain > 0 ) || !std::isfinite( full.full_strain ) || !std::isfinite( full.metres_per_newton ) ||
				!std::isfinite( full.metres_per_impulse ),
			PLIANT_BAD_ARGUMENT, "The full strain must be above 0, and all lengths must be finite." );
		const Drawer drawer( host, what, full.bullet_mode, line, context );
		host.bulletWorld().debugDrawWorld();
	} );
}
