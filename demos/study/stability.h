#pragma once

// The stability matrix: extreme cases by every method, coloured by the result.

#include "demos/study/candidate.h"
#include "demos/study/specimen.h"

#include <string>
#include <vector>

namespace pliant_study {

/// The extreme cases; lengths are fractions of the body's diagonal.
enum class Ordeal : int
{
	Drop,      ///< on a plane, from the height of its own size or with an initial velocity
	Load,      ///< rests on a plane with a box on it
	Flat,      ///< free: all nodes moved into a plane, released
	Mirrored,  ///< free: inverted
	Scrambled, ///< free: nodes at the positions of other nodes
	Point,     ///< free: all in one point
	Stretched, ///< free: a thousand times as long
	Twisted,   ///< free: by 720 degrees from end to end
	Spin       ///< free, turning
};

struct StabilityCase
{
	std::string name;
	Ordeal ordeal = Ordeal::Drop;
	std::string shape = "cube";
	int cells = 125;
	double diagonal = 1;     ///< m
	double step = 1.0 / 60;  ///< s a game step
	double gravity = 9.81;   ///< m/s^2
	double modulus = 0;      ///< Pa; 0: compressed by a tenth under its own weight on Earth
	bool isRawAlpha = false; ///< alpha 1 instead of a modulus
	double speed = 0;        ///< m/s, downwards
	double massRatio = 0;    ///< of the box to the body
	double far = 0;          ///< m from the world's origin
};

enum class Colour : int
{
	Green,
	Yellow,
	Red,
	None ///< not possible with this method
};

struct Verdict
{
	Colour colour = Colour::Green;
	std::string reason;      ///< empty for green cells
	double inverted = 0;     ///< fraction of the finest cells at the end
	double energyGrowth = 0; ///< without work done
	double depth = 0;        ///< largest depth of a cell's centre below the plane's surface plus its radius, cells; 0.5: on the plane
	double recovery = -1;    ///< s until the shape stays within a hundredth of its diagonal of the rest shape; -1: not measured
	double microseconds = 0; ///< a game step, mean
};

/// A method in the matrix: a candidate and the features that are switched on.
struct StabilityMethod
{
	std::string name;
	Candidate candidate;
	bool isFracturing = false, isPlastic = false;
};

std::vector<StabilityCase> stabilityCases();
std::vector<StabilityMethod> stabilityMethods( bool withBullet );

Verdict endure( const StabilityCase& ordeal, const StabilityMethod& method, int steps, unsigned seed );

struct StabilityPlan
{
	int steps = 10000;
	unsigned seed = 1;
	std::string folder = "out/stability";
	std::vector<std::string> cases, methods; ///< only those whose name begins with one of these; empty: all
	bool withBullet = true;
	bool isFresh = false;
};

/// Writes stability.csv and stability.html; 0, or the process's exit code: 3 where the default method is red somewhere.
int studyStability( const StabilityPlan& plan );

const char* toString( Colour colour );

} // namespace pliant_study
