// +-----------------------------------------------------------------------------------------------------------------+
// | A scene's worlds are saved at random steps. Restored in place and in a second run of the scene, they must         |
// | continue to the same bits. Meanwhile the scene itself does nothing: it moves and cuts nothing. State of its own,  |
// | such as a character's fall, it saves and restores itself (Scene::ownState).                                       |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/play.h"
#include "demos/run.h"

#include <pliant/io/snapshot.h>

#include <algorithm>
#include <cstdio>
#include <random>

namespace pliant_demos {

namespace {

constexpr int kStepsAfter = 300;

using Bytes = std::vector<std::byte>;

/// With the templates, as a game would save it; or only with what equal worlds share.
Bytes save( const Stage& stage, bool forComparison )
{
	Bytes bytes;
	pliant::SaveSettings settings;
	settings.withTemplates = !forComparison;
	settings.forComparison = forComparison;
	const pliant::Status status = pliant::saveWorld( stage.world(), bytes, settings );
	if ( !status.ok() )
	{
		std::fprintf( stderr, "%s\n", status.sentence.c_str() );
	}
	return bytes;
}

void stepOn( Stage& stage )
{
	for ( int k = 0; k < kStepsAfter; ++k )
	{
		stage.world().stepSimulation( btScalar( 1 ) / kStepsPerSecond, 0 );
	}
}

/// Bullet moves kinematic bodies to the transforms of their motion states, which belong to the scene.
void holdKinematicBodies( Stage& stage )
{
	const btCollisionObjectArray& objects = stage.world().getCollisionObjectArray();
	for ( int k = 0; k < objects.size(); ++k )
	{
		btRigidBody* const body = btRigidBody::upcast( objects[k] );
		if ( body && body->isKinematicObject() && body->getMotionState() )
		{
			body->getMotionState()->setWorldTransform( body->getWorldTransform() );
		}
	}
}

/// States of a stage's world: saved, expected right after a restore, and expected later.
struct Saved
{
	std::any own;
	Bytes world, then, wanted;
};

/// Restores, steps on, and prints the result.
std::string comparison( Scene& scene, Stage& stage, const Saved& saved )
{
	scene.restoreOwnState( saved.own );
	const auto restored = pliant::restoreWorld( stage.world(), saved.world );
	if ( !restored )
	{
		return restored.status.sentence;
	}
	holdKinematicBodies( stage );
	const bool isSame = save( stage, true ) == saved.then;
	stepOn( stage );
	return save( stage, true ) == saved.wanted ? isSame ? "equal" : "equal, but not right away"
		: isSame                               ? "DIFFERENT"
											   : "DIFFERENT right away";
}

void playTo( Play& play, int step )
{
	for ( int k = 0; k < step; ++k )
	{
		play.step();
		play.skin(); // cracks are drawn
	}
}

} // namespace

int runSnapshots( const SceneEntry& entry, const RunSettings& settings )
{
	std::printf( "%s: saved at a step, and %d steps on\n\n", entry.name, kStepsAfter );
	std::printf( "  %6s %8s %8s %10s   %-28s %s\n", "step", "bodies", "pieces", "bytes", "in the same world", "in another world" );
	const int steps = [&] {
		Play play( entry, settings.stage );
		const FilmLength film = play.film( settings.framesPerSecond, settings.frames );
		return std::max( 1, film.frames * film.stepsPerFrame );
	}();
	std::mt19937 random( settings.stage.seed );
	bool areEqual = true;
	for ( int k = 0; k < settings.snapshots; ++k )
	{
		const int step = 1 + int( random() % unsigned( steps ) );
		Play play( entry, settings.stage ), other( entry, settings.stage );
		if ( !play.isGood() || !other.isGood() )
		{
			std::fprintf( stderr, "%s: %s\n", entry.name, play.stage().status().sentence.c_str() );
			return 1;
		}
		playTo( play, step );
		playTo( other, 1 ); // this may make bodies kinematic
		const std::vector<Stage*> stages = play.stages(), others = other.stages();
		for ( std::size_t s = 0; s < stages.size(); ++s )
		{
			Stage& stage = *stages[s];
			Saved saved{ play.scene().ownState(), save( stage, false ), save( stage, true ), {} };
			const int bodies = stage.world().softBodyCount(), pieces = stage.world().fragmentCount();
			stepOn( stage );
			saved.wanted = save( stage, true );
			if ( others[s]->world().getGravity() != stage.world().getGravity() ) // a setting of the scene
			{
				others[s]->world().setGravity( stage.world().getGravity() );
			}
			const std::string here = comparison( play.scene(), stage, saved ), there = comparison( other.scene(), *others[s], saved );
			std::printf( "  %6d %8d %8d %10zu   %-28s %s\n", step, bodies, pieces, saved.world.size(), here.c_str(), there.c_str() );
			std::fflush( stdout ); // it takes a while
			areEqual = areEqual && here == "equal" && there == "equal";
		}
	}
	return areEqual ? 0 : 1;
}

} // namespace pliant_demos
