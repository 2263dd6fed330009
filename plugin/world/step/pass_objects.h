#pragma once

// What Bullet's stages see of a world during one pass over the step (substep_group.h).

#include <BulletDynamics/Dynamics/btRigidBody.h>
#include <LinearMath/btAlignedObjectArray.h>

#include <algorithm>
#include <vector>

namespace pliant {

/// One of the world's arrays, of which a pass sees a part. What the game adds or removes meanwhile (in a callback) is added to or removed
/// from the whole.
template <class T>
class PassObjects
{
public:
	/// `belongs( object )`: to the pass.
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
	/// The world removes an object that the pass may not see.
	void forget( T* object ) { m_all.erase( std::remove( m_all.begin(), m_all.end(), object ), m_all.end() ); }

private:
	std::vector<T*> m_all, m_shown;
};

/// Objects that a pass touches and does not move, for they have moved already: their velocities change and forces do not act twice. Their
/// island is that of what they touch.
class LentObjects
{
public:
	void lend( btCollisionObject& object )
	{
		if ( std::any_of( m_lent.begin(), m_lent.end(), [&object]( const Lent& lent ) { return lent.object == &object; } ) )
		{
			return;
		}
		Lent lent{ &object, object.getIslandTag(), btVector3( 0, 0, 0 ), btVector3( 0, 0, 0 ) };
		if ( btRigidBody* const rigid = btRigidBody::upcast( &object ) )
		{
			lent.force = rigid->getTotalForce();
			lent.torque = rigid->getTotalTorque();
			rigid->clearForces();
		}
		object.setIslandTag( -1 );
		m_lent.push_back( lent );
	}
	void forget( const btCollisionObject& object )
	{
		m_lent.erase( std::remove_if( m_lent.begin(), m_lent.end(), [&object]( const Lent& lent ) { return lent.object == &object; } ),
			m_lent.end() );
	}
	void giveBack()
	{
		for ( const Lent& lent : m_lent )
		{
			lent.object->setIslandTag( lent.tag );
			if ( btRigidBody* const rigid = btRigidBody::upcast( lent.object ) )
			{
				addForces( *rigid, lent );
			}
		}
		m_lent.clear();
	}

private:
	struct Lent
	{
		btCollisionObject* object;
		int tag;
		btVector3 force, torque; ///< N, N m
	};

	/// Bullet scales what is applied by the body's factors, which these have been scaled by already.
	static void addForces( btRigidBody& body, const Lent& lent )
	{
		const btVector3 linear = body.getLinearFactor(), angular = body.getAngularFactor(), one( 1, 1, 1 );
		if ( linear != one )
		{
			body.setLinearFactor( one );
		}
		body.setAngularFactor( one );
		body.applyCentralForce( lent.force );
		body.applyTorque( lent.torque );
		body.setAngularFactor( angular );
		if ( linear != one )
		{
			body.setLinearFactor( linear );
		}
	}

	std::vector<Lent> m_lent;
};

} // namespace pliant
