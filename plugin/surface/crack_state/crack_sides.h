#pragma once

// How the cells of a family hang together at each point of their cracks. Ohta et al. 2009, "Fracturing".
//
// At a point the cells that draw something there fall into sides: those that standing faces join. And of the cells that carried the point
// in the whole body each side keeps those which it reaches through standing faces. That is all that cracks change.

#include "surface/crack_state/crack_patches.h"

namespace pliant {

class BladePath;
class TaskRunner;

class CrackSides
{
public:
	/// Broken as `whole` is.
	CrackSides( std::shared_ptr<const CrackPatches> patches, const CrackSurface& whole, TaskRunner* runner = nullptr );

	/// Those broken before are passed over.
	void breakFaces( const std::vector<std::uint32_t>& faces, TaskRunner* runner = nullptr );
	/// Draws points where a blade's path has them.
	void follow( const BladePath& path, const std::vector<std::uint32_t>& points );

	bool isBroken( std::uint32_t face ) const { return m_isBroken[face] != 0; }
	/// The first slot of the side that a slot belongs to.
	std::uint32_t sideOf( std::uint32_t slot ) const { return m_side[slot]; }
	/// Of those that carry the point in the whole body, the ones that a side has, a bit each; by the side's first slot.
	std::uint64_t carriersOf( std::uint32_t side ) const { return m_carriers[side]; }
	const std::uint64_t* carriersAt( std::uint32_t side ) const { return &m_carriers[side]; }
	const Vec3& positionOf( std::uint32_t point ) const
	{
		return m_position.empty() ? m_patches->complex->pointRest[point] : m_position[point];
	}
	void fetchSide( std::uint32_t slot ) const { __builtin_prefetch( &m_side[slot] ); }
	void fetchPosition( std::uint32_t point ) const { __builtin_prefetch( &positionOf( point ) ); }
	/// Whether the outer surface around a point is not what it was in the whole body.
	bool isShadedAnew( std::uint32_t point ) const { return m_isShadedAnew[point] != 0; }
	const IntactPanels& panels() const { return m_panels; }

	const CrackPatches& patches() const { return *m_patches; }
	const CellComplex& complex() const { return *m_patches->complex; }
	std::size_t bytes() const;

private:
	friend Status validate( const CrackSides& sides );

	bool isHeld( std::uint32_t face ) const;
	void addUnheld( std::vector<std::uint32_t>& fresh );
	void splitSides( const std::vector<std::uint32_t>& fresh, TaskRunner* runner );
	void regroup( std::uint32_t point );
	void askAround( const std::vector<std::uint32_t>& fresh, TaskRunner* runner );
	std::vector<std::uint32_t> cellsAt( const std::vector<std::uint32_t>& faces ) const;
	void collectByClass( const std::vector<std::uint32_t>& cells );
	void runOver( std::vector<std::uint32_t>& list, void ( CrackSides::*each )( std::uint32_t ), TaskRunner* runner );
	void joinCarriers( std::uint32_t ofClass );
	void ask( std::uint32_t point );
	void collect( const std::uint32_t* point, const std::uint32_t* end );
	void shadeAnewAround( std::uint32_t point );
	void partPanels();
	void shadePartedPanels();

	std::shared_ptr<const CrackPatches> m_patches;
	std::vector<std::uint8_t> m_isBroken;  ///< by face
	std::vector<std::uint32_t> m_side;     ///< by slot
	std::vector<std::uint64_t> m_carriers; ///< by slot; of sides' first slots
	std::vector<std::uint64_t>
		m_joined; ///< by place of a class (CrackPatches::firstOfClass): the carriers that standing faces join to this one
	std::vector<std::uint8_t> m_isDrawn, m_isShadedAnew, m_isMarked, m_isSplit; ///< by point
	IntactPanels m_panels;
	std::vector<Vec3> m_position;       ///< by point; empty: those of the complex
	std::vector<std::uint32_t> m_found; ///< points
	std::vector<std::uint32_t> m_foundClass;
	std::vector<std::uint8_t> m_isClassMarked;
};

/// Every side is what standing faces join, and has the carriers that a walk from cell to cell finds.
Status validate( const CrackSides& sides );

} // namespace pliant
