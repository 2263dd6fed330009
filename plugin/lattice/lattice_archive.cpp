#include "archive/archive.h"
#include "lattice/lattice.h"
#include "lattice/pieces.h"

#include <algorithm>

namespace pliant {

void archive( Archive& archive, ContactPatch& patch )
{
	auto& [normal, height, radius, links] = patch;
	archive( normal, height, radius, links );
}

void archive( Archive& archive, Lattice& lattice )
{
	auto& [cellSize, corner, massCentre, extent, coordinate, fill, restCentre, isSurface, patch, edgeFace, edgeFaceStart, overhang,
		linkStart, linkTo] = lattice;
	archive( cellSize, corner, massCentre, extent, coordinate, fill, restCentre, isSurface, patch, edgeFace, edgeFaceStart, overhang,
		linkStart, linkTo );
	if ( !archive.isReading() || !archive.isSound() )
	{
		return;
	}
	archive.require( std::isfinite( cellSize ) && cellSize > 0.0f && corner.allFinite() && massCentre.allFinite() && !fill.empty() &&
			( patch.empty() || patch.size() == fill.size() ),
		"A lattice has impossible numbers." );
	const auto isFinite = []( const ContactPatch& each ) {
		return each.normal.allFinite() && std::isfinite( each.height ) && std::isfinite( each.radius );
	};
	archive.require( std::all_of( patch.begin(), patch.end(), isFinite ) && std::all_of( edgeFace.begin(), edgeFace.end(), isFinite ),
		"A contact patch has impossible numbers." );
	if ( archive.isSound() )
	{
		archive.require( validate( lattice ).ok(), "A lattice is not valid." );
	}
}

void archive( Archive& archive, CellLink& link )
{
	archive( link.a, link.b );
}

void archiveLinks( Archive& archive, std::vector<CellLink>& links, const Lattice& lattice, bool areAbsent )
{
	archive( links );
	if ( !archive.isReading() || !archive.isSound() )
	{
		return;
	}
	const auto cells = std::uint32_t( lattice.cellCount() );
	for ( std::size_t k = 0; k < links.size() && archive.isSound(); ++k )
	{
		const CellLink& link = links[k];
		if ( !archive.require( link.a < link.b && link.b < cells && ( k == 0 || links[k - 1] < link ), "Links are not in order." ) )
		{
			return;
		}
		const auto row = lattice.linkTo.begin();
		const bool isLinked = std::binary_search( row + lattice.linkStart[link.a], row + lattice.linkStart[link.a + 1], link.b );
		const int apart = ( lattice.coordinate[link.a].cast<int>() - lattice.coordinate[link.b].cast<int>() ).cwiseAbs().maxCoeff();
		archive.require( isLinked != areAbsent && apart <= 1, "A link is not one of the lattice." );
	}
}

} // namespace pliant
