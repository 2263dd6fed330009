#pragma once

// Which objects of a world take soft substeps in a game step: awake soft bodies that step explicitly, what touches them or may touch them
// within the step, and what is in an island with that or joined to it. Everything else takes the game step whole, as in Bullet's own world:
// a soft body changes nothing for what does not touch it.

#include "world/shape/contact_proxy.h"

#include <LinearMath/btAlignedObjectArray.h>

#include <vector>

class btCollisionWorld;
class btDiscreteDynamicsWorld;
class btTypedConstraint;

namespace pliant {

/// A pass over the step's stages: which objects it moves.
enum class StepPass
{
	Whole,   ///< by the whole game step
	Substeps ///< by one soft substep
};

class Attachments;

class SubstepGroup
{
public:
	struct Box
	{
		btVector3 low, high; ///< m
	};
	/// What an object that moves may sweep within a step of so many seconds.
	static Box sweptBox( const btCollisionObject& object, const btVector3& gravity, btScalar step );
	/// Whether an object is in the box that the broadphase has of it.
	static bool isInBox( const btCollisionObject& object );

	/// What the group is made from.
	struct Scene
	{
		const btDiscreteDynamicsWorld& world;
		const std::vector<SoftBody*>& soft;
		const btAlignedObjectArray<btRigidBody*>& rigid; ///< that are not static
		const btAlignedObjectArray<btTypedConstraint*>& constraints;
		const Attachments& attachments;
		bool canSplit; ///< else all that moves is in the group, or nothing
	};

	/// `substepped`: the awake soft bodies that step explicitly. Empty: so is the group. `gameStep` in s.
	void choose( const Scene& scene, const std::vector<SoftBody*>& substepped, btScalar gameStep );
	bool isEmpty() const { return m_isEmpty; }
	/// Objects that move are outside the group as well as in it.
	bool isSplit() const { return m_isSplit; }

	/// Of the object itself, or of the soft body behind a node's body. False for static and kinematic objects.
	bool contains( const btCollisionObject& object ) const { return isMember( m_isMember, object ); }
	/// Whether the object was in the group in the last game step.
	bool didContain( const btCollisionObject& object ) const { return isMember( m_wasMember, object ); }
	/// Whether a pass moves the object. Every pass moves all objects where the group is not split.
	bool moves( StepPass pass, const btCollisionObject& object ) const
	{
		return !m_isSplit || contains( object ) == ( pass == StepPass::Substeps );
	}

	/// A body came off one in the group during the step.
	void add( const btCollisionObject& object );
	/// The world is about to remove an object: Bullet then gives the last object its index.
	void noteRemoval( const btCollisionObject& object, int objectCount );
	/// Two objects touched, one of them outside the group: their islands are one in the next step.
	void noteContact( const btCollisionObject& a, const btCollisionObject& b );
	/// After the last substep: gives the islands of the group tags that no others have.
	void endSubsteps( btCollisionWorld& world );

private:
	static bool isMember( const std::vector<unsigned char>& flags, const btCollisionObject& object );
	bool include( const btCollisionObject& object );
	void includeNearby( const Scene& scene, const std::vector<SoftBody*>& substepped, btScalar gameStep );
	bool includeIslands( const Scene& scene );
	bool includeJoined( const Scene& scene );

	struct TagPair
	{
		int a, b;
	};

	std::vector<unsigned char> m_isMember, m_wasMember; ///< by the object's index in the world
	std::vector<unsigned char> m_tags;                  ///< islands that are in the group, by Bullet's tag
	struct Touching
	{
		const btCollisionObject *a, *b;
	};
	std::vector<Touching> m_touching;  ///< noteContact, in this step
	std::vector<TagPair> m_joinedTags; ///< the islands of those of the last step
	bool m_isEmpty = true, m_isSplit = false;
};

} // namespace pliant
