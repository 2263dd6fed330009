// Random impacts of soft bodies with obstacles and each other, without damping and gravity: do they gain kinetic energy, or lose angular
// momentum?

#include "experiments/experiments.h"
#include "support/random_impacts.h"

#include <algorithm>
#include <cstdio>

namespace pliant::experiment {

namespace {

using test::Ground;
using test::Rubbed;

constexpr double kGain = 1e-3; ///< fraction of the energy that counts as a gain: more than rounding and the float positions cause

constexpr Ground kGrounds[] = { Ground::Floor, Ground::Box, Ground::Soft, Ground::SoftWithLevels };

/// One cell of a table.
void printGains( int count, Ground ground, Elasticity elasticity, float strain )
{
	int gains = 0;
	double worst = 0.0;
	for ( int seed = 0; seed < count; ++seed )
	{
		const double most = test::strike( ground, elasticity, unsigned( seed ), strain );
		gains += most > 1.0 + kGain ? 1 : 0;
		worst = std::max( worst, most );
	}
	std::printf( " %d, %.4f |", gains, worst );
	std::fflush( stdout );
}

/// The same for bodies that break.
void printShatters( int count, Ground ground, Elasticity elasticity, BreakRule rule )
{
	int broken = 0, gains = 0;
	double worst = 0.0;
	for ( int seed = 0; seed < count; ++seed )
	{
		const test::Shattered shattered = test::shatter( ground, elasticity, rule, seed % 2 == 0 ? 0 : 1 + seed / 2 % 2, unsigned( seed ) );
		broken += shattered.hasBroken ? 1 : 0;
		gains += shattered.most > 1.0 + kGain ? 1 : 0;
		worst = std::max( worst, shattered.most );
	}
	std::printf( " %d, %d, %.4f |", broken, gains, worst );
	std::fflush( stdout );
}

void printStrikes( int count )
{
	std::printf( "Cubes with levels strike, %d each: those whose energy of motion rises by more than %g of it, and the worst\n\n| | "
				 "explicit | implicit |\n|---|---|---|\n",
		count, kGain );
	for ( const Ground ground : kGrounds )
	{
		std::printf( "| %s |", test::kGroundNames[int( ground )] );
		printGains( count, ground, Elasticity::Explicit, 0.0f );
		printGains( count, ground, Elasticity::Implicit, 0.0f );
		std::printf( "\n" );
	}
}

// Bodies that split by strain do so while they are compressed.
void printStrikesThatSplitByStrain( int count )
{
	std::printf( "\nThe same by strain alone, explicit, at strains of\n\n| | 0.02 | 0.05 | 0.1 | 0.2 |\n|---|---|---|---|---|\n" );
	for ( const Ground ground : kGrounds )
	{
		std::printf( "| %s |", test::kGroundNames[int( ground )] );
		for ( const float strain : { 0.02f, 0.05f, 0.1f, 0.2f } )
		{
			printGains( count, ground, Elasticity::Explicit, strain );
		}
		std::printf( "\n" );
	}
}

void printRubs( int count )
{
	struct Kind
	{
		const char* name;
		bool ( *isImplicit )( int body );
	};
	const Kind kinds[] = { { "explicit", []( int ) { return false; } }, { "implicit", []( int ) { return true; } },
		{ "every other implicit", []( int k ) { return k % 2 == 1; } } };
	std::printf( "\nTwo to four spinning cubes fly into each other, %d each\n\n| | spin lost by more than 1e-4 | at most | energy rises | "
				 "at most |\n|---|---|---|---|---|\n",
		count );
	for ( const Kind& kind : kinds )
	{
		int losses = 0, gains = 0;
		Rubbed worst;
		for ( int seed = 0; seed < count; ++seed )
		{
			const Rubbed rubbed = test::rub( kind.isImplicit, unsigned( seed ) );
			losses += rubbed.lost > 1e-4 ? 1 : 0;
			gains += rubbed.most > 1.0 + kGain ? 1 : 0;
			worst = Rubbed{ std::max( worst.lost, rubbed.lost ), std::max( worst.most, rubbed.most ) };
		}
		std::printf( "| %s | %d | %.1e | %d | %.4f |\n", kind.name, losses, worst.lost, gains, worst.most );
	}
}

} // namespace

void impactsExperiment( int count )
{
	printStrikes( count );
	printStrikesThatSplitByStrain( count );
	printRubs( count );
}

// Half of each cell's bodies have one or two levels.
void shattersExperiment( int count )
{
	std::printf( "Undamped cubes that break, at strains of 0.02 to 0.3, strike, %d each, half of them with levels: those that break, those "
				 "whose energy of motion rises by more than %g of it, and the worst\n\n"
				 "| | explicit, by distance | explicit, planes | implicit, by distance | implicit, planes |\n|---|---|---|---|---|\n",
		count, kGain );
	for ( const Ground ground : kGrounds )
	{
		std::printf( "| %s |", test::kGroundNames[int( ground )] );
		for ( const Elasticity elasticity : { Elasticity::Explicit, Elasticity::Implicit } )
		{
			printShatters( count, ground, elasticity, BreakRule::Distance );
			printShatters( count, ground, elasticity, BreakRule::Plane );
		}
		std::printf( "\n" );
	}
}

} // namespace pliant::experiment
