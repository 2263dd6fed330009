// +-----------------------------------------------------------------------------------------------------------------+
// | One step of every stage of a scene, and one picture of all of them.                                              |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/play.h"

#include <algorithm>
#include <cmath>

namespace pliant_demos {

namespace {

constexpr std::uint64_t kMostMeshes = 1u << 20; // of one stage
constexpr std::uint64_t kFnvPrime = 0x100000001b3ull;

} // namespace

std::vector<Stage*> Play::stages()
{
	std::vector<Stage*> all = m_scene->sideStages();
	all.insert( all.begin(), &m_stage );
	return all;
}

FilmLength Play::film( int framesPerSecond, int frames ) const
{
	const int stepsPerFrame = std::max( 1, kStepsPerSecond / ( framesPerSecond * m_scene->slowness() ) );
	return { frames > 0 ? frames : int( std::lround( m_scene->duration() * kStepsPerSecond / stepsPerFrame ) ), stepsPerFrame };
}

void Play::step()
{
	m_scene->beforeStep( m_stage, seconds() );
	for ( Stage* stage : stages() )
	{
		stage->step( 1.0 / kStepsPerSecond );
	}
	++m_steps;
	m_scene->afterStep( m_stage, seconds() );
}

void Play::skin()
{
	for ( Stage* stage : stages() )
	{
		stage->skin();
	}
}

void Play::draw( pliant_glue::DrawList& list, bool showNodes )
{
	m_scene->beforePicture( m_stage, list );
	std::uint64_t firstId = 0;
	for ( Stage* stage : stages() )
	{
		stage->draw( list, showNodes, firstId );
		firstId += kMostMeshes;
	}
}

std::uint64_t Play::stateHash()
{
	std::uint64_t hash = m_stage.stateHash();
	for ( Stage* stage : m_scene->sideStages() )
	{
		hash = ( hash ^ stage->stateHash() ) * kFnvPrime;
	}
	return hash;
}

int Play::quarantined()
{
	int bodies = 0;
	for ( Stage* stage : stages() )
	{
		bodies += stage->log().quarantined();
	}
	return bodies;
}

} // namespace pliant_demos
