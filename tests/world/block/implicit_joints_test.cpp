// Bullet's joints and its other solvers beside the implicit step.

#include "world/test_world.h"

#include <BulletDynamics/ConstraintSolver/btNNCGConstraintSolver.h>
#include <BulletDynamics/MLCPSolvers/btDantzigSolver.h>
#include <BulletDynamics/MLCPSolvers/btMLCPSolver.h>
#include <BulletDynamics/MLCPSolvers/btSolveProjectedGaussSeidel.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <vector>

namespace pliant {
namespace {

using test::at;
using test::block;
using test::implicit;
using test::TestWorld;

// The block takes up the impulses of Bullet's joints with a delay, but completely: a box of equal weight hangs from the one on the cube.
TEST( ImplicitBeside, AJointAddsToTheLoad )
{
	TestWorld t;
	t.addFloor();
	const double modulus = 6e6;
	SoftBody* cube = t.addSoft( block( 6, 6, 6, 0.1f ), at( 0, btScalar( 0.301 ), 0 ), implicit( float( modulus ) ) );
	btRigidBody* box = t.addBox( 5000, btVector3( 0.3f, 0.1f, 0.3f ), at( 0, btScalar( 0.702 ), 0 ) );
	btRigidBody* sides[2];
	std::vector<std::unique_ptr<btTypedConstraint>> joints;
	for ( int k = 0; k < 2; ++k )
	{
		const btScalar side = k == 0 ? btScalar( 1 ) : btScalar( -1 );
		sides[k] = t.addBox( 2500, btVector3( 0.1f, 0.1f, 0.1f ), at( side * btScalar( 0.6 ), btScalar( 0.5 ), 0 ) );
		joints.push_back( std::make_unique<btPoint2PointConstraint>(
			*box, *sides[k], btVector3( side * btScalar( 0.6 ), 0, 0 ), btVector3( 0, btScalar( 0.2 ), 0 ) ) );
		t.world.addConstraint( joints.back().get(), true );
	}
	cube->setActivationState( DISABLE_DEACTIVATION );
	box->setActivationState( DISABLE_DEACTIVATION );
	double most = 0.0;
	for ( int frame = 0; frame < 400; ++frame )
	{
		t.run( 1 );
		most = frame > 380 ? std::max( most, double( box->getLinearVelocity().length() ) ) : 0.0;
	}
	const double theory = ( 10000.0 + 108.0 ) * 10.0 / 0.36 / modulus, got = 1.0 - test::heightOf( *cube ) / 0.5;
	std::printf( "strain %.4f of %.4f, box at %.1e m/s\n", got, theory, most );
	EXPECT_NEAR( got / theory, 1.0, 0.03 );
	EXPECT_LT( most, 1e-3 );
	for ( const auto& joint : joints )
	{
		t.world.removeConstraint( joint.get() );
	}
}

// Bullet's solver handles joints and other islands; the block works together with any of Bullet's solvers.
TEST( ImplicitBeside, EverySolverOfBullet )
{
	btNNCGConstraintSolver conjugate;
	btDantzigSolver dantzig;
	btSolveProjectedGaussSeidel projected;
	btMLCPSolver pivoting( &dantzig ), relaxing( &projected );
	btConstraintSolver* const solvers[] = { nullptr, &conjugate, &pivoting, &relaxing };
	double bottom[4], hangs[4];
	for ( int k = 0; k < 4; ++k )
	{
		TestWorld t;
		if ( solvers[k] )
		{
			t.world.setConstraintSolver( solvers[k] );
		}
		t.addFloor();
		SoftBody* cube = t.addSoft( block( 6, 6, 6, 0.1f ), at( 0, btScalar( 0.301 ), 0 ), implicit( 6e6f ) );
		btRigidBody* box = t.addBox( 21600, btVector3( 0.3f, 0.3f, 0.3f ), at( 0, btScalar( 0.902 ), 0 ) );
		// It hangs from the box by a joint, without contacts.
		btRigidBody* hung = t.addBox( 5, btVector3( 0.1f, 0.1f, 0.1f ), at( btScalar( 0.6 ), btScalar( 0.9 ), 0 ) );
		btPoint2PointConstraint joint( *box, *hung, btVector3( btScalar( 0.5 ), 0, 0 ), btVector3( btScalar( -0.1 ), 0, 0 ) );
		t.world.addConstraint( &joint, true );
		t.addBox( 10, btVector3( 0.2f, 0.2f, 0.2f ), at( 3, btScalar( 0.21 ), 0 ) ); // an island that Bullet solves
		t.run( 400 );
		bottom[k] = double( box->getWorldTransform().getOrigin().y() ) - 0.3;
		hangs[k] = ( joint.getRigidBodyA().getWorldTransform() * joint.getPivotInA() )
					   .distance( hung->getWorldTransform() * joint.getPivotInB() );
		std::printf( "solver %d: box on the cube at %.4f m, joint open by %.1e m\n", k, bottom[k], hangs[k] );
		EXPECT_NEAR( bottom[k], 0.6 - 0.1 * 0.5, 0.01 ); // a tenth of five layers
		EXPECT_NEAR( bottom[k], bottom[0], 1e-3 );
		EXPECT_LT( hangs[k], 0.01 );
		EXPECT_GT( cube->massCentre().y(), btScalar( 0.2 ) );
		EXPECT_NEAR( t.rigid.back()->getWorldTransform().getOrigin().y(), 0.2, 0.01 );
		t.world.removeConstraint( &joint );
		t.world.setConstraintSolver( &t.parts.solver );
	}
}

} // namespace
} // namespace pliant
