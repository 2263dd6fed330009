// Thin parts break by bending: a plate of one cell has no stretched link when it bends, and of plates of a few cells the links are strained
// less than the faces. Each plate here is bent to an arc, and must break between .9 and 1.1 of the curvature at which its faces are
// strained by the breaking strain, by every rule.

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

#include <cmath>

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

std::vector<CellLink> linksBrokenByBending( const Lattice& lattice, const NodeState& nodes, BreakRule rule, float strain )
{
	std::vector<CellLink> broken;
	const CellPositions positions( nodes );
	if ( rule == BreakRule::Plane )
	{
		PlaneCracks cracks( strain, 1.0f );
		cracks.find( lattice, limitLinks( lattice, cracks.candidateStrain(), {} ), positions, 0.0f, true, broken );
	}
	else if ( rule == BreakRule::Shards )
	{
		Fracture settings;
		settings.rule = rule;
		settings.shardSize = 5.0f * kEdge;
		ShardCracks cracks( lattice, settings, {} );
		cracks.setLaw( strain, 1e7 );
		const LinkLimits limits = limitLinks( lattice, cracks.candidateStrain(), {} );
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
		const LinkLimits limits = limitLinks( lattice, strain, {} );
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

TEST( ThinParts, RodsBreakWhenTheirFacesAreStrainedByWhatBreaksThem )
{
	for ( const int cells : { 1, 2, 3, 4 } )
	{
		for ( const BreakRule rule : kBendRules )
		{
			const Lattice lattice = makeBlockLattice( 20, cells, cells, kEdge );
			const double bends = breakingBend( lattice, Eigen::Matrix3d::Identity(), cells * double( kEdge ), rule );
			EXPECT_NEAR( bends, 1.0, 0.1 ) << cells << " cells, rule " << int( rule );
		}
	}
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
				test::Mesh plate = test::makeBox( { -1.0, -0.4, -0.5 * thickness }, { 1.0, 0.4, 0.5 * thickness } );
				for ( std::size_t i = 0; i < plate.positions.size(); i += 3 )
				{
					Eigen::Map<Vec3> at( plate.positions.data() + i );
					at = ( turn * at.cast<double>() ).cast<float>();
				}
				LatticeSettings settings;
				settings.cellSize = kEdge;
				const Lattice lattice = buildLattice( plate.view(), settings ).value.lattice;
				for ( const BreakRule rule : kBendRules )
				{
					EXPECT_NEAR( breakingBend( lattice, turn.transpose(), thickness, rule ), 1.0, 0.25 )
						<< thickness << " m, at " << angle << " and " << tilt << ", rule " << int( rule );
				}
			}
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
	const std::vector<ThinCell> inherited = inheritThinCells( findThinCells( whole ), cells );
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
