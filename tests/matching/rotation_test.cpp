// The nearest rotation of any matrix: always finite, proper and the global optimum.

#include "matching/rotation.h"
#include "support/block_body.h"

#include <Eigen/SVD>
#include <gtest/gtest.h>

#include <limits>

namespace pliant {
namespace {

using Matrix = Eigen::Matrix3d;
using Quaternion = Eigen::Quaterniond;

/// The largest value of tr( R^T a ) over rotations, by singular values: the reference implementation.
double bestAlignment( const Matrix& a )
{
	const Eigen::JacobiSVD<Matrix> svd( a, Eigen::ComputeFullU | Eigen::ComputeFullV );
	const double sign = ( svd.matrixU() * svd.matrixV().transpose() ).determinant() < 0.0 ? -1.0 : 1.0;
	const Vec3d& s = svd.singularValues();
	return s[0] + s[1] + sign * s[2];
}

void expectOptimal( const Matrix& a, const Quaternion& previous, double tolerance )
{
	const Quaternion q = fitRotation( a, previous );
	const Matrix r = q.toRotationMatrix();
	ASSERT_TRUE( r.allFinite() );
	EXPECT_NEAR( r.determinant(), 1.0, 1e-12 );
	EXPECT_LT( ( r.transpose() * r - Matrix::Identity() ).norm(), 1e-12 );
	EXPECT_NEAR( ( r.transpose() * a ).trace(), bestAlignment( a ), tolerance * a.norm() );
}

Matrix randomMatrix( test::Seeded& random )
{
	Matrix a;
	for ( int k = 0; k < 9; ++k )
	{
		a( k / 3, k % 3 ) = random.uniform( -1.0f, 1.0f );
	}
	return a;
}

TEST( Rotation, IsOptimalForRandomMatricesOfEveryScale )
{
	test::Seeded random( 1 );
	for ( int i = 0; i < 3000; ++i )
	{
		const double scale = std::pow( 10.0, random.uniform( -18.0f, 18.0f ) );
		expectOptimal( randomMatrix( random ) * scale, Quaternion::Identity(), 1e-9 );
	}
}

TEST( Rotation, IsOptimalForFlatThinAndMirroredMatrices )
{
	test::Seeded random( 2 );
	for ( int i = 0; i < 1000; ++i )
	{
		const Eigen::JacobiSVD<Matrix> svd( randomMatrix( random ), Eigen::ComputeFullU | Eigen::ComputeFullV );
		for ( const Vec3d& s : { Vec3d( 1.0, 0.5, 0.0 ), Vec3d( 1.0, 0.0, 0.0 ), Vec3d( 1.0, 0.6, -0.3 ), Vec3d( 1.0, 1.0, -1.0 ),
				  Vec3d( 1.0, 1e-9, 1e-9 ), Vec3d( 1.0, 1.0, 0.0 ) } )
		{
			expectOptimal( svd.matrixU() * s.asDiagonal() * svd.matrixV().transpose(), Quaternion::Identity(), 1e-6 );
		}
	}
}

TEST( Rotation, KeepsThePreviousOneWhereTheMatrixSaysNothing )
{
	const Quaternion previous( Eigen::AngleAxisd( 0.7, Vec3d( 1, 2, 3 ).normalized() ) );
	EXPECT_LT( fitRotation( Matrix( Matrix::Zero() ), previous ).angularDistance( previous ), 1e-12 );

	// A line determines its own direction but not the rotation about it: that rotation is kept.
	const Matrix line = Vec3d::UnitX() * Vec3d::UnitX().transpose();
	const Quaternion twist( Eigen::AngleAxisd( 1.1, Vec3d::UnitX() ) );
	EXPECT_LT( fitRotation( line, twist ).angularDistance( twist ), 1e-6 );
}

TEST( Rotation, AnswersThePreviousOneToNumbersThatAreNotFinite )
{
	const Quaternion previous( Eigen::AngleAxisd( 0.3, Vec3d::UnitZ() ) );
	for ( double bad : { std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity() } )
	{
		Matrix a = Matrix::Identity();
		a( 1, 2 ) = bad;
		EXPECT_LT( fitRotation( a, previous ).angularDistance( previous ), 1e-12 );
	}
}

} // namespace
} // namespace pliant
