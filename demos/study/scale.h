#pragma once

// The cost of a step as a function of the number of nodes in a body, of bodies in a world, and of threads; and the cost of each feature.

#include <string>
#include <vector>

namespace pliant_study {

struct ScalePlan
{
	int mostNodes = 1000000;
	int mostBodies = 200;
	std::string folder = "out/scale";
};

struct ScaleRow
{
	std::string what; ///< "one block, flying", ...
	int bodies = 0, nodes = 0, threads = 1;
	double median = 0;      ///< s a game step
	double nanoseconds = 0; ///< a node and soft substep
	double bytes = 0;       ///< a node, template and body
};

/// One block of about `nodes` cells, or `bodies` of them; flying, or piled up on a plane. Median of some steps.
ScaleRow flyingBlock( int nodes, int threads );
ScaleRow flyingBodies( int bodies, int nodesEach, int threads );
ScaleRow pile( int bodies, int nodesEach, int threads );

/// Flying bodies: the speedup of two threads over one.
struct ThreadsRow
{
	int nodes = 0, bodies = 0;
	double middle = 0, least = 0, most = 0;
};

/// In turn, as a machine may change its clock rate within seconds: from the medians of steps with one thread and, right after, with two.
ThreadsRow twoThreads( int bodies, int nodesEach );

/// Slope of log y over log x by least squares.
double exponentOf( const std::vector<double>& x, const std::vector<double>& y );

/// Writes scale.csv and scale.json; 0, or the process's exit code.
int studyScale( const ScalePlan& plan );

struct FeaturePlan
{
	int steps = 120;
	std::string folder = "out/features";
};

/// Each feature off, on but idle, on and working: time, instructions and memory as ratios to the plain body. Writes features.csv.
int studyFeatures( const FeaturePlan& plan );

} // namespace pliant_study
