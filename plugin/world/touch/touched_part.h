#pragma once

// The part of an object that a contact point lies on, as Bullet shows it to contact callbacks: a compound's child, a mesh's triangle.

#include <BulletCollision/CollisionShapes/btTriangleShape.h>
#include <LinearMath/btTransform.h>

class btCollisionObject;

namespace pliant {

class TouchedPart
{
public:
	/// `leaf`: index of the object's simple shape, counted through its compounds. `part`, `index`: Bullet's identifiers of a triangle.
	/// `at`: the contact point on the object, in world coordinates.
	TouchedPart( const btCollisionObject& object, int leaf, int part, int index, const btVector3& at );

	TouchedPart( const TouchedPart& ) = delete;
	TouchedPart& operator=( const TouchedPart& ) = delete;

	const btCollisionShape* shape() const { return m_shape; }
	/// Transform of the shape in the world.
	const btTransform& transform() const { return m_transform; }

private:
	void findTriangle( int part, int index, const btVector3& at );

	const btCollisionShape* m_shape;
	btTransform m_transform;
	btTriangleShape m_triangle;
};

} // namespace pliant
