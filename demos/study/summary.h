#pragma once

// Runs combined: cost and error of each candidate, the front, and the best candidate for a budget.

#include "demos/study/measure.h"

#include <nlohmann/json_fwd.hpp>

#include <string>
#include <vector>

namespace pliant_study {

/// One candidate in one scene, or in all: means over orientations (of errors over several scenes: geometric means).
struct Summary
{
	std::string candidate, family;
	bool isOurs = false;
	int runs = 0;
	std::string refused;
	double nodes = 0, substeps = 0, bytes = 0;
	double median = 0, slow = 0, slowest = 0; ///< s a game step; medians over the runs
	StageTimes stages{};
	Errors errors, last;
	double spread = 0; ///< standard deviation of the mean error over orientations
	double worst = 0;
	int worstFrame = 0, worstOrientation = 0;
	std::vector<double> curve;
	double volumeDrift = 0, momentumDrift = -1, spinDrift = -1, energyGrowth = -1, brokenAt = -1;
	bool isHealthy = true;
	bool isOnFront = false; ///< no other is both faster and more accurate
};

/// Of one scene, in the order of the records; marks the front. The reference and the one on a rotated lattice are omitted.
std::vector<Summary> summarise( const std::vector<Record>& records, const std::string& scene );
/// Over all scenes that have summaries; candidates that were refused in one are omitted.
std::vector<Summary> combine( const std::vector<std::vector<Summary>>& scenes );

/// The most accurate within a budget, s a step; null if there is none.
const Summary* best( const std::vector<Summary>& all, double budget, bool oursOnly = false );

/// Our methods compared with the front of the others under `budget`, s.
struct Standing
{
	double ratio = 0;  ///< the worst case: our error over theirs, ours no slower except for noise; 0 if there are no others
	double noise = 0;  ///< sum of both errors' relative spreads over orientations
	std::string other; ///< who it is
};
Standing standing( const std::vector<Summary>& all, double budget );

nlohmann::json toJson( const Summary& summary );
std::string csvHeader();
std::string csvLine( const std::string& scene, const Summary& summary );

} // namespace pliant_study
