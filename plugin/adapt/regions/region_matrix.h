#pragma once

// Regions over the nodes of a cut as a sparse matrix U: u(a, r) is the mass of node a that counts in region r. One region a node.
// Uniform lattices, Steinemann's intervals, Ohta's unions and regions with multiplicity are ways to fill it; the step is one.
//
// Masses are whole multiples of kMassUnit, so that sums are exact whatever their order: splitting, merging and rebuilding from
// nothing give the same bits.

#include "adapt/octree/cut.h"
#include "lattice/region.h"

#include <algorithm>
#include <cmath>

namespace pliant {

/// About this share of a full finest cell's mass: 8^4 cells fit 32 bits. A cell's mass is no whole multiple of it; what one unit of a
/// node weighs is corrected node by node (RegionMatrix::unit), so that its shares add up to its mass.
inline constexpr double kMassUnit = 1.0 / ( 1 << 19 );

/// A mass in full cells as a number of units, at least one.
inline std::uint32_t inMassUnits( double cells )
{
	return std::uint32_t( std::max( 1.0, std::round( cells / kMassUnit ) ) );
}

/// Row r lists the nodes of region r, ascending by slot, r itself among them. Membership is symmetric, values need not be:
/// row r of the transposed matrix stands in `share`, beside the same members.
struct RegionMatrix
{
	std::vector<std::uint32_t> start;    ///< members of region r: start[r] .. start[r + 1]
	std::vector<std::uint32_t> member;   ///< slots
	std::vector<std::uint32_t> mass;     ///< u( member, r ): what the member gives to the sums of region r, in kMassUnit
	std::vector<std::uint32_t> fraction; ///< weight of the member's region in the goal of node r; u( r, member ) where momentum is kept
	std::vector<double> unit;            ///< of each node: what one unit of its mass weighs, full cells

	int count() const { return start.empty() ? 0 : int( start.size() ) - 1; }
	std::size_t bytes() const { return ( start.size() + member.size() * 3 ) * sizeof( std::uint32_t ) + unit.size() * sizeof( double ); }
};

/// unit = mass / sum of shares, where masses are the shares' transpose: then the goals' weights and the sums' weights are the same numbers.
void weighUnits( const Octree& octree, const Cut& cut, RegionMatrix& matrix );

/// The finest level, on which everything coarser stands: for each cell, the cells of its region and the mass it gives to each.
struct FineRegions
{
	RegionSet set;                   ///< with its table
	std::vector<std::uint32_t> mass; ///< m_c / n_c, in kMassUnit, at least 1

	std::size_t bytes() const
	{
		return ( set.start.size() + set.member.size() + mass.size() ) * sizeof( std::uint32_t ) + set.size.size() * sizeof( std::uint16_t );
	}
};

FineRegions buildFineRegions( const Lattice& lattice, int halfWidth );

/// Regions with multiplicity: U = P^T U_fine P, the sum of all fine regions under a node. Masses of a node over its regions add up to
/// its own; it is the uniform lattice where all nodes are finest cells. This is the slow twin of updateMultiplicityRegions.
RegionMatrix buildMultiplicityRegions( const Octree& octree, const Cut& cut, const FineRegions& fine );

/// What a change of the cut may build in, and what it finds on the way.
struct MatrixScratch
{
	RegionMatrix matrix;                  ///< taken for the new one: what it has allocated, not what it holds
	std::vector<std::uint32_t> rowBefore; ///< of each new row: its number before, where it holds the same nodes and masses; else kNoNode
};

/// The matrix of cut `to`, given the one of cut `from`, where only nodes that are in one of the two and not in the other changed:
/// split nodes are counted anew from their cells, merged ones are sums of their children's rows, all else is renumbered.
/// `room` may be null.
RegionMatrix updateMultiplicityRegions( const Octree& octree, const Cut& from, const RegionMatrix& matrix, const Cut& to,
	const FineRegions& fine, MatrixScratch* scratch = nullptr );

/// How the nodes of a cut stand to those of another one, over the same cells or more, where links are others.
struct RelinkedNodes
{
	std::vector<std::uint32_t> now;    ///< of each node before: its number now; kNoNode: gone
	std::vector<std::uint32_t> before; ///< of each node now; all were there before, with the same cells
	std::vector<std::uint8_t> isNew;   ///< 1 for nodes now whose finest regions hold other cells or masses
};

/// The matrix of a cut, given the one before links went or came back: rows of new nodes are counted from cells, those of their neighbours
/// take from them, all else is renumbered. `fine`: of the links as they are.
RegionMatrix updateRelinkedRegions( const Octree& octree, const Cut& cut, const FineRegions& fine, const RegionMatrix& matrix,
	const RelinkedNodes& nodes, MatrixScratch* scratch = nullptr );

/// How weights enter where a region is a plain set of cells.
enum class UnionWeights : int
{
	Conserving, ///< u( a, r ) = m_r m(a, r) / W_a, W_a = sum over r of m_r m(a, r) / m_a, and goals by the transpose
	Literal     ///< m(a, r) in sums, m_r m(a, r) / m_a in goals
};

/// Ohta et al. 2009, "Preprocessing" and eq. 6: the region of a node is the union of its children's; m(a, r) is the mass of those cells
/// of node a that lie in it.
RegionMatrix buildUnionRegions( const Octree& octree, const Cut& cut, const FineRegions& fine, UnionWeights weights );

} // namespace pliant
