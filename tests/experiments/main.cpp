// Runs one experiment and prints its tables. Without a name: lists them.

#include "experiments/experiments.h"

#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace {

using namespace pliant::experiment;

struct Entry
{
	const char* name;
	void ( *run )( int number );
	int number; ///< used if no other number is given
};

const Entry kEntries[] = {
	{ "glob", []( int orientations ) { globExperiment( orientations ); }, 6 },
	{ "vibration", []( int ) { vibrationExperiment(); }, 0 },
	{ "bars", []( int ) { barExperiment(); }, 0 },
	{ "splits", []( int ) { splitsExperiment(); }, 0 },
	{ "pull", []( int ) { pullExperiment(); }, 0 },
	{ "drops", []( int count ) { dropsExperiment( count ); }, 24 },
	{ "shots", []( int count ) { shotsExperiment( count ); }, 1000 },
	{ "impacts", []( int count ) { impactsExperiment( count ); }, 1000 },
	{ "shatters", []( int count ) { shattersExperiment( count ); }, 400 },
	{ "slides", []( int ) { slidesExperiment(); }, 0 },
	{ "things", []( int count ) { thingsExperiment( count ); }, 1700 },
	{ "rays", []( int count ) { raysExperiment( count ); }, 3000 },
	{ "crack", []( int ) { crackExperiment(); }, 0 },
	{ "bunny", []( int ) { bunnyExperiment(); }, 0 },
	{ "nodes", []( int ) { nodeExperiment(); }, 0 },
	{ "refine", []( int ) { refineExperiment(); }, 0 },
};

} // namespace

int main( int argc, char** argv )
{
	for ( const Entry& entry : kEntries )
	{
		if ( argc > 1 && std::strcmp( argv[1], entry.name ) == 0 )
		{
			entry.run( argc > 2 ? std::atoi( argv[2] ) : entry.number );
			return 0;
		}
	}
	std::puts( "pliant_experiments <name> [number]" );
	for ( const Entry& entry : kEntries )
	{
		std::printf( "  %s\n", entry.name );
	}
	return 1;
}
