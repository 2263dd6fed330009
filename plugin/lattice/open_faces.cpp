#include "lattice/open_faces.h"

namespace pliant {

OpenFaces findOpenFaces( const Lattice& lattice )
{
	OpenFaces faces;
	for ( std::size_t i = 0; i < std::size_t( lattice.cellCount() ); ++i )
	{
		faces.start.push_back( std::uint32_t( faces.inner.size() ) );
		int beside[6] = { -1, -1, -1, -1, -1, -1 }; // by axis, low and high
		for ( std::uint32_t l = lattice.linkStart[i]; l < lattice.linkStart[i + 1]; ++l )
		{
			const std::uint32_t other = lattice.linkTo[l];
			const Eigen::Vector3i step = ( lattice.coordinate[other] - lattice.coordinate[i] ).cast<int>();
			if ( step.squaredNorm() == 1 )
			{
				const int axis = step.x() != 0 ? 0 : step.y() != 0 ? 1 : 2;
				beside[2 * axis + ( step[axis] > 0 ? 1 : 0 )] = int( other );
			}
		}
		for ( int side = 0; side < 6; ++side )
		{
			if ( beside[side] >= 0 && beside[side ^ 1] < 0 )
			{
				faces.inner.push_back( std::uint32_t( beside[side] ) );
			}
		}
	}
	faces.start.push_back( std::uint32_t( faces.inner.size() ) );
	return faces;
}

} // namespace pliant
