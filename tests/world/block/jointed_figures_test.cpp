// Rigid bodies on Bullet's joints that fall on soft bodies, or are hit by them.

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
		EXPECT_LT( open, 0.06 ) << fall.youngsModulus;
	}
}

// A hit body counts with its joints in that step, and what has been learnt of these must not be added: the block of twice its plinth's mass
// got twice the velocity of its fall in a step, and hopped by three centimetres.
TEST( JointedFigures, APlinthThatIsHitCarriesItsBlockOn )
{
	for ( const int rate : { 30, 60 } )
	{
		test::SoftWorld world;
		world.addBoxFloor();
		Material material;
		material.youngsModulus = 1e9f;
		material.density = 1000.0f;
		ASSERT_TRUE( world.add( test::boxTemplate( { 2.0f, 0.2f, 1.0f }, 0.05f ), btVector3( 0, btScalar( 0.1 ), 0 ), material ) );
		const auto box = [&world]( double mass, double half, double height ) {
			const btVector3 halves( btScalar( 0.2 ), btScalar( half ), btScalar( 0.2 ) );
			return world.add( btScalar( mass ), new btBoxShape( halves ), btVector3( 0, btScalar( height ), 0 ) );
		};
		btRigidBody *const plinth = box( 20, 0.1, 0.3 ), *const block = box( 40, 0.2, 0.6 );
		btTransform onPlinth = btTransform::getIdentity(), onBlock = btTransform::getIdentity();
		onPlinth.setOrigin( btVector3( 0, btScalar( 0.1 ), 0 ) );
		onBlock.setOrigin( btVector3( 0, btScalar( -0.2 ), 0 ) );
		btFixedConstraint joint( *plinth, *block, onPlinth, onBlock );
		world.world.addConstraint( &joint, true );
		const auto step = [&] { world.world.stepSimulation( btScalar( 1 ) / btScalar( rate ), 0 ); };
		for ( int frame = 0; frame < rate; ++frame )
		{
			step();
		}
		material.youngsModulus = 1e5f;
		material.density = 500.0f;
		SoftBody* const cube = world.add(
			test::boxTemplate( { 0.12f, 0.12f, 0.12f }, 0.04f ), btVector3( btScalar( -0.6 ), btScalar( 0.3 ), 0 ), material );
		EXPECT_TRUE( cube->setVelocities( btVector3( 6, 1, 0 ), btVector3( 0, 0, 0 ) ).ok() );
		double fastest = 0.0;
		for ( int frame = 0; frame < rate; ++frame )
		{
			step();
			fastest = std::max( fastest, double( block->getLinearVelocity().length() ) );
		}
		std::printf( "1/%d s: the block moves at %.3f m/s\n", rate, fastest );
		EXPECT_LT( fastest, 0.15 );
		world.world.removeConstraint( &joint );
	}
}

// Where only what had been learnt of the joint was known, the foot sank by 13 cm. A member that rests is linked with the one that is hit,
// whichever was made first.
TEST( JointedFigures, AFootDoesNotSinkUnderTheRodThatFallsOver )
{
	for ( const bool isFootFirst : { true, false } )
	{
		test::SoftWorld world;
		world.addBoxFloor();
		Material material;
		material.youngsModulus = 1e9f;
		material.density = 1000.0f;
		ASSERT_TRUE( world.add( test::boxTemplate( { 3.0f, 0.2f, 1.0f }, 0.05f ), btVector3( 0, btScalar( 0.1 ), 0 ), material ) );
		btRigidBody *foot = nullptr, *rod = nullptr;
		for ( const bool makesFoot : { isFootFirst, !isFootFirst } )
		{
			const btVector3 halves = makesFoot ? btVector3( btScalar( 0.1 ), btScalar( 0.05 ), btScalar( 0.1 ) )
											   : btVector3( btScalar( 0.04 ), btScalar( 0.5 ), btScalar( 0.04 ) );
			btRigidBody* const body = world.add(
				makesFoot ? 2 : 50, new btBoxShape( halves ), btVector3( 0, btScalar( makesFoot ? 0.25 : 0.85 ), 0 ) );
			( makesFoot ? foot : rod ) = body;
		}
		btPoint2PointConstraint joint( *foot, *rod, btVector3( 0, btScalar( 0.1 ), 0 ), btVector3( 0, btScalar( -0.5 ), 0 ) );
		world.world.addConstraint( &joint, true );
		rod->setAngularVelocity( btVector3( 0, 0, -2 ) );
		rod->setLinearVelocity( btVector3( 1, 0, 0 ) );
		double lowest = 1.0;
		for ( int frame = 0; frame < 60; ++frame )
		{
			world.world.stepSimulation( btScalar( 1 ) / 30, 0 );
			lowest = std::min( lowest, double( foot->getWorldTransform().getOrigin().y() ) );
		}
		std::printf( "%s first: the foot sinks by %.4f m\n", isFootFirst ? "foot" : "rod", 0.25 - lowest );
		EXPECT_LT( 0.25 - lowest, 0.05 );
		world.world.removeConstraint( &joint );
	}
}

} // namespace
} // namespace pliant
