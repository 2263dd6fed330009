#pragma once

// Regions over the nodes of a cut as a sparse matrix U: u(a, r) is the mass of node a that counts in region r. One region per node. Uniform
// lattices, Steinemann's intervals, Ohta's unions and regions with multiplicity fill it differently; the step is the same.
//
// Masses are integer multiples of kMassUnit, so that sums are exact in any order: splitting, merging and rebuilding from scratch give the
// same bits.

#include "adapt/constants.h"
#include "adapt/octree/cut.h"
#include "lattice/region.h"

#include <algorithm>
#include <cmath>

namespace pliant {

/// Converts a mass in full cells to units, at least one.
inline std::uint32_t inMassUnits( double cells )
{
	return std::uint32_t( std::max( 1.0, std::round( cells / kMassUnit ) ) );
}

/// Row r lists the nodes of region r, ascending by slot, including r itself. Membership is symmetric, values need not be: `fraction` stores
/// row r of the transposed matrix for the same members.
struct RegionMatrix
{
	std::vector<std::uint32_t> start;    ///< members of region r: start[r] .. start[r + 1]
	std::vector<std::uint32_t> member;   ///< slots
	std::vector<std::uint32_t> mass;     ///< u( member, r ): the member's contribution to the sums of region r, in kMassUnit
	std::vector<std::uint32_t> fraction; ///< weight of the member's region in the goal of node r; u( r, member ) where momentum is kept
	std::vector<double> unit;            ///< of each node: the weight of one unit of its mass, full cells

	int count() const { return start.empty() ? 0 : int( start.size() ) - 1; }
};

/// unit = mass / sum of fractions, where masses are their transpose: the goals' weights then equal the sums' weights.
void weighUnits( const Octree& octree, const Cut& cut, RegionMatrix& matrix );

/// The finest level, on which all coarser ones are based: for each cell, the cells of its region and the mass it contributes to each.
struct FineRegions
{
	RegionSet set;                   ///< with its table
	std::vector<std::uint32_t> mass; ///< m_c / n_c, in kMassUnit, at least 1
};

FineRegions buildFineRegions( const Lattice& lattice, int halfWidth );

/// Regions with multiplicity: U = P^T U_fine P, the sum of all fine regions under a node. The masses of a node over its regions add up to
/// its own; equals the uniform lattice where all nodes are finest cells. Reference implementation of updateMultiplicityRegions.
RegionMatrix buildMultiplicityRegions( const Octree& octree, const Cut& cut, const FineRegions& fine );

/// Scratch and by-products of a change of the cut.
struct MatrixScratch
{
	RegionMatrix matrix;                  ///< only its memory is reused
	std::vector<std::uint32_t> rowBefore; ///< of each new row: its former number where its nodes and masses are unchanged; else kNoNode
};

/// Returns the matrix of cut `to`, given that of cut `from`: split nodes are counted again from their cells, merged ones are sums of their
/// children's rows, all others are renumbered. `scratch` may be null.
RegionMatrix updateMultiplicityRegions( const Octree& octree, const Cut& from, const RegionMatrix& matrix, const Cut& to,
	const FineRegions& fine, MatrixScratch* scratch = nullptr );

/// Maps the nodes of a cut to those of a former one, over the same cells or more, with other links.
struct RelinkedNodes
{
	std::vector<std::uint32_t> now;    ///< of each former node: its number now; kNoNode: removed
	std::vector<std::uint32_t> before; ///< of each node now: its former number; all existed before with the same cells
	std::vector<std::uint8_t> isNew;   ///< 1 for nodes now whose finest regions hold other cells or masses
};

/// Returns the matrix of a cut, given that before links were removed or added: rows of new nodes are counted from cells, their neighbours'
/// rows take the entries from them, all others are renumbered. `fine`: of the current links.
RegionMatrix updateRelinkedRegions( const Octree& octree, const Cut& cut, const FineRegions& fine, const RegionMatrix& matrix,
	const RelinkedNodes& nodes, MatrixScratch* scratch = nullptr );

/// Mass weights where a region is a plain set of cells.
enum class UnionWeights : int
{
	Conserving, ///< u( a, r ) = m_r m(a, r) / W_a, W_a = sum over r of m_r m(a, r) / m_a, and goals by the transpose
	Literal     ///< m(a, r) in sums, m_r m(a, r) / m_a in goals
};

/// Ohta et al. 2009, "Preprocessing" and eq. 6: the region of a node is the union of its children's; m(a, r) is the mass of the cells of
/// node a that lie in it.
RegionMatrix buildUnionRegions( const Octree& octree, const Cut& cut, const FineRegions& fine, UnionWeights weights );

} // namespace pliant
