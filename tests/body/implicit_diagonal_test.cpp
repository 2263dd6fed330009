// The diagonal of the implicit operator for nodes of all sizes in intact and torn bodies.

#include "body/implicit_levels_case.h"
#include "support/block_lattice.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

namespace pliant {
namespace {

using namespace implicit_case;

/// A block with four tenths of its links: regions of a few nodes, in lines and planes.
Lattice tornBlock()
{
	Lattice lattice = makeBlockLattice( 12, 8, 8, 0.1f );
	test::Seeded random( 7 );
	std::vector<std::vector<std::uint32_t>> kept( std::size_t( lattice.cellCount() ) );
	for ( std::uint32_t i = 0; i < std::uint32_t( lattice.cellCount() ); ++i )
	{
		for ( std::uint32_t k = lattice.linkStart[i]; k < lattice.linkStart[i + 1]; ++k )
		{
			if ( i < lattice.linkTo[k] && random.uniform( 0, 1 ) < 0.4f )
			{
				kept[i].push_back( lattice.linkTo[k] );
				kept[lattice.linkTo[k]].push_back( i );
			}
		}
	}
	lattice.linkStart.assign( 1, 0 );
	lattice.linkTo.clear();
	for ( std::vector<std::uint32_t>& to : kept )
	{
		std::sort( to.begin(), to.end() );
		lattice.linkTo.insert( lattice.linkTo.end(), to.begin(), to.end() );
		lattice.linkStart.push_back( std::uint32_t( lattice.linkTo.size() ) );
	}
	constexpr std::uint32_t kNeighbours = 26;
	for ( std::size_t i = 0; i < kept.size(); ++i )
	{
		lattice.isSurface[i] = lattice.linkStart[i + 1] - lattice.linkStart[i] != kNeighbours;
	}
	return lattice;
}

// The preconditioner is built from this diagonal. An estimate that makes nodes up to 23 times too easy to move costs an eighth more
// products with fifteen breaking elephants.
TEST( ImplicitLevels, ComputeTheirDiagonal )
{
	const std::vector<Rule> all = rules();
	for ( std::size_t which = 0; which < 2 * all.size(); ++which )
	{
		const Rule& rule = all[which / 2];
		Material soft = material( 1.0f );
		soft.volumeKeeping = which % 2 == 0 ? 0.0f : 2.0f;
		for ( const Lattice& lattice : { makeBlockLattice( 12, 8, 8, 0.1f ), tornBlock() } )
		{
			Result<std::unique_ptr<Body>> made = Body::create( std::make_shared<Lattice>( lattice ), soft, {}, nullptr, rule.settings );
			ASSERT_TRUE( made.ok() ) << made.status.sentence;
			Body& body = *made.value;
			splitHalf( body );
			Rates r( body );
			const std::size_t padded = std::size_t( body.nodes().padded );
			double off = 0.0, wrong = 1.0;
			for ( int i = 0; i < body.nodeCount(); i += 7 )
			{
				double sum = 0.0;
				for ( std::size_t k = 0; k < 3; ++k )
				{
					std::vector<float> unit( 3 * padded, 0.0f );
					unit[k * padded + std::size_t( i )] = 1.0f;
					sum += double( r( unit, 1.0f )[k * padded + std::size_t( i )] ) / double( body.nodes().mass[i] );
				}
				const double exact = sum / 3.0 - 1.0, own = double( r.rates.diagonal()[std::size_t( i )] );
				off = std::max( off, std::abs( exact - own ) );
				wrong = std::max( wrong, ( 0.01 + exact ) / ( 0.01 + own ) );
			}
			std::printf( "%s, %zu links: off by %.4f, factor %.2f\n", rule.name, lattice.linkTo.size() / 2, off, wrong );
			EXPECT_LT( off, 5e-3 ) << rule.name;
		}
	}
}

} // namespace
} // namespace pliant
