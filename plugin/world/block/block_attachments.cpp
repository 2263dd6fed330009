// Attachments as bilateral contacts of a block, with the same law along the normal and across it:
//
//   j = l + k ( b - u ),   b = - r e / h,   e the distance of the two points, u the relative velocity, r = kAttachmentReturn
//
// with the last substep's impulse l as the multiplier, so that b is reached even for small k. With a compliance c it is a damped spring
// instead: l = 0, k = h^2 / c and b = - e / h give j = - h ( e + h u ) / c, the impulse of the spring force at the end of the step.

#include "world/block/block_solve.h"
#include "world/bodies/soft_body_impl.h"
#include "world/constants.h"
#include "world/joints/attachments.h"

#include <algorithm>

namespace pliant {

namespace {

/// Returns the contact side of a soft body's point. If one of its nodes is held or the body is not in the block, the node's velocity is
/// prescribed.
ContactSide softSide( const AttachedPoint& point, int block, const BlockLookup& lookup )
{
	ContactSide side;
	const SoftBody::Impl& impl = point.body->impl();
	const NodeState& nodes = impl.body->nodes();
	side.shared = point.nodes;
	side.node = point.nodes.node[0];
	const bool isFree = lookup.blockOf( *point.body ) == block &&
		std::none_of(
			point.nodes.node, point.nodes.node + point.nodes.count, [&nodes]( int node ) { return nodes.freedom[node] == 0.0f; } );
	side.soft = isFree ? lookup.softPart( *point.body ) : -1;
	side.prescribedVelocity = isFree ? Vec3d( Vec3d::Zero() ) : toVec3d( impl.velocity( side.node ) );
	return side;
}

bool isExplicit( const ContactSide& side, const AttachedPoint& point )
{
	return side.soft >= 0 && !point.body->impl().isImplicit;
}

} // namespace

void BlockContacts::gatherAttachments( Attachments& attachments, double h, BlockLookup& lookup, std::deque<IslandBlock>& blocks )
{
	for ( Attachment& attachment : attachments.all() )
	{
		const int first = lookup.blockOf( *attachment.first.body );
		const int block = first < 0 && attachment.second.body ? lookup.blockOf( *attachment.second.body ) : first;
		if ( block < 0 )
		{
			continue;
		}
		BlockContact contact;
		contact.attachment = attachment.id;
		const Vec3d at = positionOf( attachment.first );
		Vec3d other;
		contact.side[0] = softSide( attachment.first, block, lookup );
		if ( attachment.second.body )
		{
			other = positionOf( attachment.second );
			contact.side[1] = softSide( attachment.second, block, lookup );
		}
		else
		{
			other = toVec3d( attachment.rigid->getWorldTransform() * toBt( attachment.rigidPoint ) );
			contact.side[1] = sideOf( *attachment.rigid, block, lookup, other );
		}
		if ( !contact.moves() )
		{
			continue;
		}
		const Vec3d impulse = h * attachment.lastForce;
		contact.normal = impulse.norm() > 0.0 ? Vec3d( impulse.normalized() ) : Vec3d( Vec3d::UnitY() );
		contact.compliance = double( attachment.settings.compliance );
		Vec3d targetVelocity = ( other - at ) / h;
		if ( contact.compliance == 0.0 )
		{
			targetVelocity *= kAttachmentReturn;
			targetVelocity *= std::min( 1.0, kPushOutSpeed / std::max( targetVelocity.norm(), kPushOutSpeed ) );
			// An explicit body's nodes resist with their masses alone: k may be large, and a multiplier, which lags, would drive
			// vibrations.
			contact.hasExplicitSide = isExplicit( contact.side[0], attachment.first ) || isExplicit( contact.side[1], attachment.second );
			contact.normalImpulse = contact.hasExplicitSide ? 0.0 : impulse.dot( contact.normal );
			contact.tangentImpulse = contact.hasExplicitSide ? Vec3d( Vec3d::Zero() )
															 : Vec3d( impulse - contact.normalImpulse * contact.normal );
		}
		contact.target = contact.targetWithoutBounce = targetVelocity.dot( contact.normal );
		contact.tangentTarget = targetVelocity - contact.target * contact.normal;
		contact.timeStep = h;
		IslandBlock& own = blocks[std::size_t( block )];
		contact.velocityBefore = own.velocityBefore( contact );
		own.contacts.push_back( contact );
	}
}

void BlockContacts::storeForces( const IslandBlock& block, Attachments& attachments )
{
	for ( const BlockContact& contact : block.contacts )
	{
		if ( !contact.isAttachment() )
		{
			continue;
		}
		Attachment& attachment = *attachments.find( contact.attachment );
		attachment.lastForce = contact.impulse() / contact.timeStep;
		attachment.stepImpulse += contact.impulse();
		attachment.stepTime += contact.timeStep;
	}
}

} // namespace pliant
