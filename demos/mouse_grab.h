#pragma once

// Pulls the soft or rigid body under the mouse.

#include <pliant/soft_body_world.h>

#include <btBulletDynamicsCommon.h>

#include <array>
#include <memory>

namespace pliant_demos {

class MouseGrab
{
public:
	explicit MouseGrab( pliant::SoftBodyWorld& world ) : m_world( world ) {}
	~MouseGrab() { release(); }
	MouseGrab( const MouseGrab& ) = delete;
	MouseGrab& operator=( const MouseGrab& ) = delete;

	/// Grabs the first object that the ray meets, if it can move.
	void grab( const btVector3& from, const btVector3& direction );
	/// Keeps the object at the distance from the eye at which it was grabbed.
	void move( const btVector3& from, const btVector3& direction );
	void release();
	bool isHolding() const { return m_soft != nullptr || m_joint != nullptr; }

	/// Before each step: the pull on a soft body is a force, and has to be applied in every step.
	void apply();

	btVector3 heldPoint() const;
	btVector3 target() const { return m_target; }

private:
	void takeNode( const btVector3& place );

	pliant::SoftBodyWorld& m_world;
	pliant::SoftBody* m_soft = nullptr;
	int m_node = 0;
	btVector3 m_heldAt = btVector3( 0, 0, 0 ); ///< last position of that node
	std::array<unsigned, 2> m_versions = {};   ///< of its body when it was grabbed
	btRigidBody* m_rigid = nullptr;
	std::unique_ptr<btPoint2PointConstraint> m_joint;
	btVector3 m_target = btVector3( 0, 0, 0 );
	btScalar m_distance = 0;
};

} // namespace pliant_demos
