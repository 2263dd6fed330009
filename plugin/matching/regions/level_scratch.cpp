// Allocates memory for the step's tables before changes of levels need it.

#include "matching/regions/level_tables.h"

namespace pliant {

void makeLevelScratch( RegionTables& tables, RegionTables& others, int reserved, int touched )
{
	const auto make = [&]( AlignedArray<float>& one, AlignedArray<float>& other ) {
		if ( !one.empty() )
		{
			reserveScratch( one, std::size_t( reserved ), 0 );
			reserveScratch( other, std::size_t( reserved ), std::size_t( touched ) );
		}
	};
	RegionMoments &a = tables.moments, &b = others.moments;
	make( a.nodeWeight, b.nodeWeight );
	make( a.inverseCover, b.inverseCover );
	make( a.inverseMass, b.inverseMass );
	make( a.regionWeight, b.regionWeight );
	make( tables.pull, others.pull );
	make( tables.beta, others.beta );
	make( tables.eta, others.eta );
	for ( int k = 0; k < 3; ++k )
	{
		make( a.centre[k], b.centre[k] );
	}
	for ( int k = 0; k < 6; ++k )
	{
		make( a.moment[k], b.moment[k] );
		make( a.inverseMoment[k], b.inverseMoment[k] );
		reserveScratch( others.outOfPlane[k], std::size_t( reserved ), std::size_t( touched ) ); // used at least while tables are built
	}
	for ( int k = 0; k < 9; ++k )
	{
		make( tables.blend[k], others.blend[k] );
	}
}

} // namespace pliant
