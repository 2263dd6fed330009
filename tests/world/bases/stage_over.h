#pragma once

// A world over one of Bullet's, with a floor and the objects of a test.

#include "support/bullet_worlds.h"
#include "support/explicit_material.h"
#include "world/test_world.h"

namespace pliant::test {

/// The floor's top is at y = 0. `Parts`: as PartsOf.
template <class Base, class Parts = PartsOf<Base>>
struct StageOver
{
	using World = SoftBodyWorldOver<Base>;

	StageOver() { addBox( 0, btVector3( 50, 1, 50 ), at( 0, -1, 0 ) ); }
	~StageOver()
	{
		soft.clear();
		for ( const auto& body : rigid )
		{
			world->removeRigidBody( body.get() );
		}
	}
	btRigidBody* addBox( btScalar mass, const btVector3& half, const btTransform& where )
	{
		shapes.push_back( std::make_unique<btBoxShape>( half ) );
		btVector3 inertia( 0, 0, 0 );
		shapes.back()->calculateLocalInertia( mass, inertia );
		btRigidBody::btRigidBodyConstructionInfo info( mass, nullptr, shapes.back().get(), inertia );
		info.m_startWorldTransform = where;
		rigid.push_back( std::make_unique<btRigidBody>( info ) );
		world->addRigidBody( rigid.back().get() );
		return rigid.back().get();
	}
	SoftBody* addCube( const btTransform& where, const Material& material, const Fracture& fracture = {} )
	{
		SoftBodyResult made = SoftBody::create( block( 4, 4, 4, 0.25f ), where, material );
		EXPECT_TRUE( made.ok() ) << made.status.sentence;
		EXPECT_TRUE( made.value->setFracture( fracture ).ok() );
		soft.push_back( std::move( made.value ) );
		world->addSoftBody( soft.back().get() );
		return soft.back().get();
	}
	void run( int frames )
	{
		for ( int frame = 0; frame < frames; ++frame )
		{
			world->stepSimulation( kFrame, 1, kFrame );
		}
	}

	Parts parts;
	std::unique_ptr<World> world = parts.template make<World>();
	std::vector<std::unique_ptr<btCollisionShape>> shapes;
	std::vector<std::unique_ptr<btRigidBody>> rigid;
	std::vector<std::unique_ptr<SoftBody>> soft;
};

/// Returns a material of 1 MPa.
inline Material materialOf( Elasticity elasticity )
{
	Material made = test::explicitMaterial();
	made.youngsModulus = 1e6f;
	made.elasticity = elasticity;
	return made;
}

} // namespace pliant::test
