#pragma once

// The largest stretch of the material around a cell, from where its neighbours are: F = ( sum p q^T ) ( sum q q^T )^+ with q a link at rest
// and p the same link now. Steinemann et al. 2008, section 4.2 (their regions' A_pq and A_qq).

#include "fracture/cell_positions.h"
#include "lattice/lattice.h"

#include <Eigen/Core>

#include <vector>

namespace pliant {

/// The largest root of F^T F's eigenvalues, less 1, and the direction in the body at rest that is stretched by it.
struct Stretch
{
	double strain = 0.0;
	Vec3d axis = Vec3d::UnitX();
};

/// In closed form but for four Newton steps; Eigen's solver is the slow twin.
Stretch largestStretch( const Eigen::Matrix3d& deformation );

/// No more than `strain` in any direction, for certain: told by mean and spread of F^T F alone. False tells nothing.
bool isStretchedLess( const Eigen::Matrix3d& deformation, double strain );

/// The pseudo-inverse of a second moment without the axes along which there is nothing (kFlatNeighbourhood). A solid one's is its adjugate
/// over its determinant; inverseInPlane is the slow twin.
Eigen::Matrix3d inverseOfRest( const Eigen::Matrix3d& moment );

/// Sums over a cell's links, made when they are first asked for. Rows of four floats, the last one nothing.
class LinkMoments
{
public:
	struct Moment
	{
		Eigen::Array4f now[3], rest[3]; ///< rows of sum p q^T, sum q q^T

		Eigen::Matrix3d deformation() const;
	};

	/// Looks at another lattice, or at the same one later. Both must outlive the questions.
	void look( const Lattice& lattice, const CellPositions& positions );

	bool has( std::uint32_t cell ) const { return m_has[cell] != 0; }
	/// Squared distance between two cells.
	float distanceSquared( std::uint32_t a, std::uint32_t b ) const
	{
		const Eigen::Array4f d = m_position[a] - m_position[b];
		return d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
	}
	const Moment& of( std::uint32_t cell );
	/// Of the cell and of all it is linked to.
	Moment around( std::uint32_t cell );

private:
	void prepare(); ///< for `of`: most looks ask for no more than distances
	Moment measure( std::uint32_t cell ) const;

	static constexpr std::uint32_t kNone = 0xffffffffu;
	const Lattice* m_lattice = nullptr;
	std::vector<Eigen::Array4f> m_position, m_rest; ///< by cell
	std::vector<std::uint8_t> m_has;                ///< by cell: a node by itself
	std::vector<std::uint32_t> m_slot;              ///< by cell, in m_made; empty: nothing has been asked for yet
	std::vector<Moment> m_made;
};

} // namespace pliant
