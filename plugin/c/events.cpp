// Events of the last step, and rays.

#include "c/handles.h"
#include "c/numbers.h"
#include "pliant/c/world.h"

namespace pliant::c {

namespace {

/// The nearest hit, and the part of a soft body's surface that it meets.
struct NearestHit : btCollisionWorld::ClosestRayResultCallback
{
	using ClosestRayResultCallback::ClosestRayResultCallback;
	btScalar addSingleResult( btCollisionWorld::LocalRayResult& hit, bool isInWorld ) override
	{
		shapeIndex = hit.m_localShapeInfo ? hit.m_localShapeInfo->m_triangleIndex : -1;
		return ClosestRayResultCallback::addSingleResult( hit, isInWorld );
	}
	int shapeIndex = -1;
};

pliant_ray_hit inC( pliant_world& world, const NearestHit& found, const pliant_vec3& to )
{
	pliant_ray_hit hit{};
	hit.node = -1;
	hit.fraction = 1;
	hit.point = to;
	if ( found.hasHit() )
	{
		const SoftBody* const soft = SoftBody::upcast( found.m_collisionObject );
		hit.object = identityOf( world, found.m_collisionObject );
		hit.node = soft ? soft->nodeOfShapeIndex( found.shapeIndex ) : -1;
		hit.fraction = double( found.m_closestHitFraction );
		hit.point = vectorOf( found.m_hitPointWorld );
		hit.normal = vectorOf( found.m_hitNormalWorld );
	}
	return hit;
}

pliant_fracture_event inC( const pliant_world& world, const FractureEvent& event )
{
	pliant_fracture_event c{};
	c.links = event.links;
	c.body = identityInEvent( world, event.parent );
	c.fragments = event.fragments.size();
	c.area = event.area;
	c.energy = event.energy;
	c.point = pliant_vec3{ event.point[0], event.point[1], event.point[2] };
	c.normal = pliant_vec3{ event.normal[0], event.normal[1], event.normal[2] };
	c.parting_velocity = event.partingVelocity;
	c.removed_pieces = event.removedPieces;
	c.removed_mass = event.removedMass;
	return c;
}

pliant_contact_event inC( pliant_world& world, const ContactEvent& event )
{
	pliant_contact_event c{};
	c.began = event.began ? 1 : 0;
	c.ended = event.ended ? 1 : 0;
	c.body = identityOf( world, event.body );
	c.other = identityOf( world, event.other );
	c.impulse = double( event.impulse );
	c.push = vectorOf( event.push );
	c.position = vectorOf( event.position );
	return c;
}

pliant_attachment_event inC( pliant_world& world, const AttachmentEvent& event )
{
	pliant_attachment_event c{};
	c.attachment = event.id; // an event is removed with a body that it names
	c.body = identityOf( *event.body );
	c.other = event.other ? identityOf( *event.other ) : identityOf( world, event.rigid );
	c.force = vectorOf( event.force );
	c.position = vectorOf( event.position );
	return c;
}

/// The event of an index.
template <class Events>
const auto& eventOf( const Events& events, std::uint64_t index )
{
	rejectIf( index >= events.size(), PLIANT_BAD_ARGUMENT, "The last step had no event of this index." );
	return events[std::size_t( index )];
}

} // namespace

} // namespace pliant::c

using namespace pliant;
using namespace pliant::c;

pliant_result pliant_world_get_fracture_count( const pliant_world* world, uint64_t* count )
{
	return withWorld( world, [&]( SoftBodyHost& host ) { give( std::uint64_t( host.fractureEvents().size() ), count ); } );
}

pliant_result pliant_world_get_fracture( const pliant_world* world, uint64_t index, pliant_fracture_event* event, uint32_t size )
{
	return withWorld(
		world, [&]( SoftBodyHost& host ) { writeSized( inC( *world, eventOf( host.fractureEvents(), index ) ), event, size ); } );
}

pliant_result pliant_world_get_fragments( const pliant_world* world, uint64_t index, pliant_id* ids, uint64_t capacity, uint64_t* count )
{
	return withWorld( world, [&]( SoftBodyHost& host ) {
		const std::vector<SoftBody*>& fragments = eventOf( host.fractureEvents(), index ).fragments;
		giveCount( fragments.size(), ids, capacity, count );
		for ( std::size_t k = 0; k < fragments.size() && k < capacity; ++k )
		{
			ids[k] = identityInEvent( *world, fragments[k] );
		}
	} );
}

pliant_result pliant_world_get_contact_count( const pliant_world* world, uint64_t* count )
{
	return withWorld( world, [&]( SoftBodyHost& host ) { give( std::uint64_t( host.contactEvents().size() ), count ); } );
}

pliant_result pliant_world_get_contact( pliant_world* world, uint64_t index, pliant_contact_event* event, uint32_t size )
{
	return withWorld(
		world, [&]( SoftBodyHost& host ) { writeSized( inC( *world, eventOf( host.contactEvents(), index ) ), event, size ); } );
}

pliant_result pliant_world_get_broken_attachment_count( const pliant_world* world, uint64_t* count )
{
	return withWorld( world, [&]( SoftBodyHost& host ) { give( std::uint64_t( host.attachmentEvents().size() ), count ); } );
}

pliant_result pliant_world_get_broken_attachment( pliant_world* world, uint64_t index, pliant_attachment_event* event, uint32_t size )
{
	return withWorld(
		world, [&]( SoftBodyHost& host ) { writeSized( inC( *world, eventOf( host.attachmentEvents(), index ) ), event, size ); } );
}

pliant_result pliant_world_cast_ray(
	pliant_world* world, pliant_vec3 from, pliant_vec3 to, int32_t group, int32_t mask, pliant_ray_hit* hit, uint32_t size )
{
	return withWorld( world, [&]( SoftBodyHost& host ) {
		rejectIf( !isWithin( from, kMostPosition ) || !isWithin( to, kMostPosition ), PLIANT_BAD_ARGUMENT,
			"The ends of the ray must be within 1e9 m." );
		requireSized( hit, size ); // before the ray gives an identity to anything
		NearestHit nearest( vectorOf( from ), vectorOf( to ) );
		nearest.m_collisionFilterGroup = group;
		nearest.m_collisionFilterMask = mask;
		host.bulletWorld().rayTest( nearest.m_rayFromWorld, nearest.m_rayToWorld, nearest );
		writeSized( inC( *world, nearest, to ), hit, size );
	} );
}
