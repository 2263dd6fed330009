#include "surface/crack_complex/panels.h"

#include "surface/constants.h"
#include "surface/crack_complex/cell_complex.h"

#include <Eigen/Geometry>

#include <algorithm>

namespace pliant {

namespace {

class PanelFinder
{
public:
	PanelFinder( const MeshView& mesh, const CellComplex& complex ) : m_mesh( mesh ), m_complex( complex ) {}

	Panels run()
	{
		std::vector<std::pair<std::uint32_t, std::uint32_t>> pieces, points;
		for ( std::uint32_t t = 0; t < std::uint32_t( m_complex.triangle.size() ); ++t )
		{
			pieces.emplace_back( m_complex.triangleSource[t], t );
		}
		m_pieces = makeTable( pieces, m_mesh.triangleCount );
		m_out.ofPiece.assign( m_complex.triangle.size(), Panels::kNone );
		m_out.border.start.push_back( 0 );
		for ( std::uint32_t cell = 0; cell < m_complex.cellCount(); ++cell )
		{
			m_out.firstOfCell.push_back( std::uint32_t( m_out.count() ) );
			for ( std::uint32_t t = m_complex.cellTriangleStart[cell]; t < m_complex.cellTriangleStart[cell + 1]; ++t )
			{
				const std::uint32_t source = m_complex.triangleSource[t];
				if ( *m_pieces.begin( source ) == t && isPanel( source ) )
				{
					add( source, points );
				}
			}
		}
		m_out.firstOfCell.push_back( std::uint32_t( m_out.count() ) );
		m_out.points = makeTable( points, m_out.count() );
		m_out.atPoint = turned( m_out.points, m_complex.pointCount() );
		findPlaceable();
		return std::move( m_out );
	}

private:
	const Vec3& at( std::uint32_t vertex ) const { return m_complex.pointRest[m_complex.vertexPoint[vertex]]; }

	/// True for a triangle that is cut, small enough, not degenerate, connected, and drawn only from its corners and cuts.
	bool isPanel( std::uint32_t source ) const
	{
		const std::uint32_t* const corner = m_mesh.indices + 3 * std::size_t( source );
		const Vec3 a = at( corner[1] ) - at( corner[0] ), b = at( corner[2] ) - at( corner[0] );
		const float longest = std::max( { a.norm(), b.norm(), ( b - a ).norm() } );
		return m_pieces.size( source ) > 1 && longest <= kLongestPanel * m_complex.cellSize && !a.cross( b ).isZero( 0.0f ) &&
			isDrawnAlone( source, corner ) && isConnected( source );
	}

	bool isDrawnAlone( std::uint32_t source, const std::uint32_t* corner ) const
	{
		bool isDrawn[3] = {}, isOwn = true;
		const auto cornerAt = [corner]( std::uint32_t vertex ) { return std::size_t( std::find( corner, corner + 3, vertex ) - corner ); };
		for ( const std::uint32_t* t = m_pieces.begin( source ); t != m_pieces.end( source ); ++t )
		{
			for ( const std::uint32_t v : m_complex.triangle[*t] )
			{
				const std::size_t k = cornerAt( v );
				isDrawn[k % 3] = isDrawn[k % 3] || k < 3;
				isOwn = isOwn && ( k < 3 || v >= m_complex.inputVertices );
				for ( std::size_t e = 0; e < 3 && isOwn && k == 3; ++e )
				{
					const std::uint32_t end = m_complex.addedOrigin[v - m_complex.inputVertices].vertex[e];
					isOwn = end == CellComplex::kNone || cornerAt( end ) < 3;
				}
			}
		}
		return isOwn && isDrawn[0] && isDrawn[1] && isDrawn[2];
	}

	/// True where its pieces are connected through shared points: then a crack can only pass at one of its points.
	bool isConnected( std::uint32_t source ) const
	{
		const std::uint32_t *const first = m_pieces.begin( source ), *const last = m_pieces.end( source );
		std::vector<std::uint32_t> reached{ m_complex.vertexPoint[m_complex.triangle[*first][0]] };
		const auto isReached = [&]( std::uint32_t v ) {
			return std::find( reached.begin(), reached.end(), m_complex.vertexPoint[v] ) != reached.end();
		};
		for ( std::size_t before = 0; before < reached.size(); )
		{
			before = reached.size();
			for ( const std::uint32_t* t = first; t != last; ++t )
			{
				const auto& corner = m_complex.triangle[*t];
				for ( std::size_t k = 0; k < 3 && std::any_of( corner.begin(), corner.end(), isReached ); ++k )
				{
					if ( !isReached( corner[k] ) )
					{
						reached.push_back( m_complex.vertexPoint[corner[k]] );
					}
				}
			}
		}
		return std::all_of( first, last, [&]( std::uint32_t t ) { return isReached( m_complex.triangle[t].front() ); } );
	}

	void add( std::uint32_t source, std::vector<std::pair<std::uint32_t, std::uint32_t>>& points )
	{
		const std::uint32_t panel = std::uint32_t( m_out.count() );
		const std::uint32_t* const corner = m_mesh.indices + 3 * std::size_t( source );
		m_out.corner.push_back( { corner[0], corner[1], corner[2] } );
		m_out.source.push_back( source );
		addBorder( source, corner );
		for ( const std::uint32_t* t = m_pieces.begin( source ); t != m_pieces.end( source ); ++t )
		{
			m_out.ofPiece[*t] = panel;
			for ( const std::uint32_t v : m_complex.triangle[*t] )
			{
				points.emplace_back( panel, m_complex.vertexPoint[v] );
			}
		}
	}

	/// Joins the edges of its pieces that have no opposite edge.
	void addBorder( std::uint32_t source, const std::uint32_t* corner )
	{
		std::vector<std::array<std::uint32_t, 2>> edges;
		for ( const std::uint32_t* t = m_pieces.begin( source ); t != m_pieces.end( source ); ++t )
		{
			const auto& v = m_complex.triangle[*t];
			for ( std::size_t k = 0; k < 3; ++k )
			{
				const auto back = std::find( edges.begin(), edges.end(), std::array{ v[( k + 1 ) % 3], v[k] } );
				back == edges.end() ? edges.push_back( { v[k], v[( k + 1 ) % 3] } ) : void( edges.erase( back ) );
			}
		}
		std::vector<std::uint32_t> around{ corner[0] };
		for ( std::size_t k = 0; k < edges.size(); ++k )
		{
			const auto next = std::find_if(
				edges.begin(), edges.end(), [&around]( const auto& edge ) { return edge[0] == around.back(); } );
			around.push_back( next == edges.end() ? Panels::kNone : ( *next )[1] );
		}
		const bool isClosed = around.back() == corner[0] && edges.size() <= std::size_t( m_pieces.size( source ) ) + 2;
		around.pop_back();
		const auto second = std::find( around.begin(), around.end(), corner[1] ), third = std::find( second, around.end(), corner[2] );
		std::vector<std::uint32_t> once( around );
		std::sort( once.begin(), once.end() );
		const bool isSimple = std::adjacent_find( once.begin(), once.end() ) == once.end();
		if ( isClosed && isSimple && third != around.end() )
		{
			m_out.border.entry.insert( m_out.border.entry.end(), around.begin(), around.end() );
		}
		m_out.border.start.push_back( std::uint32_t( m_out.border.entry.size() ) );
	}

	void findPlaceable()
	{
		m_out.isPlaceable.assign( m_complex.pointCount(), 0 );
		for ( std::size_t v = m_complex.inputVertices; v < m_complex.vertexPoint.size(); ++v )
		{
			m_out.isPlaceable[m_complex.vertexPoint[v]] = 1;
		}
		for ( std::size_t v = 0; v < m_complex.inputVertices; ++v )
		{
			m_out.isPlaceable[m_complex.vertexPoint[v]] = 0;
		}
		for ( std::size_t t = 0; t < m_complex.triangle.size(); ++t )
		{
			for ( const std::uint32_t v : m_complex.triangle[t] )
			{
				m_out.isPlaceable[m_complex.vertexPoint[v]] &= m_out.ofPiece[t] != Panels::kNone ? 1 : 0;
			}
		}
		for ( std::uint32_t panel = 0; panel < std::uint32_t( m_out.count() ); ++panel )
		{
			const auto isCorner = [&]( std::uint32_t point ) {
				return std::any_of( m_out.corner[panel].begin(), m_out.corner[panel].end(),
					[&]( std::uint32_t v ) { return m_complex.vertexPoint[v] == point; } );
			};
			const auto isPlaceable = [&]( std::uint32_t point ) { return m_out.isPlaceable[point] != 0; };
			const std::uint32_t *const first = m_out.points.begin( panel ), *const last = m_out.points.end( panel );
			const bool isPlane = m_out.border.size( panel ) > 0 && std::any_of( first, last, isPlaceable ) &&
				std::all_of( first, last, [&]( std::uint32_t p ) { return isPlaceable( p ) || isCorner( p ); } );
			m_out.isPlane.push_back( isPlane ? 1 : 0 );
		}
		findSpared();
	}

	void findSpared()
	{
		const auto isPlane = [this]( std::uint32_t panel ) { return m_out.isPlane[panel] != 0; };
		for ( std::uint32_t point = 0; point < std::uint32_t( m_out.isPlaceable.size() ); ++point )
		{
			const bool arePlanes = std::all_of( m_out.atPoint.begin( point ), m_out.atPoint.end( point ), isPlane );
			m_out.isSpared.push_back( m_out.isPlaceable[point] != 0 && arePlanes ? 1 : 0 );
		}
		const auto isHidden = [this]( std::uint32_t point ) {
			return m_out.isSpared[point] != 0 || m_out.isPlaceable[point] == 0;
		}; // or it is a corner
		for ( std::uint32_t panel = 0; panel < std::uint32_t( m_out.count() ); ++panel )
		{
			m_out.isPlain.push_back(
				isPlane( panel ) && std::all_of( m_out.points.begin( panel ), m_out.points.end( panel ), isHidden ) ? 1 : 0 );
		}
	}

	const MeshView& m_mesh;
	const CellComplex& m_complex;
	Table m_pieces; ///< by triangle of the input, ascending
	Panels m_out;
};

} // namespace

Panels findPanels( const MeshView& mesh, const CellComplex& complex )
{
	return PanelFinder( mesh, complex ).run();
}

// The first side with vertices on it forms a fan around the third corner. Where the other two sides have vertices too, each forms one more
// fan, around the first and the last vertex of the first fan.
void drawPanel( const std::vector<std::uint32_t>& around, const std::array<std::size_t, 3>& cornerAt,
	std::vector<std::array<std::uint32_t, 3>>& triangles )
{
	const std::size_t count = around.size();
	const auto endOf = [&]( std::size_t side ) { return side == 2 ? count : cornerAt[side + 1]; };
	std::size_t side = 0;
	while ( side < 2 && endOf( side ) - cornerAt[side] == 1 )
	{
		++side;
	}
	const auto at = [&]( std::size_t k ) { return around[k % count]; };
	const std::size_t first = cornerAt[side], second = endOf( side ),
					  third = second + ( endOf( ( side + 1 ) % 3 ) - cornerAt[( side + 1 ) % 3] );
	if ( second - first == 1 ) // no vertices besides corners
	{
		triangles.push_back( { at( first ), at( second ), at( third ) } );
		return;
	}
	for ( std::size_t k = first + 1; k + 1 < second; ++k )
	{
		triangles.push_back( { at( k ), at( k + 1 ), at( third ) } );
	}
	for ( std::size_t k = second; k < third; ++k )
	{
		triangles.push_back( { at( second - 1 ), at( k ), at( k + 1 ) } );
	}
	for ( std::size_t k = third; k < first + count; ++k )
	{
		triangles.push_back( { at( first + 1 ), at( k ), at( k + 1 ) } );
	}
}

IntactPanels::IntactPanels( const Panels& panels ) :
	m_panels( &panels ), m_isIntact( panels.count(), 1 ), m_isOne( panels.isPlane ), m_isPlain( panels.isPlain ),
	m_isPlaced( panels.isPlaceable ), m_isSpared( panels.isSpared )
{
	m_placed = std::size_t( std::count( m_isPlaced.begin(), m_isPlaced.end(), 1 ) );
}

void IntactPanels::separate( std::uint32_t point, std::vector<std::uint32_t>& reshaded )
{
	if ( !arePlaced() )
	{
		return;
	}
	const Table &at = m_panels->atPoint, &points = m_panels->points;
	const auto shade = [&]( std::uint32_t panel ) {
		if ( m_isOne[panel] != 0 )
		{
			m_isOne[panel] = m_isPlain[panel] = 0;
			reshaded.insert( reshaded.end(), points.begin( panel ), points.end( panel ) );
			std::for_each( points.begin( panel ), points.end( panel ), [this]( std::uint32_t p ) { uncover( p ); } );
		}
	};
	for ( const std::uint32_t* panel = at.begin( point ); panel != at.end( point ); ++panel )
	{
		if ( m_isIntact[*panel] == 0 )
		{
			continue;
		}
		m_isIntact[*panel] = 0;
		shade( *panel );
		for ( const std::uint32_t* p = points.begin( *panel ); p != points.end( *panel ); ++p )
		{
			if ( m_isPlaced[*p] != 0 )
			{
				m_isPlaced[*p] = 0;
				--m_placed;
				reshaded.push_back( *p );
				std::for_each( at.begin( *p ), at.end( *p ), shade );
			}
		}
	}
}

void IntactPanels::touch( std::uint32_t point, std::vector<std::uint32_t>& reshaded )
{
	m_isTouched.resize( m_panels->isPlaceable.size(), 0 );
	if ( !m_isTouched.empty() )
	{
		m_isTouched[point] = 1;
	}
	separate( point, reshaded );
}

void IntactPanels::uncover( std::uint32_t point )
{
	if ( isSpared( point ) )
	{
		m_isSpared[point] = 0;
		std::for_each(
			m_panels->atPoint.begin( point ), m_panels->atPoint.end( point ), [this]( std::uint32_t panel ) { m_isPlain[panel] = 0; } );
	}
}

Status IntactPanels::validate(
	const std::function<bool( std::uint32_t )>& isSeparated, const std::function<bool( std::uint32_t )>& isPassed ) const
{
	const Panels& all = *m_panels;
	const auto areAll = []( const Table& table, std::size_t row, auto&& holds ) {
		return std::all_of( table.begin( row ), table.end( row ), holds );
	};
	const auto isIntact = [&]( std::uint32_t panel ) {
		return areAll(
			all.points, panel, [&]( std::uint32_t p ) { return !isSeparated( p ) && ( m_isTouched.empty() || m_isTouched[p] == 0 ); } );
	};
	const auto isToBePlaced = [&]( std::uint32_t point ) { return all.isPlaceable[point] != 0 && areAll( all.atPoint, point, isIntact ); };
	for ( std::uint32_t point = 0; point < std::uint32_t( all.isPlaceable.size() ); ++point )
	{
		if ( isPlaced( point ) != isToBePlaced( point ) )
		{
			return { ResultCode::BadArgument, "A point that a crack separates is placed, or an intact one is not." };
		}
	}
	for ( std::uint32_t panel = 0; panel < std::uint32_t( all.count() ); ++panel )
	{
		const bool isIntactAround = areAll(
			all.points, panel, [&]( std::uint32_t p ) { return all.isPlaceable[p] == 0 || isToBePlaced( p ); } );
		if ( isOne( panel ) != ( all.isPlane[panel] != 0 && isIntact( panel ) && isIntactAround ) )
		{
			return { ResultCode::BadArgument, "A panel that is not intact is shaded as one triangle, or an intact one is not." };
		}
	}
	return validateSpared( isPassed );
}

Status IntactPanels::validateSpared( const std::function<bool( std::uint32_t )>& isPassed ) const
{
	const Panels& all = *m_panels;
	const auto isOneThere = [this]( std::uint32_t panel ) { return isOne( panel ); };
	for ( std::uint32_t point = 0; point < std::uint32_t( all.isPlaceable.size() ); ++point )
	{
		const bool isToBeSpared = isPlaced( point ) && !isPassed( point ) &&
			std::all_of( all.atPoint.begin( point ), all.atPoint.end( point ), isOneThere );
		if ( isSpared( point ) != isToBeSpared )
		{
			return { ResultCode::BadArgument, "A point that must be drawn is spared, or one that need not be is not." };
		}
	}
	for ( std::uint32_t panel = 0; panel < std::uint32_t( all.count() ); ++panel )
	{
		const auto isHidden = [&]( std::uint32_t point ) { return all.isPlaceable[point] == 0 || isSpared( point ); };
		if ( isPlain( panel ) != ( isOne( panel ) && std::all_of( all.points.begin( panel ), all.points.end( panel ), isHidden ) ) )
		{
			return { ResultCode::BadArgument, "A cut panel is drawn as the input's triangle, or an uncut one is not." };
		}
	}
	return {};
}

} // namespace pliant
