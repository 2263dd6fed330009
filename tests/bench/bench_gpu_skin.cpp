// The cost of the skin in a frame for the CPU: computed there, and as node transforms for the GPU. One thread.

#include "lattice/test_meshes.h"
#include "support/explicit_material.h"
#include "support/test_world.h"

#include <pliant/render/gpu_surface.h>

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>

namespace pliant {
namespace {

using Clock = std::chrono::steady_clock;

double microseconds( Clock::time_point begin )
{
	return std::chrono::duration<double, std::micro>( Clock::now() - begin ).count();
}

/// A bumpy sphere with as many vertices as the bunny (16 456), in a world of its own.
struct Drawn
{
	test::WorldOf<SoftBodyWorld> in;
	std::unique_ptr<SoftBody> body;

	explicit Drawn( int cells )
	{
		const test::Mesh mesh = test::makeBumpySphere( 0.5, 0.1, 91, 181 );
		LatticeSettings settings;
		settings.targetCells = cells;
		Material soft = test::explicitMaterial();
		soft.youngsModulus = 2e4f;
		body = std::move( SoftBody::create( BodyTemplate::build( mesh.view(), settings ).value, btTransform::getIdentity(), soft ).value );
		in.world.setGravity( btVector3( 0, 0, 0 ) );
		in.world.addSoftBody( body.get() );
		body->setActivationState( DISABLE_DEACTIVATION );
	}
	~Drawn() { in.world.removeSoftBody( body.get() ); }
	/// Keeps it bending.
	void step( int frame )
	{
		if ( frame % 30 == 0 )
		{
			static_cast<void>( body->setVelocities( btVector3( 0, 0, 0 ), btVector3( 3, frame % 60 == 0 ? 5 : -5, 0 ) ) );
			static_cast<void>( body->applyImpulse( btVector3( body->mass(), 0, 0 ), 0 ) );
		}
		in.world.stepSimulation( btScalar( 1 ) / 60, 0 );
	}
};

double medianOf( std::vector<double>& times )
{
	std::nth_element( times.begin(), times.begin() + std::ptrdiff_t( times.size() / 2 ), times.end() );
	return times[times.size() / 2];
}

/// In turn, frame by frame: the result is the ratio of the medians.
void skinOfAFrame( benchmark::State& state )
{
	Drawn onCpu( int( state.range( 0 ) ) ), onGpu( int( state.range( 0 ) ) );
	onCpu.body->surface();
	onGpu.body->gpuSurface();
	std::vector<double> cpu, gpu;
	int frame = 0;
	for ( auto _ : state )
	{
		onCpu.step( frame );
		onGpu.step( frame++ );
		Clock::time_point begin = Clock::now();
		benchmark::DoNotOptimize( onCpu.body->surface().positions );
		cpu.push_back( microseconds( begin ) );
		begin = Clock::now();
		benchmark::DoNotOptimize( onGpu.body->gpuSurface().nodeTransforms );
		gpu.push_back( microseconds( begin ) );
		state.SetIterationTime( 1e-6 * ( cpu.back() + gpu.back() ) );
	}
	state.counters["vertices"] = onCpu.body->surface().vertexCount;
	state.counters["nodes"] = onCpu.body->nodeCount();
	state.counters["cpu_us"] = medianOf( cpu );
	state.counters["gpu_us"] = medianOf( gpu );
	state.counters["ratio"] = medianOf( cpu ) / medianOf( gpu );
}
BENCHMARK( skinOfAFrame )->ArgName( "cells" )->Arg( 65 )->Arg( 1000 )->Iterations( 120 )->UseManualTime()->Unit( benchmark::kMicrosecond );

} // namespace
} // namespace pliant
