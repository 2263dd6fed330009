// The same scenes over the full ranges of their settings.

#include "support/plastic_scenes.h"
#include "support/put_inside.h"
#include "support/squeezes.h"

#include <gtest/gtest.h>

namespace pliant {
namespace {

TEST( EnergyFull, PlasticCorners )
{
	for ( unsigned seed = 0; seed < 400; ++seed )
	{
		const test::PlasticScene scene = test::plasticScene( seed );
		const test::PlasticEnergy energy = test::run( scene, 60 );
		EXPECT_TRUE( energy.isHealthy ) << seed;
		EXPECT_LT( energy.most, test::mostFraction( scene ) * energy.brought ) << seed;
	}
}

TEST( EnergyFull, Squeezed )
{
	for ( const Elasticity elasticity : { Elasticity::Explicit, Elasticity::Implicit } )
	{
		for ( const double youngsModulus : { 1e3, 1e4, 1e5, 1e6, 1e7 } )
		{
			for ( int kind = 0; kind < 4; ++kind )
			{
				for ( const double gap : { 0.06, 0.09, 0.32 } )
				{
					test::Squeeze how;
					how.elasticity = elasticity;
					how.youngsModulus = youngsModulus;
					how.isSlot = kind == 1;
					how.coarseLevels = kind == 2 ? 1 : 0;
					how.yieldStrain = kind == 3 ? 0.05f : 0.0f;
					how.gap = gap;
					how.seconds = 15.0;
					const test::Squeezed squeezed = test::squeeze( how );
					EXPECT_TRUE( squeezed.isHealthy );
					EXPECT_LT( squeezed.late, 1.5 * squeezed.early + 1.0 );
					EXPECT_LT( squeezed.motion, squeezed.strain + squeezed.out );
				}
			}
		}
	}
}

TEST( EnergyFull, PutInside )
{
	for ( const Elasticity elasticity : { Elasticity::Explicit, Elasticity::Implicit } )
	{
		for ( const double youngsModulus : { 1e4, 1e5, 1e6, 1e7, 1e8 } )
		{
			for ( int kind = 0; kind < 14; ++kind )
			{
				test::PutInside how;
				how.elasticity = elasticity;
				how.youngsModulus = youngsModulus;
				how.what = kind < 2 ? test::Inside::Floor : kind < 4 ? test::Inside::StaticBox : test::Inside::Cube;
				const double apart[] = { 0.0, 0.15, 0.33, 0.47, 0.55 };
				how.depth = kind < 2 ? ( kind == 0 ? 0.1 : 0.3 ) : kind < 4 ? 0.0 : apart[( kind - 4 ) / 2];
				how.isRotated = kind % 2 == 1 && kind > 1;
				const test::CameOut out = test::putInside( how );
				EXPECT_TRUE( out.isHealthy );
				EXPECT_LT( out.fastest, 3.0 );
				EXPECT_GT( out.nearest, 0.75 );
			}
		}
	}
}

} // namespace
} // namespace pliant
