#pragma once

// Which cells of a family are connected at each point of their cracks. Ohta et al. 2009, "Fracturing".
//
// The cells that draw something at a point form sides: groups connected by unbroken faces. Each side keeps those of the point's carriers
// that it reaches through unbroken faces. Cracks change nothing else.

#include "surface/crack_state/crack_patches.h"

namespace pliant {

class BladePath;
class TaskRunner;

class CrackSides
{
public:
	/// Of an uncracked body: only faces without a link that no chain of linked faces holds are broken.
	explicit CrackSides( std::shared_ptr<const CrackPatches> patches );

	/// Breaks faces; ignores those already broken.
	void breakFaces( const std::vector<std::uint32_t>& faces, TaskRunner* runner = nullptr );
	/// Moves points to their positions on a blade's path.
	void follow( const BladePath& path, const std::vector<std::uint32_t>& points );

	bool isBroken( std::uint32_t face ) const { return m_isBroken[face] != 0; }
	/// The first slot of the side that a slot belongs to.
	std::uint32_t sideOf( std::uint32_t slot ) const { return m_side[slot]; }
	/// The carriers of a side, a bit each; `side`: its first slot.
	std::uint64_t carriersOf( std::uint32_t side ) const { return m_carriers[side]; }
	const Vec3& positionOf( std::uint32_t point ) const
	{
		return m_position.empty() ? m_patches->complex->pointRest[point] : m_position[point];
	}
	/// True where the outer surface around a point differs from the uncracked one.
	bool isReshaded( std::uint32_t point ) const { return m_isReshaded[point] != 0; }
	const IntactPanels& panels() const { return m_panels; }

	const CrackPatches& patches() const { return *m_patches; }
	const CellComplex& complex() const { return *m_patches->complex; }

private:
	friend Status validate( const CrackSides& sides );

	bool isHeld( std::uint32_t face ) const;
	void addUnheld( std::vector<std::uint32_t>& added );
	void splitSides( const std::vector<std::uint32_t>& added, TaskRunner* runner );
	void regroup( std::uint32_t point );
	void updateCarriersAround( const std::vector<std::uint32_t>& added, TaskRunner* runner );
	std::vector<std::uint32_t> cellsAt( const std::vector<std::uint32_t>& faces ) const;
	void collectByClass( const std::vector<std::uint32_t>& cells );
	void runOver( std::vector<std::uint32_t>& list, void ( CrackSides::*each )( std::uint32_t ), TaskRunner* runner );
	void joinCarriers( std::uint32_t ofClass );
	void updateCarriers( std::uint32_t point );
	void collect( const std::uint32_t* point, const std::uint32_t* end );
	void reshadeAround( std::uint32_t point );
	void separatePanels();

	std::shared_ptr<const CrackPatches> m_patches;
	std::vector<std::uint8_t> m_isBroken;  ///< by face
	std::vector<std::uint32_t> m_side;     ///< by slot
	std::vector<std::uint64_t> m_carriers; ///< by the first slot of each side
	std::vector<std::uint64_t>
		m_joined; ///< by carrier of a class (CrackPatches::firstOfClass): the carriers that unbroken faces connect to it
	std::vector<std::uint8_t> m_isDrawn, m_isReshaded, m_isMarked, m_isSplit; ///< by point
	IntactPanels m_panels;
	std::vector<Vec3> m_position;       ///< by point; empty: as in the complex
	std::vector<std::uint32_t> m_found; ///< points
	std::vector<std::uint32_t> m_foundClass;
	std::vector<std::uint8_t> m_isClassMarked;
};

/// Checks that every side is connected by unbroken faces and has the carriers found by a walk from cell to cell.
Status validate( const CrackSides& sides );

} // namespace pliant
