// Rotations alone: the careful scalar computation for each matrix. The lanes' computation is part of coreStep; its time is measured by
// difference (see docs/benchmarks.md).

#include "matching/rotation.h"
#include "support/block_body.h"

#include <benchmark/benchmark.h>

#include <vector>

namespace pliant {
namespace {

void carefulRotation( benchmark::State& state )
{
	test::Seeded random( 1 );
	std::vector<Eigen::Matrix3f> matrices( 1024 );
	for ( Eigen::Matrix3f& m : matrices )
	{
		for ( int k = 0; k < 9; ++k )
		{
			m( k / 3, k % 3 ) = random.uniform( -1.0f, 1.0f );
		}
	}
	Eigen::Quaternionf q = Eigen::Quaternionf::Identity();
	std::size_t k = 0;
	for ( auto _ : state )
	{
		q = fitRotation( matrices[k++ % matrices.size()], q );
		benchmark::DoNotOptimize( q );
	}
}
BENCHMARK( carefulRotation );

} // namespace
} // namespace pliant
