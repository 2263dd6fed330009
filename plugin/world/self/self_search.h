#pragma once

// Finds which nodes of a soft body meet others of the same body. Steinemann et al. 2008, section 7.
//
// Nodes that one region holds together do not collide: what keeps them apart is matching. All others do, sides of a cut among them, from
// the distance they have at rest on where that is less than their radii.
//
// Two spheres whose sides have gone through one another are told by the way out of the material at each of them (inside_distance.h): they
// are pushed back the way they came, and not on. The paper looks the penetration depth up in its distance field; here it is the spheres',
// as in all other contacts, and the field says only which way.

#include "world/search/node_search.h"
#include "world/self/near_pairs.h"

#include <cstdint>
#include <vector>

namespace pliant {

class Body;
class NodeShape;

class SelfSearch
{
public:
	/// Normals point from the node of the higher number to that of the lower, which comes first in the key.
	const std::vector<NodeHit>& find( const SoftBody& soft, double step );
	/// The body's cells: their numbers before, and those that lost links; none named: nobody knows.
	struct CellsNow
	{
		const Lattice& lattice;
		const std::vector<std::uint32_t>& before;
		const std::vector<std::uint32_t>& touched;
	};
	/// Links have been cut: what is known of the body is measured anew there. `nodeNow` by the number before, kNoNode where the node is
	/// gone; empty: the same.
	void relink( const std::vector<std::uint32_t>& nodeNow, const CellsNow& cells );
	/// Nodes have other numbers: the same; in the same order.
	void renumber( const std::vector<std::uint32_t>& nodeNow );

private:
	/// As deep as the two sides of a fresh cut overlapped at first they may go on doing, and no deeper, until they have parted.
	struct Slack
	{
		std::uint64_t key;
		double depth; ///< m
	};

	void consider( int a, int b );
	Touch touchOf( int a, int b, const Vec3& apart );
	bool faceAwayAtRest( int a, int b );
	Vec3 outwardAtRest( int node );
	Vec3 outwardNow( int node );
	void giveSlack();

	const SoftBody* m_soft = nullptr;
	const Body* m_body = nullptr;
	double m_step = 0.0;
	std::vector<NodeHit> m_hits;
	NearPairs m_near;
	std::vector<std::uint32_t> m_depth;      ///< floodInside; empty: not asked for yet
	std::vector<float> m_rotation;           ///< 4 a node; empty: not asked for in this search
	std::vector<Slack> m_slack, m_slackNext; ///< by key
	bool m_isFirst = true;                   ///< search since the body was cut
};

} // namespace pliant
