// +-----------------------------------------------------------------------------------------------------------------+
// | A scene from its first step to its summary, without a screen.                                                    |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/findings.h"
#include "demos/frame_sink.h"
#include "demos/play.h"
#include "demos/progress_line.h"
#include "demos/run.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <cinttypes>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>

namespace pliant_demos {

namespace {

using Clock = std::chrono::steady_clock;

class HeadlessRun
{
public:
	HeadlessRun( const SceneEntry& entry, const RunSettings& settings ) : m_entry( entry ), m_settings( settings ) {}

	int run()
	{
		const Clock::time_point begin = Clock::now();
		if ( !prepare() )
		{
			return 1;
		}
		const auto [frames, stepsPerFrame] = m_play->film( m_settings.framesPerSecond, m_settings.frames );
		ProgressLine progress( m_entry.name, frames );
		for ( int frame = 0; frame < frames; ++frame )
		{
			if ( !writeFrame( frame ) )
			{
				return 1;
			}
			for ( int k = 0; k < stepsPerFrame; ++k )
			{
				m_play->step();
			}
			progress.show( frame + 1 );
		}
		progress.end();
		for ( const std::unique_ptr<FrameSink>& sink : m_sinks )
		{
			m_made.push_back( sink->finish() );
		}
		m_wholeSeconds = secondsSince( begin );
		m_frames = frames;
		printTable();
		return writeSummary() && m_play->quarantined() == 0 && cameAbout( frames ) ? 0 : 1;
	}

private:
	bool prepare()
	{
		std::error_code error;
		std::filesystem::create_directories( m_settings.folder, error );
		if ( error )
		{
			std::fprintf( stderr, "%s cannot be made: %s\n", m_settings.folder.c_str(), error.message().c_str() );
			return false;
		}
		removeOldFrames();
		const Clock::time_point begin = Clock::now();
		m_play = std::make_unique<Play>( m_entry, m_settings.stage );
		if ( !m_play->isGood() )
		{
			std::fprintf( stderr, "%s: %s\n", m_entry.name, m_play->stage().status().sentence.c_str() );
			return false;
		}
		m_buildSeconds = secondsSince( begin );
		makeSinks();
		const std::vector<std::string>& notes = m_play->stage().notes();
		m_notes.insert( m_notes.begin(), notes.begin(), notes.end() );
		std::printf( "%s: %s\n", m_entry.name, m_entry.description );
		for ( const std::string& note : m_notes )
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
		for ( const auto& file : std::filesystem::directory_iterator( m_settings.folder, error ) )
		{
			if ( file.path().filename().string().rfind( "frame_", 0 ) == 0 )
			{
				std::filesystem::remove( file.path(), error );
			}
		}
	}

	void makeSinks()
	{
		RunSettings settings = m_settings;
		if ( settings.render )
		{
			std::string why;
			if ( std::unique_ptr<FrameSink> sink = makePictureSink( settings, why ) )
			{
				m_sinks.push_back( std::move( sink ) );
			}
			else
			{
				settings.exportFormat = settings.exportFormat.empty() ? "glb" : settings.exportFormat;
				m_notes.push_back( "no pictures: " + why + "; writing ." + settings.exportFormat + " model files instead" );
			}
		}
		if ( !settings.exportFormat.empty() )
		{
			m_sinks.push_back( makeModelSink( settings ) );
		}
	}

	bool writeFrame( int frame )
	{
		const Clock::time_point begin = Clock::now();
		m_play->skin();
		if ( m_sinks.empty() )
		{
			return true;
		}
		m_list.clear();
		m_play->draw( m_list, m_settings.showNodes );
		m_list.camera = m_play->scene().camera( m_play->seconds() );
		m_list.light = m_play->scene().light();
		for ( const std::unique_ptr<FrameSink>& sink : m_sinks )
		{
			std::string why;
			if ( !sink->write( frame, m_list, why ) )
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
		const Stage& stage = m_play->stage();
		const StageCounts counts = stage.counts();
		const StepLog& log = stage.log();
		std::printf( "\n  soft bodies %d%s, nodes %d, links %d, triangles %d, rigid bodies %d\n", counts.softBodies,
			counts.fragments > 0 ? ( " (" + std::to_string( counts.fragments ) + " came off others)" ).c_str() : "", counts.nodes,
			counts.links, counts.triangles, counts.rigidBodies );
		std::printf( "  steps %d of 1/%d s, up to %d soft substeps each; contacts at most %d, %d of them on soft bodies; threads %d\n",
			log.steps(), kStepsPerSecond, log.maxSubsteps(), log.maxContacts(), log.maxSoftContacts(), m_settings.stage.threads );
		if ( log.unreachableStiffness() > 0 )
		{
			std::printf( "  %d bodies are softer than asked: their Young's modulus needs more substeps\n", log.unreachableStiffness() );
		}
		if ( m_play->quarantined() > 0 )
		{
			std::printf( "  %d bodies were stopped because a number in them was no longer finite\n", m_play->quarantined() );
		}
		std::printf( "\n%s\n", log.table().c_str() );
		print( stagesTable() );
		for ( const FindingTable& table : m_play->scene().findings( stage ) )
		{
			print( table );
		}
		print( m_play->scene().story( stage ).table() );
		std::printf( "  whole run %.1f s: building bodies %.2f, steps %.2f, drawing and writing %.2f\n", m_wholeSeconds, m_buildSeconds,
			log.wallSeconds(), m_drawSeconds );
		std::printf( "  state hash %016" PRIx64 "\n", m_play->stateHash() );
		for ( const std::string& made : m_made )
		{
			std::printf( "  %s\n", made.c_str() );
		}
		std::printf( "  in %s\n", m_settings.folder.c_str() );
	}

	/// One row for each stage if there are several.
	FindingTable stagesTable() const
	{
		FindingTable table{
			"each body in a world of its own, ms", { "nodes", "step, median", "step, max", "matching", "skin, picture" }, {} };
		for ( const Stage* stage : m_play->stages() )
		{
			const StepLog& log = stage->log();
			table.rows.push_back( { stage->name(),
				{ double( stage->counts().nodes ), log.medianStep(), log.longestStep(), log.medianMatching(), log.medianSkinning() } } );
		}
		return table.rows.size() > 1 ? table : FindingTable{};
	}

	nlohmann::json findingsJson() const
	{
		std::vector<FindingTable> tables = m_play->scene().findings( m_play->stage() );
		tables.push_back( stagesTable() );
		tables.push_back( m_play->scene().story( m_play->stage() ).table() );
		nlohmann::json all = nlohmann::json::object();
		for ( const FindingTable& table : tables )
		{
			for ( const FindingTable::Row& row : table.rows )
			{
				for ( std::size_t k = 0; k < row.values.size(); ++k )
				{
					all[table.caption][row.name][table.columns[k]] = row.values[k];
				}
			}
		}
		return all;
	}

	/// For a scene that has run its whole length: checks its conditions (Scene::story).
	bool cameAbout( int frames ) const
	{
		if ( frames < m_play->film( m_settings.framesPerSecond, 0 ).frames )
		{
			return true;
		}
		const std::vector<std::string> failures = m_play->scene().story( m_play->stage() ).failures();
		for ( const std::string& failure : failures )
		{
			std::fprintf( stderr, "%s went wrong: %s\n", m_entry.name, failure.c_str() );
		}
		return failures.empty();
	}

	bool writeSummary() const
	{
		const StageCounts counts = m_play->stage().counts();
		const StepLog& log = m_play->stage().log();
		char hash[24];
		std::snprintf( hash, sizeof( hash ), "%016" PRIx64, m_play->stateHash() );
		const nlohmann::json summary = {
			{ "scene", m_entry.name },
			{ "description", m_entry.description },
			{ "settings",
				{ { "seed", m_settings.stage.seed }, { "threads", m_settings.stage.threads }, { "frames", m_frames },
					{ "framesPerSecond", m_settings.framesPerSecond }, { "stepsPerSecond", kStepsPerSecond } } },
			{ "softBodies", counts.softBodies },
			{ "fragments", counts.fragments },
			{ "rigidBodies", counts.rigidBodies },
			{ "nodes", counts.nodes },
			{ "links", counts.links },
			{ "triangles", counts.triangles },
			{ "steps", log.steps() },
			{ "maxContacts", log.maxContacts() },
			{ "maxSoftContacts", log.maxSoftContacts() },
			{ "maxSubsteps", log.maxSubsteps() },
			{ "quarantined", m_play->quarantined() },
			{ "unreachableStiffness", log.unreachableStiffness() },
			{ "msPerStep", log.json() },
			{ "findings", findingsJson() },
			{ "seconds",
				{ { "whole", m_wholeSeconds }, { "build", m_buildSeconds }, { "steps", log.wallSeconds() }, { "draw", m_drawSeconds } } },
			{ "stateHash", hash },
			{ "notes", m_notes },
			{ "made", m_made },
		};
		const std::string path = m_settings.folder + "/summary.json";
		std::ofstream file( path );
		file << summary.dump( 1, '\t' ) << "\n";
		file.close();
		if ( !file )
		{
			std::fprintf( stderr, "%s cannot be written\n", path.c_str() );
		}
		return bool( file );
	}

	const SceneEntry& m_entry;
	RunSettings m_settings;
	std::unique_ptr<Play> m_play;
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
