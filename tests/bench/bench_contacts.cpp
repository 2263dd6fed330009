// The cost of a contact of an explicit body: the total, and the library's part, which excludes the solver, Bullet's collision and matching
// (docs/design/contacts.md). The heap of bench_pile.h.

#include "bench_pile.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <vector>

namespace pliant {
namespace {

using Clock = std::chrono::steady_clock;

double secondsSince( Clock::time_point start )
{
	return std::chrono::duration<double>( Clock::now() - start ).count();
}

/// Islands and solver: from the first call that solveConstraints makes to the last.
class TimedSolver : public btSequentialImpulseConstraintSolver
{
public:
	double seconds = 0.0;

	void prepareSolve( int bodies, int manifolds ) override
	{
		m_start = Clock::now();
		btSequentialImpulseConstraintSolver::prepareSolve( bodies, manifolds );
	}
	void allSolved( const btContactSolverInfo& info, btIDebugDraw* drawer ) override
	{
		btSequentialImpulseConstraintSolver::allSolved( info, drawer );
		seconds += secondsSince( m_start );
	}

private:
	Clock::time_point m_start;
};

/// Bullet's callback is a function without a context.
double* softPairSeconds = nullptr;

void timeSoftPairs( btBroadphasePair& pair, btCollisionDispatcher& dispatcher, const btDispatcherInfo& info )
{
	const auto isSoft = []( const btBroadphaseProxy* proxy ) {
		return SoftBody::upcast( static_cast<const btCollisionObject*>( proxy->m_clientObject ) ) != nullptr;
	};
	const bool isOurs = isSoft( pair.m_pProxy0 ) || isSoft( pair.m_pProxy1 );
	const Clock::time_point start = Clock::now();
	btCollisionDispatcher::defaultNearCallback( pair, dispatcher, info );
	*softPairSeconds += isOurs ? secondsSince( start ) : 0.0;
}

double median( std::vector<double>& values )
{
	std::nth_element( values.begin(), values.begin() + std::ptrdiff_t( values.size() / 2 ), values.end() );
	return values[values.size() / 2];
}

void pileContacts( benchmark::State& state )
{
	test::SoftWorld scene;
	TimedSolver solver;
	scene.world.setConstraintSolver( &solver );
	double pairs = 0.0;
	softPairSeconds = &pairs;
	scene.dispatcher.setNearCallback( timeSoftPairs );
	test::fillPile( scene, Elasticity::Explicit );
	std::vector<double> all, ours;
	double contacts = 0.0;
	for ( auto _ : state )
	{
		pairs = solver.seconds = 0.0;
		scene.step( 1 );
		const StepReport& report = scene.world.stepReport();
		contacts = double( report.softContacts ) * report.substeps;
		// Finding and writing contacts, positions, the work around the solver, and x += h v of all nodes.
		const double own = pairs + ( report.solve - solver.seconds ) + report.forces + report.integrate;
		all.push_back( 1e6 * report.total / contacts );
		ours.push_back( 1e6 * own / contacts );
	}
	state.counters["contacts"] = contacts;
	state.counters["us_all"] = median( all );
	state.counters["us_ours"] = median( ours );
	state.counters["us_all_least"] = *std::min_element( all.begin(), all.end() );
	state.counters["us_ours_least"] = *std::min_element( ours.begin(), ours.end() );
	scene.world.setConstraintSolver( &scene.solver );
	softPairSeconds = nullptr;
}

BENCHMARK( pileContacts )->Iterations( 200 )->Unit( benchmark::kMillisecond );

} // namespace
} // namespace pliant
