// Removes degenerate and duplicate triangles.

#include "lattice/mesh/weld.h"

#include "lattice/table.h"
#include "lattice/union_find.h"

#include <algorithm>

namespace pliant {

EdgeTable makeEdgeTable( const std::vector<Triangle>& triangles, std::size_t vertexCount )
{
	EdgeTable table;
	std::vector<std::uint32_t> row;
	const auto forEdges = [&triangles]( auto&& visit ) {
		for ( std::size_t t = 0; t < triangles.size(); ++t )
		{
			for ( std::size_t k = 0; k < 3; ++k )
			{
				const std::uint32_t a = triangles[t][k];
				const std::uint32_t b = triangles[t][( k + 1 ) % 3];
				visit( std::min( a, b ), EdgeTable::Entry{ std::min( a, b ), std::max( a, b ), std::uint32_t( t ), a < b } );
			}
		}
	};
	sortIntoRows( vertexCount, forEdges, row, table.entry );
	for ( std::size_t v = 0; v < vertexCount; ++v )
	{
		std::sort(
			table.entry.begin() + row[v], table.entry.begin() + row[v + 1], []( const EdgeTable::Entry& a, const EdgeTable::Entry& b ) {
				return a.high != b.high ? a.high < b.high : a.triangle < b.triangle;
			} );
	}
	for ( std::size_t k = 0; k < table.entry.size(); ++k )
	{
		if ( k == 0 || table.entry[k].low != table.entry[k - 1].low || table.entry[k].high != table.entry[k - 1].high )
		{
			table.start.push_back( std::uint32_t( k ) );
		}
	}
	table.start.push_back( std::uint32_t( table.entry.size() ) );
	return table;
}

double areaOf( const WeldedMesh& mesh, const std::vector<Triangle>& triangles )
{
	double area = 0.0;
	for ( const Triangle& t : triangles )
	{
		area += 0.5 * ( mesh.position[t[1]] - mesh.position[t[0]] ).cross( mesh.position[t[2]] - mesh.position[t[0]] ).norm();
	}
	return area;
}

namespace {

bool isForward( const Triangle& t )
{
	return t[1] < t[2];
}

/// Rotates the lowest vertex to the front; the orientation is kept.
Triangle withLowestFirst( const Triangle& t )
{
	const std::size_t first = std::size_t( std::min_element( t.begin(), t.end() ) - t.begin() );
	return { t[first], t[( first + 1 ) % 3], t[( first + 2 ) % 3] };
}

void sortTriangles( std::vector<Triangle>& triangles, std::size_t vertexCount )
{
	std::vector<std::uint32_t> row;
	std::vector<Triangle> sorted;
	const auto forTriangles = [&triangles]( auto&& visit ) {
		for ( const Triangle& t : triangles )
		{
			visit( t[0], t );
		}
	};
	sortIntoRows( vertexCount, forTriangles, row, sorted );
	for ( std::size_t v = 0; v < vertexCount; ++v )
	{
		std::sort( sorted.begin() + row[v], sorted.begin() + row[v + 1], []( const Triangle& a, const Triangle& b ) {
			const std::uint32_t lowA = std::min( a[1], a[2] );
			const std::uint32_t lowB = std::min( b[1], b[2] );
			const std::uint32_t highA = std::max( a[1], a[2] );
			const std::uint32_t highB = std::max( b[1], b[2] );
			return lowA != lowB ? lowA < lowB : highA != highB ? highA < highB : isForward( a ) > isForward( b );
		} );
	}
	triangles.swap( sorted );
}

/// A wall drawn from both sides. Where its border runs along edges that are paired without it, it closes off a part of the surface and
/// would divide one body in two: it is removed. Elsewhere it is the surface itself, drawn twice: one side is kept.
class DoubledWalls
{
public:
	DoubledWalls( const std::vector<Triangle>& triangles, const std::vector<std::uint8_t>& isDoubled, std::size_t vertexCount ) :
		m_isDoubled( isDoubled ), m_sets( triangles.size() ), m_votes( triangles.size(), 0 )
	{
		const EdgeTable edges = makeEdgeTable( triangles, vertexCount );
		for ( std::size_t e = 0; e < edges.edgeCount(); ++e )
		{
			joinAlong( edges, e );
		}
		for ( std::size_t e = 0; e < edges.edgeCount(); ++e )
		{
			voteAlong( edges, e );
		}
	}

	bool isWall( std::uint32_t triangle ) { return m_isDoubled[triangle] && m_votes[m_sets.find( triangle )] > 0; }

private:
	int countDoubled( const EdgeTable& edges, std::size_t e ) const
	{
		int doubled = 0;
		for ( std::size_t k = edges.start[e]; k < edges.start[e + 1]; ++k )
		{
			doubled += m_isDoubled[edges.entry[k].triangle];
		}
		return doubled;
	}

	void joinAlong( const EdgeTable& edges, std::size_t e )
	{
		if ( edges.start[e + 1] - edges.start[e] == 2 && countDoubled( edges, e ) == 2 )
		{
			m_sets.join( edges.entry[edges.start[e]].triangle, edges.entry[edges.start[e] + 1].triangle );
		}
	}

	void voteAlong( const EdgeTable& edges, std::size_t e )
	{
		const int doubled = countDoubled( edges, e );
		const int others = int( edges.start[e + 1] - edges.start[e] ) - doubled;
		if ( doubled == 0 || ( doubled == 2 && others == 0 ) )
		{
			return;
		}
		for ( std::size_t k = edges.start[e]; k < edges.start[e + 1]; ++k )
		{
			if ( const std::uint32_t t = edges.entry[k].triangle; m_isDoubled[t] )
			{
				m_votes[m_sets.find( t )] += others > 0 && others % 2 == 0 ? 1 : -1;
			}
		}
	}

	const std::vector<std::uint8_t>& m_isDoubled;
	UnionFind m_sets;
	std::vector<int> m_votes;
};

bool haveSameVertices( const Triangle& a, const Triangle& b )
{
	return a[0] == b[0] && std::min( a[1], a[2] ) == std::min( b[1], b[2] ) && std::max( a[1], a[2] ) == std::max( b[1], b[2] );
}

} // namespace

void cleanTriangles( WeldedMesh& mesh, BuildReport& report )
{
	const std::size_t before = mesh.triangle.size();
	std::vector<Triangle> triangles;
	triangles.reserve( before );
	for ( const Triangle& t : mesh.triangle )
	{
		if ( t[0] != t[1] && t[1] != t[2] && t[2] != t[0] )
		{
			triangles.push_back( withLowestFirst( t ) );
		}
		else if ( t[0] != t[1] || t[1] != t[2] )
		{
			mesh.leftOut.push_back( t );
		}
	}
	sortTriangles( triangles, mesh.position.size() );

	std::vector<std::uint8_t> isDoubled;
	bool anyDoubled = false;
	mesh.triangle.clear();
	for ( std::size_t first = 0, last = 0; first < triangles.size(); first = last )
	{
		int forward = 0;
		while ( last < triangles.size() && haveSameVertices( triangles[first], triangles[last] ) )
		{
			forward += isForward( triangles[last++] ) ? 1 : -1;
		}
		// The majority of the duplicates decides the orientation; a tie is broken by vertex order. Forward triangles come first.
		const bool areMixed = std::size_t( std::abs( forward ) ) != last - first;
		mesh.triangle.push_back( forward >= 0 ? triangles[first] : triangles[last - 1] );
		isDoubled.push_back( areMixed && forward == 0 );
		anyDoubled = anyDoubled || isDoubled.back();
	}
	if ( anyDoubled )
	{
		DoubledWalls walls( mesh.triangle, isDoubled, mesh.position.size() );
		std::size_t kept = 0;
		for ( std::size_t t = 0; t < mesh.triangle.size(); ++t )
		{
			if ( !walls.isWall( std::uint32_t( t ) ) )
			{
				mesh.triangle[kept++] = mesh.triangle[t];
			}
			else
			{
				mesh.leftOut.push_back( mesh.triangle[t] );
			}
		}
		mesh.triangle.resize( kept );
	}
	report.droppedTriangles = int( before - mesh.triangle.size() );
}

} // namespace pliant
