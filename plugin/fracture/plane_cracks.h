#pragma once

// Cracks as planes: where the material around a cell is stretched too far, all links that cross the plane normal to the largest stretch
// break together, and a crack grows in the plane in which it started. An extension of Ohta et al. 2009, "Fracturing": distances between
// neighbours depend on the orientation of the lattice (a pull between two of the 26 directions stretches no link fully), and cracks of
// single links follow it.

#include "fracture/cell_positions.h"
#include "fracture/face_stretch.h"
#include "fracture/link_limits.h"
#include "fracture/stretch.h"

#include <vector>

namespace pliant {

class PlaneCracks
{
public:
	/// Strain at which a cell of toughness 1 cracks, and the fraction of it at which an existing crack grows.
	PlaneCracks( float breakStrain, float growthFraction ) : m_breakStrain( breakStrain ), m_growthFraction( growthFraction ) {}

	/// Strain for `limitLinks` that finds candidates. A body strained by e in any direction has a link strained by at least
	/// kCandidateFraction e.
	float candidateStrain() const;

	/// Adds the links that break in this substep of length h, ascending. `limits` made for candidateStrain(). `mayBegin`: new cracks may
	/// start, otherwise only existing ones grow. Returns true when one has started.
	bool find( const Lattice& lattice, const LinkLimits& limits, const CellPositions& positions, float h, bool mayBegin,
		std::vector<CellLink>& broken );

	/// Switches to the reference implementation of find(): measures every stretched cell, whether or not a crack can reach it, and however
	/// small the stretch.
	void checkEveryCell() { m_checksEveryCell = true; }

	std::size_t count() const { return m_planes.size(); }

	/// Writes or reads the cracks.
	void archive( Archive& archive );

private:
	struct Plane
	{
		Vec3d point, normal; ///< at rest, in the mesh's coordinates
		Vec3d low, high;     ///< bounding box of the cells it has run through
		float age;           ///< s since it last grew

		double distanceOf( const Vec3d& at ) const; ///< from the box
		void archive( Archive& archive );
	};
	/// The largest stretch around a cell.
	struct Pull
	{
		float excess = 0.0f; ///< strain relative to the cell's break strain
		Vec3d normal = Vec3d::Zero();
	};
	/// The growth of an existing crack depends on the cell's own links, since the region of high stretch at its tip is small. The start of
	/// a crack also depends on its neighbours' links: otherwise every step of a slanted surface acts as a notch, and bars at 5 degrees to
	/// the lattice break at 0.87 of the break strain.
	struct Overload
	{
		std::uint32_t cell;
		float strainFactor; ///< CellPositions::strainFactor
		Pull near, wide;
		std::uint64_t planes = 0; ///< planesOf(), where cracks only grow
	};
	/// Memory reused between calls; not copied with the object.
	struct Scratch
	{
		Scratch() = default;
		Scratch( const Scratch& ) {}
		Scratch& operator=( const Scratch& ) { return *this; }

		FaceStretch faces;
		std::vector<std::uint32_t> stretched; ///< cells, ascending
		std::vector<std::uint8_t> mark;       ///< by cell
		std::vector<std::uint32_t> inSlab;
		std::vector<Overload> found;
		std::vector<Vec3d> rest; ///< by cell, in the mesh's coordinates
		std::vector<std::uint32_t> members;
		std::vector<std::uint8_t> isBroken; ///< by link of the limits, in this call
		std::vector<std::uint8_t> sideOf;   ///< by cell, while a crack passes it: 1 below, 2 above; else 0
		std::vector<std::uint64_t> above,
			inSlabs;                            ///< by cell, a bit per plane: on its upper side, and within its thickness
		std::vector<std::uint8_t> isActive;     ///< by cell: it may have an effect
		std::vector<std::uint8_t> isUnresolved; ///< by cell: an active one not yet known to be stretched
	};

	/// Planes that fit in the bits of a word; with more of them all cells are active.
	static constexpr std::size_t kMaxPlaneBits = 64;
	double heightOver( const Plane& plane, std::uint32_t cell ) const { return plane.normal.dot( m_scratch.rest[cell] - plane.point ); }

	void findActive( const Lattice& lattice );
	bool hasEffect( const Lattice& lattice, std::uint32_t cell ) const;
	void findStretched( const LinkLimits& limits, const CellPositions& positions );
	void dropUnreachable( const Lattice& lattice );
	void findOverloads( const Lattice& lattice, const LinkLimits& limits, const CellPositions& positions, bool mayBegin );
	void measureWide( const Lattice& lattice, const LinkLimits& limits, Overload& overload );
	void findRestPositions( const Lattice& lattice );
	std::uint64_t planesOf( std::uint32_t cell, const Pull& near, double cellSize ) const;
	std::uint64_t unreachedPlanes( double cellSize ) const;
	Pull measure( const Lattice& lattice, const LinkLimits& limits, const Eigen::Matrix3d& around, const Overload& overload ) const;
	/// Whether a cell has a link by more than half a cell in a direction.
	bool hasLinkAlong( const Lattice& lattice, std::uint32_t cell, const Vec3d& direction ) const;
	Plane* planeFor( const Overload& found, const Vec3d& at, double cellSize, bool mayBegin, bool& isShielded );
	bool breakAcross( const Lattice& lattice, const LinkLimits& limits, std::uint32_t cell, Plane& plane );
	void collectBroken( const LinkLimits& limits, std::vector<CellLink>& broken );

	float m_breakStrain, m_growthFraction;
	bool m_checksEveryCell = false;
	std::vector<Plane> m_planes;
	Scratch m_scratch;
};

} // namespace pliant
