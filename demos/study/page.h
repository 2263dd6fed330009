#pragma once

// The study as one page that needs nothing beside it.

#include "demos/study/study.h"

#include <string>
#include <vector>

namespace pliant_study {

struct PageScene
{
	SceneInfo scene;
	std::vector<Summary> all;
	double floor = 0;     ///< error between two references
	std::string pictures; ///< HTML; empty: none
};

struct PageContent
{
	const StudyPlan* plan = nullptr;
	const Specimen* specimen = nullptr;
	std::vector<PageScene> scenes;
	std::vector<Summary> together; ///< of all scenes, or of the only one
};

/// False when it cannot be written. `why` says what is missing on it.
bool writePage( const PageContent& content, const std::string& path, std::string& why );

/// HTML: those on the front at the moment they are worst, the reference beside each; made by running them again. Empty without OpenGL.
std::string drawWorst(
	const StudyPlan& plan, const Specimen& specimen, const SceneInfo& scene, const std::vector<Summary>& all, const Reference& reference );

/// Sentences: what taking this one costs against the best there is.
std::string whatIsGivenUp( const std::vector<Summary>& all, const Summary& pick );

/// The processor's name, or "unknown processor".
std::string processorName();

} // namespace pliant_study
