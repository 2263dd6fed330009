// The public functions of attachments: argument checks, and the choice of the attached nodes.

#include "lattice/features.h"
#include "pliant/soft_body_host.h"
#include "world/bodies/placing.h"
#include "world/constants.h"
#include "world/step/world_step.h"

#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>

#include <cmath>

namespace pliant {

namespace {

Status checkAttachment( const char* call, const SoftBodySystem& bodies, const SoftBody& body, const AttachmentSettings& settings )
{
	if ( body.impl().system != &bodies )
	{
		return refused( call, "the soft body is not in this world." );
	}
	if ( Status status = body.impl().checkTime( call ); !status.ok() )
	{
		return status;
	}
	if ( !std::isfinite( settings.compliance ) || settings.compliance < 0 || !( settings.breakingForce > 0 ) )
	{
		return Status{ ResultCode::BadSettings,
			std::string( call ) + ": the compliance must be finite and not negative, and the breaking force above 0." };
	}
	return {};
}

/// A point that a body's nodes can hold.
Status checkPoint( const SoftBody& body, const btVector3& position )
{
	Status status = checkVector( position, "attach", "the position" );
	btVector3 low, high;
	body.impl().shape->getAabb( btTransform::getIdentity(), low, high );
	const double most = kFarthestDrive * double( ( high - low ).length() );
	const bool isNear = ( toVec3d( position ) - toVec3d( body.massCentre() ) ).norm() <= most;
	return !status.ok() || isNear ? status : refused( "attach", "the position is more than 100 times the body's size away from it." );
}

Status checkRigid( const SoftBodySystem& bodies, const btCollisionObject& object )
{
	const bool isRigid = btRigidBody::upcast( &object ) && !isContactProxy( &object );
	if ( !isRigid && !btMultiBodyLinkCollider::upcast( &object ) )
	{
		return refused( "attach", "the object is neither a rigid body nor a multibody's link." );
	}
	int index = object.getWorldArrayIndex();
	return bodies.holds( &object, index ) ? Status{} : refused( "attach", "the object is not in this world." );
}

Result<int> attachTo(
	SoftBodySystem& bodies, SoftBody& body, int node, const Vec3d& at, btCollisionObject& to, const AttachmentSettings& settings )
{
	Status status = checkAttachment( "attach", bodies, body, settings );
	status = status.ok() ? checkRigid( bodies, to ) : status;
	if ( !status.ok() )
	{
		return Result<int>::failure( status.code, status.sentence );
	}
	body.activate( true );
	to.activate( true );
	return Result<int>::success( bodies.attachments.add( body, node, at, to, settings ) );
}

} // namespace

Result<int> SoftBodyHost::attach( SoftBody& body, int node, btCollisionObject& to, const AttachmentSettings& settings )
{
	if ( !body.impl().hasNode( node ) )
	{
		return Result<int>::failure( ResultCode::BadArgument, "attach: there is no node of this number." );
	}
	return attachTo( m_step->bodies, body, node, toVec3d( body.nodePosition( node ) ), to, settings );
}

Result<int> SoftBodyHost::attach( SoftBody& body, const btVector3& position, btCollisionObject& to, const AttachmentSettings& settings )
{
	if ( const Status status = checkPoint( body, position ); !status.ok() )
	{
		return Result<int>::failure( status.code, status.sentence );
	}
	const Vec3d at = toVec3d( position );
	return attachTo( m_step->bodies, body, nearestNode( body, at ), at, to, settings );
}

Result<int> SoftBodyHost::attach( SoftBody& body, SoftBody& to, const btVector3& position, const AttachmentSettings& settings )
{
	Status status = checkPoint( body, position );
	status = status.ok() ? checkPoint( to, position ) : status;
	status = status.ok() ? checkAttachment( "attach", m_step->bodies, body, settings ) : status;
	status = status.ok() ? checkAttachment( "attach", m_step->bodies, to, settings ) : status;
	status = status.ok() && &body == &to ? refused( "attach", "a body cannot be attached to itself." ) : status;
	if ( !status.ok() )
	{
		return Result<int>::failure( status.code, status.sentence );
	}
	body.activate( true );
	to.activate( true );
	const Vec3d at = toVec3d( position );
	return Result<int>::success( m_step->bodies.attachments.add( body, nearestNode( body, at ), to, nearestNode( to, at ), at, settings ) );
}

Result<int> SoftBodyHost::weld( SoftBody& body, SoftBody& to, btScalar distance, const AttachmentSettings& settings )
{
	Status status = checkAttachment( "weld", m_step->bodies, body, settings );
	status = status.ok() ? checkAttachment( "weld", m_step->bodies, to, settings ) : status;
	const bool isDistance = std::isfinite( distance ) && distance >= 0;
	status = status.ok() && ( &body == &to || !isDistance ) ? refused( "weld", "it needs two bodies and a distance." ) : status;
	if ( !status.ok() )
	{
		return Result<int>::failure( status.code, status.sentence );
	}
	int count = 0;
	for ( int node = 0; node < body.nodeCount(); ++node )
	{
		const Vec3d own = toVec3d( body.nodePosition( node ) );
		const int other = nearestNode( to, own );
		const Vec3d there = toVec3d( to.nodePosition( other ) );
		if ( ( there - own ).norm() <= double( distance ) )
		{
			m_step->bodies.attachments.add( body, node, to, other, 0.5 * ( own + there ), settings );
			++count;
		}
	}
	body.activate( true );
	to.activate( true );
	return Result<int>::success( count );
}

Result<btRigidBody*> SoftBodyHost::addFrame( SoftBody& body, const btVector3& position, btScalar radius )
{
	using Answer = Result<btRigidBody*>;
	if ( const Status status = checkVector( position, "addFrame", "the position" ); !status.ok() )
	{
		return Answer::failure( status.code, status.sentence );
	}
	if ( !std::isfinite( radius ) || !( radius > 0 ) )
	{
		return Answer::failure( ResultCode::BadArgument, "addFrame: the radius must be finite and above 0." );
	}
	if ( body.impl().system != &m_step->bodies )
	{
		return Answer::failure( ResultCode::BadArgument, "addFrame: the soft body is not in this world." );
	}
	if ( const Status status = body.impl().checkTime( "addFrame" ); !status.ok() )
	{
		return Answer::failure( status.code, status.sentence );
	}
	btRigidBody* const made = m_step->bodies.frames.add( m_step->world(), body, toVec3d( position ), double( radius ) );
	if ( !made )
	{
		return Answer::failure(
			ResultCode::BadArgument, "addFrame: fewer than three nodes, or nodes on a line, are within the radius: it must be larger." );
	}
	body.activate( true );
	return Answer::success( made );
}

bool SoftBodyHost::removeFrame( const btRigidBody* frame )
{
	return frame && !m_step->bodies.isBusy() && m_step->bodies.frames.remove( m_step->world(), *frame );
}

SoftBody* SoftBodyHost::frameOwner( const btRigidBody* frame ) const
{
	const Frame* const found = frame ? m_step->bodies.frames.find( *frame ) : nullptr;
	return found ? found->body : nullptr;
}

bool SoftBodyHost::detach( int id )
{
	const Attachment* const attachment = m_step->bodies.attachments.find( id );
	if ( !attachment || m_step->bodies.fields.areActing() )
	{
		return false;
	}
	attachment->first.body->activate( true );
	const_cast<btCollisionObject&>( attachment->secondObject() ).activate( true );
	return m_step->bodies.attachments.remove( id );
}

int SoftBodyHost::attachmentCount() const
{
	return int( m_step->bodies.attachments.all().size() );
}

btVector3 SoftBodyHost::attachmentForce( int id ) const
{
	const Attachment* const attachment = m_step->bodies.attachments.find( id );
	return attachment ? toBt( attachment->force ) : btVector3( 0, 0, 0 );
}

const std::vector<AttachmentEvent>& SoftBodyHost::attachmentEvents() const
{
	return m_step->bodies.attachments.events;
}

} // namespace pliant
