// ContactSolver is bit-identical to Bullet's solver: in heaps, with static, driven and pinned bodies, restitution, anisotropic and rolling
// friction, joints, and in modes that it delegates to Bullet.

#include "support/explicit_material.h"
#include "support/test_world.h"

#include "pliant/contact_solver.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <map>
#include <memory>

namespace pliant::test {
namespace {

using Change = std::function<void( SoftWorld& )>;

/// Soft cubes and rigid boxes that fall on each other and on a floor, and come to rest.
struct Heap
{
	std::unique_ptr<btConstraintSolver> solver; // outlives the world
	SoftWorld scene;

	Heap( std::unique_ptr<btConstraintSolver> made, const Change& change ) : solver( std::move( made ) )
	{
		scene.world.setConstraintSolver( solver.get() );
		scene.addBoxFloor();
		const auto cube = cubeTemplate( 0.6f, 4 );
		Material material = test::explicitMaterial();
		material.youngsModulus = 3e4f;
		for ( int i = 0; i < 5; ++i )
		{
			scene.add( cube, btVector3( btScalar( 0.25 * ( i % 2 ) ), btScalar( 0.4 + 0.7 * i ), btScalar( 0.2 * ( i % 3 ) ) ), material );
		}
		for ( int i = 0; i < 6; ++i )
		{
			const btScalar half = btScalar( 0.12 );
			scene.add( 5, new btBoxShape( btVector3( half, half, half ) ),
				btVector3( btScalar( 0.3 * ( i % 3 ) - 0.2 ), btScalar( 1 + 0.5 * i ), btScalar( 0.2 * ( i % 2 ) ) ) );
		}
		change( scene );
	}
};

void expectSameBits( Heap& one, Heap& other )
{
	for ( int b = 0; b < one.scene.world.softBodyCount(); ++b )
	{
		SoftBody &a = *one.scene.world.softBody( b ), &c = *other.scene.world.softBody( b );
		for ( int i = 0; i < a.nodeCount(); ++i )
		{
			ASSERT_EQ( a.nodePosition( i ), c.nodePosition( i ) ) << "node " << i << " of " << b;
			ASSERT_EQ( a.nodeVelocity( i ), c.nodeVelocity( i ) ) << "node " << i << " of " << b;
		}
	}
	for ( std::size_t i = 0; i < one.scene.rigid.size(); ++i )
	{
		ASSERT_EQ( one.scene.rigid[i]->getWorldTransform(), other.scene.rigid[i]->getWorldTransform() ) << "box " << i;
	}
	ASSERT_EQ( one.scene.dispatcher.getNumManifolds(), other.scene.dispatcher.getNumManifolds() );
	for ( int m = 0; m < one.scene.dispatcher.getNumManifolds(); ++m )
	{
		const btPersistentManifold &a = *one.scene.dispatcher.getManifoldByIndexInternal( m ),
								   &c = *other.scene.dispatcher.getManifoldByIndexInternal( m );
		ASSERT_EQ( a.getNumContacts(), c.getNumContacts() );
		for ( int k = 0; k < a.getNumContacts(); ++k )
		{
			ASSERT_EQ( a.getContactPoint( k ).m_appliedImpulse, c.getContactPoint( k ).m_appliedImpulse );
			ASSERT_EQ( a.getContactPoint( k ).m_appliedImpulseLateral1, c.getContactPoint( k ).m_appliedImpulseLateral1 );
		}
	}
}

void compare( const Change& change, int frames = 90, int contacts = 60 )
{
	Heap bullets( std::make_unique<btSequentialImpulseConstraintSolver>(), change ), ours( std::make_unique<ContactSolver>(), change );
	int most = 0;
	for ( int frame = 0; frame < frames; ++frame )
	{
		bullets.scene.step( 1 );
		ours.scene.step( 1 );
		ASSERT_NO_FATAL_FAILURE( expectSameBits( bullets, ours ) ) << "frame " << frame;
		most = std::max( most, ours.scene.world.stepReport().softContacts );
	}
	EXPECT_GT( most, contacts );
}

TEST( ContactSolver, EqualsBulletsInAHeap )
{
	compare( []( SoftWorld& ) {} );
}

/// Contacts between bodies in free flight, whose nodes rotate with their bodies.
TEST( ContactSolver, EqualsBulletsWithFrictionInFreeFlight )
{
	compare(
		[]( SoftWorld& scene ) {
			scene.world.setGravity( btVector3( 0, 0, 0 ) );
			for ( int b = 0; b < scene.world.softBodyCount(); ++b )
			{
				SoftBody& body = *scene.world.softBody( b );
				body.setFriction( btScalar( 0.9 ) );
				body.setRestitution( btScalar( 0.3 * ( b % 2 ) ) );
				EXPECT_TRUE(
					body.setVelocities( btVector3( 0, btScalar( 2 - b ), 0 ), btVector3( btScalar( b ), btScalar( 6 - 4 * b ), 1 ) ).ok() );
			}
		},
		40, 20 );
}

TEST( ContactSolver, EqualsBulletsWithRestitutionAndAnisotropicFriction )
{
	compare( []( SoftWorld& scene ) {
		for ( int b = 0; b < scene.world.softBodyCount(); ++b )
		{
			scene.world.softBody( b )->setRestitution( btScalar( 0.6 ) );
			scene.world.softBody( b )->setAnisotropicFriction( btVector3( btScalar( 0.2 ), 1, 1 ) );
		}
		for ( auto& box : scene.rigid )
		{
			box->setRestitution( btScalar( 0.8 ) );
		}
	} );
}

TEST( ContactSolver, EqualsBulletsWithHeldAndDrivenBodies )
{
	compare( []( SoftWorld& scene ) {
		EXPECT_TRUE( scene.world.softBody( 0 )->pinNode( 3 ).ok() );
		EXPECT_TRUE( scene.world.softBody( 2 )->pinNode( 0 ).ok() );
		btRigidBody* const driven = scene.rigid[1].get();
		driven->setCollisionFlags( driven->getCollisionFlags() | btCollisionObject::CF_KINEMATIC_OBJECT );
		driven->setLinearVelocity( btVector3( 0, btScalar( -0.5 ), 0 ) );
		scene.rigid[2]->setLinearFactor( btVector3( 1, 1, 0 ) );
		scene.rigid[3]->setAngularFactor( btVector3( 0, 0, 0 ) );
		scene.rigid[4]->setAngularFactor( btVector3( 0, 0, 0 ) );
		scene.rigid[4]->setLinearFactor( btVector3( 0, 1, 1 ) );
	} );
}

TEST( ContactSolver, EqualsBulletsWithStiffContactsAndRolling )
{
	compare( []( SoftWorld& scene ) {
		scene.world.softBody( 1 )->setContactStiffnessAndDamping( 1000, 10 );
		scene.world.softBody( 3 )->setRollingFriction( btScalar( 0.01 ) );
		scene.rigid[2]->setRollingFriction( btScalar( 0.02 ) );
		scene.rigid[3]->setRollingFriction( btScalar( 0.02 ) );
	} );
}

TEST( ContactSolver, EqualsBulletsInOtherModes )
{
	for ( const int mode : { int( SOLVER_USE_2_FRICTION_DIRECTIONS ), int( SOLVER_RANDMIZE_ORDER ),
			  int( SOLVER_INTERLEAVE_CONTACT_AND_FRICTION_CONSTRAINTS ) } )
	{
		compare( [mode]( SoftWorld& scene ) { scene.world.getSolverInfo().m_solverMode |= mode; }, 60 );
	}
	compare( []( SoftWorld& scene ) { scene.world.getSolverInfo().m_splitImpulse = false; }, 60 );
	compare( []( SoftWorld& scene ) { scene.world.getSolverInfo().m_leastSquaresResidualThreshold = btScalar( 1e-3 ); }, 60 );
	compare( []( SoftWorld& scene ) { scene.world.getSolverInfo().m_solverMode &= ~SOLVER_USE_WARMSTARTING; }, 60 );
}

TEST( ContactSolver, EqualsBulletsWherePenetrationIsPushedOut )
{
	// Default settings use split impulses only beyond 4 cm.
	compare( []( SoftWorld& scene ) {
		scene.world.getSolverInfo().m_splitImpulsePenetrationThreshold = 0;
		scene.rigid[0]->setMassProps( 200, btVector3( 2, 2, 2 ) );
		scene.world.softBody( 2 )->setAnisotropicFriction( btVector3( btScalar( 0.2 ), 1, 1 ) );
		EXPECT_TRUE( scene.world.softBody( 1 )->pinNode( 5 ).ok() );
	} );
}

TEST( ContactSolver, EqualsBulletsWithSoftAnchoredContacts )
{
	for ( const int mode : { 0, int( SOLVER_USE_2_FRICTION_DIRECTIONS ),
			  int( SOLVER_USE_2_FRICTION_DIRECTIONS ) | int( SOLVER_DISABLE_VELOCITY_DEPENDENT_FRICTION_DIRECTION ) } )
	{
		compare(
			[mode]( SoftWorld& scene ) {
				btContactSolverInfo& info = scene.world.getSolverInfo();
				info.m_solverMode |= mode;
				info.m_sor = btScalar( 0.9 );
				info.m_globalCfm = btScalar( 1e-5 );
				info.m_erp2 = btScalar( 0.3 );
				info.m_linearSlop = btScalar( 1e-3 );
				info.m_warmstartingFactor = btScalar( 0.6 );
				scene.rigid[2]->setCollisionFlags( scene.rigid[2]->getCollisionFlags() | btCollisionObject::CF_HAS_FRICTION_ANCHOR );
				scene.rigid[2]->setGravity( btVector3( 1, -10, 0 ) );
				SoftBody& soft = *scene.world.softBody( 2 );
				soft.setCollisionFlags( soft.getCollisionFlags() | btCollisionObject::CF_HAS_FRICTION_ANCHOR );
			},
			60 );
	}
}

/// Installs a callback during its lifetime.
struct Callback
{
	explicit Callback( ContactAddedCallback callback ) { gContactAddedCallback = callback; }
	~Callback() { gContactAddedCallback = nullptr; }
};

void requestCallbacks( SoftWorld& scene )
{
	for ( int b = 0; b < scene.world.softBodyCount(); ++b )
	{
		SoftBody& soft = *scene.world.softBody( b );
		soft.setCollisionFlags( soft.getCollisionFlags() | btCollisionObject::CF_CUSTOM_MATERIAL_CALLBACK );
	}
}

TEST( ContactSolver, EqualsBulletsOnBelts )
{
	const Callback belts(
		[]( btManifoldPoint& point, const btCollisionObjectWrapper*, int, int, const btCollisionObjectWrapper*, int, int ) {
			btPlaneSpace1( point.m_normalWorldOnB, point.m_lateralFrictionDir1, point.m_lateralFrictionDir2 );
			point.m_contactPointFlags |= BT_CONTACT_FLAG_LATERAL_FRICTION_INITIALIZED | BT_CONTACT_FLAG_HAS_CONTACT_CFM |
				BT_CONTACT_FLAG_HAS_CONTACT_ERP;
			point.m_contactMotion1 = btScalar( 0.5 );
			point.m_contactMotion2 = btScalar( -0.2 );
			point.m_frictionCFM = btScalar( 0.01 );
			point.m_contactCFM = btScalar( 1e-4 );
			point.m_contactERP = btScalar( 0.15 );
			return true;
		} );
	for ( const int mode : { 0, int( SOLVER_ENABLE_FRICTION_DIRECTION_CACHING ),
			  int( SOLVER_ENABLE_FRICTION_DIRECTION_CACHING ) | int( SOLVER_USE_2_FRICTION_DIRECTIONS ) } )
	{
		compare(
			[mode]( SoftWorld& scene ) {
				scene.world.getSolverInfo().m_solverMode |= mode;
				requestCallbacks( scene );
			},
			60 );
	}
}

btRigidBody* bodyOf( const btCollisionObjectWrapper* wrapper )
{
	return btRigidBody::upcast( const_cast<btCollisionObject*>( wrapper->getCollisionObject() ) );
}

TEST( ContactSolver, EqualsBulletsWithCallbacksThatPushNodes )
{
	{
		const Callback strikes(
			[]( btManifoldPoint&, const btCollisionObjectWrapper* one, int, int index, const btCollisionObjectWrapper*, int, int ) {
				if ( index % 7 == 3 )
				{
					bodyOf( one )->applyCentralImpulse( btVector3( btScalar( 1e-3 ), btScalar( 2e-3 ), 0 ) );
				}
				return true;
			} );
		compare( requestCallbacks, 60 );
	}
	// A contact proxy with forces on it is unsupported: the island is solved by Bullet.
	const Callback pushes(
		[]( btManifoldPoint&, const btCollisionObjectWrapper* one, int, int index, const btCollisionObjectWrapper*, int, int ) {
			btRigidBody& body = *bodyOf( one );
			if ( index % 17 == 3 && body.getTotalForce().isZero() )
			{
				body.applyCentralForce( btVector3( btScalar( 0.1 ), 0, 0 ) );
			}
			return true;
		} );
	compare( requestCallbacks, 60 );
}

// Forces on a contact proxy are cleared after the step, as the world does for its bodies; the proxy may serve another node later.
TEST( ContactCallbacks, ForcesOnNodesEndWithTheStep )
{
	static std::map<const btRigidBody*, int> frameOf; // frame in which each proxy was last seen
	static int frame, left, pushes;
	frameOf.clear();
	frame = left = pushes = 0;
	const Callback pushAll(
		[]( btManifoldPoint&, const btCollisionObjectWrapper* one, int, int, const btCollisionObjectWrapper*, int, int ) {
			btRigidBody& body = *bodyOf( one );
			int& last = frameOf[&body];
			if ( body.getInvMass() > 0 && last != frame )
			{
				left += last == frame - 1 && !body.getTotalForce().isZero() ? 1 : 0;
				last = frame;
				++pushes;
				body.applyCentralForce( btVector3( btScalar( 1e-3 ), 0, 0 ) );
			}
			return true;
		} );
	Heap heap( std::make_unique<ContactSolver>(), requestCallbacks );
	for ( frame = 1; frame < 60; ++frame )
	{
		heap.scene.step( 1 );
	}
	EXPECT_GT( pushes, 1000 );
	EXPECT_EQ( left, 0 );
}

/// Counts Bullet's rows for contacts.
class CountingSolver : public ContactSolver
{
public:
	int most = 0;

protected:
	btScalar solveSingleIteration( int iteration, btCollisionObject** bodies, int bodyCount, btPersistentManifold** manifolds,
		int manifoldCount, btTypedConstraint** joints, int jointCount, const btContactSolverInfo& info, btIDebugDraw* drawer ) override
	{
		most = std::max( most, m_tmpSolverContactConstraintPool.size() );
		return ContactSolver::solveSingleIteration(
			iteration, bodies, bodyCount, manifolds, manifoldCount, joints, jointCount, info, drawer );
	}
};

TEST( ContactSolver, NodesTakeNoRowsOfBullet )
{
	auto made = std::make_unique<CountingSolver>();
	const CountingSolver& solver = *made;
	Heap heap( std::move( made ), []( SoftWorld& ) {} );
	int contacts = 0;
	for ( int frame = 0; frame < 90; ++frame )
	{
		heap.scene.step( 1 );
		contacts = std::max( contacts, heap.scene.world.stepReport().softContacts );
	}
	EXPECT_GT( contacts, 60 );
	EXPECT_LT( solver.most, 40 ); // six boxes among themselves and on the floor
}

TEST( ContactSolver, EqualsBulletsWithJoints )
{
	btPoint2PointConstraint* joints[2] = {};
	int made = 0;
	compare( [&]( SoftWorld& scene ) {
		joints[made] = new btPoint2PointConstraint(
			*scene.rigid[1], *scene.rigid[2], btVector3( 0, btScalar( 0.25 ), 0 ), btVector3( 0, btScalar( -0.25 ), 0 ) );
		scene.world.addConstraint( joints[made++] );
	} );
	// The worlds are destroyed by now; they do not own joints.
	delete joints[0];
	delete joints[1];
}

} // namespace
} // namespace pliant::test
