#pragma once

// Restricts Bullet's stages to the objects of one pass over the step (substep_group.h).

#include <BulletDynamics/Dynamics/btRigidBody.h>
#include <LinearMath/btAlignedObjectArray.h>

#include <algorithm>
#include <vector>

namespace pliant {

/// One of the world's arrays, reduced to the objects of the pass. Objects that the game adds or removes meanwhile (in a callback) are added
/// to or removed from the full array.
template <class T>
class PassObjects
{
public:
	/// `belongs( object )`: whether the object is in the pass.
	template <class Belongs>
	void hide( btAlignedObjectArray<T*>& world, const Belongs& belongs )
	{
		m_all.assign( world.size() > 0 ? &world[0] : nullptr, world.size() > 0 ? &world[0] + world.size() : nullptr );
		world.resizeNoInitialize( 0 );
		m_shown.clear();
		for ( T* object : m_all )
		{
			if ( belongs( *object ) )
			{
				world.push_back( object );
				m_shown.push_back( object );
			}
		}
	}
	void restore( btAlignedObjectArray<T*>& world )
	{
		std::vector<T*> now( world.size() > 0 ? &world[0] : nullptr, world.size() > 0 ? &world[0] + world.size() : nullptr );
		const bool isSame = now == m_shown;
		world.resizeNoInitialize( 0 );
		const auto isIn = []( const std::vector<T*>& list, T* object ) {
			return std::find( list.begin(), list.end(), object ) != list.end();
		};
		for ( T* object : m_all )
		{
			if ( isSame || isIn( now, object ) || !isIn( m_shown, object ) )
			{
				world.push_back( object );
			}
		}
		for ( T* object : now )
		{
			if ( !isSame && !isIn( m_all, object ) )
			{
				world.push_back( object );
			}
		}
		m_all.clear();
		m_shown.clear();
	}
	/// Call when the world removes an object that may be hidden from the pass.
	void forget( T* object ) { m_all.erase( std::remove( m_all.begin(), m_all.end(), object ), m_all.end() ); }

private:
	std::vector<T*> m_all, m_shown;
};

/// Adds forces as Bullet has them, N and N m: it multiplies applied ones by the body's factors, and these are multiplied already.
inline void addForces( btRigidBody& body, const btVector3& force, const btVector3& torque )
{
	const btVector3 linear = body.getLinearFactor(), angular = body.getAngularFactor(), one( 1, 1, 1 );
	if ( linear != one )
	{
		body.setLinearFactor( one );
	}
	body.setAngularFactor( one );
	body.applyCentralForce( force );
	body.applyTorque( torque );
	body.setAngularFactor( angular );
	if ( linear != one )
	{
		body.setLinearFactor( linear );
	}
}

/// Objects outside the pass that touch objects of it. They have moved already: contacts change their velocities, but forces must not act
/// twice. Their contacts belong to the island of the object of the pass.
class OutsideObjects
{
public:
	void add( btCollisionObject& object )
	{
		if ( std::any_of( m_saved.begin(), m_saved.end(), [&object]( const Saved& saved ) { return saved.object == &object; } ) )
		{
			return;
		}
		Saved saved{ &object, object.getIslandTag(), btVector3( 0, 0, 0 ), btVector3( 0, 0, 0 ) };
		if ( btRigidBody* const rigid = btRigidBody::upcast( &object ) )
		{
			saved.force = rigid->getTotalForce();
			saved.torque = rigid->getTotalTorque();
			rigid->clearForces();
		}
		object.setIslandTag( -1 );
		m_saved.push_back( saved );
	}
	void forget( const btCollisionObject& object )
	{
		m_saved.erase(
			std::remove_if( m_saved.begin(), m_saved.end(), [&object]( const Saved& saved ) { return saved.object == &object; } ),
			m_saved.end() );
	}
	void restore()
	{
		for ( const Saved& saved : m_saved )
		{
			saved.object->setIslandTag( saved.tag );
			if ( btRigidBody* const rigid = btRigidBody::upcast( saved.object ) )
			{
				addForces( *rigid, saved.force, saved.torque );
			}
		}
		m_saved.clear();
	}

private:
	struct Saved
	{
		btCollisionObject* object;
		int tag;
		btVector3 force, torque; ///< N, N m
	};

	std::vector<Saved> m_saved;
};

} // namespace pliant
