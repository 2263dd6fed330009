// Soft bodies shot at walls of five kinds at 10 to 100 m/s, both elasticities, default settings: how many pass through?

#include "experiments/experiments.h"
#include "support/shots.h"

#include <cstdio>
#include <cstdlib>

namespace pliant::experiment {

namespace {

struct Tally
{
	int shots = 0, hits = 0, passed = 0, sick = 0;
	double deepest = 0.0;
};

void shootAll( const test::ShootingRange& range, Elasticity elasticity, int count )
{
	Tally of[test::kWalls][test::kShots];
	int passed = 0;
	for ( int seed = 0; seed < count; ++seed )
	{
		const test::ShotResult r = range.shoot( unsigned( seed ), elasticity );
		Tally& tally = of[int( r.wall )][int( r.shot )];
		const bool isThrough = r.behind > 0;
		++tally.shots;
		tally.hits += r.hits ? 1 : 0;
		tally.passed += isThrough ? 1 : 0;
		tally.sick += r.isHealthy ? 0 : 1;
		tally.deepest = std::max( tally.deepest, r.deepest );
		passed += isThrough ? 1 : 0;
		if ( isThrough && std::getenv( "PLIANT_SHOTS" ) )
		{
			std::printf( "shot %d: %s at %s, %.0f m/s, %.0f Pa: %d nodes behind, %.3f m\n", seed, test::kShotNames[int( r.shot )],
				test::kWallNames[int( r.wall )], r.speed, r.youngsModulus, r.behind, r.deepest );
		}
	}
	std::printf( "%s: %d of %d pass through\n\n| hits / passes / deepest, mm |",
		elasticity == Elasticity::Explicit ? "Explicit" : "Implicit", passed, count );
	for ( const char* name : test::kShotNames )
	{
		std::printf( " %s |", name );
	}
	std::printf( "\n|---|---|---|---|---|---|---|---|\n" );
	for ( int wall = 0; wall < test::kWalls; ++wall )
	{
		std::printf( "| %s |", test::kWallNames[wall] );
		for ( const Tally& tally : of[wall] )
		{
			std::printf( " %d / %d / %.1f%s |", tally.hits, tally.passed, 1e3 * tally.deepest, tally.sick > 0 ? " (not finite)" : "" );
		}
		std::printf( "\n" );
	}
	std::printf( "\n" );
	std::fflush( stdout );
}

} // namespace

void shotsExperiment( int count )
{
	const test::ShootingRange range;
	shootAll( range, Elasticity::Explicit, count );
	shootAll( range, Elasticity::Implicit, count );
}

} // namespace pliant::experiment
