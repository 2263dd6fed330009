#pragma once

// Bodies with levels of detail, and changes of them between two steps of the world.

#include "world/test_world.h"

#include "body/levels/levels.h"
#include "world/bodies/soft_body_impl.h"

namespace pliant::test {

inline Adaptivity levels( int count )
{
	Adaptivity settings;
	settings.coarseLevels = count;
	settings.mergeDelay = 0.05f;
	return settings;
}

/// Splits or merges octree nodes as the world does between two steps.
inline void changeLevels( SoftBody& soft, const std::vector<std::uint32_t>& split, const std::vector<std::uint32_t>& merge )
{
	SoftBody::Impl& impl = soft.impl();
	impl.changeNodes( soft, [&] { impl.body->changeLevels( split, merge ); } );
}

inline std::vector<std::uint32_t> coarseNodes( const SoftBody& soft, bool ( *isWanted )( const SoftBody& soft, int node ) )
{
	std::vector<std::uint32_t> nodes;
	for ( int i = 0; i < soft.nodeCount(); ++i )
	{
		if ( soft.nodeLevel( i ) > 0 && isWanted( soft, i ) )
		{
			nodes.push_back( soft.impl().body->levels()->cut().node[std::size_t( i )] );
		}
	}
	return nodes;
}

inline bool anyNode( const SoftBody&, int )
{
	return true;
}

} // namespace pliant::test
