#pragma once

// The largest stretch of the material around a cell, from its neighbours' positions: F = ( sum p q^T ) ( sum q q^T )^+ with q a link at
// rest and p its current vector. Steinemann et al. 2008, section 4.2 (their regions' A_pq and A_qq).

#include "fracture/cell_positions.h"
#include "lattice/lattice.h"

#include <Eigen/Core>

#include <vector>

namespace pliant {

/// The square root of F^T F's largest eigenvalue, minus 1, and the direction at rest that is stretched by it.
struct Stretch
{
	double strain = 0.0;
	Vec3d axis = Vec3d::UnitX();
};

/// Closed form with four Newton steps; Eigen's solver is the reference implementation.
Stretch largestStretch( const Eigen::Matrix3d& deformation );

/// Whether the strain is below `strain` in every direction, without finding the largest; false also where it is less by rounding only.
bool isStretchedLess( const Eigen::Matrix3d& deformation, double strain );

/// Returns the pseudo-inverse of a second moment without the axes of negligible extent (kFlatNeighbourhood). For a solid moment this is its
/// adjugate over its determinant; inverseInPlane is the reference implementation.
Eigen::Matrix3d inverseOfRest( const Eigen::Matrix3d& moment );

/// Sums over a cell's links, computed on first use. Rows of four floats, the last one unused.
class LinkMoments
{
public:
	struct Moment
	{
		Eigen::Array4f now[3], rest[3]; ///< rows of sum p q^T, sum q q^T

		Eigen::Matrix3d deformation() const;
	};

	/// Sets a new lattice or state. Both arguments must outlive the queries.
	void update( const Lattice& lattice, const CellPositions& positions );

	bool isNode( std::uint32_t cell ) const { return m_isNode[cell] != 0; }
	Vec3 position( std::uint32_t cell ) const { return m_position[cell].head<3>().matrix(); }
	/// Squared distance between two cells.
	float distanceSquared( std::uint32_t a, std::uint32_t b ) const
	{
		const Eigen::Array4f d = m_position[a] - m_position[b];
		return d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
	}
	const Moment& of( std::uint32_t cell );
	/// Sum over the cell and all linked cells.
	Moment around( std::uint32_t cell );

private:
	void prepare(); ///< for `of`: most calls of `update` are followed only by distance queries
	Moment measure( std::uint32_t cell ) const;

	static constexpr std::uint32_t kNone = 0xffffffffu;
	const Lattice* m_lattice = nullptr;
	std::vector<Eigen::Array4f> m_position, m_rest; ///< by cell
	std::vector<std::uint8_t> m_isNode;             ///< by cell: a node by itself
	std::vector<std::uint32_t> m_slot;              ///< by cell, index in m_moments; empty: nothing computed yet
	std::vector<Moment> m_moments;
};

} // namespace pliant
