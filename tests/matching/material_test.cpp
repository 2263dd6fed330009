// Materials are checked when they are passed, and stiffness is in pascals for any step.

#include "pliant/material.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace pliant {
namespace {

TEST( Material, RefusesEveryBadValueOnThatCall )
{
	const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
	EXPECT_TRUE( check( Material{} ).ok() );
	const std::vector<std::function<float&( Material& )>> values = { []( Material& m ) -> float& { return m.density; },
		[]( Material& m ) -> float& { return m.youngsModulus; }, []( Material& m ) -> float& { return m.alpha; },
		[]( Material& m ) -> float& { return m.beta; }, []( Material& m ) -> float& { return m.damping; },
		[]( Material& m ) -> float& { return m.wobbleDamping; }, []( Material& m ) -> float& { return m.yieldStrain; },
		[]( Material& m ) -> float& { return m.plasticCreep; }, []( Material& m ) -> float& { return m.plasticLimit; } };
	for ( const auto& value : values )
	{
		for ( float bad : { nan, inf, -inf, -1.0f } )
		{
			Material material;
			value( material ) = bad;
			const Status status = check( material );
			EXPECT_EQ( status.code, ResultCode::BadMaterial );
			EXPECT_NE( status.sentence.find( "Material::" ), std::string::npos );
		}
	}
	for ( int bad : { 0, -1, 5 } )
	{
		Material material;
		material.regionHalfWidth = bad;
		EXPECT_FALSE( check( material ).ok() );
	}
	for ( int bad : { 1, 65 } )
	{
		Material material;
		material.clusterEdge = bad;
		EXPECT_FALSE( check( material ).ok() );
	}
}

TEST( Material, StiffnessPlanFollowsTheFormula )
{
	Material material;
	material.youngsModulus = 1000.0f;
	const StiffnessPlan plan = planStiffness( material, 0.1f, 1.0f / 60.0f, 4 );
	// alpha = 3 E h^2 / ( rho d^2 w ( w + 1 ) )
	EXPECT_NEAR( plan.alpha, 3.0 * 1000.0 / 240.0 / 240.0 / ( 1000.0 * 0.01 * 2.0 ), 1e-8 );
	EXPECT_TRUE( plan.reachable );
	EXPECT_NEAR( plan.reachedModulus, 1000.0f, 0.1f );
}

TEST( Material, NamesTheSubstepsAStiffOneNeeds )
{
	Material material;
	material.elasticity = Elasticity::Explicit;
	material.youngsModulus = 1e6f;
	const StiffnessPlan plan = planStiffness( material, 0.05f, 1.0f / 60.0f, 4 );
	EXPECT_FALSE( plan.reachable );
	EXPECT_EQ( plan.alpha, 1.0f );
	EXPECT_LT( plan.reachedModulus, 1e6f );
	EXPECT_TRUE( planStiffness( material, 0.05f, 1.0f / 60.0f, plan.substepsNeeded ).reachable );
	EXPECT_FALSE( planStiffness( material, 0.05f, 1.0f / 60.0f, plan.substepsNeeded - 1 ).reachable );
}

} // namespace
} // namespace pliant
