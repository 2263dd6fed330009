// A sphere that is reported clear of a plane does not touch it.

#include "world/constants.h"
#include "world/touch/node_touch.h"

#include <BulletCollision/CollisionShapes/btStaticPlaneShape.h>

#include <gtest/gtest.h>

#include <random>

namespace pliant {
namespace {

struct Count
{
	int clear = 0, touching = 0, neither = 0; ///< neither: within rounding of touching, or an invalid query
};

/// Spheres around a plane whose foot is `away` from the origin; displacements towards it, along it and away from it.
Count compareBoth( double away, double spread )
{
	std::mt19937 random( 11 );
	std::uniform_real_distribution<double> any( -1.0, 1.0 );
	const auto some = [&] { return Vec3d( any( random ), any( random ), any( random ) ); };
	Count count;
	for ( int round = 0; round < 40; ++round )
	{
		const Vec3d normal = some().normalized();
		const btStaticPlaneShape shape(
			btVector3( btScalar( normal.x() ), btScalar( normal.y() ), btScalar( normal.z() ) ), btScalar( any( random ) ) );
		Obstacle plane;
		plane.shape = &shape;
		plane.basis = Eigen::Quaterniond( any( random ), any( random ), any( random ), any( random ) ).normalized().toRotationMatrix();
		plane.position = away * some();
		const FarPlane far( plane );
		for ( int k = 0; k < 500; ++k )
		{
			MovingSphere sphere;
			sphere.radius = 0.2 + 0.1 * any( random );
			sphere.displacement = 0.5 * some();
			sphere.centre = plane.position + spread * some() + double( shape.getPlaneConstant() ) * ( plane.basis * normal );
			Touch touch;
			const bool isTouching = findTouch( plane, sphere, touch ),
					   isClear = far.isClear( sphere.centre, sphere.displacement, sphere.radius );
			EXPECT_FALSE( isTouching && isClear );
			++( isTouching ? count.touching : isClear ? count.clear : count.neither );
		}
	}
	return count;
}

TEST( FarPlane, IsNeverClearOfTouchingSpheres )
{
	const Count count = compareBoth( 5.0, 1.0 );
	EXPECT_GT( count.clear, 3000 );
	EXPECT_GT( count.touching, 3000 );
	EXPECT_EQ( count.neither, 0 );
}

TEST( FarPlane, WorksAThousandKilometresOut )
{
	const Count count = compareBoth( 1e6, 0.7 );
	EXPECT_GT( count.clear, 2000 );
	EXPECT_GT( count.touching, 2000 );
	EXPECT_LT( count.neither, 3 );
}

} // namespace
} // namespace pliant
