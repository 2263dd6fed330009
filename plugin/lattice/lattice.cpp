// The invariants of every lattice. Ohta et al. 2009, "Preprocessing".

#include "lattice/lattice.h"

#include "lattice/constants.h"
#include "lattice/ranges.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace pliant {

namespace {

using Cell = Eigen::Matrix<std::int16_t, 3, 1>;

Status broken( std::string sentence )
{
	return Status{ ResultCode::BadArgument, std::move( sentence ) };
}

std::string cellName( std::size_t i )
{
	return "cell " + std::to_string( i );
}

/// Compares by z, then y, then x: negative when a comes before b, zero at the same position.
int compareOrder( const Cell& a, const Cell& b )
{
	for ( int axis = 2; axis >= 0; --axis )
	{
		if ( a[axis] != b[axis] )
		{
			return a[axis] < b[axis] ? -1 : 1;
		}
	}
	return 0;
}

bool areNeighbours( const Cell& a, const Cell& b )
{
	const Eigen::Vector3i step = ( a.cast<int>() - b.cast<int>() ).cwiseAbs();
	return step.maxCoeff() == 1;
}

const char* unmetBySizes( const Lattice& lattice )
{
	const std::size_t count = lattice.fill.size();
	return firstUnmet( { { lattice.coordinate.size() == count && lattice.restCentre.size() == count && lattice.isSurface.size() == count,
							 "the arrays of cells differ in length" },
		{ lattice.patch.empty() || lattice.patch.size() == count, "the number of patches is not the number of cells" },
		{ lattice.patch.empty() ? lattice.edgeFaceStart.empty() && lattice.edgeFace.empty()
								: lattice.edgeFaceStart.size() == count + 1 && lattice.edgeFaceStart.front() == 0 &&
					std::is_sorted( lattice.edgeFaceStart.begin(), lattice.edgeFaceStart.end() ) &&
					lattice.edgeFaceStart.back() == lattice.edgeFace.size(),
			"edgeFaceStart does not span edgeFace" },
		{ lattice.linkStart.size() == count + 1 && lattice.linkStart.front() == 0 && lattice.linkStart.back() == lattice.linkTo.size(),
			"linkStart does not span linkTo" },
		{ std::isfinite( lattice.cellSize ) && lattice.cellSize > 0.0f, "cellSize is not above zero" },
		{ lattice.corner.allFinite() && lattice.massCentre.allFinite(), "corner or massCentre is not finite" },
		{ lattice.extent.minCoeff() >= 1 && lattice.extent.maxCoeff() <= kMaxExtent, "extent is out of its range" } } );
}

const char* unmetByCell( const Lattice& lattice, std::size_t i )
{
	const Eigen::Vector3i at = lattice.coordinate[i].cast<int>();
	const double d = lattice.cellSize;
	const Vec3d inCell = ( lattice.restCentre[i].cast<double>() + lattice.massCentre - lattice.corner ) / d - at.cast<double>();
	const double slack = kRoundingFraction * ( lattice.extent.maxCoeff() + lattice.corner.cwiseAbs().maxCoeff() / d );
	return firstUnmet( { { at.minCoeff() >= 0 && ( lattice.extent - at ).minCoeff() >= 1, " lies outside the extent" },
		{ i == 0 || compareOrder( lattice.coordinate[i - 1], lattice.coordinate[i] ) <= 0, " breaks the order of z, y, x" },
		{ lattice.fill[i] > 0.0f && lattice.fill[i] <= 1.0f, " has a fill outside (0, 1]" },
		{ inCell.minCoeff() >= -slack && inCell.maxCoeff() <= 1.0 + slack, " has a rest centre outside the cell" } } );
}

const char* unmetByLinks( const Lattice& lattice, std::size_t i )
{
	if ( lattice.linkStart[i] > lattice.linkStart[i + 1] || lattice.linkStart[i + 1] > lattice.linkTo.size() )
	{
		return " has a broken row of links";
	}
	const auto rowOf = [&]( std::size_t cell ) { return lattice.linkTo.begin() + std::ptrdiff_t( lattice.linkStart[cell] ); };
	for ( auto link = rowOf( i ); link != rowOf( i + 1 ); ++link )
	{
		if ( *link >= lattice.fill.size() || !areNeighbours( lattice.coordinate[i], lattice.coordinate[*link] ) )
		{
			return " is linked to a cell that is not its neighbour";
		}
		const char* const unmet = firstUnmet( { { link == rowOf( i ) || *( link - 1 ) < *link, " has its links out of order" },
			{ lattice.linkStart[*link] <= lattice.linkStart[*link + 1] && lattice.linkStart[*link + 1] <= lattice.linkTo.size() &&
					std::binary_search( rowOf( *link ), rowOf( *link + 1 ), std::uint32_t( i ) ),
				" has a link that is not symmetric" } } );
		if ( unmet )
		{
			return unmet;
		}
	}
	const bool isSurface = lattice.fill[i] < 1.0f || lattice.linkStart[i + 1] - lattice.linkStart[i] != kNeighbours;
	return ( lattice.isSurface[i] != 0 ) == isSurface ? nullptr : " is wrongly marked as surface or inside";
}

Status validateMassCentre( const Lattice& lattice )
{
	double mass = 0.0;
	Vec3d moment = Vec3d::Zero();
	for ( std::size_t i = 0; i < lattice.fill.size(); ++i )
	{
		mass += lattice.fill[i];
		moment += double( lattice.fill[i] ) * lattice.restCentre[i].cast<double>();
	}
	const double reach = double( lattice.cellSize ) * lattice.extent.maxCoeff();
	if ( !( moment.norm() <= kRoundingFraction * reach * mass ) )
	{
		return broken( "the mass centre is not at zero" );
	}
	return {};
}

} // namespace

Status validate( const Lattice& lattice )
{
	if ( const char* const unmet = unmetBySizes( lattice ) )
	{
		return broken( unmet );
	}
	for ( std::size_t i = 0; i < lattice.fill.size(); ++i )
	{
		const char* unmet = unmetByCell( lattice, i );
		if ( unmet = unmet ? unmet : unmetByLinks( lattice, i ); unmet )
		{
			return broken( cellName( i ) + unmet );
		}
	}
	return validateMassCentre( lattice );
}

} // namespace pliant
