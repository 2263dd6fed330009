#pragma once

// Avoids jumps of the skin when nodes are split or merged: the displacement caused by a change is compensated by an offset that fades over
// the next frames. In Steinemann et al. 2008, section 7, the skin follows the nodes at once.
//
// Two effects would be visible. The new maps differ from the old ones: the difference is stored per vertex and fades. And the children of a
// split node move apart faster than within a frame: the children's maps M_c start from a common map C,
//   M'_c = ( 1 - s ) M_c + s C,   C: mass-weighted mean of M_c at the mean of their rest positions,   s from 1 to 0.

#include "pliant/render/skin_tables.h"
#include "surface/skin/skinning.h"

namespace pliant {

class CellComplex;

class SkinFade
{
public:
	/// Reserves memory for `count` nodes; touches the memory of the first `touched` of them.
	void reserveNodes( int count, std::size_t touched, int cellCount );

	/// Called right before a change: stores the nodes' maps. `maps`: the maps of this very pose, which are taken over; null: computed here.
	void keep( const NodeState& nodes, const SkinPose& pose, int cellCount, AlignedArray<float>* maps = nullptr );

	struct Nodes
	{
		const NodeState& now;
		const SkinPose& pose;
		const std::vector<std::uint32_t>& source; ///< by node after the change: its source node before
		const std::vector<std::uint32_t>& keptAs; ///< by node before the change: its index now, if it still exists
		Eigen::Quaternionf body;                  ///< the body's rotation; offsets rotate with it
		const std::vector<std::uint32_t>* measured =
			nullptr; ///< nodes after the change, ascending; all others have the maps of their sources. Null: unknown
		const CellComplex* complex = nullptr;                       ///< with the points of the binding; null: not used
		const std::vector<std::uint32_t>* cellsInComplex = nullptr; ///< by cell of the body, its index in `complex`; empty: equal
	};
	/// Called right after the change, before any motion: adds the displacement of the surface to the rest of earlier offsets.
	void start( const SkinBinding& binding, const Nodes& nodes );

	bool isActive() const { return !m_vertex.empty() || !m_group.empty(); }
	/// Advances by one frame. Returns true where that moves the surface.
	bool advance();
	void clear();

	/// Blends the maps of nodes that were split recently.
	void ease( const NodeState& nodes, float* maps ) const;
	/// Adds the remaining offsets to positions of three (`packed`) and four (`wide`) floats per vertex. Only carriers
	/// (SkinBinding::carrier) have offsets; other vertices copy from them.
	void addTo( float* packed, float* wide, const Eigen::Quaternionf& body ) const;

	/// Counts the changes of the offsets, apart from their fading.
	unsigned offsetVersion() const { return m_offsetVersion; }
	bool hasOffsets() const { return !m_vertex.empty(); }
	/// Writes the offset of each vertex, in the body's frame and before it fades: that of its carrier.
	void spread( const SkinBinding& binding, std::vector<SkinOffset>& offsets ) const;
	/// Factor that rotates offsets into the world and lets them fade.
	Eigen::Matrix3f offsetTurn( const Eigen::Quaternionf& body ) const { return fraction() * body.toRotationMatrix(); }
	/// After `start`: the maps before the change, and those after it at the same positions.
	const AlignedArray<float>& mapsBefore() const { return m_mapBefore; }
	const AlignedArray<float>& mapsNow() const { return m_mapNow; }

private:
	/// The children of one split node, with consecutive indices.
	struct Group
	{
		std::uint32_t first, count;
		int frame;
	};

	void regroup( const Nodes& nodes );
	std::vector<char> changeableSlots( const Nodes& nodes ) const;
	void measureMaps( const Nodes& nodes, const std::vector<char>& mayDiffer );
	std::vector<char> changedSlots( const Nodes& nodes, std::vector<char> mayDiffer, float visible ) const;
	float fraction() const;

	AlignedArray<float> m_mapBefore, m_mapNow;
	std::vector<std::uint32_t> m_slotBefore;
	double m_diagonal = 0.0; ///< of the surface at rest, m; 0: not yet computed

	std::vector<Group> m_group;          ///< ascending
	std::vector<std::uint32_t> m_vertex; ///< vertices with an offset, all with a row of weights, ascending
	std::vector<Vec3> m_offset;          ///< by such vertex, in the body's frame, m
	int m_frames = 1;                    ///< duration of the fade
	int m_frame = 0;
	unsigned m_offsetVersion = 0;
};

} // namespace pliant
