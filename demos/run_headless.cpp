// +-----------------------------------------------------------------------------------------------------------------+
// | A scene from its first step to its summary, without a screen.                                                    |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/frame_sink.h"
#include "demos/progress_line.h"
#include "demos/run.h"
#include "demos/step_log.h"

#include <nlohmann/json.hpp>

#include <chrono>
#include <cinttypes>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>

namespace pliant_demos {

namespace {

using Clock = std::chrono::steady_clock;

double secondsSince( Clock::time_point begin )
{
	return std::chrono::duration<double>( Clock::now() - begin ).count();
}

/// Contact points that no soft body has a part in; the step report counts the others.
int rigidContacts( pliant::SoftBodyWorld& world )
{
	int points = 0;
	for( int i = 0; i < world.getDispatcher()->getNumManifolds(); ++i )
	{
		const btPersistentManifold* manifold = world.getDispatcher()->getManifoldByIndexInternal( i );
		const bool isRigid = pliant::SoftBody::upcast( manifold->getBody0() ) == nullptr && pliant::SoftBody::upcast( manifold->getBody1() ) == nullptr;
		points += isRigid ? manifold->getNumContacts() : 0;
	}
	return points;
}

class HeadlessRun
{
public:
	HeadlessRun( const SceneEntry& entry, const RunSettings& settings ) :
		m_entry( entry ), m_settings( settings ), m_scene( entry.make() ), m_stage( settings.stage )
	{
	}

	int run()
	{
		const Clock::time_point begin = Clock::now();
		if( !prepare() )
		{
			return 1;
		}
		const int stepsPerFrame = kStepsPerSecond / m_settings.framesPerSecond;
		const int frames = m_settings.frames > 0 ? m_settings.frames : int( std::lround( m_scene->duration() * m_settings.framesPerSecond ) );
		ProgressLine progress( m_entry.name, frames );
		for( int frame = 0; frame < frames; ++frame )
		{
			if( !writeFrame( frame ) )
			{
				return 1;
			}
			for( int k = 0; k < stepsPerFrame; ++k )
			{
				step( frame * stepsPerFrame + k );
			}
			progress.show( frame + 1 );
		}
		progress.end();
		for( const std::unique_ptr<FrameSink>& sink : m_sinks )
		{
			m_made.push_back( sink->finish() );
		}
		m_wholeSeconds = secondsSince( begin );
		m_frames = frames;
		printTable();
		return writeSummary() && m_log.quarantined() == 0 ? 0 : 1;
	}

private:
	bool prepare()
	{
		std::error_code error;
		std::filesystem::create_directories( m_settings.folder, error );
		if( error )
		{
			std::fprintf( stderr, "%s cannot be made: %s\n", m_settings.folder.c_str(), error.message().c_str() );
			return false;
		}
		removeOldFrames();
		const Clock::time_point begin = Clock::now();
		if( !m_scene->init( m_stage ) )
		{
			std::fprintf( stderr, "%s: %s\n", m_entry.name, m_stage.status().sentence.c_str() );
			return false;
		}
		m_buildSeconds = secondsSince( begin );
		makeSinks();
		m_notes.insert( m_notes.begin(), m_stage.notes().begin(), m_stage.notes().end() );
		std::printf( "%s: %s\n", m_entry.name, m_entry.description );
		for( const std::string& note : m_notes )
		{
			std::printf( "  %s\n", note.c_str() );
		}
		std::fflush( stdout );
		return true;
	}

	/// A shorter film must not end with the frames of the longer one before it.
	void removeOldFrames() const
	{
		std::error_code error;
		for( const auto& file : std::filesystem::directory_iterator( m_settings.folder, error ) )
		{
			if( file.path().filename().string().rfind( "frame_", 0 ) == 0 )
			{
				std::filesystem::remove( file.path(), error );
			}
		}
	}

	void makeSinks()
	{
		RunSettings settings = m_settings;
		if( settings.render )
		{
			std::string why;
			if( std::unique_ptr<FrameSink> sink = makePictureSink( settings, why ) )
			{
				m_sinks.push_back( std::move( sink ) );
			}
			else
			{
				settings.exportFormat = settings.exportFormat.empty() ? "glb" : settings.exportFormat;
				m_notes.push_back( "no pictures: " + why + "; writing ." + settings.exportFormat + " model files instead" );
			}
		}
		if( !settings.exportFormat.empty() )
		{
			m_sinks.push_back( makeModelSink( settings ) );
		}
	}

	void step( int number )
	{
		m_scene->beforeStep( m_stage, double( number ) / kStepsPerSecond );
		const Clock::time_point begin = Clock::now();
		m_stage.world().stepSimulation( btScalar( 1 ) / kStepsPerSecond, 0 );
		const double seconds = secondsSince( begin );
		m_log.add( m_stage.world().stepReport(), seconds, rigidContacts( m_stage.world() ) );
	}

	bool writeFrame( int frame )
	{
		const Clock::time_point begin = Clock::now();
		m_stage.skin();
		m_log.addSkinning( secondsSince( begin ) );
		if( m_sinks.empty() )
		{
			return true;
		}
		m_list.clear();
		m_stage.draw( m_list, m_settings.showNodes );
		m_list.camera = m_scene->camera( double( frame ) / m_settings.framesPerSecond );
		m_list.light = m_scene->light();
		for( const std::unique_ptr<FrameSink>& sink : m_sinks )
		{
			std::string why;
			if( !sink->write( frame, m_list, why ) )
			{
				std::fprintf( stderr, "\n%s\n", why.c_str() );
				return false;
			}
		}
		m_drawSeconds += secondsSince( begin );
		return true;
	}

	void printTable() const
	{
		const StageCounts counts = m_stage.counts();
		std::printf( "\n  soft bodies %d, nodes %d, links %d, triangles %d, rigid bodies %d\n", counts.softBodies, counts.nodes, counts.links,
			counts.triangles, counts.rigidBodies );
		std::printf( "  steps %d of 1/%d s, up to %d soft substeps each; contacts at most %d, %d of them on soft bodies; threads %d\n", m_log.steps(),
			kStepsPerSecond, m_log.maxSubsteps(), m_log.maxContacts(), m_log.maxSoftContacts(), m_settings.stage.threads );
		if( m_log.unreachableStiffness() > 0 )
		{
			std::printf( "  %d bodies are softer than asked: their Young's modulus needs more substeps\n", m_log.unreachableStiffness() );
		}
		if( m_log.quarantined() > 0 )
		{
			std::printf( "  %d bodies were stopped because a number in them was no longer finite\n", m_log.quarantined() );
		}
		std::printf( "\n%s\n", m_log.table().c_str() );
		std::printf( "  whole run %.1f s: building bodies %.2f, steps %.2f, drawing and writing %.2f\n", m_wholeSeconds, m_buildSeconds,
			m_log.wallSeconds(), m_drawSeconds );
		std::printf( "  state hash %016" PRIx64 "\n", m_stage.stateHash() );
		for( const std::string& made : m_made )
		{
			std::printf( "  %s\n", made.c_str() );
		}
		std::printf( "  in %s\n", m_settings.folder.c_str() );
	}

	bool writeSummary() const
	{
		const StageCounts counts = m_stage.counts();
		char hash[24];
		std::snprintf( hash, sizeof( hash ), "%016" PRIx64, m_stage.stateHash() );
		const nlohmann::json summary = {
			{ "scene", m_entry.name },
			{ "description", m_entry.description },
			{ "settings", { { "seed", m_settings.stage.seed }, { "threads", m_settings.stage.threads }, { "frames", m_frames }, { "framesPerSecond", m_settings.framesPerSecond }, { "stepsPerSecond", kStepsPerSecond } } },
			{ "softBodies", counts.softBodies },
			{ "rigidBodies", counts.rigidBodies },
			{ "nodes", counts.nodes },
			{ "links", counts.links },
			{ "triangles", counts.triangles },
			{ "steps", m_log.steps() },
			{ "maxContacts", m_log.maxContacts() },
			{ "maxSoftContacts", m_log.maxSoftContacts() },
			{ "maxSubsteps", m_log.maxSubsteps() },
			{ "quarantined", m_log.quarantined() },
			{ "unreachableStiffness", m_log.unreachableStiffness() },
			{ "msPerStep", m_log.json() },
			{ "seconds", { { "whole", m_wholeSeconds }, { "build", m_buildSeconds }, { "steps", m_log.wallSeconds() }, { "draw", m_drawSeconds } } },
			{ "stateHash", hash },
			{ "notes", m_notes },
			{ "made", m_made },
		};
		const std::string path = m_settings.folder + "/summary.json";
		std::ofstream file( path );
		file << summary.dump( 1, '\t' ) << "\n";
		file.close();
		if( !file )
		{
			std::fprintf( stderr, "%s cannot be written\n", path.c_str() );
		}
		return bool( file );
	}

	const SceneEntry& m_entry;
	RunSettings m_settings;
	std::unique_ptr<Scene> m_scene;
	Stage m_stage;
	StepLog m_log;
	pliant_glue::DrawList m_list;
	std::vector<std::unique_ptr<FrameSink>> m_sinks;
	std::vector<std::string> m_notes, m_made;
	double m_buildSeconds = 0, m_drawSeconds = 0, m_wholeSeconds = 0;
	int m_frames = 0;
};

} // namespace

int runHeadless( const SceneEntry& entry, const RunSettings& settings )
{
	return HeadlessRun( entry, settings ).run();
}

} // namespace pliant_demos
