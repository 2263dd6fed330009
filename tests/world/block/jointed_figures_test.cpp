// Figures of rigid bodies on Bullet's joints that fall on soft bodies.

#include "support/test_world.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <vector>

namespace pliant {
namespace {

/// Capsules of 20 kg on ball joints, one above the other.
class Figure
{
public:
	Figure( test::SoftWorld& world, int count, double height ) : m_world( world )
	{
		for ( int k = 0; k < count; ++k )
		{
			m_capsules.push_back( world.add( 20, new btCapsuleShape( btScalar( 0.08 ), btScalar( 0.25 ) ),
				btVector3( btScalar( 0.1 ), btScalar( height + 0.42 * k ), 0 ) ) );
		}
		for ( std::size_t k = 1; k < m_capsules.size(); ++k )
		{
			const btVector3 reach( 0, btScalar( 0.21 ), 0 );
			m_joints.push_back( std::make_unique<btPoint2PointConstraint>( *m_capsules[k - 1], *m_capsules[k], reach, -reach ) );
			world.world.addConstraint( m_joints.back().get(), true );
		}
	}
	~Figure()
	{
		for ( const auto& joint : m_joints )
		{
			m_world.world.removeConstraint( joint.get() );
		}
	}
	Figure( const Figure& ) = delete;
	Figure& operator=( const Figure& ) = delete;

	double fastest() const
	{
		double most = 0.0;
		for ( const btRigidBody* const capsule : m_capsules )
		{
			most = std::max( most, double( capsule->getLinearVelocity().length() ) );
		}
		return most;
	}
	/// The largest gap of a joint, m.
	double gap() const
	{
		double most = 0.0;
		for ( const auto& joint : m_joints )
		{
			most = std::max( most,
				double( ( joint->getRigidBodyA().getWorldTransform() * joint->getPivotInA() )
							.distance( joint->getRigidBodyB().getWorldTransform() * joint->getPivotInB() ) ) );
		}
		return most;
	}

private:
	test::SoftWorld& m_world;
	std::vector<btRigidBody*> m_capsules;
	std::vector<std::unique_ptr<btPoint2PointConstraint>> m_joints;
};

struct FigureFall
{
	float youngsModulus, density;
	int rate, capsules;
};

// The impulses of joints were expected from the steps before: of an impact they came too late, and figures were thrown off the slab at 8
// to 11 m/s, and the slab off the floor at 17.
TEST( JointedFigures, LandOnStiffSlabsAsOnRigidOnes )
{
	const FigureFall falls[] = { { 1e7f, 1000.0f, 60, 6 }, { 1e9f, 1000.0f, 30, 5 }, { 1e9f, 1000.0f, 60, 6 }, { 7e10f, 2500.0f, 30, 3 },
		{ 7e10f, 2500.0f, 60, 6 } };
	for ( const FigureFall& fall : falls )
	{
		test::SoftWorld world;
		world.addBoxFloor();
		Material material;
		material.youngsModulus = fall.youngsModulus;
		material.density = fall.density;
		SoftBody* const slab = world.add( test::boxTemplate( { 1.0f, 0.2f, 1.0f }, 0.05f ), btVector3( 0, btScalar( 0.1 ), 0 ), material );
		const Figure figure( world, fall.capsules, 1.0 );
		double fastest = 0.0, moved = 0.0, open = 0.0;
		for ( int frame = 0; frame < 2 * fall.rate; ++frame )
		{
			world.world.stepSimulation( btScalar( 1 ) / btScalar( fall.rate ), 0 );
			fastest = std::max( fastest, figure.fastest() );
			moved = std::max( moved, double( slab->linearVelocity().length() ) );
			open = std::max( open, figure.gap() );
		}
		std::printf( "%.0e Pa, 1/%d s, %d capsules: at most %.2f m/s, slab %.3f m/s, joints open by %.4f m\n", double( fall.youngsModulus ),
			fall.rate, fall.capsules, fastest, moved, open );
		EXPECT_LT( fastest, 6.0 ) << fall.youngsModulus; // 4.6 on a rigid slab
		EXPECT_LT( moved, 0.5 ) << fall.youngsModulus;
		EXPECT_LT( open, 0.1 ) << fall.youngsModulus;
	}
}

} // namespace
} // namespace pliant
