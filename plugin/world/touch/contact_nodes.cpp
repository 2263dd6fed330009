#include "world/touch/contact_nodes.h"

#include "world/bodies/soft_body_impl.h"
#include "world/touch/round_surface.h"

#include <BulletCollision/NarrowPhaseCollision/btManifoldPoint.h>

namespace pliant {

namespace {

// During the solve one side's point lies at the height of the node (MovedContacts); a node's own is on its surface.
Vec3d positionOnSurface(
	const ContactProxy* const ( &nodes )[2], const btCollisionObject* const ( &objects )[2], const btManifoldPoint& point )
{
	const Vec3d points[2] = { toVec3d( point.getPositionWorldOnA() ), toVec3d( point.getPositionWorldOnB() ) };
	if ( nodes[0] && nodes[1] )
	{
		return points[0]; // on the surface: within a large node it would be out of the reach of the cells of a smaller one
	}
	for ( int side = 0; side < 2; ++side )
	{
		if ( !nodes[1 - side] && !objects[1 - side]->isStaticOrKinematicObject() )
		{
			return points[side];
		}
	}
	return 0.5 * ( points[0] + points[1] );
}

} // namespace

Vec3d distributeToNodes( const ContactProxy* const ( &nodes )[2], SharedNodes ( &shared )[2] )
{
	const bool isRound = nodes[0] && nodes[1] && nodes[0]->node >= 0 && nodes[1]->node >= 0 &&
		useRoundSpheres( *nodes[0]->owner, *nodes[1]->owner );
	for ( int side = 0; side < 2; ++side )
	{
		shared[side] = nodes[side] ? SharedNodes::only( nodes[side]->node ) : SharedNodes{};
		if ( !isRound )
		{
			continue;
		}
		const ContactProxy &own = *nodes[side], &other = *nodes[1 - side];
		const RoundSphere round = roundSphere(
			*own.owner, own.node, toVec3d( other.owner->impl().position( other.node ) - own.owner->impl().position( own.node ) ) );
		if ( round.inner >= 0 )
		{
			shared[side].count = 2;
			shared[side].node[1] = round.inner;
			shared[side].press[0] = shared[side].rub[0] = 1.0 - round.fraction;
			shared[side].press[1] = shared[side].rub[1] = round.fraction;
		}
	}
	return nodes[0] || nodes[1] ? toVec3d( ( nodes[0] ? nodes[0] : nodes[1] )->getWorldTransform().getOrigin() ) : Vec3d( Vec3d::Zero() );
}

Vec3d distributeOnSurface( const ContactProxy* const ( &nodes )[2], const btCollisionObject* const ( &objects )[2],
	const btManifoldPoint& point, SharedNodes ( &shared )[2] )
{
	const Vec3d near = positionOnSurface( nodes, objects, point ), normal = toVec3d( point.m_normalWorldOnB );
	Vec3d position = near;
	for ( int side = 1; side >= 0; --side )
	{
		if ( !nodes[side] || nodes[side]->node < 0 )
		{
			continue;
		}
		const SoftBody::Impl& impl = nodes[side]->owner->impl();
		const Vec3d node = toVec3d( impl.position( nodes[side]->node ) );
		Vec3d at = near - node;
		shared[side] = impl.surfaceNow().sharedNodes( impl.body->nodes(), nodes[side]->node, normal, at );
		position = node + at;
	}
	return position;
}

} // namespace pliant
