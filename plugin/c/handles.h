#pragma once

// The objects behind the handles of the C face, and their lookup by identity.
//
// A soft body's identity is twice its serial number in its world: that is in order of joining, part of snapshots, and found by bisection.
// All other objects have odd identities, given when they are made or first seen.

#include "c/call.h"
#include "pliant/body_template.h"
#include "pliant/c/body.h"
#include "pliant/c/types.h"
#include "pliant/soft_body_world.h"

#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>
#include <BulletCollision/CollisionDispatch/btDefaultCollisionConfiguration.h>
#include <BulletCollision/CollisionShapes/btTriangleIndexVertexArray.h>
#include <BulletDynamics/ConstraintSolver/btGeneric6DofSpring2Constraint.h>
#include <BulletDynamics/ConstraintSolver/btSequentialImpulseConstraintSolver.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <cstddef>
#include <memory>
#include <unordered_map>
#include <vector>

struct pliant_buffer
{
	std::vector<std::byte> bytes;
};

struct pliant_template
{
	std::shared_ptr<const pliant::BodyTemplate> shared;
};

namespace pliant::c {

/// A rigid body that C has made. The body is destroyed before its shape, and that before the arrays that it reads.
struct RigidBody
{
	std::vector<btScalar> positions;
	std::vector<int> indices;
	std::unique_ptr<btTriangleIndexVertexArray> triangles;
	std::unique_ptr<btCollisionShape> shape;
	std::unique_ptr<btRigidBody> body;
};

/// A world of Bullet with all that it needs.
struct WholeWorld
{
	btDefaultCollisionConfiguration configuration;
	btCollisionDispatcher dispatcher{ &configuration };
	btDbvtBroadphase broadphase;
	btSequentialImpulseConstraintSolver solver;
	SoftBodyWorld world{ &dispatcher, &broadphase, &solver, &configuration };
};

/// A joint that C has made.
struct Joint
{
	std::unique_ptr<btGeneric6DofSpring2Constraint> constraint;
	const btRigidBody* first = nullptr;
	const btRigidBody* second = nullptr; ///< null: the world
	int kind = 0;                        ///< PLIANT_JOINT_...
	double motorVelocity = 0.0, motorForce = 0.0;
};

struct Other
{
	btCollisionObject* object = nullptr;
	std::unique_ptr<RigidBody> made; ///< null for objects made through C++
};

} // namespace pliant::c

struct pliant_world
{
	std::unique_ptr<pliant::c::WholeWorld> whole; ///< null for a wrapped one
	pliant::SoftBodyHost* host = nullptr;
	std::unordered_map<const pliant::SoftBody*, std::unique_ptr<pliant::SoftBody>> madeSoft;
	std::unordered_map<pliant_id, pliant::c::Other> others;
	std::unordered_map<const btCollisionObject*, pliant_id> idsOfOthers;
	std::unordered_map<pliant_id, std::unique_ptr<pliant::c::Joint>> joints;
	pliant_id lastOther = 1;                          ///< identity last given to a joint or an object that is no soft body
	std::unique_ptr<pliant::Wind> wind;               ///< null: none
	std::unique_ptr<pliant::Water> water;             ///< null: none
	std::unique_ptr<pliant::ForceField> acceleration; ///< null: none
	/// Soft bodies destroyed through C that FractureEvents of the last step may still point to.
	std::vector<const pliant::SoftBody*> destroyed;

	~pliant_world();
};

namespace pliant::c {

/// The soft body of an identity; null where there is none.
SoftBody* softBody( const pliant_world& world, pliant_id id );
/// The object of an identity, of any kind; null where there is none.
btCollisionObject* object( const pliant_world& world, pliant_id id );
/// The rigid body of an identity; null where there is none.
btRigidBody* rigidBody( const pliant_world& world, pliant_id id );
/// The identity of an object of the world, given to it where it has none; 0 for null.
pliant_id identityOf( pliant_world& world, const btCollisionObject* object );
pliant_id identityOf( const SoftBody& body );
/// The same for a soft body that a FractureEvent points to; 0 where it has been destroyed since.
pliant_id identityInEvent( const pliant_world& world, const SoftBody* body );

/// The settings that concern a body's membership of the world: the defaults for null.
pliant_body_settings takeMembership( const pliant_body_settings* given );
/// Adds a body to the world, which then owns it; writes its identity.
void addMade( pliant_world& world, std::unique_ptr<SoftBody> body, const pliant_body_settings& full, pliant_id& made );

/// Ends the joints at an object before it is destroyed; null: all joints.
void endJoints( pliant_world& world, const btCollisionObject* at );

/// Destroys a frame and its joints.
void destroyFrame( pliant_world& world, pliant_id frame );

/// Rejects an identity that names no object of the required kind, for its reason.
[[noreturn]] void rejectIdentity( const pliant_world* world, pliant_id id, const char* kind );

/// Calls `work( SoftBody& )`.
template <class F>
pliant_result withSoft( const pliant_world* world, pliant_id body, F&& work ) noexcept
{
	return call( [&]() {
		SoftBody* const soft = world ? softBody( *world, body ) : nullptr;
		if ( !soft )
		{
			rejectIdentity( world, body, "soft body" );
		}
		return work( *soft );
	} );
}

inline void requireNode( const SoftBody& body, int node )
{
	rejectIf( node < 0 || node >= body.nodeCount(), PLIANT_BAD_ARGUMENT, "The body has no node of this index." );
}

/// Calls `work( btRigidBody& )`.
template <class F>
pliant_result withRigid( const pliant_world* world, pliant_id rigid, F&& work ) noexcept
{
	return call( [&]() {
		btRigidBody* const body = world ? rigidBody( *world, rigid ) : nullptr;
		if ( !body )
		{
			rejectIdentity( world, rigid, "rigid body" );
		}
		return work( *body );
	} );
}

/// Calls `work( btCollisionObject& )`.
template <class F>
pliant_result withObject( const pliant_world* world, pliant_id id, F&& work ) noexcept
{
	return call( [&]() {
		btCollisionObject* const found = world ? object( *world, id ) : nullptr;
		if ( !found )
		{
			rejectIdentity( world, id, "object" );
		}
		return work( *found );
	} );
}

/// Calls `work( SoftBodyHost& )`.
template <class F>
pliant_result withWorld( const pliant_world* world, F&& work ) noexcept
{
	return call( [&]() {
		requirePointers( world );
		return work( *world->host );
	} );
}

} // namespace pliant::c
