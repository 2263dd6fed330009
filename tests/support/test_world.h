#pragma once

// A world for tests and benchmarks that destroys everything in it in a valid order.

#include "pliant/soft_body_world.h"

#include <btBulletDynamicsCommon.h>

#include <array>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace pliant::test {

/// A box around the origin, with cells of `cell` m.
inline std::shared_ptr<const BodyTemplate> boxTemplate( const std::array<float, 3>& edges, float cell, const CrackSettings& cracks = {} )
{
	std::vector<float> positions;
	for ( int i = 0; i < 8; ++i )
	{
		for ( std::size_t k = 0; k < 3; ++k )
		{
			positions.push_back( edges[k] * ( float( i >> k & 1 ) - 0.5f ) );
		}
	}
	static const std::uint32_t indices[36] = {
		0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5 };
	MeshView mesh;
	mesh.positions = positions.data();
	mesh.vertexCount = 8;
	mesh.indices = indices;
	mesh.triangleCount = 12;
	LatticeSettings settings;
	settings.cellSize = cell;
	settings.cracks = cracks;
	return BodyTemplate::build( mesh, settings ).value;
}

/// A cube with edge `edge` m around the origin, `cells` cells along it.
inline std::shared_ptr<const BodyTemplate> cubeTemplate( float edge, int cells, const CrackSettings& cracks = {} )
{
	return boxTemplate( { edge, edge, edge }, edge / float( cells ), cracks );
}

template <class World>
struct WorldOf
{
	btDefaultCollisionConfiguration configuration;
	btCollisionDispatcher dispatcher{ &configuration };
	btDbvtBroadphase broadphase;
	btSequentialImpulseConstraintSolver solver;
	World world{ &dispatcher, &broadphase, &solver, &configuration };
	std::vector<std::unique_ptr<btCollisionShape>> shapes;
	std::vector<std::unique_ptr<btRigidBody>> rigid;

	WorldOf() { world.setGravity( btVector3( 0, btScalar( -9.81 ), 0 ) ); }
	~WorldOf()
	{
		for ( auto& body : rigid )
		{
			world.removeRigidBody( body.get() );
		}
	}

	/// Mass 0: static.
	btRigidBody* add( btScalar mass, btCollisionShape* shape, const btVector3& at )
	{
		shapes.emplace_back( shape );
		btVector3 inertia( 0, 0, 0 );
		if ( mass > 0 )
		{
			shape->calculateLocalInertia( mass, inertia );
		}
		rigid.push_back( std::make_unique<btRigidBody>( btRigidBody::btRigidBodyConstructionInfo( mass, nullptr, shape, inertia ) ) );
		const btTransform transform( btQuaternion::getIdentity(), at );
		rigid.back()->setWorldTransform( transform );
		rigid.back()->setInterpolationWorldTransform( transform );
		world.addRigidBody( rigid.back().get() );
		return rigid.back().get();
	}
	btRigidBody* addFloor() { return add( 0, new btStaticPlaneShape( btVector3( 0, 1, 0 ), 0 ), btVector3( 0, 0, 0 ) ); }
	btRigidBody* addBoxFloor() { return add( 0, new btBoxShape( btVector3( 20, 1, 20 ) ), btVector3( 0, -1, 0 ) ); }

	void step( int frames )
	{
		for ( int i = 0; i < frames; ++i )
		{
			world.stepSimulation( btScalar( 1 ) / 60, 0 );
		}
	}
};

struct SoftWorld : WorldOf<SoftBodyWorld>
{
	std::vector<std::unique_ptr<SoftBody>> soft;

	~SoftWorld()
	{
		for ( auto& body : soft )
		{
			world.removeSoftBody( body.get() );
		}
	}
	SoftBody* add( std::shared_ptr<const BodyTemplate> bodyTemplate, const btVector3& at, const Material& material = {},
		const btQuaternion& turn = btQuaternion::getIdentity(), const Adaptivity& adaptivity = {} )
	{
		SoftBodyResult made = SoftBody::create( std::move( bodyTemplate ), btTransform( turn, at ), material, adaptivity );
		if ( !made )
		{
			return nullptr;
		}
		soft.push_back( std::move( made.value ) );
		world.addSoftBody( soft.back().get() );
		return soft.back().get();
	}
	using WorldOf<SoftBodyWorld>::add;
};

} // namespace pliant::test
