#include "lattice/axis_neighbours.h"

namespace pliant {

AxisNeighbours findAxisNeighbours( const Lattice& lattice )
{
	AxisNeighbours beside( std::size_t( lattice.cellCount() ), { -1, -1, -1, -1, -1, -1 } );
	for ( std::size_t i = 0; i < beside.size(); ++i )
	{
		for ( std::uint32_t l = lattice.linkStart[i]; l < lattice.linkStart[i + 1]; ++l )
		{
			const std::uint32_t other = lattice.linkTo[l];
			const Eigen::Vector3i step = ( lattice.coordinate[other] - lattice.coordinate[i] ).cast<int>();
			if ( step.squaredNorm() == 1 )
			{
				const int axis = step.x() != 0 ? 0 : step.y() != 0 ? 1 : 2;
				beside[i][std::size_t( 2 * axis + ( step[axis] > 0 ? 1 : 0 ) )] = std::int32_t( other );
			}
		}
	}
	return beside;
}

} // namespace pliant
