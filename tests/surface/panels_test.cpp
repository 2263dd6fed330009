// What no crack parts looks as it did before there were any: cuts stand where the corners of the input's triangles put them.

#include "surface/crack_pieces.h"

#include "surface/crack_view.h"
#include "threads/parallel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace pliant {
namespace {

using namespace test;

constexpr double kCell = 0.2;

/// A bend about z by `angle` over a length of 1, and the rotation there.
Vec3 bent( const Vec3& x, float angle )
{
	const float a = angle * x.x();
	return Vec3( std::sin( a ) / angle - x.y() * std::sin( a ), x.y() * std::cos( a ) + ( 1.0f - std::cos( a ) ) / angle, x.z() );
}

Eigen::Matrix3f turnOfBend( const Vec3& x, float angle )
{
	return Eigen::AngleAxisf( angle * x.x(), Vec3::UnitZ() ).toRotationMatrix();
}

/// A sphere of triangles about as large as its cells, and a crack at one place of it.
struct Cracked
{
	explicit Cracked( int rings = 24, double cell = kCell ) : it( makeSphere( 1.0, rings, rings * 3 / 2 ), cell, noisy() ), surface( it.complex )
	{
	}

	/// Breaks faces between cells beyond a height that stand on either side of the middle.
	void crack( float height )
	{
		std::vector<std::uint32_t> faces;
		for ( std::uint32_t f = 0; f < std::uint32_t( it.complex->face.size() ); ++f )
		{
			const Vec3 &a = it.lattice().restCentre[it.complex->face[f].cellA], &b = it.lattice().restCentre[it.complex->face[f].cellB];
			if ( std::min( a.z(), b.z() ) > height && ( a.x() < 0.0f ) != ( b.x() < 0.0f ) )
			{
				faces.push_back( f );
			}
		}
		EXPECT_FALSE( faces.empty() );
		surface.breakFaces( faces );
		surface.settle();
		expectValid( surface );
	}

	void bend( float angle )
	{
		it.deform( [=]( const Vec3& x ) { return bent( x, angle ); }, [=]( const Vec3& x ) { return turnOfBend( x, angle ); } );
	}

	void skinAs( const CrackSurface& shown, TaskRunner* runner = nullptr )
	{
		positions.assign( 3 * std::size_t( shown.vertexCount() ), 1e9f );
		normals = positions;
		const SkinTriangles triangles{ shown.triangles()[0].data(), int( shown.triangles().size() ) };
		skin( shown.binding(), it.nodes, it.rotations.data(), triangles, it.scratch, positions.data(), normals.data(), runner );
	}

	Vec3 position( std::uint32_t v ) const { return Eigen::Map<const Vec3>( &positions[3 * std::size_t( v )] ); }
	Vec3 normal( std::uint32_t v ) const { return Eigen::Map<const Vec3>( &normals[3 * std::size_t( v )] ); }

	/// Of the points where broken faces pass.
	float distanceToCrack( const Vec3& rest ) const
	{
		float least = 1e9f;
		for ( std::uint32_t f = 0; f < std::uint32_t( it.complex->face.size() ); ++f )
		{
			for ( const std::uint32_t* p = it.complex->pointsOfFace.begin( f ); surface.isBroken( f ) && p != it.complex->pointsOfFace.end( f ); ++p )
			{
				least = std::min( least, ( it.complex->pointRest[*p] - rest ).norm() );
			}
		}
		return least;
	}

	CrackCase it;
	CrackSurface surface;
	std::vector<float> positions, normals;
};

TEST( Panels, CutsStandWhereTheirCornersPutThem )
{
	Cracked cracked;
	cracked.crack( 0.3f );
	cracked.bend( 0.5f );
	cracked.skinAs( cracked.surface );
	const SkinBinding& b = cracked.surface.binding();
	EXPECT_GT( 10 * b.placed.size(), 7 * cracked.it.complex->addedOrigin.size() );
	for ( const SkinBinding::Placed& of : b.placed )
	{
		Vec3 place = Vec3::Zero(), rest = Vec3::Zero(), normal = Vec3::Zero();
		for ( std::size_t k = 0; k < 3; ++k )
		{
			place += of.weight[k] * cracked.position( of.corner[k] );
			rest += of.weight[k] * b.restPosition[of.corner[k]];
			normal += of.weight[k] * cracked.normal( of.corner[k] );
		}
		EXPECT_LT( ( cracked.position( of.vertex ) - place ).norm(), 1e-6f );
		EXPECT_LT( ( cracked.normal( of.vertex ) - normal.normalized() ).norm(), 1e-6f );
		EXPECT_LT( ( b.restPosition[of.vertex] - rest ).norm(), 1e-3f * float( kCell ) ); // points that are nearer than 1e-4 are one
	}
	for ( std::uint32_t v = 0; v < cracked.surface.vertexCount(); ++v )
	{
		EXPECT_EQ( cracked.position( v ), cracked.position( b.carrier[v] ) );
		EXPECT_NEAR( cracked.normal( v ).norm(), 1.0f, 1e-5f );
	}
}

/// Along a crack each side goes with its own cells: nothing there is placed.
TEST( Panels, WhatACrackPartsIsBlended )
{
	Cracked cracked;
	const std::size_t before = cracked.surface.binding().placed.size();
	cracked.crack( 0.3f );
	const SkinBinding& b = cracked.surface.binding();
	EXPECT_LT( b.placed.size(), before );
	EXPECT_EQ( b.placed.size() + b.blended.size(), b.restPosition.size() );
	std::vector<std::uint8_t> isPlaced( b.restPosition.size(), 0 );
	for ( const SkinBinding::Placed& of : b.placed )
	{
		isPlaced[of.vertex] = 1;
	}
	std::map<std::uint32_t, std::uint32_t> firstSide;
	int parted = 0;
	for ( std::uint32_t v = 0; v < std::uint32_t( b.point.size() ); ++v )
	{
		const auto [known, isNew] = firstSide.emplace( b.point[v], cracked.surface.sideOf( v ).second );
		if ( !isNew && known->second != cracked.surface.sideOf( v ).second )
		{
			EXPECT_EQ( isPlaced[v], 0 );
			++parted;
		}
	}
	EXPECT_GT( parted, 20 );
}

TEST( Panels, AtRestNormalsAreTheWholeMeshs )
{
	Cracked cracked;
	cracked.crack( 0.3f );
	const Eigen::Matrix3f turn = Eigen::AngleAxisf( 1.1f, Vec3( 1, 2, 3 ).normalized() ).toRotationMatrix();
	cracked.it.affine( turn );
	cracked.skinAs( cracked.surface );
	const SkinBinding& b = cracked.surface.binding();
	int outer = 0, wrong = 0;
	for ( std::size_t t = 0; t < cracked.surface.triangles().size(); ++t )
	{
		for ( const std::uint32_t v : cracked.surface.triangles()[t] )
		{
			const bool isOuter = cracked.surface.sources()[t] != CrackSurface::kNone;
			outer += isOuter ? 1 : 0;
			wrong += isOuter && ( cracked.normal( v ) - turn * b.restNormal[v] ).norm() > 1e-3f ? 1 : 0;
		}
	}
	EXPECT_GT( outer, 10000 );
	EXPECT_LE( wrong, outer / 5000 ); // slivers, whose normals are rounding, as in CutsDoNotShowOnTheOuterSurface
	// Where everything around is whole there is nothing to shift.
	int shifted = 0, there = 0;
	for ( std::uint32_t v = 0; v < cracked.it.complex->inputVertices; ++v )
	{
		if ( cracked.distanceToCrack( b.restPosition[v] ) > 2.0f * float( kCell ) )
		{
			shifted += b.normalShift[v].isZero( 0.0f ) ? 0 : 1;
			++there;
		}
	}
	EXPECT_GT( there, 500 );
	EXPECT_EQ( shifted, 0 );
}

TEST( Panels, FarFromACrackABentBodyIsShadedAsBefore )
{
	Cracked cracked;
	cracked.crack( 0.3f );
	cracked.bend( 0.7f );
	cracked.it.skinIt();
	cracked.skinAs( cracked.surface );
	int there = 0;
	for ( int v = 0; v < cracked.it.vertexCount(); ++v )
	{
		if ( cracked.distanceToCrack( cracked.it.rest( v ) ) > 2.0f * float( kCell ) )
		{
			EXPECT_EQ( cracked.position( std::uint32_t( v ) ), cracked.it.position( v ) );
			EXPECT_LT( ( cracked.normal( std::uint32_t( v ) ) - cracked.it.normal( v ) ).norm(), 1e-5f );
			++there;
		}
	}
	EXPECT_GT( there, 500 );
}

/// The slow twin has no panels: every vertex follows its row.
TEST( Panels, BlendedOrPlacedTheSurfaceHardlyDiffers )
{
	Cracked cracked;
	const auto plain = std::make_shared<CellComplex>( *cracked.it.complex );
	plain->panels = {};
	CrackSurface twin( plain );
	std::vector<std::uint32_t> faces;
	cracked.crack( 0.3f );
	for ( std::uint32_t f = 0; f < std::uint32_t( plain->face.size() ); ++f )
	{
		cracked.surface.isBroken( f ) ? faces.push_back( f ) : void();
	}
	twin.breakFaces( faces );
	twin.settle();
	expectValid( twin );
	EXPECT_TRUE( twin.binding().placed.empty() );
	ASSERT_EQ( twin.triangles(), cracked.surface.triangles() );
	EXPECT_EQ( twin.binding().weight, cracked.surface.binding().weight );
	cracked.bend( 0.3f );
	cracked.skinAs( twin );
	const std::vector<float> positions = cracked.positions, normals = cracked.normals;
	cracked.skinAs( cracked.surface );
	float farthest = 0.0f, mostTurned = 0.0f;
	for ( std::uint32_t v = 0; v < twin.vertexCount(); ++v )
	{
		farthest = std::max( farthest, ( cracked.position( v ) - Eigen::Map<const Vec3>( &positions[3 * std::size_t( v )] ) ).norm() );
		mostTurned = std::max( mostTurned, ( cracked.normal( v ) - Eigen::Map<const Vec3>( &normals[3 * std::size_t( v )] ) ).norm() );
	}
	EXPECT_LT( farthest, 0.03f * float( kCell ) ); // what an edge of 1.3 cells bulges by: bend x length^2 / 8
	EXPECT_GT( farthest, 0.0f );
	EXPECT_LT( mostTurned, 0.05f );
}

TEST( Panels, SeveralThreadsPlaceAsOneDoes )
{
	Cracked cracked( 48, kCell / 2 );
	cracked.crack( 0.3f );
	cracked.bend( 0.5f );
	ASSERT_GT( cracked.surface.binding().placed.size(), 2048u ); // more than a task's share
	cracked.skinAs( cracked.surface );
	const std::vector<float> positions = cracked.positions, normals = cracked.normals;
	const std::unique_ptr<TaskRunner> runner = createThreadPool( 3 );
	cracked.skinAs( cracked.surface, runner.get() );
	EXPECT_EQ( cracked.positions, positions );
	EXPECT_EQ( cracked.normals, normals );
}

/// Seams of texture coordinates: copies at one place have corners of their own, at one place too.
TEST( Panels, SeamsStayClosed )
{
	CrackCase it( unwelded( makeSphere( 1.0, 24, 36 ) ), kCell, noisy() );
	CrackSurface surface( it.complex );
	surface.breakFaces( { 0 } );
	surface.settle();
	expectValid( surface );
	EXPECT_GT( surface.binding().placed.size(), 1000u );
	it.deform( []( const Vec3& x ) { return bent( x, 0.5f ); }, []( const Vec3& x ) { return turnOfBend( x, 0.5f ); } );
	std::vector<float> positions( 3 * std::size_t( surface.vertexCount() ) ), normals( positions );
	const SkinTriangles triangles{ surface.triangles()[0].data(), int( surface.triangles().size() ) };
	skin( surface.binding(), it.nodes, it.rotations.data(), triangles, it.scratch, positions.data(), normals.data() );
	int copies = 0;
	for ( const SkinBinding::Placed& of : surface.binding().placed )
	{
		const std::uint32_t carrier = surface.binding().carrier[of.vertex];
		const auto at = [of = of.vertex, carrier]( const std::vector<float>& list ) {
			return std::pair( Vec3( Eigen::Map<const Vec3>( &list[3 * std::size_t( of )] ) ), Vec3( Eigen::Map<const Vec3>( &list[3 * std::size_t( carrier )] ) ) );
		};
		const auto [place, carriers] = at( positions );
		const auto [normal, carriersNormal] = at( normals );
		EXPECT_EQ( place, carriers );
		EXPECT_LT( ( normal - carriersNormal ).norm(), 1e-3f ); // shares are measured in either triangle
		copies += of.vertex != carrier ? 1 : 0;
	}
	EXPECT_GT( copies, 100 );
}

/// What is larger than its cells bends with them.
TEST( Panels, LargeTrianglesAreNone )
{
	const CrackCase large( makeBox( { 0, 0, 0 }, { 1, 1, 1 }, 2 ), kCell, noisy() ), small( makeBox( { 0, 0, 0 }, { 1, 1, 1 }, 6 ), kCell, noisy() );
	EXPECT_EQ( large.complex->panels.count(), 0u );
	EXPECT_GT( small.complex->panels.count(), 100u );
	const CrackSurface bending( large.complex ), placing( small.complex );
	EXPECT_TRUE( bending.binding().placed.empty() && bending.binding().blended.empty() && bending.binding().shading.empty() );
	EXPECT_FALSE( placing.binding().placed.empty() );
}

// === Drawn as one ===

/// Whatever is cut on its sides: triangles that are not flat and turned as the panel is, each part of its border once.
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

/// What is drawn as one of a cracked surface, and which of the surface's vertices each of its is.
struct AsOne
{
	explicit AsOne( const CrackSurface& surface )
	{
		const std::vector<float> texture( 2 * std::size_t( surface.vertexCount() ) );
		surface.showPanelsAsOne( texture.data(), view );
		std::vector<std::uint8_t> isThere( surface.complex().pointCount(), 0 );
		for ( const std::uint32_t point : view.binding->point )
		{
			isThere[point] = 1;
		}
		for ( std::uint32_t v = 0; v < surface.vertexCount(); ++v )
		{
			isThere[surface.binding().point[v]] != 0 ? vertex.push_back( v ) : void();
		}
	}

	CrackView view;
	std::vector<std::uint32_t> vertex;
};

/// Closed as sums of edges, with the volume there was, and far from cracks the input's own triangles.
void expectDrawnAsOne( const Cracked& cracked, const AsOne& one )
{
	const SkinBinding& b = *one.view.binding;
	ASSERT_EQ( one.vertex.size(), b.restPosition.size() );
	std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
	std::map<std::uint32_t, std::vector<std::array<std::uint32_t, 3>>> drawnOf;
	std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> welded;
	double volume = 0.0;
	for ( int t = 0; t < one.view.triangleCount; ++t )
	{
		std::array<std::uint32_t, 3> place, own;
		for ( std::size_t k = 0; k < 3; ++k )
		{
			own[k] = one.vertex[one.view.triangles[t][k]];
			place[k] = welded.emplace( cracked.surface.sideOf( own[k] ), std::uint32_t( welded.size() ) ).first->second;
		}
		const auto at = [&]( std::size_t k ) { return Vec3d( b.restPosition[one.view.triangles[t][k]].cast<double>() ); };
		volume += signedVolume( at( 0 ), at( 1 ), at( 2 ) );
		for ( std::size_t k = 0; k < 3; ++k )
		{
			++edges[{ place[k], place[( k + 1 ) % 3] }];
		}
		if ( one.view.sources[t] != CrackSurface::kNone )
		{
			drawnOf[one.view.sources[t]].push_back( own );
		}
	}
	EXPECT_NEAR( volume, volumeOf( cracked.surface ), 1e-5 * volume );
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
		const auto isFar = [&]( std::uint32_t v ) { return cracked.distanceToCrack( cracked.it.rest( int( v ) ) ) > 2.0f * float( kCell ); };
		if ( std::all_of( input.begin(), input.end(), isFar ) )
		{
			if ( drawnOf[t].size() != 1 )
			{
				++cut;
				continue;
			}
			std::array<std::uint32_t, 3> drawn = drawnOf[t][0];
			std::rotate( drawn.begin(), std::min_element( drawn.begin(), drawn.end() ), drawn.end() );
			std::rotate( input.begin(), std::min_element( input.begin(), input.end() ), input.end() );
			EXPECT_EQ( drawn, input );
			++whole;
		}
	}
	EXPECT_GT( whole, 500 );
	EXPECT_LE( cut, whole / 100 ); // around the few triangles that are cut and no panels
}

TEST( Panels, FarFromACrackTheInputsOwnTrianglesAreDrawn )
{
	Cracked cracked;
	cracked.crack( 0.3f );
	const AsOne one( cracked.surface );
	expectDrawnAsOne( cracked, one );
	EXPECT_LT( 3 * one.vertex.size(), cracked.surface.vertexCount() ); // cuts were most of all
	EXPECT_LT( 5 * one.view.triangleCount, 2 * int( cracked.surface.triangles().size() ) );
}

/// One face that breaks within parts nothing: what passes there is drawn nevertheless, for its faces are.
TEST( Panels, WhereABrokenFacePassesCutsAreDrawn )
{
	Cracked cracked;
	std::uint32_t face = 0;
	const Panels& panels = cracked.it.complex->panels;
	const Table& points = cracked.it.complex->pointsOfFace;
	const auto isCut = [&panels]( std::uint32_t point ) { return panels.isSpared[point] != 0; };
	while ( std::count_if( points.begin( face ), points.end( face ), isCut ) < 3 )
	{
		++face;
	}
	cracked.surface.breakFaces( { face } );
	cracked.surface.settle();
	expectValid( cracked.surface );
	const AsOne one( cracked.surface );
	expectDrawnAsOne( cracked, one );
	const std::vector<std::uint32_t>& there = one.view.binding->point;
	for ( const std::uint32_t* p = points.begin( face ); p != points.end( face ); ++p )
	{
		EXPECT_NE( std::find( there.begin(), there.end(), *p ), there.end() );
	}
}

/// What is spared moves nothing: all else stands where it stood, and is shaded as it was, to the bit.
TEST( Panels, DrawnAsOneTheRestIsAsItWas )
{
	Cracked cracked;
	cracked.crack( 0.3f );
	cracked.bend( 0.5f );
	cracked.skinAs( cracked.surface );
	const AsOne one( cracked.surface );
	std::vector<float> positions( 3 * one.vertex.size() ), normals( positions );
	const SkinTriangles triangles{ one.view.triangles[0].data(), one.view.triangleCount };
	skin( *one.view.binding, cracked.it.nodes, cracked.it.rotations.data(), triangles, cracked.it.scratch, positions.data(), normals.data() );
	for ( std::size_t k = 0; k < one.vertex.size(); ++k )
	{
		EXPECT_EQ( Vec3( Eigen::Map<const Vec3>( &positions[3 * k] ) ), cracked.position( one.vertex[k] ) );
		EXPECT_EQ( Vec3( Eigen::Map<const Vec3>( &normals[3 * k] ) ), cracked.normal( one.vertex[k] ) );
	}
}

} // namespace
} // namespace pliant
