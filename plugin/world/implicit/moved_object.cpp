#include "world/implicit/moved_object.h"

#include "world/bodies/soft_body_impl.h"
#include "world/constants.h"

#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>

namespace pliant {

namespace {

void measureRigid( const btRigidBody& body, RigidPart& part )
{
	part.mass = 1.0 / double( body.getInvMass() );
	part.centre = toVec3d( body.getCenterOfMassPosition() );
	const Vec3d inverse = toVec3d( body.getInvInertiaDiagLocal() );
	const bool canTurn = inverse.minCoeff() > 0.0;
	if ( canTurn )
	{
		const Eigen::Matrix3d axes = toMatrix3d( body.getWorldTransform().getBasis() );
		part.inertia = axes * inverse.cwiseInverse().asDiagonal() * axes.transpose();
	}
	for ( int k = 0; k < 3; ++k )
	{
		part.moves[k] = body.getLinearFactor()[k] != 0;
		part.turns[k] = canTurn && body.getAngularFactor()[k] != 0;
	}
}

const btMultiBodyLinkCollider& asLink( const btCollisionObject& object )
{
	return static_cast<const btMultiBodyLinkCollider&>( object );
}

} // namespace

bool isLink( const btCollisionObject& object )
{
	return btMultiBodyLinkCollider::upcast( &object ) != nullptr;
}

// J v is the velocity at the centre, and J^T p the generalised force of an impulse p there.
void MovedObjects::fillJacobian( const btMultiBodyLinkCollider& link )
{
	const btMultiBody& body = *link.m_multiBody;
	for ( int k = 0; k < 6; ++k )
	{
		btVector3 linear( 0, 0, 0 ), angular( 0, 0, 0 );
		( k < 3 ? linear : angular )[k % 3] = 1;
		m_jacobian[k].resize( 6 + body.getNumDofs() );
		body.fillConstraintJacobianMultiDof(
			link.m_link, link.getWorldTransform().getOrigin(), angular, linear, &m_jacobian[k][0], m_scratch, m_vectors, m_matrices );
	}
}

void MovedObjects::respond( const btMultiBodyLinkCollider& link, const Vector6& impulse )
{
	const int count = 6 + link.m_multiBody->getNumDofs();
	m_force.resize( count );
	m_change.resize( count );
	for ( int i = 0; i < count; ++i )
	{
		double sum = 0.0;
		for ( int k = 0; k < 6; ++k )
		{
			sum += double( m_jacobian[k][i] ) * impulse[k];
		}
		m_force[i] = btScalar( sum );
		m_change[i] = 0;
	}
	link.m_multiBody->calcAccelerationDeltasMultiDof( &m_force[0], &m_change[0], m_scratch, m_vectors );
}

// A link has its own mass and inertia, not the effective ones at its centre, which include its neighbours: the impulses of several links
// that land together would then add up to more than the multibody's momentum, and the links would bounce.
bool MovedObjects::measure( btCollisionObject& object, RigidPart& part )
{
	if ( const btRigidBody* const body = btRigidBody::upcast( &object ) )
	{
		measureRigid( *body, part );
		return true;
	}
	const btMultiBodyLinkCollider& link = asLink( object );
	const btMultiBody& body = *link.m_multiBody;
	fillJacobian( link );
	double mobility = 0.0; // 1/kg: the sum over the axes of the velocity that a unit impulse gives
	for ( int k = 0; k < 3; ++k )
	{
		respond( link, Vector6::Unit( k ) );
		for ( int i = 0; i < m_change.size(); ++i )
		{
			mobility += double( m_jacobian[k][i] ) * double( m_change[i] );
		}
	}
	const bool isBase = link.m_link < 0;
	const double mass = double( isBase ? body.getBaseMass() : body.getLinkMass( link.m_link ) );
	const Vec3d inertia = toVec3d( isBase ? body.getBaseInertia() : body.getLinkInertia( link.m_link ) );
	if ( !( mobility * mass > kLeastLinkMobility ) )
	{
		return false;
	}
	part.mass = mass;
	part.centre = toVec3d( link.getWorldTransform().getOrigin() );
	const bool canTurn = inertia.minCoeff() > 0.0;
	const Eigen::Matrix3d axes = toMatrix3d( link.getWorldTransform().getBasis() );
	for ( bool& turns : part.turns )
	{
		turns = canTurn;
	}
	part.inertia = canTurn ? Eigen::Matrix3d( axes * inertia.asDiagonal() * axes.transpose() ) : part.inertia;
	return true;
}

Vector6 MovedObjects::velocityOf( const btCollisionObject& object )
{
	Vector6 velocity;
	if ( const btRigidBody* const body = btRigidBody::upcast( &object ) )
	{
		velocity << toVec3d( body->getLinearVelocity() ), toVec3d( body->getAngularVelocity() );
		return velocity;
	}
	const btMultiBodyLinkCollider& link = asLink( object );
	fillJacobian( link );
	const btScalar* const v = link.m_multiBody->getVelocityVector();
	for ( int k = 0; k < 6; ++k )
	{
		velocity[k] = 0.0;
		for ( int i = 0; i < m_jacobian[k].size(); ++i )
		{
			velocity[k] += double( m_jacobian[k][i] ) * double( v[i] );
		}
	}
	return velocity;
}

// h F / M and h I^-1 T.
Vector6 MovedObjects::forceOf( const btCollisionObject& object, double h )
{
	Vector6 force = Vector6::Zero();
	if ( const btRigidBody* const body = btRigidBody::upcast( &object ) )
	{
		force << h * double( body->getInvMass() ) * toVec3d( body->getTotalForce() ),
			h * toVec3d( body->getInvInertiaTensorWorld() * body->getTotalTorque() );
	}
	return force;
}

void MovedObjects::move( const RigidPart& part, const Vector6& velocity )
{
	if ( btRigidBody* const body = btRigidBody::upcast( part.object ) )
	{
		const Vector6 own = velocityOf( *body );
		Vec3d linear, angular;
		for ( int k = 0; k < 3; ++k )
		{
			linear[k] = part.moves[k] ? velocity[k] : own[k];
			angular[k] = part.turns[k] ? velocity[3 + k] : own[3 + k];
		}
		body->setLinearVelocity( toBt( linear ) );
		body->setAngularVelocity( toBt( angular ) );
		return;
	}
	const btMultiBodyLinkCollider& link = asLink( *part.object );
	Vector6 impulse;
	const Vector6 change = part.velocity - part.freeVelocity;
	impulse << part.mass * change.head<3>(), part.inertia * change.tail<3>();
	fillJacobian( link );
	respond( link, impulse );
	link.m_multiBody->applyDeltaVeeMultiDof( &m_change[0], 1 );
}

} // namespace pliant
