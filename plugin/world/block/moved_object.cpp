#include "world/block/moved_object.h"

#include "world/bodies/soft_body_impl.h"
#include "world/constants.h"
#include "world/joints/attachments.h"

#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>

#include <algorithm>
#include <iterator>

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

void MovedObjects::fillMobility( const IslandBlock& block, LinkedParts& whole )
{
	const auto linkOf = [&]( std::size_t k ) -> const btMultiBodyLinkCollider& {
		return asLink( *block.rigid[std::size_t( whole.parts[k] )].object );
	};
	const Eigen::Index size = 6 * Eigen::Index( whole.parts.size() );
	whole.mass.resize( size, size );
	const int dofs = 6 + linkOf( 0 ).m_multiBody->getNumDofs();
	m_changes.resize( dofs, size );
	for ( std::size_t k = 0; k < whole.parts.size(); ++k )
	{
		fillJacobian( linkOf( k ) );
		for ( int axis = 0; axis < 6; ++axis )
		{
			respond( linkOf( k ), Vector6::Unit( axis ) );
			for ( int i = 0; i < dofs; ++i )
			{
				m_changes( i, 6 * Eigen::Index( k ) + axis ) = double( m_change[i] );
			}
		}
	}
	for ( std::size_t k = 0; k < whole.parts.size(); ++k )
	{
		fillJacobian( linkOf( k ) );
		for ( int axis = 0; axis < 6; ++axis )
		{
			const Eigen::Map<const Eigen::Matrix<btScalar, 1, Eigen::Dynamic>> row( &m_jacobian[axis][0], dofs );
			whole.mass.row( 6 * Eigen::Index( k ) + axis ) = row.cast<double>() * m_changes;
		}
	}
	whole.mass = ( 0.5 * ( whole.mass + whole.mass.transpose() ) ).eval();
}

void MovedObjects::measureLinks( IslandBlock& block )
{
	for ( std::size_t p = 0; p < block.rigid.size(); ++p )
	{
		RigidPart& part = block.rigid[p];
		if ( !isLink( *part.object ) )
		{
			continue;
		}
		const btMultiBody* const body = asLink( *part.object ).m_multiBody;
		const auto known = std::find_if( block.linked.begin(), block.linked.end(), [&]( const LinkedParts& whole ) {
			return asLink( *block.rigid[std::size_t( whole.parts.front() )].object ).m_multiBody == body;
		} );
		part.linked = int( known - block.linked.begin() );
		LinkedParts& whole = known == block.linked.end() ? block.linked.emplace_back() : *known;
		part.link = int( whole.parts.size() );
		whole.parts.push_back( int( p ) );
	}
	for ( LinkedParts& whole : block.linked )
	{
		fillMobility( block, whole );
		invertMobility( block, whole );
	}
}

void MovedObjects::invertMobility( const IslandBlock& block, LinkedParts& whole )
{
	const double locked = whole.joints ? kLockedJointMobility : kLockedLinkMobility;
	for ( std::size_t k = 0; k < whole.parts.size(); ++k )
	{
		const RigidPart& part = block.rigid[std::size_t( whole.parts[k] )];
		const Eigen::Index at = 6 * Eigen::Index( k );
		whole.mass.block<3, 3>( at, at ) += locked / part.mass * Eigen::Matrix3d::Identity();
		whole.mass.block<3, 3>( at + 3, at + 3 ) += locked * part.inertia.inverse();
	}
	whole.mass = whole.mass.llt().solve( Eigen::MatrixXd::Identity( whole.mass.rows(), whole.mass.cols() ) ).eval();
	whole.mass = ( 0.5 * ( whole.mass + whole.mass.transpose() ) ).eval();
}

namespace {

/// How fast a contact approaches that closes in this substep, m/s.
double approachOf( const BlockContact& contact )
{
	const double along = contact.normal.dot( contact.velocityBefore );
	return along < contact.target ? std::max( 0.0, -along ) : 0.0;
}

/// Whether a contact is an impact of a soft body on a rigid one, of which the joints' impulses of the steps before say nothing.
bool isImpact( const BlockContact& contact, const RigidPart& part, double h )
{
	const double travel = h * approachOf( contact ), radiusSquare = 0.5 * part.inertia.trace() / part.mass;
	const bool hasSoft = contact.side[0].soft >= 0 || contact.side[1].soft >= 0;
	return hasSoft && travel * travel > kHitTravel * kHitTravel * radiusSquare;
}

/// Whether a rigid part of the block is attached or hit: without one, its joints are not looked at.
bool startsAny( const IslandBlock& block, double h )
{
	return std::any_of( block.contacts.begin(), block.contacts.end(), [&]( const BlockContact& contact ) {
		return std::any_of( std::begin( contact.side ), std::end( contact.side ), [&]( const ContactSide& side ) {
			return side.rigid >= 0 && ( contact.isAttachment() || isImpact( contact, block.rigid[std::size_t( side.rigid )], h ) );
		} );
	} );
}

/// A block's rigid parts on joints.
struct JointedParts
{
	std::vector<unsigned char> isJointed, isHit; ///< of each rigid part
	std::vector<JointGroup::Load> loads;         ///< that the joints will probably carry
};

/// Loads: impulses of the last substep, and of an approach those that stop it.
JointedParts jointedPartsOf( IslandBlock& block, const Attachments& attachments, const JointGroup::Joints& joints, double h )
{
	JointedParts jointed;
	jointed.isHit.resize( block.rigid.size() );
	for ( const RigidPart& part : block.rigid )
	{
		const btRigidBody* const body = btRigidBody::upcast( part.object );
		jointed.isJointed.push_back( body && JointGroup::isHeld( *body, joints ) ? 1 : 0 );
	}
	const auto forSides = [&]( const auto& visit ) {
		for ( const BlockContact& contact : block.contacts )
		{
			for ( int k = 0; k < 2; ++k )
			{
				const int rigid = contact.side[k].rigid;
				rigid >= 0 && jointed.isJointed[std::size_t( rigid )] ? visit( contact, k, std::size_t( rigid ) ) : void();
			}
		}
	};
	std::vector<int> approaching( block.rigid.size() ); // contacts of each part
	forSides( [&]( const BlockContact& contact, int, std::size_t rigid ) {
		RigidPart& part = block.rigid[rigid];
		approaching[rigid] += !contact.isAttachment() && approachOf( contact ) > 0.0 ? 1 : 0;
		part.isAttached = part.isAttached || contact.isAttachment();
		jointed.isHit[rigid] |= isImpact( contact, part, h ) ? 1 : 0;
	} );
	forSides( [&]( const BlockContact& contact, int k, std::size_t rigid ) {
		const RigidPart& part = block.rigid[rigid];
		const Vec3d onFirst = contact.isAttachment()
			? Vec3d( h * attachments.find( contact.attachment )->lastForce )
			: Vec3d( contact.impulse() + part.mass * approachOf( contact ) / std::max( 1, approaching[rigid] ) * contact.normal );
		const Vec3d impulse = k == 0 ? onFirst : Vec3d( -onFirst );
		JointGroup::Load& load = jointed.loads.emplace_back( JointGroup::Load{ btRigidBody::upcast( part.object ), Vector6::Zero() } );
		load.impulse << impulse, contact.side[k].arm.cross( impulse );
	} );
	return jointed;
}

} // namespace

void MovedObjects::measureJointed(
	IslandBlock& block, const Attachments& attachments, const JointGroup::Joints& joints, double h, double erp )
{
	if ( !startsAny( block, h ) )
	{
		return;
	}
	auto [isJointed, isHit, loads] = jointedPartsOf( block, attachments, joints, h );
	for ( std::size_t p = 0; p < block.rigid.size(); ++p )
	{
		const bool isStart = isJointed[p] && ( block.rigid[p].isAttached || isHit[p] );
		const auto made = isStart ? std::make_shared<JointGroup>() : nullptr;
		if ( !made || !made->collect( *btRigidBody::upcast( block.rigid[p].object ), joints, loads, h, erp ) )
		{
			continue;
		}
		JointGroup& group = *made;
		LinkedParts& whole = block.linked.emplace_back();
		whole.joints = made;
		const auto isMember = [&]( std::size_t other ) {
			const btRigidBody* const body = isJointed[other] ? btRigidBody::upcast( block.rigid[other].object ) : nullptr;
			return body && group.contains( *body );
		};
		bool hasHit = false;
		for ( std::size_t other = 0; other < block.rigid.size(); ++other )
		{
			hasHit = hasHit || ( isHit[other] && isMember( other ) );
		}
		std::vector<const btRigidBody*> members;
		for ( std::size_t other = 0; other < block.rigid.size(); ++other )
		{
			RigidPart& part = block.rigid[other];
			const btRigidBody* const own = btRigidBody::upcast( part.object );
			if ( isMember( other ) && ( part.isAttached || hasHit ) )
			{
				isJointed[other] = 0;
				part.linked = int( block.linked.size() ) - 1;
				part.link = int( whole.parts.size() );
				// What was learnt of a body that is not always linked includes the impulses of its joints.
				part.isHit = !part.isAttached;
				const Vector6 free = group.freeVelocityOf( *own ), beyond = free - velocityOf( *own ) - forceOf( *own, h );
				part.freeVelocity = part.isHit ? free : Vector6( part.freeVelocity + beyond );
				whole.parts.push_back( int( other ) );
				members.push_back( own );
			}
		}
		whole.mass = group.mobilityOf( members );
		invertMobility( block, whole );
	}
}

// Computed from the contacts' impulses. From velocities it would be inaccurate: a locked axis has a huge mass, which multiplies the
// rounding errors of the velocity.
void MovedObjects::moveJointed( const IslandBlock& block )
{
	for ( const LinkedParts& whole : block.linked )
	{
		std::vector<JointGroup::Load> impulses;
		for ( const BlockContact& contact : block.contacts )
		{
			for ( int k = 0; k < 2 && whole.joints; ++k )
			{
				const ContactSide& side = contact.side[k];
				const int linked = side.rigid < 0 ? -1 : block.rigid[std::size_t( side.rigid )].linked;
				if ( linked == int( &whole - block.linked.data() ) )
				{
					const Vec3d impulse = k == 0 ? contact.impulse() : Vec3d( -contact.impulse() );
					JointGroup::Load load{ btRigidBody::upcast( block.rigid[std::size_t( side.rigid )].object ), Vector6::Zero() };
					load.impulse << impulse, side.arm.cross( impulse );
					impulses.push_back( load );
				}
			}
		}
		whole.joints ? whole.joints->applyImpulses( impulses ) : void();
	}
}

void MovedObjects::move( const RigidPart& part, const Vector6& velocity )
{
	btRigidBody& body = *btRigidBody::upcast( part.object );
	const Vector6 own = velocityOf( body );
	Vec3d linear, angular;
	for ( int k = 0; k < 3; ++k )
	{
		linear[k] = part.moves[k] ? velocity[k] : own[k];
		angular[k] = part.turns[k] ? velocity[3 + k] : own[3 + k];
	}
	body.setLinearVelocity( toBt( linear ) );
	body.setAngularVelocity( toBt( angular ) );
}

void MovedObjects::moveLinks( const IslandBlock& block )
{
	for ( const LinkedParts& whole : block.linked )
	{
		for ( const int k : whole.parts )
		{
			const RigidPart& part = block.rigid[std::size_t( k )];
			if ( !isLink( *part.object ) )
			{
				continue;
			}
			const btMultiBodyLinkCollider& link = asLink( *part.object );
			const Vector6 impulse = block.linkMomentum(
				part, []( const RigidPart& other ) { return Vector6( other.velocity - other.freeVelocity ); } );
			fillJacobian( link );
			respond( link, impulse );
			link.m_multiBody->applyDeltaVeeMultiDof( &m_change[0], 1 );
		}
	}
}

} // namespace pliant
