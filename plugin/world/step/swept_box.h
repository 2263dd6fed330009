#pragma once

// Boxes that objects may sweep within a step.

#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <LinearMath/btAabbUtil2.h>

class btRigidBody;

namespace pliant {

class SoftBody;
struct ObjectMotion;

struct SweptBox
{
	btVector3 low, high; ///< m

	/// Bounds of a rigid body's motion within `step`, s, from its velocities and the changes by gravity and forces.
	static SweptBox of( const btRigidBody& body, btScalar step );
	/// Of any object, from its motion alone.
	static SweptBox of( const btCollisionObject& object, const ObjectMotion& motion, btScalar step );
	static SweptBox of( const SoftBody& body, const btVector3& gravity, btScalar step );
	/// The bounds of the displacements of a soft body's nodes.
	static SweptBox displacementsOf( const SoftBody& body, const btVector3& gravity, btScalar step );
	/// A soft body's box without motion.
	static SweptBox restOf( const SoftBody& body );

	void include( const btVector3& displacement )
	{
		btVector3 negative = displacement, positive = displacement;
		negative.setMin( btVector3( 0, 0, 0 ) );
		positive.setMax( btVector3( 0, 0, 0 ) );
		low += negative;
		high += positive;
	}
	void grow( btScalar distance )
	{
		const btVector3 margin( distance, distance, distance );
		low -= margin;
		high += margin;
	}
	bool overlaps( const SweptBox& other ) const { return TestAabbAgainstAabb2( low, high, other.low, other.high ); }
};

/// Bounds of the motion of a soft body's nodes within a step.
class SweptNodes
{
public:
	SweptNodes( const SoftBody& body, const btVector3& gravity, btScalar step );

	const SweptBox& box() const { return m_box; }
	/// Tests boxes first, then the nodes' spheres: a large hollow or bent body fills little of its box.
	bool mayTouch( const SweptBox& other ) const;

private:
	const SoftBody& m_body;
	SweptBox m_displacements, m_box;
};

/// The box of a moving object in the broadphase that contains its motion in all substeps of a game step.
SweptBox broadphaseBoxOf( const btCollisionObject& object, const btVector3& gravity, btScalar gameStep );
/// Whether an object is inside its box in the broadphase.
bool isInBroadphaseBox( const btCollisionObject& object );

} // namespace pliant
