#pragma once

// The study of one mesh: every candidate in every scene at every orientation, recorded run by run, so that it can be stopped and continued.

#include "demos/study/reference.h"
#include "demos/study/summary.h"

#include <string>
#include <vector>

namespace pliant_study {

struct StudyPlan
{
	std::string meshName;
	std::vector<SceneInfo> scenes;
	CandidatePlan candidates;
	int orientations = 6;
	std::string folder;
	double budget = 0;    ///< s a game step; 0: none
	bool isFresh = false; ///< the contents of the folder are deleted
	bool drawsPictures = true;
};

/// 0, or the process's exit code. `specimen` outlives the call.
int study( const StudyPlan& plan, const Specimen& specimen );

/// Runs by line in a file; the first line identifies the plan, and a file of another plan is not continued.
class RunStore
{
public:
	/// False if the folder cannot be used; `why` then has the reason.
	bool open( const StudyPlan& plan, const Specimen& specimen, std::string& why );
	const std::vector<Record>& records() const { return m_records; }
	bool has( const std::string& candidate, const std::string& scene, int orientation ) const;
	/// Written at once: a study that is killed loses only its current run.
	bool add( const Record& record );

private:
	bool writeAnew( const std::string& whole, std::string& why ) const;
	std::string m_path;
	std::vector<Record> m_records;
};

} // namespace pliant_study
