#include "world/implicit_contacts.h"

#include "world/constants.h"
#include "world/round_surface.h"
#include "world/soft_body_impl.h"

#include <BulletCollision/BroadphaseCollision/btDispatcher.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>
#include <BulletDynamics/ConstraintSolver/btContactSolverInfo.h>

#include <algorithm>
#include <iterator>

namespace pliant {

namespace {

const NodeBody* asNode( const btCollisionObject* object )
{
	return ownerOfNodeBody( object ) ? static_cast<const NodeBody*>( object ) : nullptr;
}

/// A contact that was a block's rubs in two directions; a solver with one leaves the other's impulse as it lies, and who sums them up would take it for the last solve's.
void forgetSecondDirection( btPersistentManifold& manifold )
{
	for ( int k = 0; k < manifold.getNumContacts(); ++k )
	{
		manifold.getContactPoint( k ).m_appliedImpulseLateral2 = 0;
	}
}

/// Two rigid bodies whose contacts the block can take over: nothing but friction. Between two solvers a stack would be pressed through itself.
bool isPlainRigid( const btPersistentManifold& manifold )
{
	for ( int k = 0; k < manifold.getNumContacts(); ++k )
	{
		const btManifoldPoint& point = manifold.getContactPoint( k );
		if ( point.m_combinedRollingFriction != 0 || point.m_combinedSpinningFriction != 0 || point.m_contactPointFlags != 0 )
		{
			return false;
		}
	}
	return btRigidBody::upcast( manifold.getBody0() ) && btRigidBody::upcast( manifold.getBody1() );
}

/// Whether both of two rigid bodies are moved by the block, or stand.
bool takeParts( const btCollisionObject* const ( &objects )[2], int block, const BlockPlaces& places )
{
	return block >= 0 && std::all_of( std::begin( objects ), std::end( objects ), [&]( const btCollisionObject* object ) {
		return object->isStaticOrKinematicObject() || places.takesPart( block, *object );
	} );
}

/// The block that solves a manifold's contacts; -1: they are Bullet's.
int blockOf( const btPersistentManifold& manifold, const BlockPlaces& places )
{
	const btCollisionObject* const objects[2] = { manifold.getBody0(), manifold.getBody1() };
	int block = -1;
	bool hasNode = false;
	for ( const btCollisionObject* object : objects )
	{
		const NodeBody* const node = asNode( object );
		hasNode = hasNode || node;
		block = node && block < 0 && node->node >= 0 ? places.blockOf( *node->owner ) : block;
	}
	if ( !hasNode && isPlainRigid( manifold ) )
	{
		block = std::max( places.blockOfIsland( objects[0]->getIslandTag() ), places.blockOfIsland( objects[1]->getIslandTag() ) );
		block = takeParts( objects, block, places ) ? block : -1;
	}
	return block;
}

/// An object's friction by direction, the root of its scales, in world axes.
Eigen::Matrix3d rootOfScales( const btCollisionObject& object )
{
	if ( !object.hasAnisotropicFriction( btCollisionObject::CF_ANISOTROPIC_FRICTION ) )
	{
		return Eigen::Matrix3d::Identity();
	}
	const Eigen::Matrix3d axes = toMatrix3d( object.getWorldTransform().getBasis() );
	return axes * toVec3d( object.getAnisotropicFriction() ).cwiseMax( 0.0 ).cwiseSqrt().asDiagonal() * axes.transpose();
}

/// S of a contact, where one of the two has any: their product where they have the same axes.
void giveDirections( const btCollisionObject* const ( &objects )[2], BlockContact& contact, ImplicitBlock& block )
{
	if ( !objects[0]->hasAnisotropicFriction( btCollisionObject::CF_ANISOTROPIC_FRICTION ) &&
		 !objects[1]->hasAnisotropicFriction( btCollisionObject::CF_ANISOTROPIC_FRICTION ) )
	{
		return;
	}
	const Eigen::Matrix3d roots = rootOfScales( *objects[1] ) * rootOfScales( *objects[0] );
	const Eigen::Matrix3d inPlane = Eigen::Matrix3d::Identity() - contact.normal * contact.normal.transpose();
	contact.directed = int( block.directions.size() );
	block.directions.push_back( inPlane * ( roots.transpose() * roots ) * inPlane );
}

/// What the game lets the second surface run at along the contact (conveyors): as Bullet's solver takes it.
Vec3d surfaceVelocity( const btManifoldPoint& point, const btContactSolverInfo& info )
{
	const bool isGiven = ( info.m_solverMode & SOLVER_ENABLE_FRICTION_DIRECTION_CACHING ) != 0 && ( point.m_contactPointFlags & BT_CONTACT_FLAG_LATERAL_FRICTION_INITIALIZED ) != 0;
	return isGiven ? Vec3d( double( point.m_contactMotion1 ) * toVec3d( point.m_lateralFrictionDir1 ) + double( point.m_contactMotion2 ) * toVec3d( point.m_lateralFrictionDir2 ) ) :
					 Vec3d( Vec3d::Zero() );
}

/// Between soft bodies: over the nodes behind, as it was found.
void spread( const NodeBody* const ( &nodes )[2], BlockContact& contact )
{
	if ( !nodes[0] || !nodes[1] || nodes[0]->node < 0 || nodes[1]->node < 0 || !meetRound( *nodes[0]->owner, *nodes[1]->owner ) )
	{
		return;
	}
	const Vec3d apart = toVec3d( nodes[1]->owner->impl().position( nodes[1]->node ) - nodes[0]->owner->impl().position( nodes[0]->node ) );
	for ( int side = 0; side < 2; ++side )
	{
		const RoundSphere round = roundSphere( *nodes[side]->owner, nodes[side]->node, side == 0 ? apart : Vec3d( -apart ) );
		if ( contact.side[side].soft >= 0 && round.inner >= 0 )
		{
			contact.side[side].inner = round.inner;
			contact.side[side].share = round.share;
		}
	}
}

/// b: speed of parting asked for. Before touch, whatever closes the gap within the step; then out of what is too deep, and bouncing off.
/// `approach`: without contacts, elasticity left out; it bounces off the speed at the substep's start (implicit_bounce.cpp).
void aim( BlockContact& contact, const btContactSolverInfo& info, double approach )
{
	const btManifoldPoint& point = *contact.point;
	const double h = double( info.m_timeStep ), gap = double( point.m_distance1 );
	contact.parting = gap > 0.0 ? -gap / h : std::min( -gap * double( info.m_erp2 ) / h, kPushOutSpeed );
	contact.target = contact.parting;
	const double met = -contact.normal.dot( contact.before );
	contact.bounces = gap < approach * h && point.m_combinedRestitution > 0 && met > double( info.m_restitutionVelocityThreshold );
	if ( contact.bounces )
	{
		contact.target = std::max( contact.parting, double( point.m_combinedRestitution ) * met );
	}
}

} // namespace

void ImplicitContacts::gather( btDispatcher& dispatcher, const btContactSolverInfo& info, BlockPlaces& places, std::deque<ImplicitBlock>& blocks )
{
	m_count = 0;
	m_hidden.clear();
	for ( int m = 0; m < dispatcher.getNumManifolds(); ++m )
	{
		gatherFrom( *dispatcher.getManifoldByIndexInternal( m ), info, places, blocks );
	}
}

void ImplicitContacts::gatherFrom(
	btPersistentManifold& manifold, const btContactSolverInfo& info, BlockPlaces& places, std::deque<ImplicitBlock>& blocks )
{
	const btCollisionObject* const objects[2] = { manifold.getBody0(), manifold.getBody1() };
	const NodeBody* const nodes[2] = { asNode( objects[0] ), asNode( objects[1] ) };
	const int block = blockOf( manifold, places );
	if ( block < 0 )
	{
		if ( ( info.m_solverMode & SOLVER_USE_2_FRICTION_DIRECTIONS ) == 0 )
		{
			forgetSecondDirection( manifold );
		}
		return;
	}
	m_hidden.push_back( Hidden{ &manifold, manifold.getContactProcessingThreshold() } );
	manifold.setContactProcessingThreshold( btScalar( kHiddenThreshold ) );
	if ( !objects[0]->hasContactResponse() || !objects[1]->hasContactResponse() )
	{
		return;
	}
	const double threshold = double( m_hidden.back().threshold );
	for ( int k = 0; k < manifold.getNumContacts(); ++k )
	{
		btManifoldPoint& point = manifold.getContactPoint( k );
		if ( double( point.m_distance1 ) > threshold )
		{
			continue;
		}
		BlockContact contact;
		for ( int side = 0; side < 2; ++side )
		{
			// A node's contact acts at its centre, on both sides: so no turn is lost.
			const NodeBody* const own = nodes[side] ? nodes[side] : nodes[1 - side];
			const btVector3& touches = own ? own->getWorldTransform().getOrigin() : side == 0 ? point.getPositionWorldOnA() : point.getPositionWorldOnB();
			contact.side[side] = sideOf( *objects[side], block, places, toVec3d( touches ) );
		}
		contact.side[1].given += surfaceVelocity( point, info );
		spread( nodes, contact );
		if ( !contact.moves() )
		{
			continue;
		}
		contact.normal = toVec3d( point.m_normalWorldOnB );
		contact.friction = double( point.m_combinedFriction );
		giveDirections( objects, contact, blocks[std::size_t( block )] );
		contact.point = &point;
		contact.normalImpulse = double( point.m_appliedImpulse );
		contact.tangentImpulse = double( point.m_appliedImpulseLateral1 ) * toVec3d( point.m_lateralFrictionDir1 ) +
								 double( point.m_appliedImpulseLateral2 ) * toVec3d( point.m_lateralFrictionDir2 );
		const ImplicitBlock& own = blocks[std::size_t( block )];
		contact.before = own.speedBefore( contact );
		aim( contact, info, -contact.normal.dot( own.freeSpeed( contact ) ) );
		blocks[std::size_t( block )].contacts.push_back( contact );
		++m_count;
	}
}

ContactSide ImplicitContacts::sideOf( const btCollisionObject& object, int block, BlockPlaces& places, const Vec3d& at ) const
{
	ContactSide side;
	if ( const NodeBody* node = asNode( &object ) )
	{
		const NodeState& nodes = node->owner->impl().body->nodes();
		const bool isFree = node->node >= 0 && places.blockOf( *node->owner ) == block && nodes.freedom[node->node] != 0.0f;
		side.soft = isFree ? places.softPart( *node->owner ) : -1;
		side.node = node->node;
		side.given = isFree ? Vec3d( Vec3d::Zero() ) : toVec3d( node->getLinearVelocity() );
		return side;
	}
	// A kinematic object may bear the static flag as well: Bullet's objects are born with it.
	btRigidBody* const rigid = btRigidBody::upcast( const_cast<btCollisionObject*>( &object ) );
	if ( !rigid || ( rigid->isStaticObject() && !rigid->isKinematicObject() ) )
	{
		return side;
	}
	const Vec3d arm = at - toVec3d( rigid->getCenterOfMassPosition() );
	if ( rigid->isKinematicObject() || rigid->getInvMass() == 0 )
	{
		side.given = toVec3d( rigid->getLinearVelocity() ) + toVec3d( rigid->getAngularVelocity() ).cross( arm );
		return side;
	}
	side.rigid = places.rigidPart( block, *rigid );
	side.arm = arm;
	return side;
}

void ImplicitContacts::writeBack( ImplicitBlock& block )
{
	for ( BlockContact& contact : block.contacts )
	{
		btManifoldPoint& point = *contact.point;
		point.m_appliedImpulse = btScalar( std::max( 0.0, contact.carried ) );
		point.m_appliedImpulseLateral1 = btScalar( contact.tangentImpulse.dot( toVec3d( point.m_lateralFrictionDir1 ) ) );
		point.m_appliedImpulseLateral2 = btScalar( contact.tangentImpulse.dot( toVec3d( point.m_lateralFrictionDir2 ) ) );
	}
}

void ImplicitContacts::show()
{
	for ( const Hidden& hidden : m_hidden )
	{
		hidden.manifold->setContactProcessingThreshold( hidden.threshold );
	}
	m_hidden.clear();
}

} // namespace pliant
