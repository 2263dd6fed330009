#include "world/joints/attachments.h"

#include "world/bodies/soft_body_impl.h"
#include "world/constants.h"

#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <algorithm>
#include <utility>

namespace pliant {

namespace {

Vec3d nodeAt( const SoftBody& body, int node )
{
	return body.impl().body->nodes().worldPosition( node );
}

/// Represents a point by a node and up to three linked neighbours, with weights such that the weighted positions give the point: forces at
/// it then have the right torque. On bodies with levels, and along directions that no neighbours span, the node alone is used.
SharedNodes weightsOf( const SoftBody& body, int node, const Vec3d& at )
{
	SharedNodes shared = SharedNodes::only( node );
	const Body& core = *body.impl().body;
	const Vec3d centre = nodeAt( body, node );
	const double cell = double( core.lattice().cellSize );
	if ( core.levels() || core.nodeCount() != core.lattice().cellCount() || ( at - centre ).norm() <= kAttachedCentre * cell )
	{
		return shared;
	}
	const Lattice& lattice = core.lattice();
	const Vec3d offset = at - centre;
	std::vector<Vec3d> axes;
	for ( std::uint32_t k = lattice.linkStart[std::size_t( node )]; k < lattice.linkStart[std::size_t( node ) + 1]; ++k )
	{
		const int other = int( lattice.linkTo[k] );
		Vec3d axis = nodeAt( body, other ) - centre, across = axis;
		for ( int j = 1; j < shared.count; ++j )
		{
			const Vec3d known = axes[std::size_t( j - 1 )];
			across -= across.dot( known ) * known;
		}
		if ( shared.count < SharedNodes::kMost && across.norm() > kLeastAttachedSpan * axis.norm() )
		{
			axes.push_back( across.normalized() );
			shared.node[shared.count++] = other;
		}
	}
	if ( shared.count == 1 )
	{
		return shared; // no neighbour, or all at its position
	}
	Eigen::Matrix3d spans = Eigen::Matrix3d::Zero();
	for ( int j = 1; j < shared.count; ++j )
	{
		spans.col( j - 1 ) = nodeAt( body, shared.node[j] ) - centre;
	}
	const Vec3d weight = spans.colPivHouseholderQr().solve( offset );
	shared.press[0] = 1.0;
	for ( int j = 1; j < shared.count; ++j )
	{
		shared.press[j] = weight[j - 1];
		shared.press[0] -= weight[j - 1];
	}
	std::copy( std::begin( shared.press ), std::end( shared.press ), std::begin( shared.rub ) );
	return shared;
}

AttachedPoint pointAt( SoftBody& body, int node, const Vec3d& at )
{
	return AttachedPoint{ &body, weightsOf( body, node, at ), at };
}

} // namespace

const btCollisionObject& Attachment::secondObject() const
{
	return second.body ? static_cast<const btCollisionObject&>( *second.body ) : *rigid;
}

Vec3d positionOf( const AttachedPoint& point )
{
	return point.nodes.velocity( Vec3d::UnitX(), [&point]( int node ) { return nodeAt( *point.body, node ); } );
}

int nearestNode( const SoftBody& body, const Vec3d& at )
{
	int nearest = 0;
	for ( int node = 1; node < body.nodeCount(); ++node )
	{
		nearest = ( nodeAt( body, node ) - at ).squaredNorm() < ( nodeAt( body, nearest ) - at ).squaredNorm() ? node : nearest;
	}
	return nearest;
}

int Attachments::add( SoftBody& body, int node, const Vec3d& at, btCollisionObject& rigid, const AttachmentSettings& settings )
{
	Attachment made;
	made.id = m_nextId++;
	made.settings = settings;
	made.first = pointAt( body, node, at );
	made.rigid = &rigid;
	made.rigidIndex = rigid.getWorldArrayIndex();
	made.rigidPoint = toVec3d( rigid.getWorldTransform().invXform( toBt( positionOf( made.first ) ) ) );
	m_attachments.push_back( made );
	return made.id;
}

int Attachments::add( SoftBody& body, int node, SoftBody& other, int otherNode, const Vec3d& at, const AttachmentSettings& settings )
{
	Attachment made;
	made.id = m_nextId++;
	made.settings = settings;
	made.first = pointAt( body, node, at );
	made.second = pointAt( other, otherNode, at );
	m_attachments.push_back( made );
	return made.id;
}

bool Attachments::remove( int id )
{
	return std::erase_if( m_attachments, [id]( const Attachment& attachment ) { return attachment.id == id; } ) > 0;
}

void Attachments::removeAllOf( const btCollisionObject& object )
{
	const auto refersTo = [&object]( const Attachment& attachment ) {
		return static_cast<const btCollisionObject*>( attachment.first.body ) == &object || &attachment.secondObject() == &object;
	};
	std::erase_if( m_attachments, refersTo );
	std::erase_if( events, [&object]( const AttachmentEvent& event ) {
		return event.rigid == &object || static_cast<const btCollisionObject*>( event.body ) == &object ||
			static_cast<const btCollisionObject*>( event.other ) == &object;
	} );
}

bool Attachments::contain( const SoftBody& body ) const
{
	return std::any_of( m_attachments.begin(), m_attachments.end(),
		[&body]( const Attachment& attachment ) { return attachment.first.body == &body || attachment.second.body == &body; } );
}

const Attachment* Attachments::find( int id ) const
{
	const auto found = std::lower_bound(
		m_attachments.begin(), m_attachments.end(), id, []( const Attachment& attachment, int wanted ) { return attachment.id < wanted; } );
	return found != m_attachments.end() && found->id == id ? &*found : nullptr;
}

Attachment* Attachments::find( int id )
{
	return const_cast<Attachment*>( std::as_const( *this ).find( id ) );
}

template <class F>
void Attachments::forPointsOf( const SoftBody& body, F&& visit )
{
	for ( Attachment& attachment : m_attachments )
	{
		for ( AttachedPoint* point : { &attachment.first, &attachment.second } )
		{
			if ( point->body == &body )
			{
				visit( attachment, *point );
			}
		}
	}
}

void Attachments::noteChange( const SoftBody& body )
{
	forPointsOf( body, []( Attachment&, AttachedPoint& point ) { point.at = positionOf( point ); } );
}

void Attachments::follow( const SoftBody& body, const std::vector<std::uint32_t>& nodeNow )
{
	forPointsOf( body, [&]( Attachment& attachment, AttachedPoint& point ) {
		const std::uint32_t now = nodeNow[std::size_t( point.nodes.node[0] )];
		point = pointAt( *point.body, now == kNoNode ? nearestNode( body, point.at ) : int( now ), point.at );
		// Where the new nodes cannot represent the point exactly, the rigid end moves to it, so that no force arises.
		if ( !attachment.second.body )
		{
			const btTransform& frame = attachment.rigid->getWorldTransform();
			attachment.rigidPoint += toMatrix3d( frame.getBasis() ).transpose() * ( positionOf( point ) - point.at );
		}
	} );
}

void Attachments::followRemains( const SoftBody& body, const std::vector<std::uint32_t>& nodeNow )
{
	const auto isLost = [&]( const AttachedPoint& point ) {
		return point.body == &body && nodeNow[std::size_t( point.nodes.node[0] )] == kNoNode;
	};
	std::erase_if(
		m_attachments, [&]( const Attachment& attachment ) { return isLost( attachment.first ) || isLost( attachment.second ); } );
	follow( body, nodeNow );
}

void Attachments::moveToPiece( const SoftBody& parent, SoftBody& piece, const std::vector<std::uint32_t>& nodeNow )
{
	forPointsOf( parent, [&]( Attachment&, AttachedPoint& point ) {
		if ( const std::uint32_t now = nodeNow[std::size_t( point.nodes.node[0] )]; now != kNoNode )
		{
			point = pointAt( piece, int( now ), point.at );
		}
	} );
}

void Attachments::endStep()
{
	for ( Attachment& attachment : m_attachments )
	{
		attachment.force = attachment.stepTime > 0.0 ? Vec3d( attachment.stepImpulse / attachment.stepTime ) : attachment.force;
		attachment.stepImpulse.setZero();
		attachment.stepTime = 0.0;
	}
	const auto isOverloaded = []( const Attachment& attachment ) {
		return attachment.force.norm() > double( attachment.settings.breakingForce );
	};
	for ( const Attachment& attachment : m_attachments )
	{
		if ( isOverloaded( attachment ) )
		{
			events.push_back( AttachmentEvent{ attachment.id, attachment.first.body, attachment.second.body, attachment.rigid,
				toBt( attachment.force ), toBt( positionOf( attachment.first ) ) } );
		}
	}
	std::erase_if( m_attachments, isOverloaded );
}

} // namespace pliant
