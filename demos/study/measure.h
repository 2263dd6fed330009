#pragma once

// One run of one candidate in one scene, and its record.

#include "demos/study/rig.h"

#include <nlohmann/json_fwd.hpp>

#include <string>
#include <vector>

namespace pliant_study {

/// Distances of the mesh's vertices from those of the reference, weighted by surface area; fractions of D.
struct Errors
{
	double mean = 0, deviation = 0;
	double shape = 0; ///< mean, without the best-fitting rigid motion
};

Errors errorsOf( const Specimen& specimen, const Points& points, const Points& reference );

/// The vertices at every framesAWrite-th frame of the scene.
using Track = std::vector<Points>;

struct Record
{
	std::string candidate, family, scene;
	int orientation = 0;
	bool isOurs = false;
	std::string refused;                      ///< reason why it could not be run; empty: it ran
	double nodes = 0, substeps = 0;           ///< mean over the run
	double bytes = 0;                         ///< memory of the body, its template, its world and its skin; 0: unknown
	double median = 0, slow = 0, slowest = 0; ///< s a game step: median, 99th percentile, maximum
	StageTimes stages{};                      ///< s a game step, mean
	Errors errors;                            ///< means over the run
	Errors last;
	double worst = 0; ///< largest mean error, and the frame it was at
	int worstFrame = 0;
	std::vector<double> curve;                 ///< mean error at every framesAWrite-th frame
	double volumeDrift = 0;                    ///< largest change of the enclosed volume, as a fraction of it
	double momentumDrift = -1, spinDrift = -1; ///< largest change in scenes in which it should be constant, as a fraction; otherwise -1
	double energyGrowth = -1;                  ///< largest growth in scenes without external work, as a fraction; otherwise -1
	double brokenAt = -1;                      ///< s; -1: it did not break
	int pieces = 1;
	bool isHealthy = true;
};

struct RunOrder
{
	SceneInfo scene;
	const Specimen* specimen = nullptr;
	Candidate candidate;
	int orientation = 0;
	const Track* reference = nullptr; ///< null: no errors are computed
	double referenceBrokenAt = -1;    ///< errors are computed until either breaks
	Track* track = nullptr;           ///< receives this run's positions, if wanted
};

Record run( const RunOrder& order );

nlohmann::json toJson( const Record& record );
Record recordFrom( const nlohmann::json& json );

} // namespace pliant_study
