#pragma once

// Reference implementation of a body's search for contacts with itself: all pairs of its nodes.

#include "world/bodies/soft_body_impl.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <vector>

namespace pliant::test {

/// By node: 1 where a region holds the node together with `node`, or with a third node that is held with it.
inline std::vector<std::uint8_t> heldWith( const SoftBody& soft, int node )
{
	const Body& body = *soft.impl().body;
	const Levels* levels = body.levels();
	const std::vector<std::uint32_t>& start = levels ? levels->matrix().start : body.lattice().linkStart;
	const std::vector<std::uint32_t>& to = levels ? levels->matrix().member : body.lattice().linkTo;
	std::vector<std::uint8_t> isHeld( std::size_t( body.nodes().count ), 0 );
	for ( std::uint32_t k = start[std::size_t( node )]; k < start[std::size_t( node ) + 1]; ++k )
	{
		isHeld[to[k]] = 1;
		for ( std::uint32_t l = start[to[k]]; l < start[to[k] + 1]; ++l )
		{
			isHeld[to[l]] = 1;
		}
	}
	return isHeld;
}

/// Expects that a search at the nodes' present positions finds all pairs that touch. Returns their number.
inline int expectAllPairs( const SoftBody& soft, SelfSearch& search )
{
	const SoftBody::Impl& impl = soft.impl();
	const NodeState& nodes = impl.body->nodes();
	const std::vector<NodeHit>& hits = search.find( soft, 0.0 );
	const auto isLess = []( const NodeHit& a, const NodeHit& b ) { return a.key < b.key; };
	EXPECT_TRUE( std::is_sorted( hits.begin(), hits.end(), isLess ) );
	int touching = 0;
	for ( int a = 0; a < nodes.count; ++a )
	{
		const std::vector<std::uint8_t> isHeld = heldWith( soft, a );
		for ( int b = a + 1; b < nodes.count; ++b )
		{
			const double radii = double( soft.nodeRadius( a ) + soft.nodeRadius( b ) );
			const double wanted = std::min( radii, double( ( nodes.x0.get( a ) - nodes.x0.get( b ) ).norm() ) );
			const bool collide = impl.shape->childOfNode( a ) >= 0 && impl.shape->childOfNode( b ) >= 0 && !isHeld[std::size_t( b )];
			if ( collide && double( ( nodes.x.get( a ) - nodes.x.get( b ) ).norm() ) < wanted + 0.03 * double( soft.nodeRadius( a ) ) )
			{
				NodeHit hit;
				hit.key = std::uint64_t( a ) << 32 | std::uint32_t( b );
				EXPECT_TRUE( std::binary_search( hits.begin(), hits.end(), hit, isLess ) );
				++touching;
			}
		}
	}
	EXPECT_LE( std::size_t( touching ), hits.size() );
	return touching;
}

} // namespace pliant::test
