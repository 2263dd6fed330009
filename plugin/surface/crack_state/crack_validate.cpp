#include "surface/constants.h"
#include "surface/crack_state/crack_sides.h"
#include "surface/crack_state/crack_surface.h"

#include <algorithm>
#include <cmath>

namespace pliant {

namespace {

Status broken( const char* words )
{
	return { ResultCode::BadArgument, words };
}

} // namespace

Status CrackSurface::validateTriangles() const
{
	const auto isOfSide = [this]( std::uint32_t cell, std::uint32_t first, std::uint32_t last ) {
		for ( std::uint32_t t = first; t < last; ++t )
		{
			for ( const std::uint32_t v : m_triangle[t] )
			{
				if ( v >= m_vertex.size() || m_vertex[v].group != groupOf( m_vertex[v].point, cell ) )
				{
					return false;
				}
			}
		}
		return true;
	};
	for ( std::uint32_t cell = 0; cell < m_cell.size(); ++cell )
	{
		if ( !isOfSide( cell, m_cellTriangle[cell], m_cellTriangle[cell + 1] ) )
		{
			return broken( "A piece of the outer surface is drawn with another side's vertex." );
		}
	}
	for ( const Face& face : m_face )
	{
		const CrackFace& known = m_complex->face[face.number];
		const std::uint32_t count = known.lastTriangle - known.firstTriangle;
		for ( const bool isA : { true, false } )
		{
			const std::uint32_t cell = isA ? face.cellA : face.cellB, first = isA ? face.firstA : face.firstB;
			if ( ( first != kNone ) != ( face.isBroken && cell != kNone ) )
			{
				return broken( "A broken face is not drawn, or an unbroken one is." );
			}
			if ( first != kNone && !isOfSide( cell, first, first + count ) )
			{
				return broken( "A side of a crack is drawn with another side's vertex." );
			}
		}
	}
	return {};
}

Status CrackSurface::validateGroups() const
{
	for ( std::uint32_t p = 0; p < m_point.size(); ++p )
	{
		const std::uint32_t first = m_slotStart[p], count = m_slotStart[p + 1] - first;
		std::uint32_t joins = 0;
		std::vector<std::uint32_t> label( count );
		for ( std::uint32_t k = 0; k < count; ++k )
		{
			label[k] = k;
		}
		for ( std::uint32_t t = m_tieStart[p]; t < m_tieStart[p + 1]; ++t )
		{
			const Tie& tie = m_tie[t];
			if ( m_face[tie.face].isBroken )
			{
				continue;
			}
			if ( m_slotGroup[first + tie.a] != m_slotGroup[first + tie.b] )
			{
				return broken( "An unbroken face separates its cells." );
			}
			const std::uint32_t from = label[tie.b], to = label[tie.a];
			joins += from != to;
			for ( std::uint32_t& l : label )
			{
				l = l == from ? to : l;
			}
		}
		if ( count > 0 && count - joins != m_groups[p] )
		{
			return broken( "Cells that no unbroken face joins are one group." );
		}
	}
	return {};
}

Status CrackSurface::validateBinding() const
{
	if ( m_binding.start.size() != m_vertex.size() + 1 || m_binding.restPosition.size() != m_vertex.size() ||
		m_binding.normalGroup.size() != m_vertex.size() || m_binding.carrier.size() != m_vertex.size() ||
		m_binding.point.size() != m_vertex.size() || m_binding.restNormal.size() != m_vertex.size() ||
		( isBindingCurrent() && m_binding.normalShift.size() != m_vertex.size() ) )
	{
		return broken( "The binding and the vertices differ in number." );
	}
	for ( std::size_t v = 0; v < m_vertex.size() && m_binding.kind != Skinning::None && isBindingCurrent(); ++v )
	{
		double sum = 0.0;
		const std::uint32_t carrier = m_binding.carrier[v];
		if ( m_binding.carrier[carrier] != carrier || m_vertex[carrier].point != m_vertex[v].point ||
			m_vertex[carrier].group != m_vertex[v].group )
		{
			return broken( "The carrier of a vertex belongs to another side." );
		}
		if ( m_binding.point[v] != m_point[m_vertex[v].point] )
		{
			return broken( "A vertex is at another point than its binding says." );
		}
		for ( std::uint32_t k = m_binding.start[carrier]; k < m_binding.start[carrier + 1]; ++k )
		{
			sum += double( m_binding.weight[k] );
			if ( m_binding.node[k] >= m_cell.size() )
			{
				return broken( "A vertex follows a cell of another body." );
			}
		}
		if ( !( std::abs( sum - 1.0 ) < kWeightSumSlack ) )
		{
			return broken( "The weights of a vertex do not sum to 1." );
		}
	}
	return {};
}

Status CrackSurface::validatePanels() const
{
	const auto isSeparated = [this]( std::uint32_t point ) {
		const std::uint32_t local = localPoint( point );
		return local != kNone &&
			( m_groups[local] != 1 || m_slotStart[local + 1] - m_slotStart[local] != m_complex->cellsOfPoint.size( point ) );
	};
	const auto isPassed = [this]( std::uint32_t point ) {
		const Table& faces = m_complex->facesOfPoint;
		return std::any_of( faces.begin( point ), faces.end( point ),
			[this]( std::uint32_t face ) { return localFace( face ) != kNone && isBroken( face ); } );
	};
	return m_panels.validate( isSeparated, isPassed );
}

Status CrackSurface::validatePlaced() const
{
	if ( !isBindingCurrent() )
	{
		return {};
	}
	std::size_t placed = 0, blended = 0;
	const auto isCorner = [&]( std::uint32_t v, std::uint32_t input ) {
		return m_binding.carrier[v] == v && m_vertex[v].kind < m_complex->inputVertices &&
			m_binding.point[v] == m_complex->vertexPoint[input];
	};
	for ( std::uint32_t v = 0; v < m_vertex.size(); ++v )
	{
		if ( !isPlaced( m_vertex[v] ) )
		{
			blended += blended < m_binding.blended.size() && m_binding.blended[blended] == v ? 1 : 0;
			continue;
		}
		const std::uint32_t carrier = m_binding.carrier[v];
		if ( placed == m_binding.placed.size() || m_binding.placed[placed].vertex != v || !isPlaced( m_vertex[carrier] ) ||
			!m_binding.normalShift[v].isZero( 0.0f ) )
		{
			return broken( "A vertex within an intact panel is not placed, or its carrier is not." );
		}
		const CellComplex::Origin& origin = m_complex->addedOrigin[m_vertex[v].kind - m_complex->inputVertices];
		const SkinBinding::Placed& of = m_binding.placed[placed++];
		for ( std::size_t k = 0; k < 3; ++k )
		{
			if ( of.weight[k] != origin.weight[k] || !isCorner( of.corner[k], origin.vertex[origin.vertex[k] == kNone ? 0 : k] ) )
			{
				return broken( "A vertex is placed by vertices other than the corners of its panel." );
			}
		}
	}
	const bool areAll = placed == m_binding.placed.size() && blended == m_binding.blended.size() &&
		( placed == 0 ? blended == 0 : placed + blended == m_vertex.size() );
	return areAll ? Status{} : broken( "Some vertex is neither placed nor blended, or is both." );
}

Status CrackSurface::validateShading() const
{
	if ( !isBindingCurrent() || m_binding.placed.empty() )
	{
		return m_binding.shading.empty() || !isBindingCurrent() ? Status{}
																: broken( "Panels are shaded as one triangle, but no point is placed." );
	}
	std::size_t listed = 0;
	const auto isListed = [&]( const std::array<std::uint32_t, 3>& points ) {
		bool isSame = listed < m_binding.shading.size();
		for ( std::size_t k = 0; k < 3 && isSame; ++k )
		{
			isSame = m_binding.point[m_binding.shading[listed][k]] == points[k];
		}
		++listed;
		return isSame;
	};
	std::vector<std::uint8_t> isThere( m_complex->panels.count(), 0 );
	bool areListed = m_binding.shadedTriangles == m_cellTriangle.back();
	for ( std::uint32_t cell = 0; cell < m_cell.size(); ++cell )
	{
		for ( std::uint32_t t = m_complex->cellTriangleStart[m_cell[cell]], to = m_cellTriangle[cell]; to < m_cellTriangle[cell + 1];
			  ++t, ++to )
		{
			const bool isOne = m_panels.isOfOne( t );
			isThere[isOne ? m_complex->panels.ofPiece[t] : 0] |= isOne ? 1 : 0;
			const auto& v = m_complex->triangle[t];
			areListed = areListed &&
				( isOne ||
					( listed < m_binding.shading.size() && m_binding.shading[listed] == m_triangle[to] &&
						isListed( { m_complex->vertexPoint[v[0]], m_complex->vertexPoint[v[1]], m_complex->vertexPoint[v[2]] } ) ) );
		}
	}
	for ( std::size_t panel = 0; panel < isThere.size(); ++panel )
	{
		const auto& v = m_complex->panels.corner[panel];
		areListed = areListed &&
			( isThere[panel] == 0 ||
				isListed( { m_complex->vertexPoint[v[0]], m_complex->vertexPoint[v[1]], m_complex->vertexPoint[v[2]] } ) );
	}
	return areListed && listed == m_binding.shading.size()
		? Status{}
		: broken( "The triangles summed to normals are not the drawn ones with intact panels as one." );
}

Status validate( const CrackSurface& surface )
{
	for ( const auto check : { &CrackSurface::validateTriangles, &CrackSurface::validateGroups, &CrackSurface::validateBinding,
			  &CrackSurface::validatePanels, &CrackSurface::validatePlaced, &CrackSurface::validateShading } )
	{
		if ( Status status = ( surface.*check )(); !status.ok() )
		{
			return status;
		}
	}
	return {};
}

// === Sides of a family's cracks ===

namespace {

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
