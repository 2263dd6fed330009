#pragma once

// Selects the objects of a world that take soft substeps in a game step: awake explicit soft bodies, objects that touch them or may touch
// them within the step, and objects in the same islands or joined to those. All others take the game step whole, as in Bullet's own world,
// so that a soft body does not affect objects it does not touch.

#include "world/shape/contact_proxy.h"

#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>
#include <LinearMath/btAlignedObjectArray.h>

#include <vector>

class btCollisionWorld;
class btDiscreteDynamicsWorld;
class btMultiBodyConstraint;
class btTypedConstraint;

namespace pliant {

/// A pass over the step's stages. It moves the objects that take
enum class StepPass
{
	Whole,   ///< the game step whole
	Substeps ///< soft substeps, by one of them
};

class Archive;
class Attachments;
class Frames;

/// Calls visit( link ) for the links of a multibody that have a shape, its base first.
template <class Visit>
void forEachCollider( const btMultiBody& body, const Visit& visit )
{
	for ( int link = -1; link < body.getNumLinks(); ++link )
	{
		const btMultiBodyLinkCollider* const collider = link < 0 ? body.getBaseCollider() : body.getLink( link ).m_collider;
		if ( collider )
		{
			visit( *collider );
		}
	}
}

class SubstepGroup
{
public:
	/// False for objects that no contact moves: static and kinematic ones, and bodies in their rigid state that pins hold.
	static bool canMove( const btCollisionObject& object );

	/// The input of choose().
	struct Scene
	{
		const btDiscreteDynamicsWorld& world;
		const std::vector<SoftBody*>& soft;
		const btAlignedObjectArray<btRigidBody*>& rigid; ///< without static ones
		const btAlignedObjectArray<btTypedConstraint*>& constraints;
		const btAlignedObjectArray<btMultiBody*>& multiBodies;
		const btAlignedObjectArray<btMultiBodyConstraint*>& multiBodyJoints;
		const Attachments& attachments;
		const Frames& frames;
		bool canSplit; ///< false: the group has all movable objects or none
	};

	/// Begins a game step: `didContain` then refers to the group so far.
	void beginStep() { m_wasMember.swap( m_isMember ); }
	/// Selects the group. `substepped`: the awake explicit soft bodies; if empty, so is the group. `gameStep` in s. The last selection of a
	/// step counts; endChoice() is called after it.
	void choose( const Scene& scene, const std::vector<SoftBody*>& substepped, btScalar gameStep );
	void endChoice() { m_joinedTags.clear(); }
	/// Number of awake rigid bodies and links of multibodies in the group.
	int rigidCount( const Scene& scene ) const;
	bool isEmpty() const { return m_isEmpty; }
	/// Whether there are awake objects outside a group that is not empty.
	bool isSplit() const { return m_isSplit; }

	/// For a contact proxy, whether its soft body is in the group. False for static and kinematic objects.
	bool contains( const btCollisionObject& object ) const { return isMember( m_isMember, object ); }
	/// Whether the object was in the group in the last game step.
	bool didContain( const btCollisionObject& object ) const { return isMember( m_wasMember, object ); }
	/// Whether a pass moves the object. Every pass moves all objects where the group is not split.
	bool moves( StepPass pass, const btCollisionObject& object ) const
	{
		return !m_isSplit || contains( object ) == ( pass == StepPass::Substeps );
	}

	/// The same of a multibody, whose links are in the group all together.
	bool moves( StepPass pass, const btMultiBody& body ) const;

	/// Adds a fragment that separated from a body of the group during the step.
	void add( const btCollisionObject& object );
	/// Call before the world removes an object: Bullet then gives the last object its index.
	void noteRemoval( const btCollisionObject& object, int objectCount );
	/// Notes a contact with an object outside the group: the two islands are united in the next step.
	void noteContact( const btCollisionObject& a, const btCollisionObject& b );
	/// After the last substep: gives the islands of the group tags that no other island has.
	void endSubsteps( btCollisionWorld& world );
	/// Writes or reads the data that one game step passes to the next, for objects in the same order.
	void archive( Archive& archive );

private:
	static bool isMember( const std::vector<unsigned char>& flags, const btCollisionObject& object );
	bool include( const btCollisionObject& object );
	bool include( const btMultiBody& body );
	bool contains( const btMultiBody& body ) const;
	void includeNearby( const Scene& scene, const std::vector<SoftBody*>& substepped, btScalar gameStep );
	bool includeSoftNear( const Scene& scene, btScalar gameStep );
	void includeIslands( const Scene& scene );
	bool includeJoined( const Scene& scene );

	struct TagPair
	{
		int a, b;
		void archive( Archive& archive );
	};

	std::vector<unsigned char> m_isMember, m_wasMember; ///< by object index in the world; in this and the last game step
	std::vector<unsigned char> m_tags;                  ///< whether an island is in the group, by Bullet's tag
	struct Touching
	{
		const btCollisionObject *a, *b;
	};
	std::vector<Touching> m_touching;  ///< from noteContact, in this step
	std::vector<TagPair> m_joinedTags; ///< the islands of the last step's contacts
	bool m_isEmpty = true, m_isSplit = false;
};

} // namespace pliant
