#pragma once

// Five by five marbles and flat boxes in turn, dropped on a horizontal surface.

#include <BulletCollision/CollisionShapes/btBoxShape.h>
#include <BulletCollision/CollisionShapes/btSphereShape.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <vector>

namespace pliant::test {

/// `radius`: of the marbles and half the edge of the boxes, m.
class MarblesAndBoxes
{
public:
	/// `add( mass, shape, position )` returns the new rigid body. `stepX`, `stepZ`: between columns and rows, m; `lowest`: height of the
	/// lowest points, m.
	template <class Add>
	MarblesAndBoxes( btScalar radius, btScalar stepX, btScalar stepZ, btScalar lowest, const Add& add ) : m_radius( radius )
	{
		for ( int k = 0; k < 25; ++k )
		{
			auto* const shape = isBox( k )
				? static_cast<btCollisionShape*>( new btBoxShape( btVector3( radius, halfHeight( k ), radius ) ) )
				: new btSphereShape( radius );
			m_bodies.push_back( add( 2400 * radius * radius * radius, shape,
				btVector3( stepX * btScalar( k % 5 - 2 ), lowest + halfHeight( k ), stepZ * btScalar( k / 5 - 2 ) ) ) );
		}
	}

	int count() const { return int( m_bodies.size() ); }
	static bool isBox( int k ) { return k % 2 == 1; }
	const btVector3& centre( int k ) const { return m_bodies[std::size_t( k )]->getWorldTransform().getOrigin(); }
	/// The height of the lowest point of one that lies flat, m.
	btScalar bottom( int k ) const { return centre( k ).y() - halfHeight( k ); }

private:
	btScalar halfHeight( int k ) const { return isBox( k ) ? m_radius * btScalar( 0.7 ) : m_radius; }

	btScalar m_radius;
	std::vector<btRigidBody*> m_bodies;
};

} // namespace pliant::test
