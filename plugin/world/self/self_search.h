#pragma once

// Finds the nodes of a soft body that touch other nodes of the same body. Steinemann et al. 2008, section 7.
//
// Nodes held together by a region do not collide: shape matching keeps them apart. All others do, including the sides of a cut, from their
// rest distance on where that is less than the sum of their radii.
//
// Two spheres whose sides have passed through one another are recognised by the outward direction of the material at each of them
// (inside_distance.h) and pushed back to their own sides. The paper takes the penetration depth from its distance field; here it is that of
// the spheres, as in all other contacts, and the field gives only the direction.

#include "world/search/node_search.h"
#include "world/shape/sphere_rows.h"

#include <cstdint>
#include <vector>

namespace pliant {

class Archive;
class Body;
class NodeShape;

class SelfSearch
{
public:
	/// Normals point from the node with the higher number to that with the lower, which comes first in the key.
	const std::vector<NodeHit>& find( const SoftBody& soft, double step );
	/// The body's cells after a change: their previous numbers, and those that lost links; none listed: unknown.
	struct CellsNow
	{
		const Lattice& lattice;
		const std::vector<std::uint32_t>& before;
		const std::vector<std::uint32_t>& touched;
	};
	/// Follows a cut.
	void relink( const CellsNow& cells );
	/// Follows a change of node numbers that keeps their order. `nodeNow` by previous number, kNoNode where the node is gone.
	void renumber( const std::vector<std::uint32_t>& nodeNow );
	/// Writes or reads the data that one search passes to the next; what only saves time is computed again.
	void archive( Archive& archive );

private:
	/// Allowed overlap of the two sides of a fresh cut: no deeper than at first, and never growing, until they have separated.
	struct Slack
	{
		std::uint64_t key;
		double depth; ///< m
		void archive( Archive& archive );
	};

	bool hasMoved( double most ) const;
	void listPairs( double margin );
	bool areHeldTogether( int a, int b ) const;
	void testPair( int a, int b );
	Touch touchOf( int a, int b, const Vec3& apart );
	bool faceAwayAtRest( int a, int b );
	Vec3 outwardAtRest( int node );
	Vec3 outwardNow( int node );
	void applySlack();

	const SoftBody* m_soft = nullptr;
	const Body* m_body = nullptr;
	double m_step = 0.0;
	std::vector<NodeHit> m_hits;
	std::vector<std::uint64_t> m_pairs; ///< that may touch until a node has moved too far, as lower number << 32 | higher, ascending
	bool m_isListed = false;
	Vec3Array m_listedAt; ///< the nodes' positions when they were listed
	SphereRows::Pairs m_found;
	std::vector<std::uint32_t> m_depth;      ///< floodInside; empty: not yet computed
	std::vector<float> m_rotation;           ///< 4 per node; empty: not yet computed in this search
	std::vector<Slack> m_slack, m_slackNext; ///< sorted by key
	bool m_isFirst = true;                   ///< first search since the body was cut
};

} // namespace pliant
