// The coarse system of the implicit preconditioner (docs/design/implicit.md): blocks of six compared with Eigen's sparse factor, which
// works on single entries. As in a pile: 20 soft bodies of 12 unknowns and 32 rigid ones of 6, 432 in all, each coupled with its neighbours
// in a heap of layers of nine: the next two and those above and below.

#include "world/linear/coarse_system.h"

#include <Eigen/SparseCholesky>

#include <benchmark/benchmark.h>

#include <vector>

namespace {

using pliant::CoarseSystem;

constexpr int kSoft = 20, kRigid = 32, kLayer = 9;

struct Heap
{
	Heap()
	{
		for ( int k = 0; k < kSoft + kRigid; ++k )
		{
			sizes.push_back( k % 5 < 2 && k < 5 * kSoft / 2 ? 12 : 6 );
			for ( const int before : { 1, kLayer } )
			{
				if ( before <= k )
				{
					pairs.emplace_back( k, k - before );
				}
			}
		}
		std::vector<CoarseSystem::Pair> all = pairs;
		system.layOut( sizes, all );
		whole.setZero( system.size(), system.size() );
		const auto number = []( int i, int j ) { return double( ( i * 7 + j * 13 ) % 11 - 5 ) / 5.0; };
		const auto add = [&]( int a, int b ) {
			for ( int j = 0; j < sizes[std::size_t( b )]; ++j )
			{
				for ( int i = 0; i < sizes[std::size_t( a )]; ++i )
				{
					const int row = system.offset( a ) + i, column = system.offset( b ) + j;
					whole( row, column ) = whole( column, row ) = row == column ? 200.0 : a == b ? 0.1 : number( row, column );
				}
			}
		};
		for ( int k = 0; k < kSoft + kRigid; ++k )
		{
			add( k, k );
		}
		for ( const auto& [a, b] : pairs )
		{
			add( a, b );
		}
	}
	void fill()
	{
		system.clear();
		const auto put = [this]( int a, int b ) {
			system.block( a, b ) = whole.block( system.offset( a ), system.offset( b ), sizes[std::size_t( a )], sizes[std::size_t( b )] );
		};
		for ( int k = 0; k < kSoft + kRigid; ++k )
		{
			put( k, k );
		}
		for ( const auto& [a, b] : pairs )
		{
			put( a, b );
		}
	}

	std::vector<int> sizes;
	std::vector<CoarseSystem::Pair> pairs;
	CoarseSystem system;
	Eigen::MatrixXd whole;
};

void coarseFactor( benchmark::State& state )
{
	Heap heap;
	heap.fill();
	const Eigen::SparseMatrix<double> sparse = heap.whole.sparseView();
	Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> eigen;
	eigen.analyzePattern( sparse );
	for ( auto _ : state )
	{
		if ( state.range( 0 ) == 0 )
		{
			benchmark::DoNotOptimize( heap.system.factor() );
		}
		else
		{
			eigen.factorize( sparse );
			benchmark::DoNotOptimize( eigen.info() );
		}
	}
	state.counters["unknowns"] = double( heap.system.size() );
}

void coarseSolve( benchmark::State& state )
{
	Heap heap;
	heap.fill();
	heap.system.factor();
	const Eigen::SparseMatrix<double> sparse = heap.whole.sparseView();
	const Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> eigen( sparse );
	const Eigen::VectorXd r = Eigen::VectorXd::LinSpaced( heap.system.size(), -1.0, 1.0 );
	Eigen::VectorXd x = r, other = r;
	heap.system.solve( r, x );
	if ( eigen.info() != Eigen::Success || !( ( x - eigen.solve( r ) ).norm() < 1e-9 * x.norm() ) )
	{
		state.SkipWithError( "the two do not agree" );
		return;
	}
	for ( auto _ : state )
	{
		if ( state.range( 0 ) == 0 )
		{
			heap.system.solve( r, x );
		}
		else
		{
			other = eigen.solve( r );
		}
		benchmark::ClobberMemory();
	}
}

BENCHMARK( coarseFactor )->ArgName( "eigen" )->Arg( 0 )->Arg( 1 )->Unit( benchmark::kMicrosecond );
BENCHMARK( coarseSolve )->ArgName( "eigen" )->Arg( 0 )->Arg( 1 )->Unit( benchmark::kMicrosecond );

} // namespace
