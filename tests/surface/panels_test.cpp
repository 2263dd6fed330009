// Parts that no crack separates look as before the first crack: cuts are interpolated from the corners of the input's triangles.

#include "surface/cracked_sphere.h"

#include "threads/parallel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace pliant {
namespace {

using namespace test;

TEST( Panels, CutsStandWhereTheirCornersPutThem )
{
	Cracked cracked;
	cracked.crack( 0.3f );
	cracked.bend( 0.5f );
	cracked.skinAs( cracked.withCuts );
	const SkinBinding& b = cracked.withCuts.binding();
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
	for ( std::uint32_t v = 0; v < cracked.withCuts.vertexCount(); ++v )
	{
		EXPECT_EQ( cracked.position( v ), cracked.position( b.carrier[v] ) );
		EXPECT_NEAR( cracked.normal( v ).norm(), 1.0f, 1e-5f );
	}
}

/// Along a crack each side follows its own cells: no cut there is interpolated.
TEST( Panels, WhatACrackPartsIsBlended )
{
	Cracked cracked;
	const std::size_t before = cracked.withCuts.binding().placed.size();
	cracked.crack( 0.3f );
	const SkinBinding& b = cracked.withCuts.binding();
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
		const auto [known, isNew] = firstSide.emplace( b.point[v], cracked.withCuts.sideOf( v ).second );
		if ( !isNew && known->second != cracked.withCuts.sideOf( v ).second )
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
	cracked.skinAs( cracked.withCuts );
	const SkinBinding& b = cracked.withCuts.binding();
	int outer = 0, wrong = 0;
	for ( std::size_t t = 0; t < cracked.withCuts.triangles().size(); ++t )
	{
		for ( const std::uint32_t v : cracked.withCuts.triangles()[t] )
		{
			const bool isOuter = cracked.withCuts.sources()[t] != CellComplex::kNone;
			outer += isOuter ? 1 : 0;
			wrong += isOuter && ( cracked.normal( v ) - turn * b.restNormal[v] ).norm() > 1e-3f ? 1 : 0;
		}
	}
	EXPECT_GT( outer, 10000 );
	EXPECT_LE( wrong, outer / 5000 ); // slivers, whose normals are rounding, as in CutsDoNotShowOnTheOuterSurface
	// Where everything around is unbroken there is nothing to shift.
	int shifted = 0, there = 0;
	const std::vector<std::uint32_t> drawn = cracked.withCuts.vertexOfKind();
	for ( std::uint32_t v = 0; v < cracked.it.complex->inputVertices; ++v )
	{
		if ( cracked.distanceToCrack( b.restPosition[drawn[v]] ) > 2.0f * float( kCell ) )
		{
			shifted += b.normalShiftOf( drawn[v] ).isZero( 0.0f ) ? 0 : 1;
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
	cracked.skinAs( cracked.withCuts );
	int there = 0;
	const std::vector<std::uint32_t> drawn = cracked.withCuts.vertexOfKind();
	for ( int v = 0; v < cracked.it.vertexCount(); ++v )
	{
		if ( cracked.distanceToCrack( cracked.it.rest( v ) ) > 2.0f * float( kCell ) )
		{
			EXPECT_EQ( cracked.position( drawn[std::size_t( v )] ), cracked.it.position( v ) );
			EXPECT_LT( ( cracked.normal( drawn[std::size_t( v )] ) - cracked.it.normal( v ) ).norm(), 1e-5f );
			++there;
		}
	}
	EXPECT_GT( there, 500 );
}

/// Without panels every vertex follows its row.
TEST( Panels, BlendedOrPlacedTheSurfaceHardlyDiffers )
{
	Cracked cracked;
	const auto plain = std::make_shared<CellComplex>( *cracked.it.complex );
	plain->panels = {};
	DrawnCracks twin( plain );
	std::vector<std::uint32_t> faces;
	cracked.crack( 0.3f );
	for ( std::uint32_t f = 0; f < std::uint32_t( plain->face.size() ); ++f )
	{
		cracked.surface.isBroken( f ) ? faces.push_back( f ) : void();
	}
	twin.breakFaces( faces );
	expectValid( twin );
	EXPECT_TRUE( twin.binding().placed.empty() );
	ASSERT_EQ( twin.vertexCount(), cracked.withCuts.vertexCount() ); // in the same order: only triangles differ
	EXPECT_EQ( twin.binding().point, cracked.withCuts.binding().point );
	EXPECT_EQ( twin.binding().weight, cracked.withCuts.binding().weight );
	cracked.bend( 0.3f );
	cracked.skinAs( twin );
	const std::vector<float> positions = cracked.positions, normals = cracked.normals;
	cracked.skinAs( cracked.withCuts );
	float farthest = 0.0f, mostTurned = 0.0f;
	for ( std::uint32_t v = 0; v < twin.vertexCount(); ++v )
	{
		farthest = std::max( farthest, ( cracked.position( v ) - Eigen::Map<const Vec3>( &positions[3 * std::size_t( v )] ) ).norm() );
		mostTurned = std::max( mostTurned, ( cracked.normal( v ) - Eigen::Map<const Vec3>( &normals[3 * std::size_t( v )] ) ).norm() );
	}
	EXPECT_LT( farthest, 0.03f * float( kCell ) ); // the bulge of an edge of 1.3 cells: bend x length^2 / 8
	EXPECT_GT( farthest, 0.0f );
	EXPECT_LT( mostTurned, 0.05f );
}

TEST( Panels, SeveralThreadsPlaceAsOneDoes )
{
	Cracked cracked( 48, kCell / 2 );
	cracked.crack( 0.3f );
	cracked.bend( 0.5f );
	ASSERT_GT( cracked.withCuts.binding().placed.size(), 2048u ); // more than one task's part
	cracked.skinAs( cracked.withCuts );
	const std::vector<float> positions = cracked.positions, normals = cracked.normals;
	const std::unique_ptr<TaskRunner> runner = createThreadPool( 3 );
	cracked.skinAs( cracked.withCuts, runner.get() );
	EXPECT_EQ( cracked.positions, positions );
	EXPECT_EQ( cracked.normals, normals );
}

/// Seams of texture coordinates: copies at one position have different corners, at one position too.
TEST( Panels, SeamsStayClosed )
{
	CrackCase it( unwelded( makeSphere( 1.0, 24, 36 ) ), kCell, noisy() );
	DrawnCracks surface( withAllCuts( it.complex ) );
	surface.breakFaces( { 0 } );
	EXPECT_GT( surface.binding().placed.size(), 1000u );
	it.deform( []( const Vec3& x ) { return bent( x, 0.5f ); }, []( const Vec3& x ) { return turnOfBend( x, 0.5f ); } );
	std::vector<float> positions( 3 * std::size_t( surface.vertexCount() ) ), normals( positions );
	const SkinTriangles triangles{ surface.triangles()[0].data(), int( surface.triangles().size() ) };
	skin( surface.binding(), it.nodes, SkinPose{ .rotations = it.rotations.data() }, triangles, it.scratch, positions.data(),
		normals.data() );
	int copies = 0;
	for ( const SkinBinding::Placed& of : surface.binding().placed )
	{
		const std::uint32_t carrier = surface.binding().carrier[of.vertex];
		const auto at = [of = of.vertex, carrier]( const std::vector<float>& list ) {
			return std::pair( Vec3( Eigen::Map<const Vec3>( &list[3 * std::size_t( of )] ) ),
				Vec3( Eigen::Map<const Vec3>( &list[3 * std::size_t( carrier )] ) ) );
		};
		const auto [place, carriers] = at( positions );
		const auto [normal, carriersNormal] = at( normals );
		EXPECT_EQ( place, carriers );
		EXPECT_LT( ( normal - carriersNormal ).norm(), 1e-3f ); // shares are measured in either triangle
		copies += of.vertex != carrier ? 1 : 0;
	}
	EXPECT_GT( copies, 100 );
}

/// The loops of each instruction set, in scratch memory with the numbers of another surface. Where triangles are crushed to a point there
/// is no area for normals.
TEST( Panels, AreSkinnedToTheSameBitsByAnyKernels )
{
	CrackCase it( unwelded( makeSphere( 1.0, 24, 36 ) ), kCell, noisy() );
	DrawnCracks surface( withAllCuts( it.complex ) );
	surface.breakFaces( { 0, 40, 41, 42 } );
	const SkinBinding& binding = surface.binding();
	ASSERT_FALSE( binding.placed.empty() || binding.carrier.empty() || binding.normalShift.empty() || binding.shading.empty() );
	it.deform( []( const Vec3& x ) { return x.x() > 0.6f ? Vec3( 0.6f, 0.0f, 0.0f ) : bent( x, 0.5f ); },
		[]( const Vec3& x ) { return turnOfBend( x, 0.5f ); } );
	const SkinTriangles triangles{ surface.triangles()[0].data(), int( surface.triangles().size() ) };
	SkinPose pose;
	pose.rotations = it.rotations.data();
	const auto skinned = [&]( SkinScratch& scratch, const SkinKernels& kernels ) {
		std::vector<float> both( 6 * std::size_t( surface.vertexCount() ), 1e9f );
		skin( binding, it.nodes, pose, triangles, scratch, both.data(), both.data() + both.size() / 2, nullptr, kernels );
		return both;
	};
	SkinScratch own, others;
	for ( AlignedArray<float>* scratch : { &others.position, &others.turnedShift, &others.groupNormal } )
	{
		scratch->assign( 8 * std::size_t( surface.vertexCount() ), std::numeric_limits<float>::quiet_NaN() );
	}
	const std::vector<float> plain = skinned( own, plainSkinKernels() );
	EXPECT_TRUE( std::all_of( plain.begin(), plain.end(), []( float x ) { return std::abs( x ) < 2.0f; } ) );
	EXPECT_EQ( skinned( others, bestSkinKernels() ), plain );
	EXPECT_STREQ( plainSkinKernels().name, "baseline" );
}

/// Triangles larger than the cells bend with them.
TEST( Panels, LargeTrianglesAreNone )
{
	const CrackCase large( makeBox( { 0, 0, 0 }, { 1, 1, 1 }, 2 ), kCell, noisy() ),
		small( makeBox( { 0, 0, 0 }, { 1, 1, 1 }, 6 ), kCell, noisy() );
	EXPECT_EQ( large.complex->panels.count(), 0u );
	EXPECT_GT( small.complex->panels.count(), 100u );
	const DrawnCracks bending( large.complex ), placing( withAllCuts( small.complex ) );
	EXPECT_TRUE( bending.binding().placed.empty() && bending.binding().blended.empty() && bending.binding().shading.empty() );
	EXPECT_FALSE( placing.binding().placed.empty() );
}

} // namespace
} // namespace pliant
