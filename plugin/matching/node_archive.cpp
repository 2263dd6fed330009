// The state of nodes and of matchers in general as bytes.

#include "archive/archive.h"
#include "matching/matcher.h"

#include <algorithm>

namespace pliant {

void NodeState::archive( Archive& archive )
{
	archive( origin );
	for ( AlignedArray<float>* const array : { &x.x, &x.y, &x.z, &v.x, &v.y, &v.z, &mass, &freedom } )
	{
		archive.entries( *array, count );
	}
	for ( AlignedArray<float>* const array : { &force.x, &force.y, &force.z } )
	{
		archive.entriesOrNone( *array, count, padded );
		archive.requireFinite( *array, array->empty() ? 0 : std::size_t( count ) );
	}
	if ( !archive.isReading() || archive.isTrusted() || !archive.isSound() )
	{
		return;
	}
	const auto areWithin = [this]( const Vec3Array& vectors, float limit ) {
		bool areAll = true;
		for ( int i = 0; i < count; ++i )
		{
			areAll = areAll && vectors.get( i ).cwiseAbs().maxCoeff() <= limit; // false for NaN
		}
		return areAll;
	};
	archive.require(
		origin.cwiseAbs().maxCoeff() <= double( kFarthestStored ) && areWithin( x, kFarthestStored ) && areWithin( v, kFastestStored ),
		"A node is too far out or too fast." );
	archive.requireFinite( mass, std::size_t( count ) );
	archive.require( std::all_of( mass.begin(), mass.begin() + count, []( float m ) { return m > 0.0f; } ) &&
			std::all_of( freedom.begin(), freedom.begin() + count, []( float f ) { return f == 0.0f || f == 1.0f; } ) &&
			force.x.size() == force.y.size() && force.x.size() == force.z.size(),
		"The masses, pins or forces of nodes are not valid." );
}

void Matcher::archive( Archive& archive )
{
	archive.refuse( "This matcher cannot be saved." );
}

} // namespace pliant
