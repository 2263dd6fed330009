#pragma once

// The study as one self-contained page.

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

/// False if it cannot be written. `why` names what is missing on it.
bool writePage( const PageContent& content, const std::string& path, std::string& why );

/// HTML: the candidates on the front at their worst moments, with the reference next to each; made by running them again. Empty without
/// OpenGL.
std::string drawWorst(
	const StudyPlan& plan, const Specimen& specimen, const SceneInfo& scene, const std::vector<Summary>& all, const Reference& reference );

/// Sentences that compare this candidate with the most accurate one.
std::string whatIsGivenUp( const std::vector<Summary>& all, const Summary& pick );

/// The processor's name, or "unknown processor".
std::string processorName();

} // namespace pliant_study
