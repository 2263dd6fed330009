// Runs one experiment and prints its tables:
//   pliant_experiments glob [orientations] | vibration | bars | splits

#include "experiments/experiments.h"

#include <cstdio>
#include <cstdlib>
#include <cstring>

int main( int argc, char** argv )
{
	using namespace pliant::experiment;
	const char* const name = argc > 1 ? argv[1] : "";
	if ( std::strcmp( name, "glob" ) == 0 )
	{
		globExperiment( argc > 2 ? std::atoi( argv[2] ) : 6 );
		return 0;
	}
	if ( std::strcmp( name, "vibration" ) == 0 )
	{
		vibrationExperiment();
		return 0;
	}
	if ( std::strcmp( name, "bars" ) == 0 )
	{
		barExperiment();
		return 0;
	}
	if ( std::strcmp( name, "splits" ) == 0 )
	{
		splitsExperiment();
		return 0;
	}
	std::puts( "pliant_experiments glob [orientations] | vibration | bars | splits" );
	return 1;
}
