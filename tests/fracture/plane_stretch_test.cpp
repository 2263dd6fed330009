// Cracks as planes begin where the largest stretch goes beyond what the material bears, and not a hair before, whatever its direction.

#include "fracture/plane_cracks.h"
#include "support/block_body.h"

#include <Eigen/Dense>
#include <gtest/gtest.h>

namespace pliant {
namespace {

using test::Seeded;

constexpr float kBreakStrain = 0.1f;

bool begins( const Lattice& lattice, std::vector<float> toughness, const Eigen::Matrix3d& f )
{
	PlaneCracks cracks( kBreakStrain, 1.0f );
	const LinkLimits limits = limitLinks( lattice, cracks.candidateStrain(), std::move( toughness ) );
	NodeState nodes = test::restNodes( lattice );
	for ( int i = 0; i < nodes.count; ++i )
	{
		nodes.x.set( i, ( f * nodes.x0.get( i ).cast<double>() ).cast<float>() );
	}
	std::vector<CellLink> broken;
	return cracks.find( lattice, limits, CellPlaces( nodes ), 1.0f / 240.0f, true, broken );
}

/// A rotation, and a stretch of which this is the largest.
Eigen::Matrix3d deformation( Seeded& random, double largest )
{
	const auto turn = [&random] {
		const Vec3 a = random.inBox( 1.0f ), b = random.inBox( 1.0f );
		return Eigen::Quaterniond( double( a.x() ), double( a.y() ), double( a.z() ), double( b.x() ) ).normalized().toRotationMatrix();
	};
	const Eigen::Matrix3d axes = turn();
	const auto less = [&] { return 1.0 + ( largest - 1.0 ) * double( random.uniform( 0.0f, 1.0f ) ); };
	const double others[2] = { less(), less() };
	return turn() * axes * Vec3d( largest, others[0], others[1] ).asDiagonal() * axes.transpose();
}

TEST( PlaneStretch, BeginWhereTheLargestStretchIsTooLarge )
{
	const Lattice lattice = makeBlockLattice( 4, 4, 4, 0.1f );
	Seeded random( 3 );
	for ( int k = 0; k < 200; ++k )
	{
		const float share = k % 2 == 0 ? 1.0f : random.uniform( 0.3f, 3.0f );
		const std::vector<float> toughness( k % 2 == 0 ? 0u : std::size_t( lattice.linkCount() ), share );
		const double limit = double( kBreakStrain ) * double( share );
		Seeded again = random;
		EXPECT_FALSE( begins( lattice, toughness, deformation( random, 1.0 + 0.999 * limit ) ) );
		EXPECT_TRUE( begins( lattice, toughness, deformation( again, 1.0 + 1.001 * limit ) ) );
	}
}

/// Plates one cell thick have no stretch across, and lines only one.
TEST( PlaneStretch, AlsoInPlatesAndLines )
{
	for ( const Lattice& lattice : { makeBlockLattice( 5, 5, 1, 0.1f ), makeBlockLattice( 6, 1, 1, 0.1f ) } )
	{
		for ( const double strain : { 0.099, 0.101 } )
		{
			const Eigen::Matrix3d f = Vec3d( 1.0 + strain, 1.0, 1.0 ).asDiagonal();
			EXPECT_EQ( begins( lattice, {}, f ), strain > double( kBreakStrain ) );
		}
	}
}

} // namespace
} // namespace pliant
