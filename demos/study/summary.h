#pragma once

// Runs put together: what each candidate costs and how wrong it is, who is on the front, and what to take for a budget.

#include "demos/study/measure.h"

#include <nlohmann/json_fwd.hpp>

#include <string>
#include <vector>

namespace pliant_study {

/// One candidate in one scene, or in all: means over orientations (errors of several scenes: geometric mean of theirs).
struct Summary
{
	std::string candidate, family;
	bool isOurs = false;
	int runs = 0;
	std::string refused;
	double nodes = 0, substeps = 0, bytes = 0;
	double median = 0, slow = 0, slowest = 0; ///< s a game step; the middle ones of the runs'
	StageTimes stages{};
	Errors errors, last;
	double spread = 0; ///< standard deviation of the mean error over orientations
	double worst = 0;
	int worstFrame = 0, worstOrientation = 0;
	std::vector<double> curve;
	double volumeDrift = 0, momentumDrift = -1, spinDrift = -1, energyGrowth = -1, brokenAt = -1;
	bool isHealthy = true;
	bool isOnFront = false; ///< nothing is both faster and better
};

/// Of one scene, in the order of the records; marks the front. The reference and its turned twin are left out.
std::vector<Summary> summarise( const std::vector<Record>& records, const std::string& scene );
/// Of all the scenes of which there are summaries; candidates that were refused in one are left out.
std::vector<Summary> combine( const std::vector<std::vector<Summary>>& scenes );

/// The best on or under a budget, s a step; null where nothing is.
const Summary* best( const std::vector<Summary>& all, double budget, bool oursOnly = false );

/// How ours stand against the others' front under `budget`, s.
struct Standing
{
	double ratio = 0;  ///< the worst: our error over theirs, ours no slower but for noise; 0 where there are no others
	double noise = 0;  ///< what both errors' spread over orientations makes of that ratio
	std::string other; ///< who it is
};
Standing standing( const std::vector<Summary>& all, double budget );

nlohmann::json toJson( const Summary& summary );
std::string csvHeader();
std::string csvLine( const std::string& scene, const Summary& summary );

} // namespace pliant_study
