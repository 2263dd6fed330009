// Identities, functions for all kinds of objects, and their destruction.

#include "c/handles.h"
#include "c/numbers.h"
#include "pliant/c/mix.h"
#include "pliant/c/world.h"
#include "world/bodies/soft_body_impl.h"
#include "world/step/world_step.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <string>

namespace pliant::c {

namespace {

// Compares pointers only: objects made through C++ may have been deleted.
bool isInWorld( const pliant_world& world, const btCollisionObject* object )
{
	const btCollisionObjectArray& all = world.host->bulletWorld().getCollisionObjectArray();
	for ( int k = 0; k < all.size(); ++k )
	{
		if ( all[k] == object )
		{
			return true;
		}
	}
	return false;
}

// Events of the last step may point to a body where another is made later.
void noteDestroyed( pliant_world& world, const SoftBody& body )
{
	if ( world.host->fractureEvents().empty() )
	{
		world.destroyed.clear();
	}
	world.destroyed.push_back( &body );
}

pliant_result destroySoft( pliant_world& world, SoftBody& body )
{
	const auto made = world.madeSoft.find( &body );
	noteDestroyed( world, body );
	if ( made != world.madeSoft.end() )
	{
		world.host->removeSoftBody( &body );
		world.madeSoft.erase( made );
		return PLIANT_OK;
	}
	if ( !world.host->releaseFragment( &body ) )
	{
		world.destroyed.pop_back();
		return refuse( PLIANT_BAD_ARGUMENT, "The body was made in C++, which destroys it." );
	}
	world.host->removeSoftBody( &body );
	delete &body;
	return PLIANT_OK;
}

pliant_result destroyOther( pliant_world& world, pliant_id id )
{
	const auto other = world.others.find( id );
	if ( !other->second.made )
	{
		return refuse( PLIANT_BAD_ARGUMENT, "The object was made in C++, which destroys it." );
	}
	endJoints( world, other->second.object );
	world.host->bulletWorld().removeRigidBody( other->second.made->body.get() );
	world.idsOfOthers.erase( other->second.object );
	world.others.erase( other );
	return PLIANT_OK;
}

} // namespace

SoftBody* softBody( const pliant_world& world, pliant_id id )
{
	const pliant_id serial = id / 2;
	if ( id == 0 || id % 2 != 0 )
	{
		return nullptr;
	}
	// They are in the order of their numbers.
	const std::vector<SoftBody*>& all = world.host->step().bodies.bodies();
	const auto found = std::ranges::lower_bound( all, serial, {}, []( const SoftBody* body ) { return pliant_id( body->impl().serial ); } );
	return found != all.end() && ( *found )->impl().serial == serial ? *found : nullptr;
}

btCollisionObject* object( const pliant_world& world, pliant_id id )
{
	if ( SoftBody* const soft = softBody( world, id ) )
	{
		return soft;
	}
	const auto other = world.others.find( id );
	if ( other == world.others.end() )
	{
		return nullptr;
	}
	btCollisionObject* const found = other->second.object;
	return other->second.made || isInWorld( world, found ) ? found : nullptr;
}

btRigidBody* rigidBody( const pliant_world& world, pliant_id id )
{
	btCollisionObject* const found = id % 2 == 1 ? object( world, id ) : nullptr;
	return found ? btRigidBody::upcast( found ) : nullptr;
}

pliant_result destroyFrame( pliant_world& world, pliant_id frame )
{
	const auto other = world.others.find( frame );
	const btRigidBody* const rigid = btRigidBody::upcast( other->second.object );
	const SoftBodySystem& bodies = world.host->step().bodies;
	if ( bodies.isBusy() || !bodies.frames.find( *rigid ) )
	{
		return refuse( PLIANT_BAD_ARGUMENT, "The rigid body is no frame, or a step is in progress." );
	}
	endJoints( world, rigid );
	world.host->removeFrame( rigid );
	world.idsOfOthers.erase( rigid );
	world.others.erase( other );
	return PLIANT_OK;
}

pliant_id identityOf( const SoftBody& body )
{
	return pliant_id( body.impl().serial ) * 2;
}

pliant_id identityOf( pliant_world& world, const btCollisionObject* object )
{
	if ( !object )
	{
		return 0;
	}
	if ( const SoftBody* const soft = SoftBody::upcast( object ) )
	{
		return identityOf( *soft );
	}
	if ( const auto known = world.idsOfOthers.find( object ); known != world.idsOfOthers.end() )
	{
		return known->second;
	}
	const pliant_id id = world.lastOther + 2;
	world.idsOfOthers.emplace( object, id );
	try
	{
		world.others.emplace( id, Other{ const_cast<btCollisionObject*>( object ), nullptr } );
	}
	catch ( ... )
	{
		world.idsOfOthers.erase( object );
		throw;
	}
	world.lastOther = id;
	return id;
}

pliant_id identityInEvent( const pliant_world& world, const SoftBody* body )
{
	const std::vector<SoftBody*>& all = world.host->step().bodies.bodies();
	const bool isGone = std::ranges::find( world.destroyed, body ) != world.destroyed.end() || std::ranges::find( all, body ) == all.end();
	return isGone ? 0 : identityOf( *body );
}

pliant_result refuseIdentity( const pliant_world* world, pliant_id id, const char* kind ) noexcept
{
	if ( !world )
	{
		return refuseNull();
	}
	if ( object( *world, id ) )
	{
		return call( [kind]() { return refuse( PLIANT_BAD_ARGUMENT, ( std::string( "The object is no " ) + kind + "." ).c_str() ); } );
	}
	return refuse( PLIANT_NO_SUCH_OBJECT, "No object of the world has this identity: it is gone, or was never there." );
}

} // namespace pliant::c

using namespace pliant;
using namespace pliant::c;

pliant_result pliant_object_get_kind( const pliant_world* world, pliant_id object, int32_t* kind )
{
	return withObject( world, object, [&]( btCollisionObject& found ) {
		if ( !kind )
		{
			return refuseNull();
		}
		*kind = SoftBody::upcast( &found ) ? PLIANT_KIND_SOFT : btRigidBody::upcast( &found ) ? PLIANT_KIND_RIGID : PLIANT_KIND_OTHER;
		return pliant_result( PLIANT_OK );
	} );
}

pliant_result pliant_object_set_contact( pliant_world* world, pliant_id object, double friction, double restitution )
{
	return withObject( world, object, [&]( btCollisionObject& found ) {
		if ( !isWithin( friction, 0, kMostFriction ) || !isWithin( restitution, 0, 1 ) )
		{
			return refuse( PLIANT_BAD_ARGUMENT, "Friction must be 0 to 1e6, and restitution 0 to 1." );
		}
		found.setFriction( btScalar( friction ) );
		found.setRestitution( btScalar( restitution ) );
		return pliant_result( PLIANT_OK );
	} );
}

pliant_result pliant_object_get_contact( const pliant_world* world, pliant_id object, double* friction, double* restitution )
{
	return withObject( world, object, [&]( btCollisionObject& found ) {
		friction ? void( *friction = double( found.getFriction() ) ) : void();
		restitution ? void( *restitution = double( found.getRestitution() ) ) : void();
		return pliant_result( PLIANT_OK );
	} );
}

pliant_result pliant_object_wake( pliant_world* world, pliant_id object )
{
	return withObject( world, object, []( btCollisionObject& found ) {
		found.activate();
		return pliant_result( PLIANT_OK );
	} );
}

pliant_result pliant_object_get_awake( const pliant_world* world, pliant_id object, int32_t* is_awake )
{
	return withObject( world, object, [&]( btCollisionObject& found ) {
		if ( !is_awake )
		{
			return refuseNull();
		}
		*is_awake = found.isActive() ? 1 : 0;
		return pliant_result( PLIANT_OK );
	} );
}

pliant_result pliant_object_set_user_data( pliant_world* world, pliant_id object, uint64_t data )
{
	return withObject( world, object, [&]( btCollisionObject& found ) {
		if ( data > std::numeric_limits<std::uintptr_t>::max() )
		{
			return refuse( PLIANT_BAD_ARGUMENT, "The user data does not fit into a pointer of this machine." );
		}
		found.setUserPointer( reinterpret_cast<void*>( std::uintptr_t( data ) ) );
		return pliant_result( PLIANT_OK );
	} );
}

pliant_result pliant_object_get_user_data( const pliant_world* world, pliant_id object, uint64_t* data )
{
	return withObject( world, object, [&]( btCollisionObject& found ) {
		if ( !data )
		{
			return refuseNull();
		}
		*data = reinterpret_cast<std::uintptr_t>( found.getUserPointer() );
		return pliant_result( PLIANT_OK );
	} );
}

pliant_result pliant_object_destroy( pliant_world* world, pliant_id object )
{
	return withObject( world, object, [&]( btCollisionObject& found ) {
		SoftBody* const soft = SoftBody::upcast( &found );
		return soft ? destroySoft( *world, *soft ) : destroyOther( *world, object );
	} );
}

namespace pliant {

SoftBodyHost* hostOf( pliant_world* world )
{
	return world ? world->host : nullptr;
}

btCollisionObject* objectOf( pliant_world* world, pliant_id object )
{
	return world ? c::object( *world, object ) : nullptr;
}

pliant_id idOf( pliant_world* world, const btCollisionObject* object )
{
	pliant_id id = 0;
	if ( world )
	{
		static_cast<void>( c::call( [&]() -> pliant_result {
			id = c::isInWorld( *world, object ) ? c::identityOf( *world, object ) : 0;
			return PLIANT_OK;
		} ) );
	}
	return id;
}

pliant_result wrapTemplate( std::shared_ptr<const BodyTemplate> bodyTemplate, pliant_template** made )
{
	return c::call( [&]() -> pliant_result {
		if ( !bodyTemplate || !made )
		{
			return c::refuseNull();
		}
		*made = new pliant_template{ std::move( bodyTemplate ) };
		return PLIANT_OK;
	} );
}

} // namespace pliant
