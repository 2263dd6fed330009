#include "world/rigid/rigid_proxy.h"

#include "body/rigid_state.h"
#include "world/bodies/soft_body_impl.h"
#include "world/rigid/rigid_constants.h"
#include "world/step/soft_body_system.h"

#include <algorithm>

namespace pliant {

namespace {

const char kRigidProxyMark = 0;

/// Mass and moments in the solver: 0, as for static bodies, if pins hold the body or it is scenery.
btRigidBody::btRigidBodyConstructionInfo solverBody( const SoftBody& owner, btCollisionShape& shape )
{
	const RigidState& state = *owner.impl().body->rigidState();
	const bool isFree = !state.isHeld && !owner.impl().isScenery;
	return btRigidBody::btRigidBodyConstructionInfo(
		isFree ? btScalar( state.mass ) : btScalar( 0 ), nullptr, &shape, isFree ? toBt( state.moments ) : btVector3( 0, 0, 0 ) );
}

} // namespace

RigidProxy::RigidProxy( SoftBody& owner, std::unique_ptr<RigidShape> hulls ) :
	btRigidBody( solverBody( owner, hulls->shape() ) ), m_owner( owner ), m_hulls( std::move( hulls ) )
{
	internalSetExtensionPointer( const_cast<char*>( &kRigidProxyMark ) );
	setFlags( BT_DISABLE_WORLD_GRAVITY ); // gyroscopic torque too: the core keeps the angular momentum
	follow();
}

bool RigidProxy::isHeld() const
{
	return m_owner.impl().body->rigidState()->isHeld;
}

void RigidProxy::follow()
{
	const RigidMotion& motion = m_owner.impl().body->rigidState()->motion;
	m_followed = toBt( motion.rotation, motion.centre );
	setWorldTransform( m_followed );
	updateInertiaTensor();
	setLinearVelocity( toBt( motion.velocity ) );
	setAngularVelocity( toBt( motion.angularVelocity ) );
	setCollisionFlags( m_owner.getCollisionFlags() | ( isHeld() ? CF_STATIC_OBJECT : 0 ) );
	setIslandTag( isHeld() ? -1 : m_owner.getIslandTag() ); // of no island, as static objects
	setWorldArrayIndex( static_cast<const btCollisionObject&>( m_owner ).getWorldArrayIndex() );
	setBroadphaseHandle( m_owner.getBroadphaseHandle() );
	forceActivationState( m_owner.getActivationState() );
	setCompanionId( -1 );
}

RigidMotion RigidProxy::pushed( const RigidMotion& motion ) const
{
	const btTransform& now = getWorldTransform();
	if ( now == m_followed )
	{
		return motion;
	}
	RigidMotion pushed = motion;
	pushed.centre += toVec3d( now.getOrigin() ) - toVec3d( m_followed.getOrigin() );
	const Eigen::Matrix3d turn = toMatrix3d( now.getBasis() ) * toMatrix3d( m_followed.getBasis() ).transpose();
	pushed.rotation = ( Eigen::Quaterniond( turn ) * motion.rotation ).normalized();
	return pushed;
}

SoftBody* ownerOfRigidProxy( const btCollisionObject* object )
{
	const bool isRigid = object && object->internalGetExtensionPointer() == &kRigidProxyMark;
	return isRigid ? &static_cast<const RigidProxy*>( object )->owner() : nullptr;
}

void SoftBody::Impl::placeRigid( SoftBody& owner )
{
	const RigidMotion& motion = body->rigidState()->motion;
	const btTransform at = toBt( motion.rotation, motion.centre );
	++skin.moves;
	mass = body->motion().mass;
	meanSquareSpeed = body->motion().squareSpeed / mass;
	owner.setWorldTransform( at );
	owner.setInterpolationWorldTransform( at );
}

void SoftBody::Impl::becomeRigid( SoftBody& owner )
{
	body->becomeRigid();
	followRigidState( owner );
	placeRigid( owner );
	mustDeform = false;
}

void SoftBody::Impl::followRigidState( SoftBody& owner )
{
	rigidProxy.reset();
	if ( !body->rigidState() )
	{
		owner.setCollisionShape( queried.get() );
		return;
	}
	rigidProxy = std::make_unique<RigidProxy>( owner, std::make_unique<RigidShape>( *body, *shape ) );
	owner.setCollisionShape( rigidProxy->getCollisionShape() );
}

void SoftBody::Impl::becomeDeformable( SoftBody& owner )
{
	owner.setCollisionShape( queried.get() );
	rigidProxy.reset();
	body->becomeDeformable();
	placeShape( owner );
	rigidPause = rigidWait > -kBrieflyRigid && restTime > 0.0 ? std::min( 2 * rigidPause, kLongestRigidPause ) : kRigidPause;
	rigidWait = rigidPause;
	mustDeform = false;
}

} // namespace pliant
