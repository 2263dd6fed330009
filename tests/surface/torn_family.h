#pragma once

// A family that is torn, and everything that its bodies draw.

#include "surface/crack_pieces.h"

#include "surface/crack_mesh/shared_crack_state.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <random>
#include <vector>

namespace pliant::test {

/// All data of a corner: position, normal, texture coordinates, its cells and their weights.
using Corner = std::vector<float>;
using Drawing = std::vector<std::vector<Corner>>;

inline Corner cornerOf( const SkinBinding& b, const float* texture, std::uint32_t v )
{
	Corner corner = { texture[2 * std::size_t( v )], texture[2 * std::size_t( v ) + 1] };
	for ( const Vec3& a : { b.restPosition[v], b.restNormal[v], b.normalShiftOf( v ) } )
	{
		corner.insert( corner.end(), a.data(), a.data() + 3 );
	}
	for ( std::uint32_t c = b.carrierOf( v ), k = b.start[c]; k < b.start[c + 1] && b.weight[k] != 0.0f; ++k )
	{
		corner.push_back( float( b.node[k] ) );
		corner.push_back( b.weight[k] );
	}
	const auto placed = std::lower_bound(
		b.placed.begin(), b.placed.end(), v, []( const SkinBinding::Placed& a, std::uint32_t wanted ) { return a.vertex < wanted; } );
	for ( std::size_t k = 0; placed != b.placed.end() && placed->vertex == v && k < 3; ++k )
	{
		corner.insert( corner.end(), { -1.0f, float( b.point[placed->corner[k]] ), placed->weight[k] } );
	}
	return corner;
}

/// The triangles that add to normals, by points: sums are the same to the bit only in the same order.
inline std::vector<Corner> shadingOf( const SkinBinding& b )
{
	std::vector<Corner> shading = { { float( b.shadedTriangles ), float( b.placed.size() ), float( b.blended.size() ) } };
	for ( const auto& [x, y, z] : b.shading )
	{
		shading.push_back( { float( b.point[x] ), float( b.point[y] ), float( b.point[z] ) } );
	}
	return shading;
}

/// Triangles in a canonical order, each beginning with its smallest corner.
inline Drawing drawingOf(
	const SkinBinding& b, const std::array<std::uint32_t, 3>* triangles, const std::uint32_t* sources, int count, const float* texture )
{
	Drawing drawing;
	for ( int t = 0; t < count; ++t )
	{
		std::vector<Corner> corners;
		for ( const std::uint32_t v : triangles[t] )
		{
			corners.push_back( cornerOf( b, texture, v ) );
		}
		std::rotate( corners.begin(), std::min_element( corners.begin(), corners.end() ), corners.end() );
		corners.push_back( { float( sources[t] ) } );
		drawing.push_back( corners );
	}
	std::sort( drawing.begin(), drawing.end() );
	drawing.push_back( shadingOf( b ) );
	return drawing;
}

inline Drawing drawingOf( const CrackView& view )
{
	return drawingOf( *view.binding, view.triangles, view.sources, view.triangleCount, view.texture );
}

enum class Cuts
{
	All,   ///< as for a body in one piece, whose drawing only grows by its cracks
	Needed ///< undivided panels as in the input
};

inline Drawing drawingOf( const CrackSurface& surface, const float* input, Cuts cuts )
{
	std::vector<float> texture( 2 * std::size_t( surface.vertexCount() ) );
	surface.textureCoordinates( input, 0, texture.data() );
	if ( cuts == Cuts::All )
	{
		return drawingOf(
			surface.binding(), surface.triangles().data(), surface.sources().data(), int( surface.triangles().size() ), texture.data() );
	}
	CrackView view;
	surface.showPanelsAsOne( texture.data(), view );
	return drawingOf( view );
}

struct Torn
{
	explicit Torn( const CrackCase& it ) : whole( it.complex ), lattice( it.lattice() )
	{
		for ( std::size_t v = 0; v < it.mesh.vertexCount(); ++v )
		{
			const float* p = &it.mesh.positions[3 * v];
			texture.insert( texture.end(), { 2.0f * p[0] + p[1], p[2] - 3.0f * p[1] } );
		}
		family = std::make_unique<SharedCrackState>( whole, CrackPatches::make( whole, texture.data() ), texture.data() );
	}

	/// A fraction of the remaining links, and those between pieces.
	void tear( double fraction, int pieces, unsigned seed )
	{
		std::mt19937 random( seed );
		std::vector<std::size_t> pieceOf( lattice.fill.size(), 0 );
		const auto parts = shatter( lattice, pieces, seed );
		for ( std::size_t k = 0; k < parts.size(); ++k )
		{
			for ( const std::uint32_t cell : parts[k] )
			{
				pieceOf[cell] = k;
			}
		}
		std::vector<CellLink> links;
		for ( std::uint32_t a = 0; a < std::uint32_t( lattice.cellCount() ); ++a )
		{
			for ( std::uint32_t k = lattice.linkStart[a]; k < lattice.linkStart[a + 1]; ++k )
			{
				const std::uint32_t b = lattice.linkTo[k];
				if ( a < b && ( pieceOf[a] != pieceOf[b] || random() < fraction * 4294967296.0 ) )
				{
					links.push_back( { a, b } );
				}
			}
		}
		lattice = withoutLinks( lattice, links );
		family->breakLinks( links );
		EXPECT_TRUE( family->hasNews() || links.empty() );
	}

	/// The expected drawing of a body of the family.
	Cuts cuts() const { return family->sides() ? Cuts::Needed : Cuts::All; }

	/// Whether the family draws in patches; validates its structures first.
	bool isInPatches() const
	{
		const Status status = family->whole() ? validate( *family->whole() ) : validate( *family->sides() );
		EXPECT_TRUE( status.ok() ) << status.sentence;
		return family->sides() != nullptr;
	}

	CrackSurface whole;
	Lattice lattice;
	std::vector<float> texture;
	std::unique_ptr<SharedCrackState> family;
};

} // namespace pliant::test
