// The region matrix: its invariants, its changes with the cut compared with the reference implementation, and the uniform lattice as a
// special case.

#include "adapt/regions/region_matrix.h"
#include "support/shapes.h"

#include <gtest/gtest.h>

#include <map>

namespace pliant {
namespace {

using test::makeBlobLattice;

void expectEqual( const RegionMatrix& a, const RegionMatrix& b )
{
	EXPECT_EQ( a.start, b.start );
	EXPECT_EQ( a.member, b.member );
	EXPECT_EQ( a.mass, b.mass );
	EXPECT_EQ( a.fraction, b.fraction );
	EXPECT_EQ( a.unit, b.unit );
}

/// Value of region r at node a, directly from the definition.
std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> byDefinition(
	const Octree& octree, const Cut& cut, const FineRegions& fine )
{
	std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> u;
	for ( std::uint32_t f = 0; f < std::uint32_t( octree.cells.size() ); ++f )
	{
		for ( std::uint32_t k = fine.set.start[f]; k < fine.set.start[f + 1]; ++k )
		{
			const std::uint32_t c = fine.set.member[k];
			u[{ cut.slotOfCell[c], cut.slotOfCell[f] }] += fine.mass[c];
		}
	}
	return u;
}

TEST( MultiplicityRegions, AreTheSumsOfTheFineRegionsUnderThem )
{
	std::mt19937 random( 11 );
	const Lattice lattice = makeBlobLattice( 14, 0.1f, 2, 6, [&random]( int, int ) { return random() % 5 != 0; } );
	const Octree octree = buildOctree( lattice, 3 );
	const Cut cut = selectCut( octree, keepsByMass( octree, 0.4f ) );
	for ( int w = 1; w <= 2; ++w )
	{
		const FineRegions fine = buildFineRegions( lattice, w );
		const RegionMatrix matrix = buildMultiplicityRegions( octree, cut, fine );
		const auto wanted = byDefinition( octree, cut, fine );
		ASSERT_EQ( matrix.member.size(), wanted.size() );
		for ( std::uint32_t r = 0; r < std::uint32_t( matrix.count() ); ++r )
		{
			std::uint64_t fractions = 0, own = 0;
			for ( std::uint32_t k = matrix.start[r]; k < matrix.start[r + 1]; ++k )
			{
				EXPECT_EQ( matrix.mass[k], wanted.at( { matrix.member[k], r } ) );
				EXPECT_EQ( matrix.fraction[k], wanted.at( { r, matrix.member[k] } ) );
				fractions += matrix.fraction[k];
			}
			for ( std::uint32_t k = octree.cellStart[cut.node[r]]; k < octree.cellStart[cut.node[r]] + octree.cellCount[cut.node[r]]; ++k )
			{
				own += std::uint64_t( fine.mass[octree.cells[k]] ) * fine.set.size[octree.cells[k]];
			}
			EXPECT_EQ( fractions, own ) << "the node's mass over its regions is not its own";
		}
	}
}

TEST( MultiplicityRegions, OfFinestCellsAreTheUniformLattice )
{
	const Lattice lattice = makeBlobLattice( 10, 0.1f, 4 );
	const Octree octree = buildOctree( lattice, 2 );
	const Cut cut = selectCut( octree, []( std::uint32_t ) { return false; } );
	const FineRegions fine = buildFineRegions( lattice, 1 );
	const RegionMatrix matrix = buildMultiplicityRegions( octree, cut, fine );
	for ( std::uint32_t r = 0; r < std::uint32_t( matrix.count() ); ++r )
	{
		ASSERT_EQ( matrix.start[r + 1] - matrix.start[r], fine.set.size[cut.node[r]] );
		for ( std::uint32_t k = matrix.start[r]; k < matrix.start[r + 1]; ++k )
		{
			EXPECT_EQ( matrix.mass[k], fine.mass[cut.node[matrix.member[k]]] );
			EXPECT_EQ( matrix.fraction[k], fine.mass[cut.node[r]] );
		}
	}
}

TEST( MultiplicityRegions, ChangedStepByStepAreThoseBuiltFromNothing )
{
	for ( unsigned seed = 1; seed <= 6; ++seed )
	{
		std::mt19937 random( seed );
		const Lattice lattice = makeBlobLattice( 14, 0.1f, seed, 5, [&random]( int, int ) { return random() % 6 != 0; } );
		const Octree octree = buildOctree( lattice, 3 );
		const FineRegions fine = buildFineRegions( lattice, 1 + int( seed % 2 ) );
		Cut cut = selectCut( octree, keepsByMass( octree, 0.5f ) );
		RegionMatrix matrix = buildMultiplicityRegions( octree, cut, fine );
		for ( int round = 0; round < 12; ++round )
		{
			// A new random cut, which may differ by splits and merges over several levels at once.
			std::vector<std::uint8_t> keeps( octree.parent.size() );
			for ( std::uint8_t& k : keeps )
			{
				k = random() % 2;
			}
			const std::uint32_t firstCoarse = octree.levelStart[1];
			const Cut next = selectCut( octree, [&]( std::uint32_t n ) { return n >= firstCoarse && keeps[n] != 0; } );
			matrix = updateMultiplicityRegions( octree, cut, matrix, next, fine );
			expectEqual( matrix, buildMultiplicityRegions( octree, next, fine ) );
			cut = next;
		}
	}
}

TEST( UnionRegions, ConservingOnesAreTheirOwnTranspose )
{
	const Lattice lattice = makeBlobLattice( 14, 0.1f, 7 );
	const Octree octree = buildOctree( lattice, 2 );
	const Cut cut = selectCut( octree, keepsByMass( octree, 0.5f ) );
	const FineRegions fine = buildFineRegions( lattice, 1 );
	const RegionMatrix matrix = buildUnionRegions( octree, cut, fine, UnionWeights::Conserving );
	for ( std::uint32_t r = 0; r < std::uint32_t( matrix.count() ); ++r )
	{
		double own = 0.0;
		for ( std::uint32_t k = matrix.start[r]; k < matrix.start[r + 1]; ++k )
		{
			const std::uint32_t a = matrix.member[k];
			const auto back = std::lower_bound( matrix.member.begin() + matrix.start[a], matrix.member.begin() + matrix.start[a + 1], r );
			ASSERT_EQ( *back, r );
			EXPECT_EQ( matrix.fraction[k], matrix.mass[std::size_t( back - matrix.member.begin() )] );
			own += matrix.fraction[k] * kMassUnit;
		}
		EXPECT_NEAR( own / octree.mass[cut.node[r]], 1.0, 1e-3 ); // rounding to units
	}
	// Literal weights: a region counts the mass of the node's cells in it, which is never more than the node's mass.
	const RegionMatrix literal = buildUnionRegions( octree, cut, fine, UnionWeights::Literal );
	ASSERT_EQ( literal.member, matrix.member );
	for ( std::uint32_t r = 0; r < std::uint32_t( literal.count() ); ++r )
	{
		for ( std::uint32_t k = literal.start[r]; k < literal.start[r + 1]; ++k )
		{
			const double m = literal.mass[k] * kMassUnit;
			EXPECT_LE( m, octree.mass[cut.node[literal.member[k]]] + 1e-9 );
			EXPECT_NEAR( m, std::round( m ), 1e-9 ); // all cells are full
		}
	}
}

} // namespace
} // namespace pliant
