#pragma once

// A scene while it runs: its stage, its additional stages, and the clock.

#include "demos/scene.h"

namespace pliant_demos {

constexpr int kStepsPerSecond = 60;

/// Of a film of a scene.
struct FilmLength
{
	int frames, stepsPerFrame;
};

class Play
{
public:
	Play( const SceneEntry& entry, const StageOptions& options ) :
		m_stage( options ), m_scene( entry.make() ), m_isGood( m_scene->init( m_stage ) )
	{}

	/// False if a body was refused; the stage's status has the reason.
	bool isGood() const { return m_isGood; }
	Stage& stage() { return m_stage; }
	const Stage& stage() const { return m_stage; }
	Scene& scene() { return *m_scene; }
	const Scene& scene() const { return *m_scene; }
	/// The main stage first.
	std::vector<Stage*> stages();

	/// `frames`: the number of frames, or 0 for the scene's own length.
	FilmLength film( int framesPerSecond, int frames ) const;

	void step();
	/// Skins everything; the data that `draw` adds is borrowed until the next step.
	void skin();
	void draw( pliant_glue::DrawList& list, bool showNodes );

	/// Of all stages.
	std::uint64_t stateHash();
	int quarantined();

	double seconds() const { return double( m_steps ) / kStepsPerSecond; }

private:
	Stage m_stage;
	std::unique_ptr<Scene> m_scene;
	bool m_isGood;
	int m_steps = 0;
};

} // namespace pliant_demos
