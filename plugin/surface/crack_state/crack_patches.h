#pragma once

// Precomputed drawing data of separated bodies: for each cell its part of the outer surface and each of its sides of a face, vertex by
// vertex, as if all faces were broken. Immutable, one per template. Ohta et al. 2009, "Fracturing".
//
// Cracks only change which of these vertices coincide (CrackSides), not the vertices themselves.

#include "surface/crack_complex/cell_complex.h"

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

namespace pliant {

class CrackPatches
{
public:
	static constexpr std::uint32_t kNone = CellComplex::kNone;
	static constexpr std::uint8_t kNoBit = 0xff;
	/// Kinds of vertices at a point: a vertex of the complex, or kInside + 2 x axis + side for a face.
	static constexpr std::uint32_t kInside = 0xfffffff0u;

	/// `texture`: u, v of the input's vertices, or null.
	static std::shared_ptr<const CrackPatches> make( std::shared_ptr<const CellComplex> complex, const float* texture );

	/// A point as drawn by one cell: the data that determine which vertices coincide, ...
	struct Vertex
	{
		std::uint32_t slot;      ///< a point and a cell there: an index into CellComplex::cellsOfPoint
		std::uint16_t kindAt;    ///< index among the kinds drawn at the point
		std::uint8_t isInside;   ///< 1: on a face
		std::uint8_t isUnshared; ///< 1: within a face, used by no other patch of the cell, and by no other cell once the face is broken
	};
	/// ... and the data that determine its appearance.
	struct Appearance
	{
		std::uint32_t point;
		std::uint32_t kind; ///< a vertex of the complex, or kInside and above
		float u, v;         ///< outside as in the input (0 where it has none), inside by position, with period CrackSettings::textureTile
	};
	/// Patch c: cell c's part of the outer surface, its triangles in the complex's order. From index `cells` on: the cells' sides of their
	/// faces, in the order of CellComplex::facesOfCell. Each patch ends where the next one begins.
	struct Patch
	{
		std::uint32_t firstVertex, firstTriangle;
	};
	std::vector<Patch> patch;
	std::vector<Vertex> vertex;                         ///< of each patch, in the order of first use
	std::vector<Appearance> appearance;                 ///< by vertex
	std::vector<std::array<std::uint32_t, 3>> triangle; ///< indices relative to the patch's vertices
	/// Index of a patch; `entry`: of CellComplex::facesOfCell.
	std::uint32_t sideOfFace( std::uint32_t entry ) const { return std::uint32_t( complex->cellCount() ) + entry; }

	std::vector<std::uint32_t> pointOfSlot;
	/// By slot: start of the numbers of a side that begins there: kNumbersOfSide, then one for each kind drawn at the point (none where
	/// only an unshared vertex draws it). The last entry is their total.
	std::vector<std::uint32_t> numbersOfSlot;
	static constexpr std::uint32_t kNumbersOfSide = 3;
	/// By vertex of the input: start of the numbers of the side that begins with its point's first slot.
	std::vector<std::uint32_t> numbersOfInput;
	/// By entry of Panels::border, and by panel for its corners: the number of the vertex as long as all slots of its point are one side.
	std::vector<std::uint32_t> numberOfBorder;
	std::vector<std::array<std::uint32_t, 3>> numbersOfCorners;
	/// By vertex of the complex: shift of its normal in the closed, uncracked surface.
	std::vector<Vec3> normalShift;
	/// SkinBinding::normalShift of a vertex with the normal `normal` whose triangles' areas sum to `area`.
	static Vec3 shiftOf( const Vec3& normal, const Vec3& area );

	/// A face and two of a point's cells that it joins: two slots, two carriers, or a slot and a carrier, counted from the point's first.
	struct Tie
	{
		std::uint32_t face;
		std::uint16_t a, b;
	};
	/// Points with the same carriers form a class.
	std::vector<std::uint32_t> classOfPoint;
	std::vector<std::uint32_t> firstOfClass; ///< start of each class among the carriers of all classes; the last entry is their total
	Table classesOfCell;                     ///< by cell: classes of the points that it carries
	std::size_t classCount() const { return firstOfClass.size() - 1; }
	/// Ties by point, between its cells (slot) and between its cells that do not carry it and neighbouring ones that do (loose); and by
	/// class, between the carriers of its points.
	std::vector<std::uint32_t> slotTieStart, looseTieStart, carrierTieStart;
	std::vector<Tie> slotTie, carrierTie, looseTie;
	std::vector<std::uint32_t> dividedPoints; ///< drawn points with cells that no faces join: triangles without common vertices
	std::vector<std::uint8_t> bitOfSlot;      ///< bit of the cell among the point's carriers, or kNoBit

	std::shared_ptr<const CellComplex> complex;

private:
	explicit CrackPatches( std::shared_ptr<const CellComplex> of ) : complex( std::move( of ) ) {}
	std::uint32_t slotOf( std::uint32_t point, std::uint32_t cell ) const;
	void addPatches( const float* texture );
	void numberKinds();
	void numberPanels();
	void findUnshared();
	void sortIntoClasses();
	void addTies();
	void findDivided();
	void addNormalShifts();
	template <class Take>
	void forCarriersBeside( std::uint32_t cell, const std::vector<std::uint8_t>& bitOfCell, Take&& take ) const;
	void addCarrierTies( std::uint32_t point, const std::vector<std::uint8_t>& bitOfCell );
	void addLooseTies( std::uint32_t point, const std::vector<std::uint8_t>& bitOfCell );
};

} // namespace pliant
