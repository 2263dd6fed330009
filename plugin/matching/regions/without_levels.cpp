// For builds without levels of detail: bodies that need them are rejected (adaptivity.cpp), so none of this is ever called.

#include "matching/regions/level_tables.h"

namespace pliant {

std::shared_ptr<const LevelBase> buildLevelBase( const Lattice&, const Material&, const Adaptivity& )
{
	return nullptr;
}

std::shared_ptr<const LevelBase> LevelCache::find( const Lattice&, const Material&, const Adaptivity& )
{
	return nullptr;
}

Cut firstCut( const Octree&, const Adaptivity& )
{
	return {};
}

} // namespace pliant
