// Panels that no crack divides are drawn as the input's triangles, and everything else as before.

#include "surface/cracked_sphere.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <set>

namespace pliant {
namespace {

using namespace test;

/// For any cuts on its sides: triangles that are not flat and are oriented like the panel, with each part of its border once.
TEST( Panels, ACutPanelIsDrawnBetweenItsCuts )
{
	const Vec3 corner[3] = { { 0, 0, 0 }, { 3, 0, 0 }, { 1, 2, 0 } };
	for ( int cuts = 0; cuts < 64; ++cuts )
	{
		std::vector<Vec3> place;
		std::vector<std::uint32_t> around;
		std::array<std::size_t, 3> cornerAt{};
		for ( std::size_t side = 0; side < 3; ++side )
		{
			cornerAt[side] = place.size();
			const int count = cuts >> ( 2 * side ) & 3;
			for ( int k = 0; k <= count; ++k )
			{
				around.push_back( std::uint32_t( 100 + place.size() ) );
				place.push_back( corner[side] + float( k ) / float( count + 1 ) * ( corner[( side + 1 ) % 3] - corner[side] ) );
			}
		}
		std::vector<std::array<std::uint32_t, 3>> triangles;
		drawPanel( around, cornerAt, triangles );
		EXPECT_EQ( triangles.size(), around.size() - 2 );
		float area = 0.0f;
		std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
		for ( const auto& t : triangles )
		{
			const auto at = [&]( std::size_t k ) { return place[t[k % 3] - 100]; };
			const float own = 0.5f * ( at( 1 ) - at( 0 ) ).cross( at( 2 ) - at( 0 ) ).z();
			EXPECT_GT( own, 0.01f );
			area += own;
			for ( std::size_t k = 0; k < 3; ++k )
			{
				++edges[{ t[k], t[( k + 1 ) % 3] }];
			}
		}
		EXPECT_NEAR( area, 3.0f, 1e-5f );
		for ( std::size_t k = 0; k < around.size(); ++k )
		{
			const std::uint32_t from = around[k], to = around[( k + 1 ) % around.size()];
			EXPECT_EQ( ( edges[{ from, to }] ), 1 );
			EXPECT_EQ( ( edges[{ to, from }] ), 0 );
		}
	}
}

/// Closed as sums of edges, with the mesh's volume, and far from cracks the input's own triangles.
void expectDrawnAsOne( const Cracked& cracked )
{
	const DrawnCracks& drawn = cracked.surface;
	std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
	std::map<std::uint32_t, std::vector<std::array<std::uint32_t, 3>>> drawnOf;
	const std::vector<TrianglePoints> places = welded( drawn );
	for ( std::size_t t = 0; t < places.size(); ++t )
	{
		for ( std::size_t k = 0; k < 3; ++k )
		{
			++edges[{ places[t][k], places[t][( k + 1 ) % 3] }];
		}
		if ( drawn.sources()[t] != CellComplex::kNone )
		{
			const TrianglePoints& v = drawn.triangles()[t];
			drawnOf[drawn.sources()[t]].push_back( { drawn.kindOf( v[0] ), drawn.kindOf( v[1] ), drawn.kindOf( v[2] ) } );
		}
	}
	EXPECT_NEAR( volumeOf( drawn ) / meshVolume( cracked.it.mesh ), 1.0, 1e-5 );
	const bool isClosed = std::all_of( edges.begin(), edges.end(), [&edges]( const auto& e ) {
		const auto back = edges.find( { e.first.second, e.first.first } );
		return back != edges.end() && back->second == e.second;
	} );
	EXPECT_TRUE( isClosed );
	const std::uint32_t* const indices = cracked.it.mesh.indices.data();
	int whole = 0, cut = 0;
	for ( std::uint32_t t = 0; t < std::uint32_t( cracked.it.mesh.triangleCount() ); ++t )
	{
		std::array<std::uint32_t, 3> input = { indices[3 * t], indices[3 * t + 1], indices[3 * t + 2] };
		const auto isFar = [&](
							   std::uint32_t v ) { return cracked.distanceToCrack( cracked.it.rest( int( v ) ) ) > 2.0f * float( kCell ); };
		if ( std::all_of( input.begin(), input.end(), isFar ) )
		{
			if ( drawnOf[t].size() != 1 )
			{
				++cut;
				continue;
			}
			std::array<std::uint32_t, 3> own = drawnOf[t][0];
			std::rotate( own.begin(), std::min_element( own.begin(), own.end() ), own.end() );
			std::rotate( input.begin(), std::min_element( input.begin(), input.end() ), input.end() );
			EXPECT_EQ( own, input );
			++whole;
		}
	}
	EXPECT_GT( whole, 500 );
	EXPECT_LE( cut, whole / 100 ); // around the few triangles that are cut but are not panels
}

TEST( Panels, FarFromACrackTheInputsOwnTrianglesAreDrawn )
{
	Cracked cracked;
	cracked.crack( 0.3f );
	expectDrawnAsOne( cracked );
	const auto plain = std::make_shared<CellComplex>( *cracked.it.complex );
	plain->panels = {};
	const DrawnCracks cut( plain );
	EXPECT_LT( 3 * cracked.surface.vertexCount(), cracked.withCuts.vertexCount() ); // most vertices were those of cuts
	EXPECT_LT( 5 * cracked.surface.triangles().size(), 2 * cut.triangles().size() );
}

/// Vertices at one position with different texture coordinates.
TEST( Panels, DrawnAsOneSeamsStayClosed )
{
	Cracked cracked( 24, kCell, true );
	cracked.crack( 0.3f );
	expectDrawnAsOne( cracked );
}

/// A face that breaks within the body may separate nothing where it ends: its cuts are drawn nevertheless, since its sides are.
TEST( Panels, WhereBrokenFacesPassCutsAreDrawn )
{
	Cracked cracked;
	const CellComplex& complex = *cracked.it.complex;
	const auto isCut = [&complex]( std::uint32_t point ) { return complex.panels.isSpared[point] != 0; };
	std::mt19937 random( 3 );
	int passed = 0;
	for ( int round = 0; round < 20; ++round )
	{
		std::vector<std::uint32_t> faces;
		for ( int k = 0; k < ( round == 0 ? 1 : 20 ); ++k )
		{
			faces.push_back( std::uint32_t( random() % complex.face.size() ) );
		}
		cracked.breakFaces( faces ); // only cuts at which no broken face passes are spared
		if ( round == 0 )
		{
			expectDrawnAsOne( cracked );
		}
		const std::vector<std::uint32_t>& drawn = cracked.surface.binding().point;
		const std::set<std::uint32_t> there( drawn.begin(), drawn.end() );
		for ( const std::uint32_t face : faces )
		{
			for ( const std::uint32_t* p = complex.pointsOfFace.begin( face ); p != complex.pointsOfFace.end( face ); ++p )
			{
				EXPECT_EQ( there.count( *p ), 1u );
				passed += isCut( *p ) ? 1 : 0;
			}
		}
	}
	EXPECT_GT( passed, 100 );
}

/// Spared cuts move nothing: everything else keeps its position and its shading, to the bit.
TEST( Panels, DrawnAsOneTheRestIsAsItWas )
{
	Cracked cracked;
	cracked.crack( 0.3f );
	cracked.bend( 0.5f );
	cracked.skinAs( cracked.withCuts );
	const std::vector<float> positions = cracked.positions, normals = cracked.normals;
	cracked.skinAs( cracked.surface );
	std::vector<std::uint8_t> isThere( cracked.it.complex->pointCount(), 0 );
	for ( const std::uint32_t point : cracked.surface.binding().point )
	{
		isThere[point] = 1;
	}
	std::uint32_t k = 0; // both have the same vertices in the same order, apart from spared ones
	for ( std::uint32_t v = 0; v < cracked.withCuts.vertexCount(); ++v )
	{
		if ( isThere[cracked.withCuts.binding().point[v]] != 0 )
		{
			ASSERT_EQ( cracked.surface.kindOf( k ), cracked.withCuts.kindOf( v ) );
			EXPECT_EQ( Vec3( Eigen::Map<const Vec3>( &positions[3 * std::size_t( v )] ) ), cracked.position( k ) );
			EXPECT_EQ( Vec3( Eigen::Map<const Vec3>( &normals[3 * std::size_t( v )] ) ), cracked.normal( k ) );
			++k;
		}
	}
	EXPECT_EQ( k, cracked.surface.vertexCount() );
}

} // namespace
} // namespace pliant
