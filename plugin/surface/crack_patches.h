#pragma once

// What bodies that have come apart draw, laid ready: for each cell its part of the outer surface, and each of its sides of a face, vertex by vertex
// as it would be were all broken. Immutable, one a template. Ohta et al. 2009, "Fracturing".
//
// What cracks change is only which of these vertices are one (CrackSides), not what they are.

#include "surface/cell_complex.h"

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

namespace pliant {

class CrackSurface;

class CrackPatches
{
public:
	static constexpr std::uint32_t kNone = CellComplex::kNone;
	static constexpr std::uint8_t kNoBit = 0xff;
	/// Cells that carry one point are a bit each in a word.
	static constexpr std::size_t kMostCarriers = 64;

	/// `whole`: of all cells, nothing broken. `texture`: u, v of the input's vertices, or null. Null where a point is carried by more cells than a
	/// word has bits.
	static std::shared_ptr<const CrackPatches> make( const CrackSurface& whole, const float* texture );

	/// A point as one cell draws it.
	struct Vertex
	{
		std::uint32_t slot; ///< a point and a cell there: an entry of CellComplex::cellsOfPoint
		std::uint32_t point;
		std::uint32_t kind; ///< as CrackSurface has it
		float u, v;
	};
	/// Patch c: cell c's part of the outer surface, its triangles numbered as the complex has them. From `cells` on, cell by cell, its sides of its faces,
	/// as CellComplex::facesOfCell lists them. Each ends where the next one begins.
	struct Patch
	{
		std::uint32_t firstVertex, firstTriangle;
	};
	std::vector<Patch> patch;
	std::vector<Vertex> vertex; ///< of each patch in the order of first use
	std::vector<std::array<std::uint32_t, 3>> triangle; ///< by the patch's vertices
	/// `entry`: of CellComplex::facesOfCell.
	std::uint32_t sideOfFace( std::uint32_t entry ) const { return std::uint32_t( complex->cellCount() ) + entry; }

	std::vector<std::uint32_t> pointOfSlot;
	/// By vertex of the complex: how the whole, closed surface shifts its normal (SkinBinding::normalShift).
	std::vector<Vec3> normalShift;

	/// A face and two of a point's cells that it joins: slots, or carriers, or a slot and a carrier, each counted from the point's first.
	struct Tie
	{
		std::uint32_t face;
		std::uint16_t a, b;
	};
	/// By point. Of its cells; of what carries it; and of its cells that do not carry it with those next to them that do.
	std::vector<std::uint32_t> slotTieStart, carrierTieStart, looseTieStart;
	std::vector<Tie> slotTie, carrierTie, looseTie;
	std::vector<std::uint8_t> bitOfSlot; ///< which of those that carry the point the cell is, or kNoBit

	std::shared_ptr<const CellComplex> complex;

	std::size_t bytes() const;

private:
	explicit CrackPatches( std::shared_ptr<const CellComplex> of ) : complex( std::move( of ) ) {}
	std::uint32_t slotOf( std::uint32_t point, std::uint32_t cell ) const;
	void addPatches( const float* texture );
	void addCorners( const std::array<Vertex, 3>& corners );
	void addTies();
	void addCarrierTies( std::uint32_t point, const std::vector<std::uint8_t>& bitOfCell );
};

} // namespace pliant
