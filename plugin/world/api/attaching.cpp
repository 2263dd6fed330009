// The public functions of attachments: argument checks, and the choice of the attached nodes.

#include "lattice/attempt.h"
#include "lattice/features.h"
#include "pliant/soft_body_host.h"
#include "world/bodies/placing.h"
#include "world/constants.h"
#include "world/step/world_step.h"

#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>

#include <cmath>

namespace pliant {

namespace {

void checkAttachment( const char* call, const SoftBodySystem& bodies, const SoftBody& body, const AttachmentSettings& settings )
{
	rejectIf( body.impl().system != &bodies, call, "the soft body is not in this world." );
	insist( body.impl().checkTime( call ) );
	if ( !std::isfinite( settings.compliance ) || settings.compliance < 0 || !( settings.breakingForce > 0 ) )
	{
		reject( ResultCode::BadSettings,
			std::string( call ) + ": the compliance must be finite and not negative, and the breaking force above 0." );
	}
}

/// A point that a body's nodes can hold.
void checkPoint( const SoftBody& body, const btVector3& position )
{
	insist( checkVector( position, "attach", "the position" ) );
	btVector3 low, high;
	body.impl().shape->getAabb( btTransform::getIdentity(), low, high );
	const double most = kFarthestDrive * double( ( high - low ).length() );
	const bool isNear = ( toVec3d( position ) - toVec3d( body.massCentre() ) ).norm() <= most;
	rejectIf( !isNear, "attach", "the position is more than 100 times the body's size away from it." );
}

void checkRigid( const SoftBodySystem& bodies, const btCollisionObject& object )
{
	const bool isRigid = btRigidBody::upcast( &object ) && !isContactProxy( &object );
	rejectIf(
		!isRigid && !btMultiBodyLinkCollider::upcast( &object ), "attach", "the object is neither a rigid body nor a multibody's link." );
	int index = object.getWorldArrayIndex();
	rejectIf( !bodies.holds( &object, index ), "attach", "the object is not in this world." );
}

Result<int> attachTo(
	SoftBodySystem& bodies, SoftBody& body, int node, const Vec3d& at, btCollisionObject& to, const AttachmentSettings& settings )
{
	checkAttachment( "attach", bodies, body, settings );
	checkRigid( bodies, to );
	body.activate( true );
	to.activate( true );
	return Result<int>::success( bodies.attachments.add( body, node, at, to, settings ) );
}

} // namespace

Result<int> SoftBodyHost::attach( SoftBody& body, int node, btCollisionObject& to, const AttachmentSettings& settings )
{
	return attempt( [&]() {
		rejectIf( !body.impl().hasNode( node ), "attach", "there is no node of this number." );
		return attachTo( m_step->bodies, body, node, toVec3d( body.nodePosition( node ) ), to, settings );
	} );
}

Result<int> SoftBodyHost::attach( SoftBody& body, const btVector3& position, btCollisionObject& to, const AttachmentSettings& settings )
{
	return attempt( [&]() {
		checkPoint( body, position );
		const Vec3d at = toVec3d( position );
		return attachTo( m_step->bodies, body, nearestNode( body, at ), at, to, settings );
	} );
}

Result<int> SoftBodyHost::attach( SoftBody& body, SoftBody& to, const btVector3& position, const AttachmentSettings& settings )
{
	return attempt( [&]() {
		checkPoint( body, position );
		checkPoint( to, position );
		checkAttachment( "attach", m_step->bodies, body, settings );
		checkAttachment( "attach", m_step->bodies, to, settings );
		rejectIf( &body == &to, "attach", "a body cannot be attached to itself." );
		body.activate( true );
		to.activate( true );
		const Vec3d at = toVec3d( position );
		return Result<int>::success(
			m_step->bodies.attachments.add( body, nearestNode( body, at ), to, nearestNode( to, at ), at, settings ) );
	} );
}

Result<int> SoftBodyHost::weld( SoftBody& body, SoftBody& to, btScalar distance, const AttachmentSettings& settings )
{
	return attempt( [&]() {
		checkAttachment( "weld", m_step->bodies, body, settings );
		checkAttachment( "weld", m_step->bodies, to, settings );
		rejectIf( &body == &to || !std::isfinite( distance ) || distance < 0, "weld", "it needs two bodies and a distance." );
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
	} );
}

Result<btRigidBody*> SoftBodyHost::addFrame( SoftBody& body, const btVector3& position, btScalar radius )
{
	return attempt( [&]() {
		insist( checkVector( position, "addFrame", "the position" ) );
		rejectIf( !std::isfinite( radius ) || !( radius > 0 ), "addFrame", "the radius must be finite and above 0." );
		rejectIf( body.impl().system != &m_step->bodies, "addFrame", "the soft body is not in this world." );
		insist( body.impl().checkTime( "addFrame" ) );
		btRigidBody* const made = m_step->bodies.frames.add( m_step->world(), body, toVec3d( position ), double( radius ) );
		rejectIf( !made, "addFrame", "fewer than three nodes, or nodes on a line, are within the radius: it must be larger." );
		body.activate( true );
		return Result<btRigidBody*>::success( made );
	} );
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
