// The study's own solvers compared with known values.

#include "demos/study/theory.h"

#include <gtest/gtest.h>

#include <cmath>

namespace {

using namespace pliant_study;

TEST( Theory, HeavyElasticaIsABeamUnderLittleWeight )
{
	// w ( 6 s^2 - 4 s^3 + s^4 ) / 24 and its end at w / 8.
	const double load = 1e-3;
	EXPECT_NEAR( heavyElastica( load, 1 ).y(), load / 8, 1e-6 * load );
	EXPECT_NEAR( heavyElastica( load, 0.5 ).y(), load * ( 6 * 0.25 - 4 * 0.125 + 0.0625 ) / 24, 1e-6 * load );
	EXPECT_NEAR( heavyElastica( load, 1 ).x(), 1, 1e-6 );
}

TEST( Theory, HeavyElasticaHangsDownUnderMuch )
{
	const Eigen::Vector2d end = heavyElastica( 50, 1 );
	EXPECT_GT( end.y(), 0.8 );
	EXPECT_GT( end.x(), 0.05 );
	EXPECT_LT( end.norm(), 1 );
}

TEST( Theory, NeoHookeanBarKeepsItsVolumeTowardsOneHalf )
{
	EXPECT_NEAR( neoHookeanAcross( 2, 0 ), 1, 1e-9 );
	EXPECT_NEAR( neoHookeanAcross( 2, 0.49999 ), std::sqrt( 0.5 ), 1e-4 );
	EXPECT_NEAR( ( 1 - neoHookeanAcross( 1.001, 0.3 ) ) / 0.001, 0.3, 1e-3 );
}

TEST( Theory, CooksMembraneIsTheOneInPrint )
{
	// E = 1, nu = 1/3, load 1: 23.96 in the middle of the right edge (Simo and Rifai 1990).
	EXPECT_NEAR( cookDeflection( 1.0 / 3, 48, 52 ), 23.96, 0.05 );
}

} // namespace
