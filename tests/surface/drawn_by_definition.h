#pragma once

// The drawing of a cracked body by its definition, corner by corner: the reference implementation of CrackPatches, CrackSides and
// CrackGatherer. A side of a point is the cells there that unbroken faces join; it follows the carriers that it reaches.

#include "surface/crack_drawing.h"
#include "surface/crack_pieces.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <set>
#include <tuple>
#include <vector>

namespace pliant::test {

/// Adds to broken faces those without a link that no chain of three unbroken linked faces holds.
inline std::vector<std::uint8_t> withUnheld( const CellComplex& complex, std::vector<std::uint8_t> isBroken )
{
	const std::vector<std::uint8_t> given = isBroken;
	for ( std::uint32_t f = 0; f < std::uint32_t( isBroken.size() ); ++f )
	{
		bool isHeld = complex.face[f].isLinked;
		for ( const std::uint32_t* h = complex.holdersOfFace.begin( f ); h != complex.holdersOfFace.end( f ); h += 3 )
		{
			isHeld = isHeld || std::none_of( h, h + 3, [&given]( std::uint32_t face ) { return given[face] != 0; } );
		}
		isBroken[f] |= isHeld ? 0 : 1;
	}
	return isBroken;
}

class DrawnByDefinition
{
public:
	/// `isBroken`: by face of the complex. `texture`: u, v of the input's vertices, or null.
	DrawnByDefinition( const CellComplex& complex, const std::vector<std::uint32_t>& cells, const std::vector<std::uint8_t>& isBroken,
		const float* texture ) :
		m_complex( complex ),
		m_cells( cells ), m_isOpen( isBroken ), m_texture( texture ), m_local( complex.cellCount(), kNone )
	{
		for ( std::uint32_t k = 0; k < std::uint32_t( cells.size() ); ++k )
		{
			m_local[cells[k]] = k;
		}
		for ( std::size_t f = 0; f < m_isOpen.size(); ++f )
		{
			const bool isInside = m_local[complex.face[f].cellA] != kNone && m_local[complex.face[f].cellB] != kNone;
			m_isOpen[f] |= isInside ? 0 : 1;
		}
		findPanels();
	}

	Drawing drawing()
	{
		drawOuter();
		drawInside();
		std::sort( m_drawing.begin(), m_drawing.end() );
		const std::size_t all = m_vertices.size(),
						  placed = std::size_t( std::count_if( m_vertices.begin(), m_vertices.end(), [this]( const auto&v ) {
							  return std::get<2>( v ) < CrackPatches::kInside && isIn( m_isPlaced, std::get<0>( v ) );
						  } ) );
		m_shading.resize( placed > 0 ? m_shading.size() : 0 );
		m_shading.insert( m_shading.begin(),
			{ float( all ), float( placed > 0 ? m_outerTriangles : 0 ), float( placed ), float( placed > 0 ? all - placed : 0 ) } );
		m_drawing.push_back( m_shading );
		return m_drawing;
	}

private:
	static constexpr std::uint32_t kNone = CellComplex::kNone;
	using List = std::vector<std::uint32_t>;

	static bool isIn( const std::vector<std::uint8_t>& flags, std::size_t k ) { return k < flags.size() && flags[k] != 0; }

	/// Cells connected to `cells` by unbroken faces through `allowed` ones, sorted; with a point, only through faces that contain it.
	List connected( List cells, const List& allowed, std::uint32_t point ) const
	{
		for ( std::size_t k = 0; k < cells.size(); ++k )
		{
			for ( const std::uint32_t* f = m_complex.facesOfCell.begin( cells[k] ); f != m_complex.facesOfCell.end( cells[k] ); ++f )
			{
				const CrackFace& face = m_complex.face[*f];
				const std::uint32_t other = face.cellA == cells[k] ? face.cellB : face.cellA;
				if ( m_isOpen[*f] == 0 && std::find( allowed.begin(), allowed.end(), other ) != allowed.end() &&
					( point == kNone || m_complex.facesOfPoint.has( point, *f ) ) &&
					std::find( cells.begin(), cells.end(), other ) == cells.end() )
				{
					cells.push_back( other );
				}
			}
		}
		std::sort( cells.begin(), cells.end() );
		return cells;
	}

	const List& sideAt( std::uint32_t point, std::uint32_t cell )
	{
		List& side = m_side[{ point, cell }];
		const Table& there = m_complex.cellsOfPoint;
		side = side.empty() ? connected( { cell }, List( there.begin( point ), there.end( point ) ), point ) : std::move( side );
		return side;
	}

	bool isPassed( std::uint32_t point ) const
	{
		const Table& faces = m_complex.facesOfPoint;
		return std::any_of( faces.begin( point ), faces.end( point ), [this]( std::uint32_t f ) { return m_isOpen[f] != 0; } );
	}

	/// Cells of another body, or several sides.
	bool isSplit( std::uint32_t point )
	{
		const Table& there = m_complex.cellsOfPoint;
		return there.size( point ) > 0 &&
			( m_local[*there.begin( point )] == kNone || sideAt( point, *there.begin( point ) ).size() != there.size( point ) );
	}

	void findPanels()
	{
		const Panels& all = m_complex.panels;
		std::vector<std::uint8_t> isIntact;
		for ( std::uint32_t panel = 0; panel < std::uint32_t( all.count() ); ++panel )
		{
			isIntact.push_back(
				std::none_of( all.points.begin( panel ), all.points.end( panel ), [this]( std::uint32_t p ) { return isSplit( p ); } ) );
		}
		const auto areAll = [&]( std::uint32_t point, const std::vector<std::uint8_t>& flags ) {
			return std::all_of( all.atPoint.begin( point ), all.atPoint.end( point ), [&]( std::uint32_t p ) { return flags[p] != 0; } );
		};
		for ( std::uint32_t point = 0; point < std::uint32_t( all.isPlaceable.size() ); ++point )
		{
			m_isPlaced.push_back( all.isPlaceable[point] != 0 && areAll( point, isIntact ) );
		}
		for ( std::uint32_t panel = 0; panel < std::uint32_t( all.count() ); ++panel )
		{
			m_isOne.push_back( all.isPlane[panel] != 0 && isIntact[panel] != 0 &&
				std::all_of( all.points.begin( panel ), all.points.end( panel ),
					[&]( std::uint32_t p ) { return all.isPlaceable[p] == 0 || m_isPlaced[p] != 0; } ) );
		}
		for ( std::uint32_t point = 0; point < std::uint32_t( all.isPlaceable.size() ); ++point )
		{
			m_isSpared.push_back( all.isSpared[point] != 0 && m_isPlaced[point] != 0 && !isPassed( point ) && areAll( point, m_isOne ) );
		}
	}

	void drawOuter()
	{
		for ( const bool isSum : { true, false } ) // normals are sums over all triangles
		{
			for ( const std::uint32_t cell : m_cells )
			{
				for ( std::uint32_t t = m_complex.cellTriangleStart[cell]; t < m_complex.cellTriangleStart[cell + 1]; ++t )
				{
					takePiece( cell, t, isSum );
				}
			}
			for ( std::uint32_t panel = 0; panel < std::uint32_t( m_isOne.size() ); ++panel )
			{
				m_isOne[panel] != 0 && isOwn( panel ) ? takePanel( panel, isSum ) : void();
			}
		}
	}

	bool isOwn( std::uint32_t panel ) const
	{
		const std::uint32_t point = m_complex.vertexPoint[m_complex.panels.corner[panel][0]];
		return m_local[*m_complex.cellsOfPoint.begin( point )] != kNone;
	}

	void takePiece( std::uint32_t cell, std::uint32_t t, bool isSum )
	{
		const TrianglePoints& v = m_complex.triangle[t];
		const bool isOne = !m_isOne.empty() && m_complex.panels.ofPiece[t] != kNone && m_isOne[m_complex.panels.ofPiece[t]] != 0;
		const std::array<std::uint32_t, 3> cells = { cell, cell, cell };
		if ( !isOne )
		{
			isSum ? addArea( v, cells ) : draw( v, cells, m_complex.triangleSource[t] );
		}
		for ( std::size_t k = 0; k < 3 && !isSum; ++k )
		{
			const std::uint32_t point = m_complex.vertexPoint[v[k]];
			isIn( m_isSpared, point ) ? void() : note( point, cell, v[k] );
		}
	}

	void takePanel( std::uint32_t panel, bool isSum )
	{
		const Panels& all = m_complex.panels;
		const auto cellAt = [this]( std::uint32_t v ) { return *m_complex.cellsOfPoint.begin( m_complex.vertexPoint[v] ); };
		const auto cellsOf = [&]( const TrianglePoints& v ) { return TrianglePoints{ cellAt( v[0] ), cellAt( v[1] ), cellAt( v[2] ) }; };
		if ( isSum )
		{
			addArea( all.corner[panel], cellsOf( all.corner[panel] ) );
			return;
		}
		std::vector<TrianglePoints> triangles;
		List around;
		const auto drawnAt = [&]( std::uint32_t entry ) {
			const std::uint32_t v = all.border.entry[entry];
			return m_isSpared[m_complex.vertexPoint[v]] != 0 ? kNone : v;
		};
		drawPanel( all, panel, drawnAt, around, triangles );
		for ( const TrianglePoints& v : triangles )
		{
			draw( v, cellsOf( v ), all.source[panel] );
		}
	}

	/// `v`: vertices of the complex. Lists the points of what adds to normals.
	void addArea( const TrianglePoints& v, const TrianglePoints& cells )
	{
		const TrianglePoints p = { m_complex.vertexPoint[v[0]], m_complex.vertexPoint[v[1]], m_complex.vertexPoint[v[2]] };
		const Vec3& a = m_complex.pointRest[p[0]];
		const Vec3 area = ( m_complex.pointRest[p[1]] - a ).cross( m_complex.pointRest[p[2]] - a );
		for ( std::size_t k = 0; k < 3; ++k )
		{
			m_area.try_emplace( { p[k], sideAt( p[k], cells[k] )[0] }, Vec3::Zero() ).first->second += area;
		}
		m_shading.push_back( { float( p[0] ), float( p[1] ), float( p[2] ) } );
	}

	void draw( const TrianglePoints& v, const TrianglePoints& cells, std::uint32_t source )
	{
		const auto at = [&]( std::size_t k ) { return cornerOf( m_complex.vertexPoint[v[k]], cells[k], v[k] ); };
		add( { at( 0 ), at( 1 ), at( 2 ) }, source );
		++m_outerTriangles;
	}

	void drawInside()
	{
		for ( const std::uint32_t cell : m_cells )
		{
			for ( const std::uint32_t* f = m_complex.facesOfCell.begin( cell ); f != m_complex.facesOfCell.end( cell ); ++f )
			{
				const CrackFace& face = m_complex.face[*f];
				const bool isA = face.cellA == cell;
				for ( std::uint32_t t = face.firstTriangle; m_isOpen[*f] != 0 && t < face.lastTriangle; ++t )
				{
					const TrianglePoints& p = m_complex.faceTriangle[t];
					const std::uint32_t kind = CrackPatches::kInside + ( m_complex.faceAxis[t] ^ ( isA ? 0u : 1u ) );
					const auto at = [&]( std::size_t k ) {
						note( p[k], cell, kind );
						return cornerOf( p[k], cell, kind );
					};
					add( { at( 0 ), at( isA ? 1 : 2 ), at( isA ? 2 : 1 ) }, kNone );
				}
			}
		}
	}

	void note( std::uint32_t point, std::uint32_t cell, std::uint32_t kind )
	{
		m_vertices.emplace( point, sideAt( point, cell )[0], kind );
	}

	void add( std::vector<Corner> corners, std::uint32_t source )
	{
		std::rotate( corners.begin(), std::min_element( corners.begin(), corners.end() ), corners.end() );
		corners.push_back( { float( source ) } );
		m_drawing.push_back( std::move( corners ) );
	}

	/// As cornerOf of a binding.
	Corner cornerOf( std::uint32_t point, std::uint32_t cell, std::uint32_t kind )
	{
		const bool isInside = kind >= CrackPatches::kInside;
		const List side = sideAt( point, cell );
		const Vec3& rest = m_complex.pointRest[point];
		Vec3 normal = Vec3::Zero(), shift = Vec3::Zero();
		Corner corner;
		if ( isInside )
		{
			const std::uint32_t axis = ( kind - CrackPatches::kInside ) / 2;
			normal[axis] = kind % 2 != 0 ? -1.0f : 1.0f;
			const float tile = m_complex.settings.textureTile;
			corner = { rest[( axis + 1 ) % 3] / tile, rest[( axis + 2 ) % 3] / tile };
		}
		else
		{
			corner = textureOf( kind );
			normal = m_complex.vertexNormal[kind];
			shift = isIn( m_isPlaced, point ) ? shift : CrackPatches::shiftOf( normal, m_area.at( { point, side[0] } ) );
		}
		for ( const Vec3& a : { rest, normal, shift } )
		{
			corner.insert( corner.end(), a.data(), a.data() + 3 );
		}
		addRow( point, side, corner );
		for ( std::size_t k = 0; k < 3 && !isInside && isIn( m_isPlaced, point ); ++k )
		{
			const CellComplex::Origin& origin = m_complex.addedOrigin[kind - m_complex.inputVertices];
			const std::uint32_t from = origin.vertex[origin.vertex[k] == kNone ? 0 : k];
			corner.insert( corner.end(), { -1.0f, float( m_complex.vertexPoint[from] ), origin.weight[k] } );
		}
		return corner;
	}

	Corner textureOf( std::uint32_t kind ) const
	{
		Corner uv = { 0.0f, 0.0f };
		for ( std::size_t k = 0; k < 2 && m_texture; ++k )
		{
			const auto at = [&]( std::uint32_t v ) { return m_texture[2 * std::size_t( v ) + k]; };
			if ( kind < m_complex.inputVertices )
			{
				uv[k] = at( kind );
				continue;
			}
			const CellComplex::Origin& origin = m_complex.addedOrigin[kind - m_complex.inputVertices];
			for ( std::size_t i = 0; i < 3 && origin.vertex[i] != kNone; ++i )
			{
				uv[k] += origin.weight[i] * at( origin.vertex[i] );
			}
		}
		return uv;
	}

	/// The carriers that a side reaches. Where no crack is near it keeps those that no face connects to it.
	void addRow( std::uint32_t point, const List& side, Corner& corner ) const
	{
		const std::uint32_t first = m_complex.bindStart[point];
		const List carriers( m_complex.bindCell.begin() + first, m_complex.bindCell.begin() + m_complex.bindStart[point + 1] );
		const bool isNear = isPassed( point ) || std::any_of( carriers.begin(), carriers.end(), [this]( std::uint32_t cell ) {
			const Table& faces = m_complex.facesOfCell;
			return m_local[cell] == kNone ||
				std::any_of( faces.begin( cell ), faces.end( cell ), [this]( std::uint32_t f ) { return m_isOpen[f] != 0; } );
		} );
		const List reached = isNear ? connected( side, carriers, kNone ) : carriers;
		List kept;
		double sum = 0.0;
		for ( std::uint32_t k = 0; k < std::uint32_t( carriers.size() ); ++k )
		{
			if ( std::find( reached.begin(), reached.end(), carriers[k] ) != reached.end() )
			{
				kept.push_back( k );
				sum += double( m_complex.bindWeight[first + k] );
			}
		}
		for ( const std::uint32_t k : kept )
		{
			const float weight = m_complex.bindWeight[first + k];
			const float own = kept.size() == carriers.size() ? weight : float( double( weight ) / sum );
			corner.insert( corner.end(), { float( m_local[carriers[k]] ), own } );
		}
		kept.empty() ? void( corner.insert( corner.end(), { float( m_local[side[0]] ), 1.0f } ) ) : void();
	}

	const CellComplex& m_complex;
	List m_cells;
	std::vector<std::uint8_t> m_isOpen; ///< by face: broken, or not between two of the cells
	const float* m_texture;
	List m_local;                                                                 ///< by cell: its index in the body
	std::vector<std::uint8_t> m_isPlaced, m_isSpared;                             ///< by point
	std::vector<std::uint8_t> m_isOne;                                            ///< by panel
	std::map<std::pair<std::uint32_t, std::uint32_t>, List> m_side;               ///< by point and cell
	std::map<std::pair<std::uint32_t, std::uint32_t>, Vec3> m_area;               ///< by point and the first cell of its side
	std::set<std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>> m_vertices; ///< point, first cell of its side, kind
	std::vector<Corner> m_shading;
	std::size_t m_outerTriangles = 0;
	Drawing m_drawing;
};

/// The sides are valid, and everything is drawn as by its definition. The piece begins at the template's mass centre.
inline void expectValid( const DrawnCracks& drawn, const float* texture = nullptr )
{
	const Status status = validate( drawn.sides() );
	EXPECT_TRUE( status.ok() ) << status.sentence;
	std::vector<std::uint8_t> isBroken;
	for ( std::uint32_t f = 0; f < std::uint32_t( drawn.complex().face.size() ); ++f )
	{
		isBroken.push_back( drawn.isBroken( f ) ? 1 : 0 );
	}
	EXPECT_EQ( withUnheld( drawn.complex(), isBroken ), isBroken );
	const bool isSame = drawingOf( drawn.view() ) == DrawnByDefinition( drawn.complex(), drawn.cells(), isBroken, texture ).drawing();
	EXPECT_TRUE( isSame );
}

} // namespace pliant::test
