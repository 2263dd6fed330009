// Orients triangles consistently, first with their neighbours, then outwards. A shell that is inside out is flipped together with the
// shells inside it: a nested shell keeps its orientation relative to its container, so that an oppositely oriented one stays a cavity and
// an equally oriented one stays part of the union.

#include "lattice/mesh/weld.h"

#include "lattice/constants.h"
#include "lattice/mesh/winding_number.h"
#include "lattice/union_find.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <span>

namespace pliant {

namespace {

/// Triangles connected through edges with exactly two triangles: the orientation of one determines that of all. A soup has as many patches
/// as triangles, so the struct is kept small.
struct Patch
{
	std::uint32_t first = 0; ///< of its triangles in Patches::triangle
	std::uint32_t last = 0;
	bool isNearlyClosed = false;
	double volume = 0.0; ///< signed; about the patch's own centroid, so that a few holes have little effect
};

struct Patches
{
	std::vector<Patch> patch;
	std::vector<std::uint32_t> triangle; ///< patch by patch

	std::span<const std::uint32_t> of( const Patch& p ) const { return { triangle.data() + p.first, triangle.data() + p.last }; }
};

Vec3d areaVector( const WeldedMesh& mesh, const Triangle& t )
{
	return 0.5 * ( mesh.position[t[1]] - mesh.position[t[0]] ).cross( mesh.position[t[2]] - mesh.position[t[0]] );
}

void flip( Triangle& t )
{
	std::swap( t[1], t[2] );
}

constexpr std::uint32_t kNone = ~0u;

struct Neighbour
{
	std::uint32_t triangle = kNone;
	bool agrees = true;
};

using Neighbours = std::vector<std::array<Neighbour, 3>>;

Neighbours findNeighbours( const EdgeTable& edges, std::size_t triangles )
{
	Neighbours neighbours( triangles );
	const auto add = [&]( std::uint32_t t, Neighbour other ) {
		auto& row = neighbours[t];
		*std::find_if( row.begin(), row.end(), []( const Neighbour& n ) { return n.triangle == kNone; } ) = other;
	};
	for ( std::size_t e = 0; e < edges.edgeCount(); ++e )
	{
		if ( edges.start[e + 1] - edges.start[e] == 2 )
		{
			const EdgeTable::Entry& a = edges.entry[edges.start[e]];
			const EdgeTable::Entry& b = edges.entry[edges.start[e] + 1];
			add( a.triangle, { b.triangle, a.isForward != b.isForward } );
			add( b.triangle, { a.triangle, a.isForward != b.isForward } );
		}
	}
	return neighbours;
}

/// Traverses each patch from its first triangle and makes neighbours agree; the orientation with the larger area is kept.
Patches collectPatches( WeldedMesh& mesh, const EdgeTable& edges )
{
	const Neighbours neighbours = findNeighbours( edges, mesh.triangle.size() );
	Patches patches;
	patches.triangle.reserve( mesh.triangle.size() );
	std::vector<std::uint8_t> isReached( mesh.triangle.size(), 0 );
	std::vector<std::uint8_t> isFlipped( mesh.triangle.size(), 0 );
	for ( std::uint32_t seed = 0; seed < mesh.triangle.size(); ++seed )
	{
		if ( isReached[seed] )
		{
			continue;
		}
		Patch patch;
		patch.first = std::uint32_t( patches.triangle.size() );
		patches.triangle.push_back( seed );
		isReached[seed] = 1;
		double flippedArea = 0.0; // minus the area that keeps its orientation
		for ( std::size_t k = patch.first; k < patches.triangle.size(); ++k )
		{
			const std::uint32_t t = patches.triangle[k];
			flippedArea += ( isFlipped[t] ? 1.0 : -1.0 ) * areaVector( mesh, mesh.triangle[t] ).norm();
			for ( const Neighbour& next : neighbours[t] )
			{
				if ( next.triangle != kNone && !isReached[next.triangle] )
				{
					isReached[next.triangle] = 1;
					isFlipped[next.triangle] = isFlipped[t] ^ std::uint8_t( next.agrees ? 0 : 1 );
					patches.triangle.push_back( next.triangle );
				}
			}
		}
		patch.last = std::uint32_t( patches.triangle.size() );
		for ( const std::uint32_t t : patches.of( patch ) )
		{
			if ( ( isFlipped[t] != 0 ) == ( flippedArea <= 0.0 ) )
			{
				flip( mesh.triangle[t] );
			}
		}
		patches.patch.push_back( patch );
	}
	return patches;
}

void measurePatch( const WeldedMesh& mesh, const Patches& patches, Patch& patch )
{
	double area = 0.0;
	Vec3d vectorArea = Vec3d::Zero();
	Vec3d middle = Vec3d::Zero();
	for ( const std::uint32_t t : patches.of( patch ) )
	{
		const Vec3d a = areaVector( mesh, mesh.triangle[t] );
		area += a.norm();
		vectorArea += a;
		for ( const std::uint32_t v : mesh.triangle[t] )
		{
			middle += a.norm() / 3.0 * mesh.position[v];
		}
	}
	if ( area == 0.0 )
	{
		return;
	}
	middle /= area;
	for ( const std::uint32_t t : patches.of( patch ) )
	{
		// V = 1/3 sum over triangles of A . ( p - middle )
		patch.volume += areaVector( mesh, mesh.triangle[t] ).dot( mesh.position[mesh.triangle[t][0]] - middle ) / 3.0;
	}
	patch.isNearlyClosed = vectorArea.norm() < kNearlyClosed * area;
}

/// Determines which shells contain which, for meshes whose shells differ in orientation.
class Nesting
{
public:
	Nesting( const WeldedMesh& mesh, const Patches& patches ) : m_mesh( mesh ), m_patches( patches )
	{
		for ( std::uint32_t i = 0; i < patches.patch.size(); ++i )
		{
			if ( patches.patch[i].isNearlyClosed && patches.patch[i].volume != 0.0 )
			{
				m_containers.push_back( i );
			}
		}
		std::sort( m_containers.begin(), m_containers.end(), [&]( std::uint32_t a, std::uint32_t b ) {
			const double va = std::abs( patches.patch[a].volume );
			const double vb = std::abs( patches.patch[b].volume );
			return va != vb ? va > vb : a < b;
		} );
		m_containers.resize( std::min( m_containers.size(), kMaxContainers ) );
		m_trees.resize( m_containers.size() );
	}

	/// Returns the outermost shell around a patch: the largest that contains it, or the patch itself.
	std::uint32_t outermost( std::uint32_t patch )
	{
		for ( std::size_t k = 0; k < m_containers.size() && m_containers[k] != patch; ++k )
		{
			if ( holds( k, m_patches.patch[patch] ) )
			{
				return m_containers[k];
			}
		}
		return patch;
	}

private:
	bool holds( std::size_t k, const Patch& inner )
	{
		if ( !m_trees[k] )
		{
			std::vector<Triangle> triangles;
			for ( const std::uint32_t t : m_patches.of( m_patches.patch[m_containers[k]] ) )
			{
				triangles.push_back( m_mesh.triangle[t] );
			}
			m_trees[k] = std::make_unique<WindingTree>( m_mesh.position, std::move( triangles ) );
		}
		const std::span<const std::uint32_t> probed = m_patches.of( inner );
		const std::size_t step = std::max<std::size_t>( 1, probed.size() / kContainmentProbes );
		for ( std::size_t i = 0; i < probed.size(); i += step )
		{
			const Triangle& t = m_mesh.triangle[probed[i]];
			const Vec3d probe = ( m_mesh.position[t[0]] + m_mesh.position[t[1]] + m_mesh.position[t[2]] ) / 3.0;
			if ( std::abs( m_trees[k]->at( probe ) ) < kInsideWinding )
			{
				return false;
			}
		}
		return true;
	}

	const WeldedMesh& m_mesh;
	const Patches& m_patches;
	std::vector<std::uint32_t> m_containers;
	std::vector<std::unique_ptr<WindingTree>> m_trees;
};

void flipInsideOut( WeldedMesh& mesh, const Patches& patches )
{
	bool anyPositive = false;
	bool anyNegative = false;
	for ( const Patch& patch : patches.patch )
	{
		anyPositive = anyPositive || ( patch.isNearlyClosed && patch.volume > 0.0 );
		anyNegative = anyNegative || ( patch.isNearlyClosed && patch.volume < 0.0 );
	}
	if ( !anyNegative )
	{
		return;
	}
	Nesting nesting( mesh, patches );
	std::vector<std::uint32_t> outermost( patches.patch.size() );
	for ( std::uint32_t i = 0; i < patches.patch.size(); ++i )
	{
		outermost[i] = anyPositive && patches.patch[i].isNearlyClosed ? nesting.outermost( i ) : i;
	}
	for ( std::size_t i = 0; i < patches.patch.size(); ++i )
	{
		if ( patches.patch[i].isNearlyClosed && patches.patch[outermost[i]].volume < 0.0 )
		{
			for ( const std::uint32_t t : patches.of( patches.patch[i] ) )
			{
				flip( mesh.triangle[t] );
			}
		}
	}
}

int countShells( const EdgeTable& edges, std::size_t triangles )
{
	UnionFind shells( triangles );
	for ( std::size_t e = 0; e < edges.edgeCount(); ++e )
	{
		for ( std::size_t k = edges.start[e] + 1; k < edges.start[e + 1]; ++k )
		{
			shells.join( edges.entry[edges.start[e]].triangle, edges.entry[k].triangle );
		}
	}
	int count = 0;
	for ( std::uint32_t t = 0; t < triangles; ++t )
	{
		count += shells.find( t ) == t;
	}
	return count;
}

} // namespace

std::vector<RimEdge> orientTriangles( WeldedMesh& mesh, BuildReport& report )
{
	const EdgeTable edges = makeEdgeTable( mesh.triangle, mesh.position.size() );
	const std::vector<Triangle> before = mesh.triangle;
	{
		Patches patches = collectPatches( mesh, edges );
		for ( Patch& patch : patches.patch )
		{
			measurePatch( mesh, patches, patch );
		}
		flipInsideOut( mesh, patches );
	}
	std::vector<std::uint8_t> isFlipped( mesh.triangle.size() );
	for ( std::size_t t = 0; t < mesh.triangle.size(); ++t )
	{
		isFlipped[t] = mesh.triangle[t] != before[t];
		report.flippedTriangles += isFlipped[t];
	}

	report.shells = countShells( edges, mesh.triangle.size() );
	std::vector<RimEdge> rim;
	for ( std::size_t e = 0; e < edges.edgeCount(); ++e )
	{
		int forward = 0;
		for ( std::size_t k = edges.start[e]; k < edges.start[e + 1]; ++k )
		{
			forward += edges.entry[k].isForward != ( isFlipped[edges.entry[k].triangle] != 0 ) ? 1 : -1;
		}
		const EdgeTable::Entry& edge = edges.entry[edges.start[e]];
		if ( forward != 0 )
		{
			rim.push_back( forward > 0 ? RimEdge{ edge.low, edge.high, forward } : RimEdge{ edge.high, edge.low, -forward } );
		}
		report.openEdges += edges.start[e + 1] - edges.start[e] == 1;
		report.nonManifoldEdges += edges.start[e + 1] - edges.start[e] > 2;
	}
	return rim;
}

} // namespace pliant
