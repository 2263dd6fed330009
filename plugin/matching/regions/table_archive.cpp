// The numbers of the tables as bytes: where links break they are computed from the previous ones, and differ in their last bits from
// rebuilt tables.

#include "archive/archive.h"
#include "matching/regions/level_tables.h"

namespace pliant {

void RegionTables::archiveNumbers( Archive& archive )
{
	for ( AlignedArray<float>* const array : { &moments.nodeWeight, &moments.inverseCover, &moments.regionWeight, &moments.inverseMass,
			  &pull, &rateFraction, &ratePull, &beta, &eta } )
	{
		archive.sameLength( *array );
	}
	for ( AlignedArray<float>& array : moments.centre )
	{
		archive.sameLength( array );
	}
	for ( int k = 0; k < 6; ++k )
	{
		archive.sameLength( moments.moment[k] );
		archive.sameLength( moments.inverseMoment[k] );
		archive.sameLength( outOfPlane[k] );
	}
	for ( AlignedArray<float>& array : blend )
	{
		archive.sameLength( array );
	}
	archive( largestRateFraction );
}

void LevelBase::archiveNumbers( Archive& archive )
{
	archive.sameLength( octree.mass );
	archive.sameLength( octree.restCentre );
	archive.sameLength( octree.spread );
	archive.sameLength( moments.covariance );
}

} // namespace pliant
