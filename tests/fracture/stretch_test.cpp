// The largest stretch in closed form, against Eigen's solver.

#include "fracture/constants.h"
#include "fracture/stretch.h"
#include "matching/regions/region_moments.h"

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace pliant {
namespace {

Eigen::Matrix3d randomMatrix( std::mt19937& random, double size )
{
	std::uniform_real_distribution<double> any( -size, size );
	Eigen::Matrix3d m;
	for ( int k = 0; k < 9; ++k )
	{
		m( k / 3, k % 3 ) = any( random );
	}
	return m;
}

/// `slack`: where the two largest stretches are nearly equal, the error is of the order of the root of the rounding error.
void expectLikeEigen( const Eigen::Matrix3d& f, double slack )
{
	const Eigen::Matrix3d c = f.transpose() * f;
	const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver( c );
	const Stretch found = largestStretch( f );
	const double strain = std::sqrt( std::max( 0.0, solver.eigenvalues()[2] ) ) - 1.0;
	EXPECT_NEAR( found.strain, strain, slack * ( 1.0 + c.norm() ) );
	EXPECT_NEAR( found.axis.norm(), 1.0, 1e-12 );
	// Among equal stretches any axis will do: along it the stretch is the largest one.
	EXPECT_NEAR( ( f * found.axis ).norm(), 1.0 + strain, 1e-6 * ( 1.0 + c.norm() ) );
}

TEST( Stretch, IsEigens )
{
	std::mt19937 random( 5 );
	for ( const double size : { 1e-6, 1e-3, 0.03, 0.3, 1.0 } )
	{
		for ( int k = 0; k < 2000; ++k )
		{
			expectLikeEigen( Eigen::Matrix3d( Eigen::Matrix3d::Identity() + randomMatrix( random, size ) ), 1e-12 );
		}
	}
}

TEST( Stretch, WhereDirectionsAreAlike )
{
	std::mt19937 random( 6 );
	for ( int k = 0; k < 300; ++k )
	{
		const Eigen::HouseholderQR<Eigen::Matrix3d> turn( randomMatrix( random, 1.0 ) );
		const Eigen::Matrix3d q = turn.householderQ();
		for ( const Vec3d& stretches : { Vec3d( 1.1, 1.1, 0.9 ), Vec3d( 1.1, 0.9, 0.9 ), Vec3d( 1.0, 1.0, 1.0 ), Vec3d( 1.2, 1.2, 1.2 ),
				  Vec3d( 1.1, 0.0, 1.1 ), Vec3d( 0.0, 0.0, 0.0 ) } )
		{
			expectLikeEigen( Eigen::Matrix3d( q * stretches.asDiagonal() * q.transpose() ), 1e-8 );
		}
	}
}

/// Never true for a larger stretch; true for a stretch that is smaller by a thousandth.
TEST( Stretch, IsLessOnlyWhereItIs )
{
	std::mt19937 random( 8 );
	std::uniform_real_distribution<double> any( 0.0, 1.0 );
	int told = 0;
	for ( const double size : { 1e-3, 0.03, 0.3, 1.0 } )
	{
		for ( int k = 0; k < 2000; ++k )
		{
			const Eigen::Matrix3d f = Eigen::Matrix3d::Identity() + randomMatrix( random, size );
			const double strain = largestStretch( f ).strain, asked = size * any( random );
			EXPECT_FALSE( isStretchedLess( f, strain ) );
			EXPECT_FALSE( isStretchedLess( f, asked ) && strain >= asked ) << strain << " " << asked;
			told += isStretchedLess( f, asked ) ? 1 : 0;
			const Eigen::HouseholderQR<Eigen::Matrix3d> turn( randomMatrix( random, 1.0 ) );
			const Eigen::Matrix3d q = turn.householderQ();
			const double pull = 0.01 + size * any( random );
			EXPECT_TRUE(
				isStretchedLess( q * Vec3d( 1.0 + pull, 1.0 - 0.3 * pull, 1.0 - 0.3 * pull ).asDiagonal() * q.transpose(), 1.001 * pull ) );
		}
	}
	EXPECT_GT( told, 500 );
}

TEST( Stretch, OfFlatNeighbourhoodsIsWithinThem )
{
	std::mt19937 random( 7 );
	for ( int k = 0; k < 300; ++k )
	{
		const Eigen::HouseholderQR<Eigen::Matrix3d> turn( randomMatrix( random, 1.0 ) );
		const Eigen::Matrix3d q = turn.householderQ();
		for ( const Vec3d& spread : { Vec3d( 3.0, 2.0, 1.0 ), Vec3d( 3.0, 2.0, 0.01 ), Vec3d( 3.0, 2.0, 1e-4 ), Vec3d( 3.0, 2.0, 0.0 ),
				  Vec3d( 3.0, 0.0, 0.0 ), Vec3d( 0.0, 0.0, 0.0 ) } )
		{
			const Eigen::Matrix3d moment = q * spread.asDiagonal() * q.transpose();
			Eigen::Matrix3d outside;
			const Eigen::Matrix3d known = inverseInPlane( moment, kFlatNeighbourhood, outside );
			EXPECT_LT( ( inverseOfRest( moment ) - known ).norm(), 1e-9 * ( 1.0 + known.norm() ) );
		}
	}
}

} // namespace
} // namespace pliant
