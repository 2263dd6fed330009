// Regions truncated by the surface, with the moments of their links.

#include "matching/regions/link_moments.h"
#include "support/explicit_material.h"

#include "matching/implicit/strain_rates.h"
#include "matching/step/lattice_matcher.h"
#include "support/block_body.h"
#include "support/block_lattice.h"

#include <gtest/gtest.h>

#include <cmath>

namespace pliant {
namespace {

Material implicit( int halfWidth )
{
	Material material = test::explicitMaterial();
	material.elasticity = Elasticity::Implicit;
	material.regionHalfWidth = halfWidth;
	return material;
}

/// The cells of a block for which `holds` is true, with their links.
Lattice cellsOf( const Lattice& block, bool ( *holds )( Eigen::Vector3i ) )
{
	Lattice lattice = block;
	lattice.linkStart.assign( 1, 0 );
	lattice.linkTo.clear();
	for ( int i = 0; i < block.cellCount(); ++i )
	{
		for ( std::uint32_t k = block.linkStart[std::size_t( i )]; k < block.linkStart[std::size_t( i ) + 1]; ++k )
		{
			const std::uint32_t j = block.linkTo[k];
			if ( holds( block.coordinate[std::size_t( i )].cast<int>() ) == holds( block.coordinate[j].cast<int>() ) )
			{
				lattice.linkTo.push_back( j );
			}
		}
		lattice.linkStart.push_back( std::uint32_t( lattice.linkTo.size() ) );
	}
	return lattice;
}

TEST( LinkMoments, EnergyOfAnyUniformStrainIsThatOfTheLinks )
{
	const Lattice block = makeBlockLattice( 7, 5, 2, 0.1f ),
				  slit = cellsOf( block, []( Eigen::Vector3i c ) { return c.x() < 3 && c.y() > 1; } );
	for ( const Lattice* lattice : { &block, &slit } )
	{
		for ( const int w : { 2, 3 } )
		{
			const Material material = implicit( w );
			const auto tables = buildRegionTables( *lattice, material, Summation::Table );
			Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
			for ( int r = 0; r < lattice->cellCount(); ++r )
			{
				// J C = J*
				const auto& m = tables->moments.moment;
				Eigen::Matrix3d j, c;
				j << m[0][r], m[5][r], m[4][r], m[5][r], m[1][r], m[3][r], m[4][r], m[3][r], m[2][r];
				for ( int k = 0; k < 9; ++k )
				{
					c( k / 3, k % 3 ) = double( tables->blend[k][std::size_t( r )] );
				}
				sum += j * c;
			}
			Eigen::Vector3d links = Eigen::Vector3d::Zero();
			for ( int i = 0; i < lattice->cellCount(); ++i )
			{
				for ( std::uint32_t k = lattice->linkStart[std::size_t( i )]; k < lattice->linkStart[std::size_t( i ) + 1]; ++k )
				{
					const Eigen::Vector3i step = ( lattice->coordinate[lattice->linkTo[k]] - lattice->coordinate[std::size_t( i )] )
													 .cast<int>();
					links += step.squaredNorm() == 1 ? Eigen::Vector3d( 0.5 * step.cwiseAbs().cast<double>() )
													 : Eigen::Vector3d( Eigen::Vector3d::Zero() );
				}
			}
			const double mu = w * ( w + 1 ) / 3.0;
			const Eigen::Matrix3d wanted = mu * links.asDiagonal().toDenseMatrix();
			EXPECT_LT( ( sum - wanted ).norm() / wanted.norm(), 1e-4 ) << w;
		}
	}
}

TEST( LinkMoments, LeaveWholeRegionsAndExplicitBodiesAsTheyAre )
{
	const Lattice lattice = makeBlockLattice( 9, 9, 9, 0.1f );
	const auto tables = buildRegionTables( lattice, implicit( 2 ), Summation::Automatic );
	const int middle = ( 4 * 9 + 4 ) * 9 + 4;
	for ( int k = 0; k < 9; ++k )
	{
		EXPECT_NEAR( tables->blend[k][middle], k % 4 == 0 ? 1.0f : 0.0f, 1e-5f );
	}
	EXPECT_TRUE( buildRegionTables( lattice, implicit( 1 ), Summation::Automatic )->blend[0].empty() );
	Material material = implicit( 2 );
	material.elasticity = Elasticity::Explicit;
	EXPECT_TRUE( buildRegionTables( lattice, material, Summation::Automatic )->blend[0].empty() );
}

// The operator must not assume less resistance of a region than matching has, or a stiff step would overshoot.
TEST( LinkMoments, TheOperatorBoundsWhatTheyPullWith )
{
	const Lattice lattice = makeBlockLattice( 2, 5, 6, 0.1f );
	const Material material = implicit( 2 );
	LatticeMatcher matcher( lattice, material );
	NodeState nodes = test::restNodes( lattice );
	StrainRates rates;
	rates.prepare( matcher, nodes, nullptr );
	test::Seeded random( 5 );
	const std::size_t padded = std::size_t( nodes.padded );
	for ( int trial = 0; trial < 40; ++trial )
	{
		// For a small displacement: matching gives the force, and the operator, applied to it as a velocity, its bound.
		AlignedArray<float> v( 3 * padded, 0.0f ), resisted( 3 * padded, 0.0f );
		NodeState moved = test::restNodes( lattice );
		const Eigen::Matrix3f strain = Eigen::Matrix3f::NullaryExpr( [&] { return random.uniform( -1, 1 ); } );
		const float shake = trial % 2 == 0 ? 0.0f : 1.0f;
		for ( int i = 0; i < nodes.count; ++i )
		{
			const Vec3 d = 1e-4f * ( strain * nodes.x0.get( i ) + shake * random.inBox( lattice.cellSize ) );
			moved.x.set( i, moved.x.get( i ) + d );
			for ( int k = 0; k < 3; ++k )
			{
				v[std::size_t( k ) * padded + std::size_t( i )] = d[k];
			}
		}
		LatticeMatcher other( lattice, material );
		other.accelerate( moved, MatchStep{ 1.0f, 1.0f, 0.0f, 0.0f, 0.0f, false, {}, {} }, nullptr );
		rates.resist( v.data(), 1.0f, resisted.data(), nullptr );
		double pulled = 0.0, bound = 0.0;
		for ( int i = 0; i < nodes.count; ++i )
		{
			for ( int k = 0; k < 3; ++k )
			{
				const std::size_t at = std::size_t( k ) * padded + std::size_t( i );
				pulled -= double( nodes.mass[i] ) * double( moved.v.get( i )[k] ) * double( v[at] );
				bound += ( double( resisted[at] ) - double( nodes.mass[i] ) * double( v[at] ) ) * double( v[at] );
			}
		}
		EXPECT_GT( pulled, 0.0 );
		EXPECT_LT( pulled, bound * 1.01 );
	}
}

} // namespace
} // namespace pliant
