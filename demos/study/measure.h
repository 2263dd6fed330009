#pragma once

// One run of one candidate in one scene, and what is written down of it.

#include "demos/study/rig.h"

#include <nlohmann/json_fwd.hpp>

#include <string>
#include <vector>

namespace pliant_study {

/// Distances of the mesh's vertices from where the reference has them, weighted by the surface they stand for; shares of D.
struct Errors
{
	double mean = 0, deviation = 0;
	double shape = 0; ///< mean, with the rigid motion taken off that fits best
};

Errors errorsOf( const Specimen& specimen, const Points& points, const Points& reference );

/// The vertices at every framesAWrite-th frame of the scene.
using Track = std::vector<Points>;

struct Record
{
	std::string candidate, family, scene;
	int orientation = 0;
	bool isOurs = false;
	std::string refused;                      ///< why it could not be run; empty: it was
	double nodes = 0, substeps = 0;           ///< mean over the run
	double bytes = 0;                         ///< of memory for the body, its template and its world, the skin in it; 0: not known here
	double median = 0, slow = 0, slowest = 0; ///< s a game step: median, 99th percentile, most
	StageTimes stages{};                      ///< s a game step, mean
	Errors errors;                            ///< means over the run
	Errors last;
	double worst = 0; ///< largest mean error, and the frame it was at
	int worstFrame = 0;
	std::vector<double> curve;                 ///< mean error at every framesAWrite-th frame
	double volumeDrift = 0;                    ///< largest change of the enclosed volume, share of it
	double momentumDrift = -1, spinDrift = -1; ///< largest change in scenes where nothing changes it, share of what there is; else -1
	double energyGrowth = -1;                  ///< largest growth in scenes that do not feed it, share of what there is; else -1
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
	const Track* reference = nullptr; ///< null: no errors are taken
	double referenceBrokenAt = -1;    ///< errors are taken until either breaks
	Track* track = nullptr;           ///< where this run's own places go, if wanted
};

Record run( const RunOrder& order );

nlohmann::json toJson( const Record& record );
Record recordFrom( const nlohmann::json& json );

} // namespace pliant_study
