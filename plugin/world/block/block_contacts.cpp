#include "world/block/block_contacts.h"

#include "world/block/moved_object.h"
#include "world/bodies/soft_body_impl.h"
#include "world/constants.h"
#include "world/touch/contact_nodes.h"

#include <BulletCollision/CollisionDispatch/btManifoldResult.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>
#include <BulletDynamics/ConstraintSolver/btContactSolverInfo.h>

#include <algorithm>
#include <cmath>
#include <iterator>

namespace pliant {

namespace {

const ContactProxy* asProxy( const btCollisionObject* object )
{
	return ownerOfContactProxy( object ) ? static_cast<const ContactProxy*>( object ) : nullptr;
}

/// Contacts of a block have friction in two directions. A solver with one direction leaves the impulse of the second unchanged, so that
/// sums of applied impulses would include a stale value.
void clearSecondDirection( btPersistentManifold& manifold )
{
	for ( int k = 0; k < manifold.getNumContacts(); ++k )
	{
		manifold.getContactPoint( k ).m_appliedImpulseLateral2 = 0;
	}
}

/// True for two rigid bodies whose contacts the block can take over: they have sliding friction only. A stack split between two solvers
/// would be pressed through itself.
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

/// True if each of two rigid bodies is moved by the block or fixed.
bool areInBlock( const btCollisionObject* const ( &objects )[2], int block, const BlockLookup& lookup )
{
	return block >= 0 && std::all_of( std::begin( objects ), std::end( objects ), [&]( const btCollisionObject* object ) {
		return object->isStaticOrKinematicObject() || lookup.takesPart( block, *object );
	} );
}

/// Returns the block that solves a manifold's contacts; -1: Bullet solves them.
int blockOf( const btPersistentManifold& manifold, const BlockLookup& lookup )
{
	const btCollisionObject* const objects[2] = { manifold.getBody0(), manifold.getBody1() };
	int block = -1;
	bool hasNode = false;
	for ( const btCollisionObject* object : objects )
	{
		const ContactProxy* const node = asProxy( object );
		hasNode = hasNode || node;
		block = node && block < 0 && node->node >= 0 ? lookup.blockOf( *node->owner ) : block;
	}
	if ( !hasNode )
	{
		block = std::max( lookup.blockOfIsland( objects[0]->getIslandTag() ), lookup.blockOfIsland( objects[1]->getIslandTag() ) );
		block = areInBlock( objects, block, lookup ) && isPlainRigid( manifold ) ? block : -1;
	}
	return block;
}

/// Returns the square root of an object's anisotropic friction scales, in world axes.
Eigen::Matrix3d rootOfScales( const btCollisionObject& object )
{
	if ( !object.hasAnisotropicFriction( btCollisionObject::CF_ANISOTROPIC_FRICTION ) )
	{
		return Eigen::Matrix3d::Identity();
	}
	const Eigen::Matrix3d axes = toMatrix3d( object.getWorldTransform().getBasis() );
	return axes * toVec3d( object.getAnisotropicFriction() ).cwiseMax( 0.0 ).cwiseSqrt().asDiagonal() * axes.transpose();
}

/// Sets S of a contact if either object has anisotropic friction; with common axes it is the product of their scales.
void setFrictionScale( const btCollisionObject* const ( &objects )[2], BlockContact& contact, IslandBlock& block )
{
	if ( !objects[0]->hasAnisotropicFriction( btCollisionObject::CF_ANISOTROPIC_FRICTION ) &&
		!objects[1]->hasAnisotropicFriction( btCollisionObject::CF_ANISOTROPIC_FRICTION ) )
	{
		return;
	}
	const Eigen::Matrix3d roots = rootOfScales( *objects[1] ) * rootOfScales( *objects[0] );
	const Eigen::Matrix3d inPlane = Eigen::Matrix3d::Identity() - contact.normal * contact.normal.transpose();
	contact.frictionScale = int( block.frictionScales.size() );
	block.frictionScales.push_back( inPlane * ( roots.transpose() * roots ) * inPlane );
}

/// Returns the velocity of the second surface along the contact (conveyors), as Bullet's solver interprets it.
Vec3d surfaceVelocity( const btManifoldPoint& point, const btContactSolverInfo& info )
{
	const bool isGiven = ( info.m_solverMode & SOLVER_ENABLE_FRICTION_DIRECTION_CACHING ) != 0 &&
		( point.m_contactPointFlags & BT_CONTACT_FLAG_LATERAL_FRICTION_INITIALIZED ) != 0;
	return isGiven ? Vec3d( double( point.m_contactMotion1 ) * toVec3d( point.m_lateralFrictionDir1 ) +
						 double( point.m_contactMotion2 ) * toVec3d( point.m_lateralFrictionDir2 ) )
				   : Vec3d( Vec3d::Zero() );
}

bool isDrawn( const ContactProxy* node, const btCollisionObject& other )
{
	return node && node->node >= 0 && node->owner->impl().isMetAsDrawnBy( other );
}

/// Mass of a contact's side, kg; infinite for prescribed velocities.
double massOf( const ContactSide& side, const IslandBlock& block )
{
	return side.soft >= 0 ? double( block.soft[std::size_t( side.soft )].owner->mass() )
		: side.rigid >= 0 ? block.rigid[std::size_t( side.rigid )].mass
						  : HUGE_VAL;
}

/// Combined restitution, less where a body rebounds from a heavy object by its own elasticity.
double restitutionOf( const BlockContact& contact, const IslandBlock& block )
{
	double restitution = double( contact.point->m_combinedRestitution );
	for ( int k = 0; restitution > 0.0 && k < 2; ++k )
	{
		const ContactSide& side = contact.side[k];
		if ( side.soft >= 0 )
		{
			const double own = massOf( side, block ), other = massOf( contact.side[1 - k], block );
			const double weight = std::isinf( other ) ? 1.0 : other / ( own + other );
			restitution *= 1.0 - weight * ( 1.0 - block.soft[std::size_t( side.soft )].restitutionFraction );
		}
	}
	return restitution;
}

/// Whether one of the bodies bounces as rigid: until it separates, it needs the restitution that a touching contact no longer has.
bool hasRigidBounce( const BlockContact& contact, const IslandBlock& block )
{
	return std::any_of( std::begin( contact.side ), std::end( contact.side ),
		[&block]( const ContactSide& side ) { return side.soft >= 0 && block.soft[std::size_t( side.soft )].bouncesAsRigid; } );
}

/// Velocity after a step of h in which a body bounces that begins it at a gap d above the surface with the velocity u, m/s: that with which
/// it rises again if it leaves the surface at e times its velocity there,
///
///   ( v + a h / 2 )^2 = e^2 ( ( u + a h / 2 )^2 + 2 a d ) - 2 a d
///
/// a is the acceleration towards the surface. Positions follow the velocities at the end of each step, so that a falling body is half a
/// step's acceleration faster than its velocity at the start of the step, and a rising one that much slower.
double bounceVelocity( double restitution, double impact, double gap, double acceleration, double h )
{
	const double half = 0.5 * acceleration * h, gained = 2.0 * acceleration * std::max( gap, 0.0 );
	const double squared = restitution * restitution * ( ( impact + half ) * ( impact + half ) + gained ) - gained;
	return std::sqrt( std::max( 0.0, squared ) ) - half;
}

/// Depth, m, to which a contact may penetrate without being pushed out: of nodes that step explicitly, which nothing but wobble damping
/// would bring to rest again. Characters push as far as they walk.
double slopOf( const BlockContact& contact, const btCollisionObject* const ( &objects )[2], const IslandBlock& block )
{
	double slop = 0.0;
	for ( int k = 0; k < 2; ++k )
	{
		const int soft = contact.side[k].soft;
		if ( objects[1 - k]->getCollisionFlags() & btCollisionObject::CF_CHARACTER_OBJECT )
		{
			return 0.0;
		}
		if ( soft >= 0 && !block.soft[std::size_t( soft )].motion->isElastic() )
		{
			const SoftBody& owner = *block.soft[std::size_t( soft )].owner;
			slop = std::max( slop, double( kContactSlop * owner.impl().shape->smallestRadius() ) );
		}
	}
	return slop;
}

/// Sets b, the target separation velocity: before touch it closes the gap within the step, in penetration it pushes out, and with
/// restitution it bounces off the velocity at the start of the substep (block_restitution.cpp). `approach`: approach velocity without
/// contacts and elasticity, m/s. `rollingLag`, m/s, is added. Penetrations to `slop`, m, remain.
void setTarget(
	BlockContact& contact, const btContactSolverInfo& info, double approach, double rollingLag, double slop, IslandBlock& block )
{
	const btManifoldPoint& point = *contact.point;
	const double h = double( info.m_timeStep ), gap = double( point.m_distance1 );
	contact.targetWithoutBounce = gap > 0.0 ? -( gap + block.landingDepth( contact, gap ) ) / h
											: std::min( std::max( -gap - slop, 0.0 ) * double( info.m_erp2 ) / h, kPushOutSpeed );
	contact.targetWithoutBounce += rollingLag;
	contact.target = contact.targetWithoutBounce;
	const double impact = -contact.normal.dot( contact.velocityBefore );
	const double restitution = restitutionOf( contact, block );
	contact.bounces = gap < approach * h && restitution > 0.0 && impact > double( info.m_restitutionVelocityThreshold );
	if ( contact.bounces )
	{
		contact.target = std::max( contact.targetWithoutBounce, bounceVelocity( restitution, impact, gap, ( approach - impact ) / h, h ) );
	}
}

/// Pinned nodes share a contact, but not its impulses: they have their velocities prescribed.
void fixPinned( ContactSide& side, const ContactProxy* node, const Vec3d& normal )
{
	if ( side.soft < 0 || side.shared.count <= 1 )
	{
		return;
	}
	const NodeState& nodes = node->owner->impl().body->nodes();
	side.prescribedVelocity += side.shared.remove(
		normal, [&nodes]( int other ) { return nodes.freedom[other] == 0.0f; },
		[&nodes]( int other ) { return Vec3d( nodes.v.get( other ).cast<double>() ); } );
}

} // namespace

void BlockContacts::gather( const std::vector<btPersistentManifold*>& manifolds, const btContactSolverInfo& info, BlockLookup& lookup,
	std::deque<IslandBlock>& blocks, ManifoldFilter& taken )
{
	m_count = 0;
	m_hidden.clear();
	for ( btPersistentManifold* const manifold : manifolds )
	{
		gatherFrom( *manifold, info, lookup, blocks );
	}
	for ( const Hidden& hidden : m_hidden )
	{
		taken.add( *hidden.manifold );
	}
}

void BlockContacts::gatherFrom(
	btPersistentManifold& manifold, const btContactSolverInfo& info, BlockLookup& lookup, std::deque<IslandBlock>& blocks )
{
	const btCollisionObject* const objects[2] = { manifold.getBody0(), manifold.getBody1() };
	const ContactProxy* const nodes[2] = { asProxy( objects[0] ), asProxy( objects[1] ) };
	const int block = blockOf( manifold, lookup );
	if ( block < 0 )
	{
		if ( ( info.m_solverMode & SOLVER_USE_2_FRICTION_DIRECTIONS ) == 0 )
		{
			clearSecondDirection( manifold );
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
	const bool isMetAsDrawn = isDrawn( nodes[0], *objects[1] ) || isDrawn( nodes[1], *objects[0] );
	IslandBlock& own = blocks[std::size_t( block )];
	for ( int k = 0; k < manifold.getNumContacts(); ++k )
	{
		btManifoldPoint& point = manifold.getContactPoint( k );
		if ( double( point.m_distance1 ) > threshold )
		{
			continue;
		}
		BlockContact& contact = own.contacts.emplace_back(); // half a kilobyte: filled in place
		contact.normal = toVec3d( point.m_normalWorldOnB );
		contact.isDrawn = isMetAsDrawn;
		SharedNodes shared[2];
		const Vec3d position = contact.isDrawn ? distributeOnSurface( nodes, objects, point, shared ) : distributeToNodes( nodes, shared );
		for ( int side = 0; side < 2; ++side )
		{
			const Vec3d touches = toVec3d( side == 0 ? point.getPositionWorldOnA() : point.getPositionWorldOnB() );
			contact.side[side] = sideOf( *objects[side], block, lookup, nodes[0] || nodes[1] ? position : touches );
			contact.side[side].shared = nodes[side] ? shared[side] : SharedNodes{};
			fixPinned( contact.side[side], nodes[side], contact.normal );
		}
		contact.side[1].prescribedVelocity += surfaceVelocity( point, info );
		if ( !contact.moves() )
		{
			own.contacts.pop_back();
			continue;
		}
		contact.friction = double( point.m_combinedFriction );
		contact.restitution = double( point.m_appliedImpulse > 0 && hasRigidBounce( contact, own )
				? gCalculateCombinedRestitutionCallback( objects[0], objects[1] )
				: point.m_combinedRestitution );
		setFrictionScale( objects, contact, own );
		contact.point = &point;
		contact.normalImpulse = double( point.m_appliedImpulse );
		contact.tangentImpulse = double( point.m_appliedImpulseLateral1 ) * toVec3d( point.m_lateralFrictionDir1 ) +
			double( point.m_appliedImpulseLateral2 ) * toVec3d( point.m_lateralFrictionDir2 );
		contact.velocityBefore = own.velocityBefore( contact );
		const double rolling = contact.isDrawn ? own.rollingLag( contact, double( info.m_timeStep ) ) : 0.0;
		setTarget( contact, info, -contact.normal.dot( own.freeVelocity( contact ) ), rolling, slopOf( contact, objects, own ), own );
		++m_count;
	}
}

ContactSide BlockContacts::sideOf( const btCollisionObject& object, int block, BlockLookup& lookup, const Vec3d& at ) const
{
	ContactSide side;
	if ( const ContactProxy* node = asProxy( &object ) )
	{
		const NodeState& nodes = node->owner->impl().body->nodes();
		const bool isFree = node->node >= 0 && lookup.blockOf( *node->owner ) == block && nodes.freedom[node->node] != 0.0f;
		side.soft = isFree ? lookup.softPart( *node->owner ) : -1;
		side.node = node->node;
		side.prescribedVelocity = isFree ? Vec3d( Vec3d::Zero() ) : toVec3d( node->getLinearVelocity() );
		return side;
	}
	if ( isLink( object ) )
	{
		side.rigid = lookup.rigidPart( block, const_cast<btCollisionObject&>( object ) );
		side.arm = at - toVec3d( object.getWorldTransform().getOrigin() );
		return side;
	}
	// A kinematic object may have the static flag as well: Bullet sets it on every new object.
	btRigidBody* const rigid = btRigidBody::upcast( const_cast<btCollisionObject*>( &object ) );
	if ( !rigid || ( rigid->isStaticObject() && !rigid->isKinematicObject() ) )
	{
		return side;
	}
	const Vec3d arm = at - toVec3d( rigid->getCenterOfMassPosition() );
	if ( rigid->isKinematicObject() || rigid->getInvMass() == 0 )
	{
		side.prescribedVelocity = toVec3d( rigid->getLinearVelocity() ) + toVec3d( rigid->getAngularVelocity() ).cross( arm );
		return side;
	}
	side.rigid = lookup.rigidPart( block, *rigid );
	side.arm = arm;
	return side;
}

void BlockContacts::writeBack( IslandBlock& block )
{
	for ( BlockContact& contact : block.contacts )
	{
		if ( contact.isAttachment() )
		{
			continue;
		}
		btManifoldPoint& point = *contact.point;
		point.m_appliedImpulse = btScalar( std::max( 0.0, contact.normalImpulse ) );
		point.m_appliedImpulseLateral1 = btScalar( contact.tangentImpulse.dot( toVec3d( point.m_lateralFrictionDir1 ) ) );
		point.m_appliedImpulseLateral2 = btScalar( contact.tangentImpulse.dot( toVec3d( point.m_lateralFrictionDir2 ) ) );
	}
}

void BlockContacts::carryImpulses( IslandBlock& block )
{
	for ( const BlockContact& contact : block.contacts )
	{
		if ( !contact.isAttachment() )
		{
			contact.point->m_appliedImpulse = btScalar( std::max( 0.0, contact.carried ) );
		}
	}
}

void BlockContacts::unhide()
{
	for ( const Hidden& hidden : m_hidden )
	{
		hidden.manifold->setContactProcessingThreshold( hidden.threshold );
	}
	m_hidden.clear();
}

} // namespace pliant
