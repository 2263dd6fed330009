// Cuts by planes, spheres and blades: exactly the links that cross them, at the present positions of the cells.

#include "fracture/cut_links.h"
#include "support/block_body.h"
#include "support/block_lattice.h"
#include "support/shapes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace pliant {
namespace {

/// Mesh coordinates to the present positions of the cells.
using Deformation = std::function<Vec3d( const Vec3d& )>;

std::vector<Vec3d> placed( const Lattice& lattice, const Deformation& by )
{
	std::vector<Vec3d> positions;
	for ( const Vec3& rest : lattice.restCentre )
	{
		positions.push_back( by( rest.cast<double>() ) );
	}
	return positions;
}

std::vector<CellLink> linksThat( const Lattice& lattice, const std::function<bool( std::uint32_t, std::uint32_t )>& isCut )
{
	std::vector<CellLink> links;
	for ( std::uint32_t i = 0; i < std::uint32_t( lattice.cellCount() ); ++i )
	{
		for ( std::uint32_t k = lattice.linkStart[i]; k < lattice.linkStart[i + 1]; ++k )
		{
			if ( i < lattice.linkTo[k] && isCut( i, lattice.linkTo[k] ) )
			{
				links.push_back( CellLink{ i, lattice.linkTo[k] } );
			}
		}
	}
	return links;
}

Vec3d wide( const Vec3& v )
{
	return v.cast<double>();
}

Eigen::Matrix3d someMap( test::Seeded& random, float stretch )
{
	const Eigen::Quaterniond turn = Eigen::Quaterniond(
		random.uniform( -1, 1 ), random.uniform( -1, 1 ), random.uniform( -1, 1 ), random.uniform( -1, 1 ) )
										.normalized();
	Eigen::Matrix3d map = turn.toRotationMatrix();
	for ( int k = 0; k < 9; ++k )
	{
		map( k % 3, k / 3 ) += random.uniform( -stretch, stretch );
	}
	return map;
}

TEST( CutLinks, APlaneCutsAllLinksBetweenItsSidesTurnedAndStretchedOrNot )
{
	for ( unsigned seed = 1; seed <= 30; ++seed )
	{
		test::Seeded random( seed );
		const Lattice blob = test::makeBlobLattice( 10, 0.1f, seed );
		const Vec3d normal = wide( random.inBox( 1.0f ) ), point = wide( random.inBox( 0.2f ) );
		// The plane moves with the material: affine maps preserve the side of each point.
		const Eigen::Matrix3d map = someMap( random, seed % 2 ? 0.3f : 0.0f );
		const Vec3d shift = wide( random.inBox( 5.0f ) );
		const double turned = map.determinant() > 0.0 ? 1.0 : -1.0;
		const PlaneCut cut{ map * point + shift, turned * map.inverse().transpose() * normal };
		const auto isAbove = [&]( std::uint32_t i ) { return normal.dot( blob.restCentre[i].cast<double>() - point ) >= 0.0; };
		const auto links = linksCut( blob, placed( blob, [&]( const Vec3d& x ) { return Vec3d( map * x + shift ); } ), cut );
		EXPECT_EQ( links, linksThat( blob, [&]( std::uint32_t a, std::uint32_t b ) { return isAbove( a ) != isAbove( b ); } ) ) << seed;
		EXPECT_FALSE( links.empty() );
	}
}

TEST( CutLinks, APlaneThroughTheMiddlesOfCellsPutsThemOnOneSide )
{
	const Lattice bar = makeBlockLattice( 7, 3, 3, 0.25f ); // every number is exact
	for ( const double way : { 1.0, -1.0 } )
	{
		const auto links = linksCut(
			bar, placed( bar, []( const Vec3d& x ) { return x; } ), PlaneCut{ Vec3d::Zero(), Vec3d( way, 0, 0 ) } );
		EXPECT_EQ( links.size(), 49u ); // one layer, and not two
		const auto parts = connectedParts( withoutLinks( bar, links ) );
		ASSERT_EQ( parts.size(), 2u );
		// The layer in the plane belongs to the side to which the normal points.
		const bool isFirst = way < 0.0;
		EXPECT_EQ( parts[0].size(), isFirst ? 36u : 27u );
	}
}

TEST( CutLinks, ADiscCutsNoFurtherThanItReaches )
{
	const Lattice bar = makeBlockLattice( 6, 6, 6, 0.1f );
	const auto positions = placed( bar, []( const Vec3d& x ) { return x; } );
	const PlaneCut disc{ Vec3d( 0, 0.02, -0.01 ), Vec3d( 1, 0, 0 ), 0.15 };
	const auto wanted = linksThat( bar, [&]( std::uint32_t a, std::uint32_t b ) {
		const Vec3d middle = 0.5 * ( positions[a] + positions[b] ); // of links across x = 0
		return ( positions[a].x() < 0.0 ) != ( positions[b].x() < 0.0 ) && ( middle - disc.point ).norm() <= 0.15;
	} );
	EXPECT_EQ( linksCut( bar, positions, disc ), wanted );
	EXPECT_GT( wanted.size(), 9u );
	EXPECT_LT( wanted.size(), 16u * 16u );
}

TEST( CutLinks, ASphereTakesOutWhatIsInIt )
{
	for ( unsigned seed = 1; seed <= 20; ++seed )
	{
		test::Seeded random( seed );
		const Lattice block = makeBlockLattice( 9, 9, 9, 0.1f );
		const Eigen::Matrix3d map = someMap( random, 0.2f );
		const auto positions = placed( block, [&]( const Vec3d& x ) { return Vec3d( map * x ); } );
		const SphereCut ball{ wide( random.inBox( 0.1f ) ), double( random.uniform( 0.15f, 0.3f ) ) };
		const auto isIn = [&]( std::uint32_t i ) { return ( positions[i] - ball.centre ).norm() < ball.radius; };
		const auto links = linksCut( block, positions, ball );
		// All links between inside and outside; others only if they enter and leave the sphere: their nearest point is inside.
		const auto wanted = linksThat( block, [&]( std::uint32_t a, std::uint32_t b ) {
			bool passes = isIn( a ) || isIn( b );
			for ( int k = 1; k < 2000 && !passes; ++k )
			{
				passes = ( positions[a] + double( k ) / 2000.0 * ( positions[b] - positions[a] ) - ball.centre ).norm() <
					ball.radius * ( 1.0 - 1e-6 );
			}
			return passes && !( isIn( a ) && isIn( b ) );
		} );
		EXPECT_EQ( links, wanted ) << seed;
		EXPECT_GE( connectedParts( withoutLinks( block, links ) ).size(), 2u );
	}
}

TEST( CutLinks, ABladeThatHasGoneThroughAllOfItCutsLikeItsPlane )
{
	for ( unsigned seed = 1; seed <= 20; ++seed )
	{
		test::Seeded random( seed );
		const Lattice blob = test::makeBlobLattice( 10, 0.1f, seed );
		const auto positions = placed( blob, []( const Vec3d& x ) { return x; } );
		const Vec3d normal = wide( random.inBox( 1.0f ) ).normalized(), edge = normal.unitOrthogonal(), way = normal.cross( edge );
		const Vec3d middle = wide( random.inBox( 0.1f ) );
		// In one sweep, and in forty: no link is missed where sweeps meet.
		for ( const int steps : { 1, 40 } )
		{
			std::vector<CellLink> links;
			for ( int k = 0; k < steps; ++k )
			{
				const Vec3d from = middle + way * ( -2.0 + 4.0 * k / steps ), to = middle + way * ( -2.0 + 4.0 * ( k + 1 ) / steps );
				const auto some = linksCut(
					blob, positions, BladeCut{ from - 2.0 * edge, from + 2.0 * edge, to - 2.0 * edge, to + 2.0 * edge } );
				links.insert( links.end(), some.begin(), some.end() );
			}
			std::sort( links.begin(), links.end() );
			links.erase( std::unique( links.begin(), links.end() ), links.end() );
			EXPECT_EQ( links, linksCut( blob, positions, PlaneCut{ middle, normal } ) ) << seed;
			EXPECT_FALSE( links.empty() );
		}
	}
}

/// Solves for the point where a link meets a triangle's plane.
bool meets( const Vec3d& a, const Vec3d& b, const Vec3d& u, const Vec3d& v, const Vec3d& w )
{
	Eigen::Matrix3d columns;
	columns << b - a, u - v, u - w;
	const Vec3d at = columns.inverse() * ( u - a );
	return at.x() >= 0.0 && at.x() <= 1.0 && at.y() >= 0.0 && at.z() >= 0.0 && at.y() + at.z() <= 1.0;
}

TEST( CutLinks, SmallBladesCutWhatMeetsTheirTriangles )
{
	int cut = 0;
	for ( unsigned seed = 1; seed <= 50; ++seed )
	{
		test::Seeded random( seed );
		const Lattice blob = test::makeBlobLattice( 10, 0.1f, seed );
		const Eigen::Matrix3d map = someMap( random, 0.3f );
		const auto positions = placed( blob, [&]( const Vec3d& x ) { return Vec3d( map * x ); } );
		const Vec3d p0 = wide( random.inBox( 0.4f ) ), p1 = wide( random.inBox( 0.4f ) ), q0 = wide( random.inBox( 0.4f ) ),
					q1 = wide( random.inBox( 0.4f ) );
		const auto wanted = linksThat( blob, [&]( std::uint32_t i, std::uint32_t j ) {
			return meets( positions[i], positions[j], p0, p1, q0 ) || meets( positions[i], positions[j], q0, p1, q1 );
		} );
		EXPECT_EQ( linksCut( blob, positions, BladeCut{ p0, p1, q0, q1 } ), wanted ) << seed;
		cut += int( wanted.size() );
	}
	EXPECT_GT( cut, 1000 );
}

TEST( CutLinks, LinksThroughTheLineTwoTrianglesFractionAreCut )
{
	const Lattice pair = makeBlockLattice( 1, 1, 2, 1.0f );
	const std::vector<Vec3d> positions = { Vec3d( 0, 0, -0.5 ), Vec3d( 0, 0, 0.5 ) };
	// The diagonal from p1 to q0 passes through the origin; then an edge, then a corner.
	EXPECT_EQ( linksCut( pair, positions, BladeCut{ { -1, -1, 0 }, { 1, -1, 0 }, { -1, 1, 0 }, { 1, 1, 0 } } ).size(), 1u );
	EXPECT_EQ( linksCut( pair, positions, BladeCut{ { -1, 0, 0 }, { 1, 0, 0 }, { -1, 1, 0 }, { 1, 1, 0 } } ).size(), 1u );
	EXPECT_EQ( linksCut( pair, positions, BladeCut{ { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 1, 1, 0 } } ).size(), 1u );
	// Past it, and ending before it.
	EXPECT_TRUE( linksCut( pair, positions, BladeCut{ { 0.1, -1, 0 }, { 1, -1, 0 }, { 0.1, 1, 0 }, { 1, 1, 0 } } ).empty() );
	EXPECT_TRUE( linksCut( pair, positions, BladeCut{ { -1, -1, 0.6 }, { 1, -1, 0.6 }, { -1, 1, 0.6 }, { 1, 1, 0.6 } } ).empty() );
}

TEST( CutLinks, WhatIsNoCutCutsNothing )
{
	const Lattice bar = makeBlockLattice( 4, 4, 4, 0.1f );
	const auto positions = placed( bar, []( const Vec3d& x ) { return x; } );
	const double nan = std::nan( "" ), inf = std::numeric_limits<double>::infinity();
	EXPECT_TRUE( linksCut( bar, positions, PlaneCut{ Vec3d::Zero(), Vec3d::Zero() } ).empty() );
	EXPECT_TRUE( linksCut( bar, positions, PlaneCut{ Vec3d( nan, 0, 0 ), Vec3d::UnitX() } ).empty() );
	EXPECT_TRUE( linksCut( bar, positions, PlaneCut{ Vec3d::Zero(), Vec3d( 0, inf, 0 ) } ).empty() );
	EXPECT_TRUE( linksCut( bar, positions, PlaneCut{ Vec3d::Zero(), Vec3d::UnitX(), nan } ).empty() );
	EXPECT_TRUE( linksCut( bar, positions, SphereCut{ Vec3d::Zero(), -0.15 } ).empty() );
	EXPECT_TRUE( linksCut( bar, positions, SphereCut{ Vec3d::Zero(), nan } ).empty() );
	EXPECT_TRUE( linksCut( bar, positions, BladeCut{ Vec3d( nan, 0, 0 ), Vec3d::UnitX(), Vec3d::UnitY(), Vec3d::Ones() } ).empty() );
	EXPECT_TRUE( linksCut( bar, positions, BladeCut{} ).empty() );
}

TEST( CutLinks, HealingIsTheInverseOfCutting )
{
	for ( unsigned seed = 1; seed <= 10; ++seed )
	{
		const Lattice blob = test::makeBlobLattice( 10, 0.1f, seed );
		const auto positions = placed( blob, []( const Vec3d& x ) { return x; } );
		test::Seeded random( seed );
		const auto cut = linksCut( blob, positions, PlaneCut{ Vec3d::Zero(), wide( random.inBox( 1.0f ) ) } );
		const Lattice open = withoutLinks( blob, cut );
		EXPECT_EQ( linksToHeal( blob, open, {}, positions, 1.01 ), cut );
		// In a piece of it: the piece's links. Farther apart than allowed: none.
		const std::vector<std::uint32_t> cells = connectedParts( open )[0];
		const Lattice part = extractCells( open, cells );
		std::vector<Vec3d> ofPart;
		for ( const std::uint32_t cell : cells )
		{
			ofPart.push_back( positions[cell] );
		}
		EXPECT_TRUE( linksToHeal( blob, part, cells, ofPart, 1.01 ).empty() ); // a plane leaves no broken link within a side
		const auto slit = linksCut( part, ofPart, PlaneCut{ ofPart[0], Vec3d( 0.3, 1, 0.2 ), 0.2 } );
		EXPECT_EQ( linksToHeal( blob, withoutLinks( part, slit ), cells, ofPart, 1.01 ), slit );
		for ( Vec3d& place : ofPart )
		{
			place *= 1.1;
		}
		EXPECT_TRUE( linksToHeal( blob, withoutLinks( part, slit ), cells, ofPart, 1.05 ).empty() );
	}
}

} // namespace
} // namespace pliant
