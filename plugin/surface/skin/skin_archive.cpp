#include "archive/archive.h"
#include "surface/skin/skinning.h"

#include <algorithm>

namespace pliant {

void SkinBinding::archive( Archive& archive, std::size_t vertices, std::size_t cells )
{
	archive.choice( kind, Skinning::None );
	archive( start, node, weight, restPosition, restNormal, normalGroup, normalGroups, normalShift );
	if ( !archive.isReading() || !archive.isSound() )
	{
		return;
	}
	if ( kind == Skinning::None )
	{
		archive.require(
			vertices == 0 && node.empty() && restPosition.empty() && normalGroup.empty(), "A skin without a kind has vertices." );
		return;
	}
	const auto isBelow = []( std::size_t limit ) { return [limit]( std::uint32_t index ) { return index < limit; }; };
	archive.require( start.size() == vertices + 1 && start.front() == 0 && start.back() == node.size() &&
			std::is_sorted( start.begin(), start.end() ) && weight.size() == node.size() && restPosition.size() == vertices &&
			restNormal.size() == vertices && normalGroup.size() == vertices && normalShift.size() <= vertices && normalGroups >= 0 &&
			std::size_t( normalGroups ) <= vertices && std::all_of( node.begin(), node.end(), isBelow( cells ) ) &&
			std::all_of( normalGroup.begin(), normalGroup.end(), isBelow( std::size_t( std::max( 0, normalGroups ) ) ) ),
		"A skin's rows are not valid." );
	archive.requireFinite( weight, weight.size() );
	for ( const std::vector<Vec3>* const list : { &restPosition, &restNormal, &normalShift } )
	{
		archive.require(
			std::all_of( list->begin(), list->end(), []( const Vec3& v ) { return v.allFinite(); } ), "A skin is not finite." );
	}
}

} // namespace pliant
