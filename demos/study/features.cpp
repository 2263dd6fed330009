// +-----------------------------------------------------------------------------------------------------------------+
// | The cost of each feature: off, on but idle, on and working.                                                      |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/study/feature_cases.h"
#include "demos/study/instruction_count.h"
#include "demos/study/scale.h"
#include "demos/study/subject.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>

namespace pliant_study {

namespace {

struct Cost
{
	double instructions = 0, seconds = 0, bytes = 0; ///< a game step, a game step, in total
};

/// All zero if this build refuses it.
Cost measure( const FeatureCase& one, int steps )
{
	Cost cost;
	const double before = bytesInUse();
	const std::unique_ptr<SmallWorld> world = makeFeatureWorld( one );
	if ( world == nullptr )
	{
		return cost;
	}
	InstructionCount count;
	std::vector<double> times;
	const std::uint64_t first = count.now();
	for ( int k = 0; k < steps; ++k )
	{
		times.push_back( world->timedStep( one.isLookedAt ) );
	}
	cost.instructions = double( count.now() - first ) / steps;
	std::nth_element( times.begin(), times.begin() + std::ptrdiff_t( times.size() / 2 ), times.end() );
	cost.seconds = times[times.size() / 2];
	cost.bytes = bytesInUse() - before;
	return cost;
}

} // namespace

int studyFeatures( const FeaturePlan& plan )
{
	std::error_code error;
	std::filesystem::create_directories( plan.folder, error );
	std::ofstream csv( plan.folder + "/features.csv" );
	csv << "feature;state;instructions_a_step;us_a_step;bytes;instructions_ratio;time_ratio;memory_ratio\n";
	std::printf( "A block of %d cells on a plane, %d game steps; ratios to the plain body\n\n  %-16s %-38s %14s %10s %10s\n",
		featureCells(), plan.steps, "feature", "", "instructions", "time", "memory" );
	Cost plain;
	if ( !InstructionCount().works() )
	{
		std::printf( "  (this system does not let instructions be counted: their column is empty; demos/study_features.sh counts them by "
					 "other means)\n" );
	}
	for ( const FeatureCase& one : featureCases() )
	{
		const Cost cost = measure( one, plan.steps );
		plain = one.feature == "plain" ? cost : plain;
		const double instructions = plain.instructions > 0 ? cost.instructions / plain.instructions : 0.0;
		const double time = cost.seconds / plain.seconds, memory = plain.bytes > 0 ? cost.bytes / plain.bytes : 0.0;
		std::printf( "  %-16s %-38s %14.4f %10.3f %10.3f\n", one.feature.c_str(), one.state.c_str(), instructions, time, memory );
		csv << one.feature << ';' << one.state << ';' << cost.instructions << ';' << 1e6 * cost.seconds << ';' << cost.bytes << ';'
			<< instructions << ';' << time << ';' << memory << '\n';
	}
	std::printf( "\n%s/features.csv\n", plan.folder.c_str() );
	return csv.flush() ? 0 : 1;
}

} // namespace pliant_study
