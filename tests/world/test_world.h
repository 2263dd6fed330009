#pragma once

// A world for tests: Bullet's usual parts, a floor, boxes and soft blocks.

#include "support/explicit_material.h"
#include "support/test_world.h"

#include <pliant/soft_body_world.h>

#include <algorithm>
#include <array>

#include <btBulletDynamicsCommon.h>

#include <gtest/gtest.h>

#include <memory>
#include <vector>

namespace pliant::test {

constexpr btScalar kFrame = btScalar( 1 ) / 60;

inline btTransform at( btScalar x, btScalar y, btScalar z )
{
	return btTransform( btQuaternion::getIdentity(), btVector3( x, y, z ) );
}

/// A block of nx x ny x nz full cells about the origin, built from twelve triangles as a game would do.
inline std::shared_ptr<const BodyTemplate> block( int nx, int ny, int nz, float cell )
{
	std::shared_ptr<const BodyTemplate> made = boxTemplate( { cell * nx, cell * ny, cell * nz }, cell );
	EXPECT_NE( made, nullptr );
	EXPECT_EQ( made->cellCount(), nx * ny * nz );
	return made;
}

inline Material stiff( float youngsModulus )
{
	Material material = test::explicitMaterial();
	material.youngsModulus = youngsModulus;
	return material;
}

/// The same for the implicit step.
inline Material implicit( float youngsModulus, int halfWidth = 1 )
{
	Material material = stiff( youngsModulus );
	material.elasticity = Elasticity::Implicit;
	material.regionHalfWidth = halfWidth;
	return material;
}

constexpr double kGravity = 10.0; // the world's gravity, m/s^2

struct BulletParts
{
	btDefaultCollisionConfiguration configuration;
	btCollisionDispatcher dispatcher{ &configuration };
	btDbvtBroadphase broadphase;
	btSequentialImpulseConstraintSolver solver;
};

class TestWorld
{
public:
	TestWorld() : world( &parts.dispatcher, &parts.broadphase, &parts.solver, &parts.configuration ) {}
	~TestWorld()
	{
		soft.clear(); // bodies leave a living world by themselves
		for ( const auto& body : rigid )
		{
			world.removeRigidBody( body.get() );
		}
	}

	btRigidBody* add( btScalar mass, btCollisionShape* shape, const btTransform& where )
	{
		shapes.emplace_back( shape );
		btVector3 inertia( 0, 0, 0 );
		if ( mass > 0 )
		{
			shape->calculateLocalInertia( mass, inertia );
		}
		btRigidBody::btRigidBodyConstructionInfo info( mass, nullptr, shape, inertia );
		info.m_startWorldTransform = where;
		rigid.push_back( std::make_unique<btRigidBody>( info ) );
		world.addRigidBody( rigid.back().get() );
		return rigid.back().get();
	}
	btRigidBody* addBox( btScalar mass, const btVector3& half, const btTransform& where )
	{
		return add( mass, new btBoxShape( half ), where );
	}
	/// The top is at height y.
	btRigidBody* addFloor( btScalar y = 0 ) { return addBox( 0, btVector3( 10, 1, 10 ), at( 0, y - 1, 0 ) ); }
	btRigidBody* addPlane( btScalar y = 0 )
	{
		return add( 0, new btStaticPlaneShape( btVector3( 0, 1, 0 ), y ), btTransform::getIdentity() );
	}

	SoftBody* addSoft( const std::shared_ptr<const BodyTemplate>& shape, const btTransform& where, const Material& material = stiff( 1e5f ),
		const Adaptivity& adaptivity = {} )
	{
		SoftBodyResult made = SoftBody::create( shape, where, material, adaptivity );
		EXPECT_TRUE( made.ok() ) << made.status.sentence;
		soft.push_back( std::move( made.value ) );
		world.addSoftBody( soft.back().get() );
		return soft.back().get();
	}

	void run( int frames )
	{
		for ( int k = 0; k < frames; ++k )
		{
			world.stepSimulation( kFrame, 0 );
		}
	}

	BulletParts parts;
	SoftBodyWorld world;
	std::vector<std::unique_ptr<btCollisionShape>> shapes;
	std::vector<std::unique_ptr<btRigidBody>> rigid;
	std::vector<std::unique_ptr<SoftBody>> soft;
};

inline btScalar lowestNode( const SoftBody& body )
{
	btScalar low = SIMD_INFINITY;
	for ( int i = 0; i < body.nodeCount(); ++i )
	{
		low = btMin( low, body.nodePosition( i ).y() );
	}
	return low;
}

/// The vertical distance from the lowest node of `body` to its highest, in metres.
inline btScalar heightOf( const SoftBody& body )
{
	btScalar high = -SIMD_INFINITY;
	for ( int i = 0; i < body.nodeCount(); ++i )
	{
		high = btMax( high, body.nodePosition( i ).y() );
	}
	return high - lowestNode( body );
}

/// Returns every drawn triangle, starting with its least corner, in a canonical order.
inline std::vector<std::array<float, 10>> trianglesOf( const SurfaceView& view )
{
	std::vector<std::array<float, 10>> all;
	for ( int t = 0; t < view.triangleCount; ++t )
	{
		std::array<std::array<float, 3>, 3> corner{};
		for ( std::size_t k = 0; k < 3; ++k )
		{
			const float* p = view.positions + 3 * std::size_t( view.indices[3 * std::size_t( t ) + k] );
			std::copy( p, p + 3, corner[k].begin() );
		}
		std::rotate( corner.begin(), std::min_element( corner.begin(), corner.end() ), corner.end() );
		all.push_back( { corner[0][0], corner[0][1], corner[0][2], corner[1][0], corner[1][1], corner[1][2], corner[2][0], corner[2][1],
			corner[2][2], view.triangleSource ? float( view.triangleSource[t] ) : float( t ) } );
	}
	std::sort( all.begin(), all.end() );
	return all;
}

} // namespace pliant::test
