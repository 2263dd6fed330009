// +-----------------------------------------------------------------------------------------------------------------+
// | A scene in a window: pause, step, grab, and change the material's settings while it runs.                        |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/play.h"
#include "demos/run.h"

#if PLIANT_HAS_WINDOW
	#include "demos/mouse_blade.h"
	#include "demos/mouse_grab.h"
	#include "third_party_glue/renderer.h"
	#include "third_party_glue/window.h"
#endif

#include <cmath>
#include <cstdio>

namespace pliant_demos {

#if PLIANT_HAS_WINDOW

namespace {

constexpr int kMaxStepsPerPicture = 4; // on a slow machine motion slows down; otherwise the frame rate would fall further and further
constexpr pliant_glue::Colour kGrabColour = { 0.9f, 0.1f, 0.05f };

btVector3 toBullet( const pliant_glue::Vec3& v )
{
	return btVector3( btScalar( v[0] ), btScalar( v[1] ), btScalar( v[2] ) );
}

pliant_glue::Vec3 fromBullet( const btVector3& v )
{
	return { float( v.x() ), float( v.y() ), float( v.z() ) };
}

/// Sliders of the panel. They are multipliers, because each body has its own material.
struct Knobs
{
	float stiffness = 1, damping = 1, gravity = 9.81f, substeps = 4;

	bool operator==( const Knobs& ) const = default;
};

/// One run of the scene; "restart" makes a new one.
class Life
{
public:
	Life( const SceneEntry& entry, const RunSettings& settings ) :
		m_play( entry, settings.stage ), m_grab( m_play.stage().world() ), m_blade( m_play.stage().world() )
	{
		forEachBody( [this]( pliant::SoftBody& body ) {
			body.setUserIndex3( int( m_materials.size() ) ); // pieces inherit it
			m_materials.push_back( body.material() );
		} );
		m_knobs.substeps = float( m_play.stage().world().softSubsteps() );
	}

	Play& play() { return m_play; }
	MouseGrab& mouse() { return m_grab; }
	MouseBlade& blade() { return m_blade; }

	void step()
	{
		m_grab.apply();
		m_play.step();
	}

	void turn( const Knobs& knobs )
	{
		if ( knobs == m_knobs )
		{
			return;
		}
		m_knobs = knobs;
		for ( Stage* stage : m_play.stages() )
		{
			stage->host().bulletWorld().setGravity( btVector3( 0, btScalar( -knobs.gravity ), 0 ) );
			stage->host().setSoftSubsteps( int( std::lround( knobs.substeps ) ) );
		}
		forEachBody( [&]( pliant::SoftBody& body ) {
			pliant::Material material = m_materials[std::size_t( body.getUserIndex3() )];
			material.youngsModulus *= knobs.stiffness;
			material.damping *= knobs.damping;
			if ( const pliant::Status status = body.setMaterial( material ); !status.ok() )
			{
				std::fprintf( stderr, "%s\n", status.sentence.c_str() );
			}
		} );
	}

private:
	template <class Visit>
	void forEachBody( Visit visit )
	{
		for ( Stage* stage : m_play.stages() )
		{
			for ( int i = 0; i < stage->host().softBodyCount(); ++i )
			{
				visit( *stage->host().softBody( i ) );
			}
		}
	}

	Play m_play;
	MouseGrab m_grab; // releases its body before the stage is destroyed
	MouseBlade m_blade;
	std::vector<pliant::Material> m_materials;
	Knobs m_knobs;
};

class WindowRun
{
public:
	WindowRun( const SceneEntry& entry, const RunSettings& settings ) : m_entry( entry ), m_settings( settings ) {}

	int run()
	{
		std::string why;
		m_window = pliant_glue::Window::create(
			std::string( "Pliant: " ) + m_entry.name, m_settings.width * 4 / 3, m_settings.height * 4 / 3, why );
		m_renderer = m_window == nullptr ? nullptr : pliant_glue::Renderer::create( why );
		if ( m_renderer == nullptr )
		{
			std::fprintf( stderr, "No window: %s. Without --window the scene is written into files.\n", why.c_str() );
			return 1;
		}
		if ( !restart() )
		{
			return 1;
		}
		m_panel.title = m_entry.name;
		m_panel.sliders = { { "stiffness x", &m_knobs.stiffness, 0.1f, 10.0f, true }, { "damping x", &m_knobs.damping, 0.0f, 10.0f, false },
			{ "gravity, m/s2", &m_knobs.gravity, 0.0f, 20.0f, false }, { "substeps", &m_knobs.substeps, 1.0f, 16.0f, false } };
		m_list.camera = m_life->play().scene().camera( 0 );
		m_followed = m_list.camera.target;
		while ( m_window->takeInput( m_list.camera ) && ( m_settings.frames == 0 || m_pictures < m_settings.frames ) )
		{
			if ( m_panel.restart && !restart() )
			{
				return 1;
			}
			m_life->turn( m_knobs );
			useMouse();
			useKeys();
			advance();
			show();
			++m_pictures;
		}
		return 0;
	}

private:
	bool restart()
	{
		m_life = std::make_unique<Life>( m_entry, m_settings );
		if ( !m_life->play().isGood() )
		{
			std::fprintf( stderr, "%s: %s\n", m_entry.name, m_life->play().stage().status().sentence.c_str() );
		}
		m_list.light = m_life->play().scene().light();
		return m_life->play().isGood();
	}

	void useMouse()
	{
		MouseGrab& mouse = m_life->mouse();
		const pliant_glue::MouseRay ray = m_window->mouseRay( m_list.camera );
		const bool isDown = m_window->isGrabbing();
		if ( isDown && !m_wasDown )
		{
			mouse.grab( toBullet( ray.from ), toBullet( ray.direction ) );
		}
		else if ( isDown && mouse.isHolding() )
		{
			mouse.move( toBullet( ray.from ), toBullet( ray.direction ) );
		}
		else if ( !isDown )
		{
			mouse.release();
		}
		m_wasDown = isDown;
		if ( m_window->isCutting() )
		{
			m_life->blade().move( toBullet( ray.from ), toBullet( ray.direction ) );
		}
		else
		{
			m_life->blade().lift();
		}
	}

	/// Lets the camera follow the one of a scene that is played.
	void useKeys()
	{
		const pliant_glue::WindowKeys held = m_window->keys();
		const Play& play = m_life->play();
		const pliant_glue::Vec3 target = play.scene().camera( play.seconds() ).target;
		if ( m_life->play().scene().takeKeys( { held.ahead, held.aside, held.space, held.tab } ) )
		{
			for ( std::size_t k = 0; k < 3; ++k )
			{
				m_list.camera.eye[k] += target[k] - m_followed[k];
				m_list.camera.target[k] += target[k] - m_followed[k];
			}
		}
		m_followed = target;
	}

	void advance()
	{
		m_unspent += m_window->secondsSinceLastPicture();
		int steps = std::min( int( m_unspent * kStepsPerSecond ), kMaxStepsPerPicture );
		m_unspent = steps == kMaxStepsPerPicture ? 0 : m_unspent - double( steps ) / kStepsPerSecond;
		if ( m_panel.paused )
		{
			steps = m_panel.stepOnce ? 1 : 0;
		}
		for ( int k = 0; k < steps; ++k )
		{
			m_life->step();
		}
	}

	void show()
	{
		m_list.clear();
		m_life->play().skin();
		m_life->play().draw( m_list, m_panel.showNodes );
		if ( m_life->mouse().isHolding() )
		{
			m_list.lines.push_back( { fromBullet( m_life->mouse().heldPoint() ), fromBullet( m_life->mouse().target() ), kGrabColour } );
		}
		m_renderer->draw( m_list, m_window->width(), m_window->height() );
		const pliant::StepReport& report = m_life->play().stage().world().stepReport();
		char line[128];
		m_panel.lines.clear();
		std::snprintf( line, sizeof( line ), "%.1f s   %d nodes, %d soft contacts, %d of %d bodies awake", m_life->play().seconds(),
			report.nodes, report.softContacts, report.awakeSoftBodies, report.softBodies );
		m_panel.lines.emplace_back( line );
		std::snprintf( line, sizeof( line ), "%.2f ms a step, %d substeps", 1e3 * report.total, report.substeps );
		m_panel.lines.emplace_back( line );
		std::snprintf( line, sizeof( line ), "matching %.2f  collision %.2f  solve %.2f ms", 1e3 * report.matching, 1e3 * report.collision,
			1e3 * report.solve );
		m_panel.lines.emplace_back( line );
		m_window->present( m_panel );
	}

	const SceneEntry& m_entry;
	RunSettings m_settings;
	std::unique_ptr<pliant_glue::Window> m_window; // outlives the renderer, whose objects live in its context
	std::unique_ptr<pliant_glue::Renderer> m_renderer;
	std::unique_ptr<Life> m_life;
	pliant_glue::WindowPanel m_panel;
	pliant_glue::DrawList m_list;
	pliant_glue::Vec3 m_followed = {}; ///< previous target of the scene's camera
	Knobs m_knobs;
	double m_unspent = 0;
	bool m_wasDown = false;
	int m_pictures = 0;
};

} // namespace

int runInWindow( const SceneEntry& entry, const RunSettings& settings )
{
	return WindowRun( entry, settings ).run();
}

#else

int runInWindow( const SceneEntry&, const RunSettings& )
{
	std::fprintf( stderr, "No window: built without libglfw3-dev and libimgui-dev. Without --window the scene is written into files.\n" );
	return 1;
}

#endif

} // namespace pliant_demos
