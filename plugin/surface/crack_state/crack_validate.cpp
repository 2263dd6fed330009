#include "surface/crack_state/crack_sides.h"

#include <algorithm>

namespace pliant {

namespace {

Status broken( const char* words )
{
	return { ResultCode::BadArgument, words };
}

/// Cells connected to `frontier` by unbroken faces through `allowed` cells; with a point, only through faces that contain it.
std::vector<std::uint32_t> walkFrom(
	const CrackSides& sides, std::vector<std::uint32_t> frontier, const std::vector<std::uint32_t>& allowed, std::uint32_t point )
{
	const CellComplex& complex = sides.complex();
	const auto isThere = [&]( std::uint32_t face ) {
		return point == CellComplex::kNone ||
			std::find( complex.facesOfPoint.begin( point ), complex.facesOfPoint.end( point ), face ) != complex.facesOfPoint.end( point );
	};
	for ( std::size_t k = 0; k < frontier.size(); ++k )
	{
		for ( const std::uint32_t* f = complex.facesOfCell.begin( frontier[k] ); f != complex.facesOfCell.end( frontier[k] ); ++f )
		{
			const std::uint32_t other = complex.face[*f].cellA == frontier[k] ? complex.face[*f].cellB : complex.face[*f].cellA;
			const bool isAllowed = std::find( allowed.begin(), allowed.end(), other ) != allowed.end();
			if ( isAllowed && isThere( *f ) && !sides.isBroken( *f ) &&
				std::find( frontier.begin(), frontier.end(), other ) == frontier.end() )
			{
				frontier.push_back( other );
			}
		}
	}
	return frontier;
}

Status validateSide( const CrackSides& sides, std::uint32_t slot )
{
	const CellComplex& complex = sides.complex();
	const std::uint32_t point = sides.patches().pointOfSlot[slot], first = complex.cellsOfPoint.start[point];
	const std::vector<std::uint32_t> there( complex.cellsOfPoint.begin( point ), complex.cellsOfPoint.end( point ) );
	const std::vector<std::uint32_t> carriers(
		complex.bindCell.begin() + complex.bindStart[point], complex.bindCell.begin() + complex.bindStart[point + 1] );
	std::vector<std::uint32_t> side;
	for ( std::size_t k = 0; k < there.size(); ++k )
	{
		if ( sides.sideOf( first + std::uint32_t( k ) ) == slot )
		{
			side.push_back( there[k] );
		}
	}
	std::vector<std::uint32_t> joined = walkFrom( sides, { there[slot - first] }, there, point );
	std::sort( joined.begin(), joined.end() );
	if ( joined != side )
	{
		return broken( "A side of a crack is not a group joined by unbroken faces." );
	}
	// A side keeps carriers that no face connects to it until a crack comes near (CrackSides::updateCarriersAround).
	const bool isUntouched = std::none_of( carriers.begin(), carriers.end(), [&]( std::uint32_t cell ) {
		return std::any_of( complex.facesOfCell.begin( cell ), complex.facesOfCell.end( cell ),
			[&sides]( std::uint32_t face ) { return sides.isBroken( face ); } );
	} );
	const std::vector<std::uint32_t> reached = isUntouched ? carriers : walkFrom( sides, side, carriers, CellComplex::kNone );
	for ( std::size_t k = 0; k < carriers.size(); ++k )
	{
		const bool isReached = std::find( reached.begin(), reached.end(), carriers[k] ) != reached.end();
		if ( isReached != ( ( sides.carriersOf( slot ) >> k & 1u ) != 0 ) )
		{
			return broken( "A side of a crack has other carriers than it reaches." );
		}
	}
	return {};
}

} // namespace

Status validate( const CrackSides& sides )
{
	for ( std::uint32_t slot = 0; slot < std::uint32_t( sides.m_side.size() ); ++slot )
	{
		if ( sides.m_isDrawn[sides.patches().pointOfSlot[slot]] != 0 && sides.sideOf( slot ) == slot )
		{
			if ( Status status = validateSide( sides, slot ); !status.ok() )
			{
				return status;
			}
		}
	}
	const auto isSeparated = [&sides]( std::uint32_t point ) {
		const std::uint32_t *const start = sides.complex().cellsOfPoint.start.data(), first = start[point];
		return std::any_of( sides.m_side.begin() + first, sides.m_side.begin() + start[point + 1],
			[first]( std::uint32_t side ) { return side != first; } );
	};
	const auto isPassed = [&sides]( std::uint32_t point ) {
		const Table& faces = sides.complex().facesOfPoint;
		return std::any_of( faces.begin( point ), faces.end( point ), [&sides]( std::uint32_t face ) { return sides.isBroken( face ); } );
	};
	return sides.m_panels.validate( isSeparated, isPassed );
}

} // namespace pliant
