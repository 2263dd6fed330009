// Thin parts break by bending: a plate of one cell has no stretched link when it bends, and of plates of a few cells the links are strained
// less than the faces. Each plate here is bent to an arc, and must break between .9 and 1.1 of the curvature at which its faces are
// strained by the breaking strain, by every rule.

#include "archive/archive.h"
#include "fracture/constants.h"
#include "fracture/face_stretch.h"
#include "fracture/plane_cracks.h"
#include "fracture/shards/shard_cracks.h"
#include "lattice/build/build_lattice.h"
#include "lattice/pieces.h"
#include "pliant/fracture.h"
#include "support/block_body.h"
#include "support/block_lattice.h"
#include "test_meshes.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <random>
#include <utility>

namespace pliant {
namespace {

constexpr float kEdge = 0.1f, kBendStrain = 0.02f;

/// A part of the height t along z that is bent about y, so that its upper face is strained by `strain`, and its middle not.
NodeState bentNodes( const Lattice& lattice, const Eigen::Matrix3d& toPart, double thickness, double strain )
{
	NodeState nodes = test::restNodes( lattice );
	const double radius = 0.5 * thickness / strain;
	for ( int i = 0; i < nodes.count; ++i )
	{
		const Vec3d at = toPart * nodes.x0.get( i ).cast<double>();
		const double angle = at.x() / radius, r = radius + at.z();
		const Vec3d bent( r * std::sin( angle ), at.y(), r * std::cos( angle ) - radius );
		nodes.x.set( i, ( toPart.transpose() * bent ).cast<float>() );
	}
	return nodes;
}

LinkLimits limitsWithThin( const Lattice& lattice, float strain )
{
	LinkLimits limits = limitLinks( lattice, strain, {} );
	limits.thin = findThinCells( lattice );
	return limits;
}

std::vector<CellLink> linksBrokenByBending( const Lattice& lattice, const NodeState& nodes, BreakRule rule, float strain )
{
	std::vector<CellLink> broken;
	const CellPositions positions( nodes );
	if ( rule == BreakRule::Plane )
	{
		PlaneCracks cracks( strain, 1.0f );
		cracks.find( lattice, limitsWithThin( lattice, cracks.candidateStrain() ), positions, 0.0f, true, broken );
	}
	else if ( rule == BreakRule::Shards )
	{
		Fracture settings;
		settings.rule = rule;
		settings.shardSize = 5.0f * kEdge;
		ShardCracks cracks( lattice, settings, {} );
		cracks.setLaw( strain, 1e7 );
		const LinkLimits limits = limitsWithThin( lattice, cracks.candidateStrain() );
		cracks.findOverloads( lattice, limits, positions );
		cracks.run(
			lattice, limits,
			[&] {
				std::vector<Vec3d> at;
				for ( std::uint32_t i = 0; i < std::uint32_t( lattice.cellCount() ); ++i )
				{
					at.push_back( positions.at( i ).cast<double>() );
				}
				return at;
			},
			broken );
	}
	else
	{
		const LinkLimits limits = limitsWithThin( lattice, strain );
		findOverstretched( limits, nodes, broken );
		FaceStretch faces;
		faces.update( lattice, limits, positions, double( strain ) );
		faces.findOverbent( limits, positions, broken );
	}
	return broken;
}

/// The bend, in breaking strains at the face, from which on the part breaks, to .01.
double breakingBend( const Lattice& lattice, const Eigen::Matrix3d& toPart, double thickness, BreakRule rule )
{
	double low = 0.0, high = 8.0;
	while ( high - low > 0.01 )
	{
		const double middle = 0.5 * ( low + high );
		const NodeState nodes = bentNodes( lattice, toPart, thickness, middle * double( kBendStrain ) );
		( linksBrokenByBending( lattice, nodes, rule, kBendStrain ).empty() ? low : high ) = middle;
	}
	return high;
}

constexpr BreakRule kBendRules[] = { BreakRule::Distance, BreakRule::Plane, BreakRule::Shards };

TEST( ThinParts, PlatesBreakWhenTheirFacesAreStrainedByWhatBreaksThem )
{
	for ( const int layers : { 1, 2, 3, 4, 6 } )
	{
		for ( const BreakRule rule : kBendRules )
		{
			const Lattice lattice = makeBlockLattice( 20, 8, layers, kEdge );
			const double bends = breakingBend( lattice, Eigen::Matrix3d::Identity(), layers * double( kEdge ), rule );
			EXPECT_NEAR( bends, 1.0, 0.1 ) << layers << " layers, rule " << int( rule );
		}
	}
}

// Along a diagonal the edges of a rod are strained most. Shards added the bendings along the two normals, which cancel there to one side.
TEST( ThinParts, RodsBreakWhenTheirEdgesAreStrainedByWhatBreaksThem )
{
	for ( const int cells : { 2, 3, 4 } )
	{
		for ( const double degrees : { 0.0, 30.0, 45.0, -45.0, 90.0 } )
		{
			const double angle = degrees * 3.14159265358979323846 / 180.0;
			const Eigen::Matrix3d turn = Eigen::AngleAxisd( angle, Vec3d::UnitX() ).toRotationMatrix();
			const double height = cells * double( kEdge ) * ( std::fabs( std::cos( angle ) ) + std::fabs( std::sin( angle ) ) );
			for ( const BreakRule rule : kBendRules )
			{
				const double bends = breakingBend( makeBlockLattice( 20, cells, cells, kEdge ), turn, height, rule );
				EXPECT_NEAR( bends, 1.0, 0.1 ) << cells << " cells at " << degrees << " degrees, rule " << int( rule );
			}
		}
	}
}

// A row of single cells does not know how it is turned about its axis: its faces count, not its edges.
TEST( ThinParts, RowsOfSingleCellsBreakAsIfBentAlongAFace )
{
	for ( const BreakRule rule : kBendRules )
	{
		const double bends = breakingBend( makeBlockLattice( 20, 1, 1, kEdge ), Eigen::Matrix3d::Identity(), double( kEdge ), rule );
		EXPECT_NEAR( bends, 1.0, 0.1 ) << int( rule );
	}
}

// What bending stores and links between the centres of cells do not have: E K^2 d^5 / 24 a cell.
TEST( ThinParts, HaveTheEnergyThatLinksDoNot )
{
	const int sections[][2] = { { 8, 1 }, { 8, 2 }, { 8, 4 }, { 8, 6 }, { 1, 1 }, { 2, 2 }, { 3, 3 }, { 4, 2 }, { 2, 1 }, { 1, 3 } };
	for ( const auto& [wide, high] : sections )
	{
		const Lattice lattice = makeBlockLattice( 24, wide, high, kEdge );
		const double height = high * double( kEdge ), strain = double( kBendStrain ), curvature = 2.0 * strain / height;
		const NodeState nodes = bentNodes( lattice, Eigen::Matrix3d::Identity(), height, strain );
		const LinkLimits limits = limitsWithThin( lattice, kBendStrain );
		FaceStretch faces;
		faces.update( lattice, limits, CellPositions( nodes ), strain );
		double sum = 0.0;
		for ( const ThinCell& thin : limits.thin )
		{
			sum += faces.hiddenSquare( thin );
		}
		const double inside = 22.0 * wide * high; // cells at the ends have no pairs
		EXPECT_NEAR( sum / ( inside * std::pow( curvature * double( kEdge ), 2 ) / 12.0 ), 1.0, 0.3 ) << wide << " x " << high;
	}
}

/// A plate of 2 x .8 m, rotated against the lattice.
Lattice slantedPlate( double thickness, const Eigen::Matrix3d& turn )
{
	test::Mesh plate = test::makeBox( { -1.0, -0.4, -0.5 * thickness }, { 1.0, 0.4, 0.5 * thickness } );
	for ( std::size_t i = 0; i < plate.positions.size(); i += 3 )
	{
		Eigen::Map<Vec3> at( plate.positions.data() + i );
		at = ( turn * at.cast<double>() ).cast<float>();
	}
	LatticeSettings settings;
	settings.cellSize = kEdge;
	return buildLattice( plate.view(), settings ).value.lattice;
}

// The normal of a slanted part is not an axis of the lattice, and its cells are partly filled.
TEST( ThinParts, SlantedPlatesBreakLikewise )
{
	for ( const double thickness : { 0.1, 0.2, 0.4 } )
	{
		for ( const double angle : { 0.17, 0.35, 0.52 } )
		{
			for ( const double tilt : { 0.0, 0.52 } )
			{
				const Eigen::Matrix3d turn = ( Eigen::AngleAxisd( tilt, Vec3d::UnitX() ) * Eigen::AngleAxisd( angle, Vec3d::UnitY() ) )
												 .toRotationMatrix();
				const Lattice lattice = slantedPlate( thickness, turn );
				for ( const BreakRule rule : kBendRules )
				{
					EXPECT_NEAR( breakingBend( lattice, turn.transpose(), thickness, rule ), 1.0, 0.25 )
						<< thickness << " m, at " << angle << " and " << tilt << ", rule " << int( rule );
				}
			}
		}
	}
}

// The stretch along a part and its normal were found from each other in three passes. At steps of slanted plates, and where links are
// missing, as beside cracks and coarse nodes, that left a strain of .08 in a plate at rest.
TEST( ThinParts, AreNotStrainedAtRestWhateverLinksTheyHave )
{
	const Eigen::Matrix3d turn = ( Eigen::AngleAxisd( 0.52, Vec3d::UnitX() ) * Eigen::AngleAxisd( 0.52, Vec3d::UnitY() ) )
									 .toRotationMatrix();
	std::mt19937 random( 7 );
	for ( const double thickness : { 0.06, 0.1, 0.2 } )
	{
		const Lattice whole = slantedPlate( thickness, turn );
		std::vector<CellLink> gone;
		for ( std::uint32_t i = 0; i < std::uint32_t( whole.cellCount() ); ++i )
		{
			for ( std::uint32_t k = whole.linkStart[i]; k < whole.linkStart[i + 1]; ++k )
			{
				if ( whole.linkTo[k] > i && random() % 3 == 0 )
				{
					gone.push_back( CellLink{ i, whole.linkTo[k] } );
				}
			}
		}
		const Lattice lattice = withoutLinks( whole, gone );
		NodeState nodes = test::restNodes( lattice );
		for ( int i = 0; i < nodes.count; ++i )
		{
			nodes.x.set( i, ( turn * nodes.x0.get( i ).cast<double>() ).cast<float>() );
		}
		LinkLimits limits = limitLinks( lattice, kBendStrain, {} );
		limits.thin = findThinCells( whole );
		FaceStretch faces;
		faces.update( lattice, limits, CellPositions( nodes ), 0.0 ); // every rounding counts as bending
		for ( const ThinCell& thin : limits.thin )
		{
			EXPECT_LT( largestStretch( faces.deformationOf( thin.cell, false ) ).strain, 1e-4 ) << thickness << " m, cell " << thin.cell;
		}
	}
}

// A piece keeps what its cells are of: a plate that is cut breaks as it did.
TEST( ThinParts, PiecesInheritThem )
{
	const Lattice whole = makeBlockLattice( 20, 8, 2, kEdge );
	std::vector<std::uint32_t> cells;
	for ( std::uint32_t i = 0; i < std::uint32_t( whole.cellCount() ); ++i )
	{
		if ( whole.coordinate[i].x() < 12 )
		{
			cells.push_back( i );
		}
	}
	const std::vector<ThinCell> inherited = inheritThinCells( findThinCells( whole ), extractCells( whole, cells ), cells );
	ASSERT_EQ( inherited.size(), cells.size() );
	for ( std::size_t k = 0; k < inherited.size(); ++k )
	{
		EXPECT_EQ( inherited[k].cell, k );
		for ( int p = 0; p < inherited[k].pairs; ++p )
		{
			const Vec3 sum = whole.restCentre[cells[inherited[k].pair[p].a]] + whole.restCentre[cells[inherited[k].pair[p].b]];
			EXPECT_LT( ( sum - 2.0f * whole.restCentre[cells[k]] ).norm(), 1e-5f );
		}
	}
}

// The gap of a slit is no bending.
TEST( ThinParts, PairsEndAtASlit )
{
	const Lattice whole = makeBlockLattice( 20, 8, 1, kEdge );
	std::vector<CellLink> slit;
	std::vector<std::uint32_t> all;
	for ( std::uint32_t i = 0; i < std::uint32_t( whole.cellCount() ); ++i )
	{
		all.push_back( i );
		for ( std::uint32_t k = whole.linkStart[i]; k < whole.linkStart[i + 1]; ++k )
		{
			const std::uint32_t j = whole.linkTo[k];
			if ( j > i && whole.coordinate[i].y() < 4 && whole.coordinate[j].y() < 4 &&
				( whole.coordinate[i].x() < 10 ) != ( whole.coordinate[j].x() < 10 ) )
			{
				slit.push_back( CellLink{ i, j } );
			}
		}
	}
	const Lattice cut = withoutLinks( whole, slit );
	for ( const ThinCell& thin : inheritThinCells( findThinCells( whole ), cut, all ) )
	{
		for ( int p = 0; p < thin.pairs; ++p )
		{
			for ( const std::uint32_t end : { thin.pair[p].a, thin.pair[p].b } )
			{
				const auto row = cut.linkTo.begin() + cut.linkStart[thin.cell], last = cut.linkTo.begin() + cut.linkStart[thin.cell + 1];
				EXPECT_TRUE( std::binary_search( row, last, end ) ) << thin.cell;
			}
		}
	}
}

// A pair beyond the lattice passed, and the next step read memory of others.
TEST( ThinParts, DamagedOnesAreRefused )
{
	const Lattice lattice = makeBlockLattice( 20, 8, 2, kEdge );
	const auto isRefused = [&lattice]( const auto& damage ) {
		std::vector<ThinCell> thin = findThinCells( lattice );
		damage( thin );
		std::vector<std::byte> bytes;
		Archive to( bytes );
		archiveThinCells( to, thin, std::size_t( lattice.cellCount() ) );
		to.finish();
		Archive from( bytes.data(), bytes.size() );
		std::vector<ThinCell> read;
		archiveThinCells( from, read, std::size_t( lattice.cellCount() ) );
		return !from.isSound();
	};
	using Thin = std::vector<ThinCell>;
	EXPECT_FALSE( isRefused( []( Thin& ) {} ) );
	EXPECT_TRUE( isRefused( []( Thin& thin ) { thin[30].pair[0].a = 0x7ffffff0u; } ) );
	EXPECT_TRUE( isRefused( []( Thin& thin ) { thin[30].pair[0].b = 320; } ) );
	EXPECT_TRUE( isRefused( []( Thin& thin ) { thin.back().cell = 320; } ) );
	EXPECT_TRUE( isRefused( []( Thin& thin ) { std::swap( thin[3], thin[4] ); } ) );
	EXPECT_TRUE( isRefused( []( Thin& thin ) { thin[3].pairs = 5; } ) );
	EXPECT_TRUE( isRefused( []( Thin& thin ) { thin[3].normal[0] *= 1e20f; } ) );
	EXPECT_TRUE( isRefused( []( Thin& thin ) { thin[3].half[0] = std::numeric_limits<float>::quiet_NaN(); } ) );
	EXPECT_TRUE( isRefused( []( Thin& thin ) { thin[3].pair[0].scale = std::numeric_limits<float>::infinity(); } ) );
}

// Nothing is thin about a cube, and a body that is stretched without bending is measured as if nothing were.
TEST( ThinParts, ThickBodiesHaveNone )
{
	EXPECT_TRUE( findThinCells( makeBlockLattice( 6, 6, 6, kEdge ) ).empty() );
	EXPECT_TRUE( findThinCells( makeBlockLattice( 24, 8, 8, kEdge ) ).empty() );
	const Lattice plate = makeBlockLattice( 20, 8, 3, kEdge );
	NodeState nodes = test::restNodes( plate );
	for ( int i = 0; i < nodes.count; ++i )
	{
		nodes.x.x[std::size_t( i )] *= 1.0f + 0.97f * kBendStrain;
	}
	for ( const BreakRule rule : kBendRules )
	{
		EXPECT_TRUE( linksBrokenByBending( plate, nodes, rule, kBendStrain ).empty() ) << int( rule );
	}
}

} // namespace
} // namespace pliant
