// Cracks as planes: where they begin, and how far they run.

#include "fracture/plane_cracks.h"
#include "lattice/pieces.h"
#include "pliant/fracture.h"
#include "support/block_body.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace pliant {
namespace {

constexpr float kCell = 0.1f, kBreakStrain = 0.1f;

/// A slab of 8 x 12 x 3 cells, weak in the middle of one of its long edges, drawn out along x to 0.8 of what breaks it elsewhere.
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

	/// What breaks in so many substeps; nothing moves meanwhile.
	std::vector<CellLink> breakFor( int substeps, float growthShare ) const
	{
		PlaneCracks cracks( kBreakStrain, growthShare );
		const LinkLimits limits = limitLinks( lattice, cracks.candidateStrain(), toughness );
		std::vector<CellLink> broken;
		for ( int k = 0; k < substeps; ++k )
		{
			cracks.find( lattice, limits, CellPlaces( nodes ), 1.0f / 240.0f, true, broken );
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

TEST( PlaneCracks, RunOnAtTheirShareAndBeginNoSooner )
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

TEST( PlaneCracks, TheShareIsChecked )
{
	Fracture fracture;
	for ( const float bad : { 0.0f, -1.0f, 1.01f } )
	{
		fracture.growthShare = bad;
		EXPECT_FALSE( check( fracture ).ok() );
	}
	fracture.growthShare = 0.3f;
	EXPECT_TRUE( check( fracture ).ok() );
}

} // namespace
} // namespace pliant
