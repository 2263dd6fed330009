// Worlds and bodies as bytes.

#include "c/handles.h"
#include "c/numbers.h"
#include "pliant/c/body.h"
#include "pliant/c/world.h"
#include "pliant/io/snapshot.h"
#include "world/bodies/soft_body_impl.h"

using namespace pliant;
using namespace pliant::c;

namespace pliant::c {

namespace {

// A body that is created again belongs to the library's world, as a fragment does, where it would count as debris: bodies that are not
// fragments are given back to the C face.
void takeOver( pliant_world& world, const std::vector<SoftBody*>& created )
{
	for ( SoftBody* const body : created )
	{
		if ( body->impl().separatedAt > 0 )
		{
			continue;
		}
		std::unique_ptr<SoftBody>& owner = world.madeSoft[body];
		if ( world.host->releaseFragment( body ) )
		{
			owner.reset( body );
		}
		else
		{
			world.madeSoft.erase( body ); // a build without breaking releases nothing
		}
	}
}

const char* const kBadFlags = "The flags have a bit that is none of PLIANT_SAVE_... or not for this call.";

/// Rejects a list, or a template in it, that is null.
LoadSettings takeTemplates( const pliant_template* const* given, std::uint64_t count )
{
	LoadSettings settings;
	for ( std::uint64_t k = 0; k < count; ++k )
	{
		requirePointers( given );
		requirePointers( given[k] );
		settings.templates.push_back( given[k]->shared );
	}
	return settings;
}

BytesView viewOf( const void* data, std::uint64_t count )
{
	requirePointers( data );
	return BytesView( static_cast<const std::byte*>( data ), std::size_t( count ) );
}

void dropRemoved( pliant_world& world, const std::vector<SoftBody*>& removed )
{
	for ( const SoftBody* const body : removed )
	{
		world.madeSoft.erase( body );
	}
}

} // namespace

} // namespace pliant::c

pliant_result pliant_world_save( const pliant_world* world, uint32_t flags, pliant_buffer* bytes )
{
	return withWorld( world, [&]( SoftBodyHost& host ) {
		requirePointers( bytes );
		rejectIf( flags > ( PLIANT_SAVE_STATE_ONLY | PLIANT_SAVE_FOR_COMPARISON ), PLIANT_BAD_ARGUMENT, kBadFlags );
		SaveSettings settings;
		settings.withTemplates = ( flags & PLIANT_SAVE_STATE_ONLY ) == 0;
		settings.forComparison = ( flags & PLIANT_SAVE_FOR_COMPARISON ) != 0;
		return saveWorld( host, bytes->bytes, settings );
	} );
}

pliant_result pliant_world_restore(
	pliant_world* world, const void* data, uint64_t byte_count, const pliant_template* const* templates, uint64_t template_count )
{
	return withWorld( world, [&]( SoftBodyHost& host ) {
		const auto restored = restoreWorld( host, viewOf( data, byte_count ), takeTemplates( templates, template_count ) );
		if ( restored.ok() )
		{
			world->destroyed.clear();
			dropRemoved( *world, restored.value.removed );
			takeOver( *world, restored.value.created );
		}
		return restored.status;
	} );
}

pliant_result pliant_body_save( const pliant_world* world, pliant_id body, uint32_t flags, pliant_buffer* bytes )
{
	return withSoft( world, body, [&]( SoftBody& soft ) {
		requirePointers( bytes );
		rejectIf( flags != PLIANT_SAVE_ALL && flags != PLIANT_SAVE_STATE_ONLY, PLIANT_BAD_ARGUMENT, kBadFlags );
		SaveSettings settings;
		settings.withTemplates = flags == PLIANT_SAVE_ALL;
		return offer( saveBody( soft, settings ), &bytes->bytes );
	} );
}

pliant_result pliant_body_load( pliant_world* world, const void* data, uint64_t byte_count, const pliant_template* const* templates,
	uint64_t template_count, const pliant_body_settings* settings, pliant_id* made )
{
	return withWorld( world, [&]( SoftBodyHost& ) {
		requirePointers( made );
		const BytesView bytes = viewOf( data, byte_count );
		const LoadSettings load = takeTemplates( templates, template_count );
		const pliant_body_settings full = takeMembership( settings );
		SoftBodyResult body = loadBody( bytes, load );
		if ( body.ok() )
		{
			addMade( *world, std::move( body.value ), full, *made );
		}
		return body.status;
	} );
}
