#pragma once

// The deformation at the faces of thin parts. Around a cell of a thin part that bends with the curvature K, symmetric and within the part,
//
//   p = F q - ( q^T K q ) n / 2 + ( N q ) F K q
//
// q a link at rest, p its current vector, N the part's normal at rest and n the current one (Kirchhoff: normals stay normals). F is that of
// the cell's centre, and at a face at the distance s outside of it F ( 1 + s K ). A rod has such terms along two normals.

#include "fracture/link_limits.h"
#include "fracture/stretch.h"

#include <vector>

namespace pliant {

class FaceStretch
{
public:
	/// Sets a new lattice or state. `limits`: of the lattice. `strain`: at which the weakest cell breaks. All but the positions must
	/// outlive the queries.
	void update( const Lattice& lattice, const LinkLimits& limits, const CellPositions& positions, double strain );

	/// The entry of a cell in a thin part; null where it is in none.
	const ThinCell* thinCellOf( std::uint32_t cell );
	/// Whether the cell may break at the face in front of it; false where it is no node. `isStretched`: a link of it is.
	bool mayBreak( const ThinCell& cell, bool isStretched );
	/// Whether bending strains the face in front of a cell by more than a small part of what breaks it.
	bool isBent( const ThinCell& cell ) const;
	/// F around a cell; where a thin part is bent at the face in front of it, where it is open on both sides at the one that is stretched
	/// more. `isWide`: the mean over the linked cells, of a thin part over those at the same face.
	Eigen::Matrix3d deformationOf( std::uint32_t cell, bool isWide );
	/// K along a normal of the cell times half the part's thickness: what bending adds to the stretch at its outermost face.
	Eigen::Matrix3d bendingOf( const ThinCell& cell, int normal );
	/// Mean of the squared strain by bending that the links do not have, since they join the cells' centres.
	double hiddenSquare( const ThinCell& cell ) const;
	/// Energy of bending in the links' share of the cells that they join, over Young's modulus, m^3.
	double hiddenEnergy( const std::vector<CellLink>& links );
	/// BreakRule::Distance: adds the links that are beyond their limits at the faces of thin parts, and keeps `found` ascending.
	void findOverbent( const LinkLimits& limits, const CellPositions& positions, std::vector<CellLink>& found );
	const std::vector<ThinCell>& thin() const { return *m_thin; }
	const LinkMoments& moments() const { return m_moments; }

private:
	struct Bend
	{
		Eigen::Matrix3d now, rest;    ///< sums of p q^T without the terms of K, and of q q^T, square cells
		Eigen::Matrix3d curvature[2]; ///< K along each normal, 1/m
	};

	/// About the strain that bending adds at the face in front of a cell, from the opposite links alone.
	float roughBending( const ThinCell& cell ) const;
	const Bend& bendOf( const ThinCell& cell );
	Bend measure( const ThinCell& cell );
	Eigen::Matrix3d atFace( const ThinCell& cell, bool isWide, const double sides[2] );
	Eigen::Matrix3d atWeakerFace( const ThinCell& cell, bool isWide );

	double m_strain = 0.0;
	const Lattice* m_lattice = nullptr;
	const std::vector<ThinCell>* m_thin = nullptr;
	LinkMoments m_moments;
	std::vector<std::uint32_t> m_thinOf; ///< by cell: index in m_thin; empty: nothing asked yet
	std::vector<std::uint32_t> m_slot;   ///< by thin cell: index in m_bends; empty: nothing computed yet
	std::vector<Bend> m_bends;
};

} // namespace pliant
