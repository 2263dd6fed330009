#include "lattice/build/box_cells.h"

#include "lattice/constants.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pliant {

bool isBox( const Vec3d& size, double area, double volume )
{
	const double boxArea = 2.0 * ( size.x() * size.y() + size.y() * size.z() + size.z() * size.x() );
	return boxArea > 0.0 && std::abs( area / boxArea - 1.0 ) < kBoxFill && std::abs( volume / size.prod() - 1.0 ) < kBoxFill;
}

double cellEdgeOfBox( const Vec3d& size, double near, double target )
{
	double best = 0.0, least = std::numeric_limits<double>::max();
	for ( int axis = 0; axis < 3; ++axis )
	{
		const int middle = int( std::lround( size[axis] / near ) ), range = 1 + middle / kBoxSearch;
		for ( int k = std::max( 1, middle - range ); k <= middle + range; ++k )
		{
			const Vec3d counts = size * ( double( k ) / size[axis] ), whole = counts.array().round().max( 1.0 );
			const double misfit = ( ( counts - whole ).cwiseAbs().array() / counts.array() ).sum();
			const double deviation = std::abs( whole.prod() / target - 1.0 );
			if ( const double cost = misfit + kBoxCountWeight * deviation; deviation <= kBoxTargetSlack && cost < least )
			{
				least = cost;
				best = size[axis] / double( k );
			}
		}
	}
	return best;
}

} // namespace pliant
