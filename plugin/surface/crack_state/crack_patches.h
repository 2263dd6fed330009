#pragma once

// What bodies that have come apart draw, laid ready: for each cell its part of the outer surface, and each of its sides of a face, vertex
// by vertex as it would be were all broken. Immutable, one a template. Ohta et al. 2009, "Fracturing".
//
// What cracks change is only which of these vertices are one (CrackSides), not what they are.

#include "surface/crack_complex/cell_complex.h"

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

	/// `whole`: of all cells, nothing broken. `texture`: u, v of the input's vertices, or null. Null where a point is carried by more cells
	/// than a word has bits, or where one patch has more vertices than half a word counts.
	static std::shared_ptr<const CrackPatches> make( const CrackSurface& whole, const float* texture );

	/// A point as one cell draws it: what tells which vertices are one, ...
	struct Vertex
	{
		std::uint32_t slot;    ///< a point and a cell there: an entry of CellComplex::cellsOfPoint
		std::uint16_t kindAt;  ///< which of the kinds that are drawn at the point
		std::uint8_t isInside; ///< 1: of a face
		std::uint8_t isAlone;  ///< 1: inside a face, where no other patch of the cell comes, and no other cell once the face is broken
	};
	/// ... and what they look like.
	struct Look
	{
		std::uint32_t point;
		std::uint32_t kind; ///< as CrackSurface has it
		float u, v;
	};
	/// Patch c: cell c's part of the outer surface, its triangles numbered as the complex has them. From `cells` on, cell by cell, its
	/// sides of its faces, as CellComplex::facesOfCell lists them. Each ends where the next one begins.
	struct Patch
	{
		std::uint32_t firstVertex, firstTriangle;
	};
	std::vector<Patch> patch;
	std::vector<Vertex> vertex;                         ///< of each patch in the order of first use
	std::vector<Look> look;                             ///< by vertex
	std::vector<std::array<std::uint16_t, 3>> triangle; ///< by the patch's vertices
	/// `entry`: of CellComplex::facesOfCell.
	std::uint32_t sideOfFace( std::uint32_t entry ) const { return std::uint32_t( complex->cellCount() ) + entry; }

	std::vector<std::uint32_t> pointOfSlot;
	/// By slot: where a side that begins there may keep one number for each kind drawn at the point, and kNumbersOfSide more before them
	/// (none, where only a vertex draws it that is alone). Then how many there are in all.
	std::vector<std::uint32_t> numbersOfSlot;
	static constexpr std::uint32_t kNumbersOfSide = 3;
	/// By vertex of the input: where the side that begins with its point's first slot has its numbers.
	std::vector<std::uint32_t> numbersOfInput;
	/// By entry of Panels::border, and by panel, of its corners: the number that its vertex is drawn by, as long as its point's first slot
	/// is all its sides.
	std::vector<std::uint32_t> numberOfBorder;
	std::vector<std::array<std::uint32_t, 3>> numbersOfCorners;
	/// By vertex of the complex: how the whole, closed surface shifts its normal (SkinBinding::normalShift).
	std::vector<Vec3> normalShift;

	/// A face and two of a point's cells that it joins: slots, or carriers, or a slot and a carrier, each counted from the point's first.
	struct Tie
	{
		std::uint32_t face;
		std::uint16_t a, b;
	};
	/// Points that the same cells carry are of one class.
	std::vector<std::uint32_t> classOfPoint;
	std::vector<std::uint32_t> firstOfClass; ///< where a class has a place for each of its cells, among all; and how many there are in all
	Table classesOfCell;                     ///< by cell: of the points that it carries
	std::size_t classCount() const { return firstOfClass.size() - 1; }
	/// By point: of its cells, and of its cells that do not carry it with those next to them that do. By class: of what carries its points.
	std::vector<std::uint32_t> slotTieStart, looseTieStart, carrierTieStart;
	std::vector<Tie> slotTie, carrierTie, looseTie;
	std::vector<std::uint8_t> bitOfSlot; ///< which of those that carry the point the cell is, or kNoBit

	std::shared_ptr<const CellComplex> complex;

	std::size_t bytes() const;

private:
	explicit CrackPatches( std::shared_ptr<const CellComplex> of ) : complex( std::move( of ) ) {}
	std::uint32_t slotOf( std::uint32_t point, std::uint32_t cell ) const;
	bool addPatches( const float* texture );
	struct Corner
	{
		std::uint32_t slot;
		Look look;
	};
	bool addCorners( const std::array<Corner, 3>& corners );
	void numberKinds();
	void numberPanels();
	void findAlone();
	void sortIntoClasses();
	void addTies();
	template <class Take>
	void forCarriersBeside( std::uint32_t cell, const std::vector<std::uint8_t>& bitOfCell, Take&& take ) const;
	void addCarrierTies( std::uint32_t point, const std::vector<std::uint8_t>& bitOfCell );
	void addLooseTies( std::uint32_t point, const std::vector<std::uint8_t>& bitOfCell );
};

} // namespace pliant
