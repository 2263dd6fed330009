#pragma once

#include "surface/crack_state/crack_surface.h"

#include <utility>
#include <vector>

namespace pliant::test {

/// A piece of a cracked body with its own vertices and triangles and the same cracks. `cells`: indices of the template, ascending.
inline CrackSurface takenPiece( const CrackSurface& whole, const std::shared_ptr<const CellComplex>& complex,
	std::vector<std::uint32_t> cells, const Vec3& shift = Vec3::Zero() )
{
	std::vector<std::uint8_t> isBroken;
	for ( std::uint32_t face = 0; face < std::uint32_t( complex->face.size() ); ++face )
	{
		isBroken.push_back( whole.isBroken( face ) ? 1 : 0 );
	}
	return CrackSurface( complex, std::move( cells ), isBroken, shift );
}

} // namespace pliant::test
