// Cracks as planes: where they begin, and how far they grow.

#include "fracture/plane_cracks.h"
#include "lattice/pieces.h"
#include "pliant/fracture.h"
#include "support/block_body.h"
#include "support/block_lattice.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

namespace pliant {
namespace {

constexpr float kCell = 0.1f, kBreakStrain = 0.1f;

/// A slab of 8 x 12 x 3 cells, weak in the middle of one of its long edges, stretched along x to 0.8 of the breaking stretch elsewhere.
struct Slab
{
	Lattice lattice = makeBlockLattice( 8, 12, 3, kCell );
	NodeState nodes = test::restNodes( lattice );
	std::vector<float> toughness;

	Slab()
	{
		for ( int i = 0; i < nodes.count; ++i )
		{
			nodes.x.x[std::size_t( i )] *= 1.0f + 0.8f * kBreakStrain;
		}
		for ( std::uint32_t i = 0; i < std::uint32_t( lattice.cellCount() ); ++i )
		{
			for ( std::uint32_t k = lattice.linkStart[i]; k < lattice.linkStart[i + 1]; ++k )
			{
				if ( lattice.linkTo[k] > i )
				{
					toughness.push_back( isWeak( i ) || isWeak( lattice.linkTo[k] ) ? 0.4f : 1.0f );
				}
			}
		}
	}

	bool isWeak( std::uint32_t cell ) const
	{
		const auto& at = lattice.coordinate[cell];
		const auto& first = lattice.coordinate[0];
		return at.y() - first.y() < 2 && ( at.x() - first.x() == 3 || at.x() - first.x() == 4 );
	}

	/// The links that break in so many substeps without motion.
	std::vector<CellLink> breakFor( int substeps, float growthFraction ) const
	{
		PlaneCracks cracks( kBreakStrain, growthFraction );
		const LinkLimits limits = limitLinks( lattice, cracks.candidateStrain(), toughness );
		std::vector<CellLink> broken;
		for ( int k = 0; k < substeps; ++k )
		{
			cracks.find( lattice, limits, CellPositions( nodes ), 1.0f / 240.0f, true, broken );
		}
		return broken;
	}
};

TEST( PlaneCracks, GoOnOnlyWhereItTakesAsMuchAsToBeginOne )
{
	const Slab slab;
	const std::vector<CellLink> broken = slab.breakFor( 30, 1.0f );
	ASSERT_FALSE( broken.empty() );
	EXPECT_EQ( connectedParts( withoutLinks( slab.lattice, broken ) ).size(), 1u );
	EXPECT_EQ( slab.breakFor( 60, 1.0f ).size(), broken.size() );
}

// The plane of a crack that began at the last cell before a free end lay outside of the body, broke nothing, and kept other cracks away.
TEST( PlaneCracks, BeginWithinTheBody )
{
	for ( const bool isLow : { false, true } )
	{
		const Lattice lattice = makeBlockLattice( 8, 2, 2, kCell );
		NodeState nodes = test::restNodes( lattice );
		for ( int i = 0; i < nodes.count; ++i )
		{
			const int x = lattice.coordinate[std::size_t( i )].x();
			nodes.x.x[std::size_t( i )] += x == 7 && !isLow ? 0.2f * kCell : x == 0 && isLow ? -0.2f * kCell : 0.0f;
		}
		PlaneCracks cracks( kBreakStrain, 1.0f );
		std::vector<CellLink> broken;
		cracks.find( lattice, limitLinks( lattice, cracks.candidateStrain(), {} ), CellPositions( nodes ), 0.0f, true, broken );
		EXPECT_EQ( connectedParts( withoutLinks( lattice, broken ) ).size(), 2u ) << isLow;
	}
}

TEST( PlaneCracks, RunOnAtTheirFractionAndBeginNoSooner )
{
	const Slab slab;
	const std::vector<CellLink> broken = slab.breakFor( 30, 0.5f );
	const std::vector<std::vector<std::uint32_t>> parts = connectedParts( withoutLinks( slab.lattice, broken ) );
	ASSERT_EQ( parts.size(), 2u );
	EXPECT_EQ( parts[0].size(), parts[1].size() ); // along the plane it began in

	Slab sound;
	std::fill( sound.toughness.begin(), sound.toughness.end(), 1.0f );
	EXPECT_TRUE( sound.breakFor( 30, 0.5f ).empty() );
}

/// A block with random waves, from which broken links are removed, with new cracks allowed from time to time; all broken links, in order.
std::vector<std::vector<CellLink>> breakInWaves( unsigned seed, float growthFraction, bool everywhere, bool isTough,
	Lattice lattice = makeBlockLattice( 9, 8, 7, kCell ), std::size_t* most = nullptr )
{
	NodeState nodes = test::restNodes( lattice );
	std::mt19937 random( seed );
	std::uniform_real_distribution<float> any( -1.0f, 1.0f );
	PlaneCracks cracks( kBreakStrain, growthFraction );
	if ( everywhere )
	{
		cracks.checkEveryCell();
	}
	std::vector<float> toughness( isTough ? lattice.linkTo.size() / 2 : 0 );
	std::generate( toughness.begin(), toughness.end(), [&] { return any( random ) < 0.985f ? 2.0f : 0.01f; } ); // weak spots, far apart
	LinkLimits limits = limitLinks( lattice, cracks.candidateStrain(), toughness );
	std::vector<std::uint32_t> all( std::size_t( lattice.cellCount() ) );
	std::iota( all.begin(), all.end(), 0u );
	Eigen::Matrix3f pull = Eigen::Matrix3f::Zero();
	std::vector<std::vector<CellLink>> history;
	for ( int step = 0; step < 24; ++step )
	{
		for ( int k = 0; k < 9; ++k )
		{
			pull( k / 3, k % 3 ) = 0.7f * pull( k / 3, k % 3 ) + 0.05f * any( random );
		}
		for ( int i = 0; i < nodes.count; ++i )
		{
			const Vec3 rest = nodes.x0.get( i );
			nodes.x.set( i, rest + pull * rest * ( 1.0f + std::sin( 5.0f * rest.x() + float( step ) ) ) );
		}
		std::vector<CellLink> broken;
		cracks.find( lattice, limits, CellPositions( nodes ), 1.0f / 240.0f, step % 8 == 0, broken );
		lattice = withoutLinks( lattice, broken );
		limits = inheritLimits( limits, lattice, all, cracks.candidateStrain() );
		history.push_back( std::move( broken ) );
		if ( most )
		{
			*most = std::max( *most, cracks.count() );
		}
	}
	return history;
}

TEST( PlaneCracks, AreThoseOfLookingEverywhere )
{
	std::size_t goneOn = 0;
	for ( unsigned seed = 0; seed < 40; ++seed )
	{
		const float fraction = seed % 2 == 0 ? 1.0f : 0.6f;
		const std::vector<std::vector<CellLink>> quick = breakInWaves( seed, fraction, false, seed % 3 == 0 ),
												 slow = breakInWaves( seed, fraction, true, seed % 3 == 0 );
		ASSERT_EQ( quick, slow ) << seed;
		for ( std::size_t step = 0; step < quick.size(); ++step )
		{
			goneOn += step % 8 == 0 ? 0 : quick[step].size();
		}
	}
	EXPECT_GT( goneOn, 5000u );
}

TEST( PlaneCracks, AreThoseOfLookingEverywhereHoweverMany )
{
	const Lattice bar = makeBlockLattice( 900, 2, 2, kCell );
	std::size_t most = 0;
	EXPECT_EQ( breakInWaves( 1, 0.6f, false, false, bar, &most ), breakInWaves( 1, 0.6f, true, false, bar ) );
	EXPECT_GT( most, 64u ); // more than the bits of a word
}

TEST( PlaneCracks, TheFractionIsChecked )
{
	Fracture fracture;
	for ( const float bad : { 0.0f, -1.0f, 1.01f } )
	{
		fracture.growthFraction = bad;
		EXPECT_FALSE( check( fracture ).ok() );
	}
	fracture.growthFraction = 0.3f;
	EXPECT_TRUE( check( fracture ).ok() );
}

} // namespace
} // namespace pliant
