// +-----------------------------------------------------------------------------------------------------------------+
// | Frames as PNG, drawn without a window, and a film if ffmpeg is installed. A build without OpenGL reports that it  |
// | cannot draw.                                                                                                      |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/frame_sink.h"

#if PLIANT_HAS_GL
	#include "third_party_glue/offscreen.h"
	#include "third_party_glue/renderer.h"

	#include <cstdio>
	#include <cstdlib>
	#include <filesystem>
	#include <future>
#endif

namespace pliant_demos {

#if PLIANT_HAS_GL

namespace {

/// For a POSIX shell.
std::string quoted( const std::string& text )
{
	std::string safe = "'";
	for ( const char c : text )
	{
		safe += c == '\'' ? std::string( "'\\''" ) : std::string( 1, c );
	}
	return safe + "'";
}

class PictureSink : public FrameSink
{
public:
	PictureSink(
		const RunSettings& settings, std::unique_ptr<pliant_glue::Offscreen> context, std::unique_ptr<pliant_glue::Renderer> renderer ) :
		m_settings( settings ),
		m_context( std::move( context ) ), m_renderer( std::move( renderer ) )
	{}

	bool write( int frame, const pliant_glue::DrawList& list, std::string& why ) override
	{
		pliant_glue::Picture picture = m_renderer->drawPicture( list, m_settings.width, m_settings.height, m_settings.supersampling );
		if ( !waitForFile() )
		{
			why = "a frame could not be written into " + m_settings.folder;
			return false;
		}
		char name[32];
		std::snprintf( name, sizeof( name ), "/frame_%04d.png", frame );
		m_writing = std::async( std::launch::async,
			[path = m_settings.folder + name, kept = std::move( picture )] { return pliant_glue::writePng( path, kept ); } );
		++m_frames;
		return true;
	}

	std::string finish() override
	{
		if ( !waitForFile() )
		{
			return "the last frame could not be written into " + m_settings.folder;
		}
		std::string made = std::to_string( m_frames ) + " pictures frame_*.png (" + m_context->driver() + ")";
		if ( std::system( "command -v ffmpeg > /dev/null 2>&1" ) != 0 )
		{
			return made + "; no film, since ffmpeg is not installed";
		}
		const std::string film = m_settings.folder + "/film.mp4";
		const std::string command = "ffmpeg -y -loglevel error -framerate " + std::to_string( m_settings.framesPerSecond ) + " -i " +
			quoted( m_settings.folder + "/frame_%04d.png" ) + " -frames:v " + std::to_string( m_frames ) +
			" -c:v libx264 -preset fast -crf 20 -pix_fmt yuv420p -movflags +faststart " + quoted( film ) + " < /dev/null";
		return made + ( std::system( command.c_str() ) == 0 ? "; film.mp4" : "; no film, since ffmpeg failed" );
	}

private:
	bool waitForFile() { return !m_writing.valid() || m_writing.get(); }

	RunSettings m_settings;
	std::unique_ptr<pliant_glue::Offscreen> m_context; // outlives the renderer, whose objects live in it
	std::unique_ptr<pliant_glue::Renderer> m_renderer;
	std::future<bool> m_writing; // compressing a PNG takes as long as a small step, so it runs concurrently with the next one
	int m_frames = 0;
};

} // namespace

std::unique_ptr<FrameSink> makePictureSink( const RunSettings& settings, std::string& why )
{
	auto context = pliant_glue::Offscreen::create( why );
	if ( context == nullptr )
	{
		return nullptr;
	}
	auto renderer = pliant_glue::Renderer::create( why );
	if ( renderer == nullptr )
	{
		return nullptr;
	}
	return std::make_unique<PictureSink>( settings, std::move( context ), std::move( renderer ) );
}

#else

std::unique_ptr<FrameSink> makePictureSink( const RunSettings&, std::string& why )
{
	why = "built without OpenGL (libepoxy-dev, libegl-dev, libglm-dev, libstb-dev)";
	return nullptr;
}

#endif

} // namespace pliant_demos
