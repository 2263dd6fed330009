// The cost of a frame under a box of 1 to 1 000 times a block's mass, compared with the same block without a load
// (docs/design/implicit.md).

#include "support/explicit_material.h"
#include "support/test_world.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <vector>

namespace pliant {
namespace {

constexpr int kFrames = 400;

/// A cube of 6 x 6 x 6 cells and 216 kg a millimetre above a plane, with the box a millimetre above it; nothing sleeps.
struct LoadScene : test::SoftWorld
{
	LoadScene( const std::shared_ptr<const BodyTemplate>& cube, Elasticity elasticity, int halfWidth, double ratio, double modulus )
	{
		addFloor();
		Material material = test::explicitMaterial();
		material.elasticity = elasticity;
		material.regionHalfWidth = halfWidth;
		material.youngsModulus = float( modulus );
		add( cube, btVector3( 0, btScalar( 0.301 ), 0 ), material )->setActivationState( DISABLE_DEACTIVATION );
		if ( ratio > 0 )
		{
			add( btScalar( ratio * 216.0 ), new btBoxShape( btVector3( btScalar( 0.3 ), btScalar( 0.3 ), btScalar( 0.3 ) ) ),
				btVector3( 0, btScalar( 0.902 ), 0 ) )
				->setActivationState( DISABLE_DEACTIVATION );
		}
	}
	double frame()
	{
		step( 1 );
		return 1e3 * world.stepReport().total;
	}
};

double meanOf( const std::vector<double>& values )
{
	double sum = 0.0;
	for ( const double value : values )
	{
		sum += value / double( values.size() );
	}
	return sum;
}

/// Frame by frame in turn, the shortest of all runs for each frame: means over five seconds from the release. With this modulus the box
/// compresses the block by a tenth.
void loadedBlock( benchmark::State& state )
{
	const auto cube = test::cubeTemplate( 0.6f, 6 );
	const double ratio = double( state.range( 0 ) ), modulus = ratio * 9.81 * 216.0 / 0.36 / 0.1;
	const int halfWidth = int( state.range( 1 ) );
	std::vector<double> cost[3];
	for ( std::vector<double>& frames : cost )
	{
		frames.assign( kFrames, 1e9 );
	}
	for ( auto _ : state )
	{
		LoadScene loaded( cube, Elasticity::Implicit, halfWidth, ratio, modulus );
		LoadScene bare( cube, Elasticity::Implicit, halfWidth, 0, modulus );
		// The stiffest that an explicit step can be.
		LoadScene plain( cube, Elasticity::Explicit, halfWidth, 0, 2e4 );
		for ( std::size_t k = 0; k < kFrames; ++k )
		{
			cost[0][k] = std::min( cost[0][k], loaded.frame() );
			cost[1][k] = std::min( cost[1][k], bare.frame() );
			cost[2][k] = std::min( cost[2][k], plain.frame() );
		}
	}
	state.counters["loaded_ms"] = meanOf( cost[0] );
	state.counters["bare_ms"] = meanOf( cost[1] );
	state.counters["explicit_ms"] = meanOf( cost[2] );
	state.counters["over_bare"] = meanOf( cost[0] ) / meanOf( cost[1] );
	state.counters["over_explicit"] = meanOf( cost[0] ) / meanOf( cost[2] );
}
BENCHMARK( loadedBlock )
	->ArgNames( { "ratio", "w" } )
	->ArgsProduct( { { 1, 10, 100, 1000 }, { 1, 2 } } )
	->Iterations( 3 )
	->Unit( benchmark::kMillisecond );

} // namespace
} // namespace pliant
