#pragma once

#include "lattice/lattice.h"

#include <cstdint>
#include <utility>
#include <vector>

namespace pliant::test {

/// Keeps the links between cells a and b for which keep( a, b ) is true; keep must be symmetric.
template <class Keep>
void keepLinks( Lattice& lattice, Keep&& keep )
{
	std::vector<std::uint32_t> start( 1, 0 ), to;
	for ( std::uint32_t a = 0; a < std::uint32_t( lattice.cellCount() ); ++a )
	{
		for ( std::uint32_t k = lattice.linkStart[a]; k < lattice.linkStart[a + 1]; ++k )
		{
			if ( keep( a, lattice.linkTo[k] ) )
			{
				to.push_back( lattice.linkTo[k] );
			}
		}
		start.push_back( std::uint32_t( to.size() ) );
	}
	lattice.linkStart = std::move( start );
	lattice.linkTo = std::move( to );
}

} // namespace pliant::test
