// +-----------------------------------------------------------------------------------------------------------------+
// | Several runs of a scene, each with the next seed, and the means of its findings. Results that depend on how       |
// | objects fall differ from run to run: a single one says little.                                                    |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/findings.h"
#include "demos/play.h"
#include "demos/progress_line.h"
#include "demos/run.h"

#include <cstdio>

namespace pliant_demos {

int runDraws( const SceneEntry& entry, const RunSettings& settings )
{
	std::printf( "%s: %s\n", entry.name, entry.description );
	FindingMeans means;
	ProgressLine progress( entry.name, settings.draws );
	for ( int draw = 0; draw < settings.draws; ++draw )
	{
		StageOptions options = settings.stage;
		options.seed += unsigned( draw );
		Play play( entry, options );
		if ( !play.isGood() )
		{
			std::fprintf( stderr, "%s: %s\n", entry.name, play.stage().status().sentence.c_str() );
			return 1;
		}
		const FilmLength film = play.film( settings.framesPerSecond, settings.frames );
		for ( int step = 0; step < film.frames * film.stepsPerFrame; ++step )
		{
			play.step();
		}
		if ( play.quarantined() > 0 )
		{
			std::fprintf( stderr, "%s, seed %u: %d bodies were stopped because a number in them was no longer finite\n", entry.name,
				options.seed, play.quarantined() );
			return 1;
		}
		means.add( play.scene().findings( play.stage() ) );
		progress.show( draw + 1 );
	}
	progress.end();
	std::printf( "\n  means of %d draws, seeds %u to %u\n\n", settings.draws, settings.stage.seed,
		settings.stage.seed + unsigned( settings.draws ) - 1 );
	const std::vector<FindingTable> tables = means.tables();
	for ( const FindingTable& table : tables )
	{
		print( table );
	}
	if ( tables.empty() )
	{
		std::printf( "  the scene finds nothing out\n" );
	}
	return 0;
}

} // namespace pliant_demos
