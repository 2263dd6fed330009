#include "c/handles.h"
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
		if ( !bytes )
		{
			return refuseNull();
		}
		if ( flags > ( PLIANT_SAVE_STATE_ONLY | PLIANT_SAVE_FOR_COMPARISON ) )
		{
			return refuse( PLIANT_BAD_ARGUMENT, "The flags have a bit that is none of PLIANT_SAVE_..." );
		}
		SaveSettings settings;
		settings.withTemplates = ( flags & PLIANT_SAVE_STATE_ONLY ) == 0;
		settings.forComparison = ( flags & PLIANT_SAVE_FOR_COMPARISON ) != 0;
		return resultOf( saveWorld( host, bytes->bytes, settings ) );
	} );
}

pliant_result pliant_world_restore(
	pliant_world* world, const void* data, uint64_t byte_count, const pliant_template* const* templates, uint64_t template_count )
{
	return withWorld( world, [&]( SoftBodyHost& host ) {
		if ( !data || ( !templates && template_count > 0 ) )
		{
			return refuseNull();
		}
		LoadSettings settings;
		for ( std::uint64_t k = 0; k < template_count; ++k )
		{
			if ( !templates[k] )
			{
				return refuseNull();
			}
			settings.templates.push_back( templates[k]->shared );
		}
		const auto restored = restoreWorld( host, BytesView( static_cast<const std::byte*>( data ), std::size_t( byte_count ) ), settings );
		if ( restored.ok() )
		{
			world->destroyed.clear();
			dropRemoved( *world, restored.value.removed );
			takeOver( *world, restored.value.created );
		}
		return resultOf( restored.status );
	} );
}
