#pragma once

// No jump of the skin when nodes are split or merged: what a change moved the surface by stays on it and goes away over the next frames.
// Beyond Steinemann et al. 2008, section 7, whose skin follows the nodes at once.
//
// Two things would show. The new maps differ from the old ones: that difference is kept a vertex, and fades. And where a node is split its
// children soon find places of their own, faster than a frame: the children's maps M_c go over from the one map they have in common,
//   M'_c = ( 1 - s ) M_c + s C,   C: mass-weighted mean of M_c at the mean of their rest places,   s from 1 to 0.

#include "surface/skin/skinning.h"

namespace pliant {

class CellComplex;

class SkinFade
{
public:
	/// Room for as many nodes, for `touched` of them in memory that is there.
	void reserveNodes( int count, std::size_t touched, int cellCount );

	/// Right before a change: how the skin is carried. `maps`: those of this very pose, which are taken; null where nobody has them.
	void keep( const NodeState& nodes, const SkinPose& pose, int cellCount, AlignedArray<float>* maps = nullptr );

	struct Nodes
	{
		const NodeState& now;
		const SkinPose& pose;
		const std::vector<std::uint32_t>& source; ///< of each node now: a node before
		const std::vector<std::uint32_t>& keptAs; ///< of each node before: its number now, if it is still there
		Eigen::Quaternionf body;                  ///< the body's rotation: offsets turn along with it
		const std::vector<std::uint32_t>* measured =
			nullptr;                          ///< nodes now, ascending: all others are carried as before. Null: nobody knows
		const CellComplex* complex = nullptr; ///< whose points the binding names; null: they are not asked for
		const std::vector<std::uint32_t>* cellsThere = nullptr; ///< with it: the numbers the body's cells have there; empty: the same
	};
	/// Right after the change, with nothing moved in between: what the surface would jump by, on top of what is left of earlier changes.
	void start( const SkinBinding& binding, const Nodes& nodes );

	bool isActive() const { return !m_vertex.empty() || !m_group.empty(); }
	/// One frame further. True where that moves the surface.
	bool advance();
	void clear();

	/// Brings the maps of nodes that were split of late nearer to each other.
	void ease( const NodeState& nodes, float* maps ) const;
	/// Adds what is left to positions of three and of four floats a vertex, of those that carry others (SkinBinding::carrier), which
	/// follow.
	void addTo( float* packed, float* wide, const Eigen::Quaternionf& body ) const;

	std::size_t bytes() const;

private:
	/// The children of one node that was split, which stand side by side.
	struct Group
	{
		std::uint32_t first, count;
		int frame;
	};

	void regroup( const Nodes& nodes );
	std::vector<char> freshSlots( const Nodes& nodes ) const;
	void measureMaps( const Nodes& nodes, const std::vector<char>& isFresh );
	std::vector<char> changedSlots( const Nodes& nodes, std::vector<char> isFresh, float visible ) const;
	float fraction() const;

	AlignedArray<float> m_mapBefore, m_mapNow;
	std::vector<std::uint32_t> m_slotBefore;
	double m_diagonal = 0.0; ///< of the surface at rest, m; 0: not measured yet

	std::vector<Group> m_group;          ///< ascending
	std::vector<std::uint32_t> m_vertex; ///< those with an offset that have a row of weights, ascending
	std::vector<Vec3> m_offset;          ///< of each of them, in the body's frame, m
	int m_frames = 1;                    ///< that the fade takes
	int m_frame = 0;
};

} // namespace pliant
