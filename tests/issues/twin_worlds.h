#pragma once

// Worlds for scenes that are compared with a rigid version: the same rigid bodies in Bullet's world and in ours.

#include "world/test_world.h"

#include <BulletCollision/CollisionDispatch/btGhostObject.h>

namespace pliant::test {

/// Bullet's own world with Bullet's own parts; it outlives its contents.
struct BulletWorld
{
	BulletParts parts;
	btDiscreteDynamicsWorld world{ &parts.dispatcher, &parts.broadphase, &parts.solver, &parts.configuration };
};

/// The rigid bodies of one scene, in any world.
class RigidScene
{
public:
	explicit RigidScene( btDiscreteDynamicsWorld& world ) : m_world( world ) {}
	~RigidScene()
	{
		for ( const auto& joint : m_joints )
		{
			m_world.removeConstraint( joint.get() );
		}
		for ( const auto& body : m_bodies )
		{
			m_world.removeRigidBody( body.get() );
		}
	}
	RigidScene( const RigidScene& ) = delete;
	RigidScene& operator=( const RigidScene& ) = delete;

	btRigidBody* add( btScalar mass, btCollisionShape* shape, const btTransform& where )
	{
		m_shapes.emplace_back( shape );
		btVector3 inertia( 0, 0, 0 );
		if ( mass > 0 )
		{
			shape->calculateLocalInertia( mass, inertia );
		}
		btRigidBody::btRigidBodyConstructionInfo info( mass, nullptr, shape, inertia );
		info.m_startWorldTransform = where;
		m_bodies.push_back( std::make_unique<btRigidBody>( info ) );
		m_world.addRigidBody( m_bodies.back().get() );
		return m_bodies.back().get();
	}
	btRigidBody* addBox( btScalar mass, const btVector3& half, const btTransform& where )
	{
		return add( mass, new btBoxShape( half ), where );
	}
	btRigidBody* addFloor() { return addBox( 0, btVector3( 50, 1, 50 ), at( 0, -1, 0 ) ); }
	/// A kinematic box as games create it: with the flag in addition to the initial static one.
	btRigidBody* addKinematic( const btVector3& half, const btTransform& where )
	{
		btRigidBody* const body = addBox( 0, half, where );
		body->setCollisionFlags( body->getCollisionFlags() | btCollisionObject::CF_KINEMATIC_OBJECT );
		body->setActivationState( DISABLE_DEACTIVATION );
		return body;
	}
	template <class Joint>
	Joint* join( Joint* joint )
	{
		m_joints.emplace_back( joint );
		m_world.addConstraint( joint );
		return joint;
	}
	const std::vector<std::unique_ptr<btRigidBody>>& bodies() const { return m_bodies; }

private:
	btDiscreteDynamicsWorld& m_world;
	std::vector<std::unique_ptr<btCollisionShape>> m_shapes;
	std::vector<std::unique_ptr<btRigidBody>> m_bodies;
	std::vector<std::unique_ptr<btTypedConstraint>> m_joints;
};

/// A material for explicit or implicit stepping.
inline Material stepping( Elasticity elasticity, float youngsModulus )
{
	Material material = stiff( youngsModulus );
	material.elasticity = elasticity;
	return material;
}

} // namespace pliant::test
