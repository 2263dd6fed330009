// Identities, functions for all kinds of objects, and their destruction.

#include "c/handles.h"
#include "c/numbers.h"
#include "pliant/c/mix.h"
#include "pliant/c/world.h"
#include "world/bodies/soft_body_impl.h"
#include "world/step/world_step.h"

#include <algorithm>
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

void destroySoft( pliant_world& world, SoftBody& body )
{
	const auto made = world.madeSoft.find( &body );
	noteDestroyed( world, body );
	if ( made != world.madeSoft.end() )
	{
		world.host->removeSoftBody( &body );
		world.madeSoft.erase( made );
		return;
	}
	if ( !world.host->releaseFragment( &body ) )
	{
		world.destroyed.pop_back();
		reject( PLIANT_BAD_ARGUMENT, "The body was made in C++, which destroys it." );
	}
	world.host->removeSoftBody( &body );
	delete &body;
}

void destroyOther( pliant_world& world, pliant_id id )
{
	const auto other = world.others.find( id );
	rejectIf( !other->second.made, PLIANT_BAD_ARGUMENT, "The object was made in C++, which destroys it." );
	endJoints( world, other->second.object );
	world.host->bulletWorld().removeRigidBody( other->second.made->body.get() );
	world.idsOfOthers.erase( other->second.object );
	world.others.erase( other );
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

void destroyFrame( pliant_world& world, pliant_id frame )
{
	const auto other = world.others.find( frame );
	const btRigidBody* const rigid = btRigidBody::upcast( other->second.object );
	const SoftBodySystem& bodies = world.host->step().bodies;
	rejectIf(
		bodies.isBusy() || !bodies.frames.find( *rigid ), PLIANT_BAD_ARGUMENT, "The rigid body is no frame, or a step is in progress." );
	endJoints( world, rigid );
	world.host->removeFrame( rigid );
	world.idsOfOthers.erase( rigid );
	world.others.erase( other );
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

void rejectIdentity( const pliant_world* world, pliant_id id, const char* kind )
{
	requirePointers( world );
	rejectIf( object( *world, id ) != nullptr, PLIANT_BAD_ARGUMENT, ( std::string( "The object is no " ) + kind + "." ).c_str() );
	reject( PLIANT_NO_SUCH_OBJECT, "No object of the world has this identity: it is gone, or was never there." );
}

} // namespace pliant::c

using namespace pliant;
using namespace pliant::c;

pliant_result pliant_object_get_kind( const pliant_world* world, pliant_id object, int32_t* kind )
{
	return withObject( world, object, [&]( btCollisionObject& found ) {
		const bool isRigid = btRigidBody::upcast( &found ) != nullptr;
		give( std::int32_t( SoftBody::upcast( &found ) ? PLIANT_KIND_SOFT : isRigid ? PLIANT_KIND_RIGID : PLIANT_KIND_OTHER ), kind );
	} );
}

pliant_result pliant_object_set_contact( pliant_world* world, pliant_id object, double friction, double restitution )
{
	return withObject( world, object, [&]( btCollisionObject& found ) {
		rejectIf( !isWithin( friction, 0, kMostFriction ) || !isWithin( restitution, 0, 1 ), PLIANT_BAD_ARGUMENT,
			"Friction must be 0 to 1e6, and restitution 0 to 1." );
		found.setFriction( btScalar( friction ) );
		found.setRestitution( btScalar( restitution ) );
	} );
}

pliant_result pliant_object_get_contact( const pliant_world* world, pliant_id object, double* friction, double* restitution )
{
	return withObject( world, object, [&]( btCollisionObject& found ) {
		offer( double( found.getFriction() ), friction );
		offer( double( found.getRestitution() ), restitution );
	} );
}

pliant_result pliant_object_wake( pliant_world* world, pliant_id object )
{
	return withObject( world, object, []( btCollisionObject& found ) { found.activate(); } );
}

pliant_result pliant_object_get_awake( const pliant_world* world, pliant_id object, int32_t* is_awake )
{
	return withObject( world, object, [&]( btCollisionObject& found ) { give( found.isActive() ? 1 : 0, is_awake ); } );
}

pliant_result pliant_object_set_user_data( pliant_world* world, pliant_id object, uint64_t data )
{
	return withObject( world, object, [&]( btCollisionObject& found ) { found.setUserPointer( userPointer( data ) ); } );
}

pliant_result pliant_object_get_user_data( const pliant_world* world, pliant_id object, uint64_t* data )
{
	return withObject( world, object,
		[&]( btCollisionObject& found ) { give( std::uint64_t( reinterpret_cast<std::uintptr_t>( found.getUserPointer() ) ), data ); } );
}

pliant_result pliant_object_destroy( pliant_world* world, pliant_id object )
{
	return withObject( world, object, [&]( btCollisionObject& found ) {
		SoftBody* const soft = SoftBody::upcast( &found );
		soft ? destroySoft( *world, *soft ) : destroyOther( *world, object );
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
		static_cast<void>( c::call( [&]() { id = c::isInWorld( *world, object ) ? c::identityOf( *world, object ) : 0; } ) );
	}
	return id;
}

pliant_result wrapTemplate( std::shared_ptr<const BodyTemplate> bodyTemplate, pliant_template** made )
{
	return c::call( [&]() {
		c::requirePointers( bodyTemplate.get(), made );
		*made = new pliant_template{ std::move( bodyTemplate ) };
	} );
}

} // namespace pliant
