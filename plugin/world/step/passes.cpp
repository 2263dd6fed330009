// One pass over the step (substep_group.h): the arrays, boxes, pairs, manifolds and islands that Bullet's stages see.

#include "world/step/world_step.h"

#include "world/bodies/manifolds.h"
#include "world/bodies/soft_body_impl.h"
#include "world/detect/pair_contacts.h"
#include "world/rigid/lost_contacts.h"
#include "world/step/swept_box.h"

#include <BulletCollision/CollisionDispatch/btSimulationIslandManager.h>
#include <BulletDynamics/Featherstone/btMultiBodyConstraint.h>
#include <LinearMath/btQuickprof.h>

#include <algorithm>

namespace pliant {

namespace {

/// Passes the pairs of one pass to the dispatcher's near callback, the game's or Bullet's own.
struct PassPairs : btOverlapCallback
{
	PassPairs( btCollisionDispatcher& target, const btDispatcherInfo& dispatchInfo, const SoftBodySystem& system, bool later ) :
		dispatcher( target ), info( dispatchInfo ), bodies( system ), isLater( later )
	{}

	bool processOverlap( btBroadphasePair& pair ) override
	{
		const auto& a = *static_cast<const btCollisionObject*>( pair.m_pProxy0->m_clientObject );
		const auto& b = *static_cast<const btCollisionObject*>( pair.m_pProxy1->m_clientObject );
		if ( bodies.isPairInPass( a, b ) && !( isLater && refresh( pair, a, b ) ) )
		{
			dispatcher.getNearCallback()( pair, dispatcher, info );
		}
		return false;
	}

	/// Contacts of hulls with each other and with rigid objects are found once a game step, as in Bullet's world; in later substeps their
	/// points move with the objects. Returns false for other pairs.
	bool refresh( btBroadphasePair& pair, const btCollisionObject& a, const btCollisionObject& b )
	{
		if ( !pair.m_algorithm || !areRigid( a, b ) )
		{
			return false;
		}
		refreshPair( pair, manifolds, info );
		return true;
	}

	/// Whether one is a soft body in its rigid state, and the other one too or a rigid object.
	static bool areRigid( const btCollisionObject& a, const btCollisionObject& b )
	{
		const SoftBody *const first = SoftBody::upcast( &a ), *const second = SoftBody::upcast( &b );
		return ( first || second ) && ( !first || first->isRigid() ) && ( !second || second->isRigid() );
	}

	btCollisionDispatcher& dispatcher;
	const btDispatcherInfo& info;
	const SoftBodySystem& bodies;
	bool isLater; ///< not the first substep of the game step
	btManifoldArray manifolds;
};

bool isDynamic( const btCollisionObject& object )
{
	return !object.isStaticOrKinematicObject();
}

void scaleImpulses( btPersistentManifold& manifold, btScalar factor )
{
	for ( int k = 0; k < manifold.getNumContacts(); ++k )
	{
		btManifoldPoint& point = manifold.getContactPoint( k );
		point.m_appliedImpulse *= factor;
		point.m_appliedImpulseLateral1 *= factor;
		point.m_appliedImpulseLateral2 *= factor;
	}
}

} // namespace

void WorldStep::beginPass( StepPass pass )
{
	bodies.beginPass( pass );
	if ( !bodies.group.isSplit() )
	{
		return;
	}
	const auto belongs = [&]( const btCollisionObject& object ) { return bodies.isInPass( object ); };
	m_rigid.hide( m_parts.rigidBodies, belongs );
	m_joints.hide( m_parts.constraints, [&]( const btTypedConstraint& joint ) {
		const btRigidBody &a = joint.getRigidBodyA(), &b = joint.getRigidBodyB();
		return bodies.group.contains( a ) || bodies.group.contains( b ) ? pass == StepPass::Substeps : pass == StepPass::Whole;
	} );
	m_multiBodies.hide( m_parts.multiBodies, [&]( const btMultiBody& body ) { return bodies.group.moves( pass, body ); } );
	m_multiBodyJoints.hide( m_parts.multiBodyJoints, [&]( btMultiBodyConstraint& joint ) {
		const btMultiBody* const first = joint.getMultiBodyA(); // the second one may be a rigid body
		return first ? bodies.group.moves( pass, *first ) : pass == StepPass::Whole;
	} );
}

void WorldStep::endPass()
{
	if ( bodies.group.isSplit() )
	{
		m_rigid.restore( m_parts.rigidBodies );
		m_joints.restore( m_parts.constraints );
		m_multiBodies.restore( m_parts.multiBodies );
		m_multiBodyJoints.restore( m_parts.multiBodyJoints );
	}
}

// Start impulses solved in a step of another length are scaled to this one, so that they represent the same force. This applies to islands
// with an awake soft body and to contacts of objects that have entered or left the group; others are left as Bullet has them.
void WorldStep::carryImpulses( btScalar h )
{
	const Lengths before = m_lengths;
	if ( m_substep != 0 || before.whole == 0 || ( before.whole == h && before.substep == h ) )
	{
		return;
	}
	forEachManifold( *m_parts.dispatcher, [&]( btPersistentManifold& manifold ) {
		const bool wasSubstep = bodies.group.didContain( *manifold.getBody0() ) || bodies.group.didContain( *manifold.getBody1() );
		const bool hasChanged = wasSubstep != ( bodies.pass() == StepPass::Substeps );
		const btScalar lengthBefore = wasSubstep ? before.substep : before.whole;
		const int island = std::max( manifold.getBody0()->getIslandTag(), manifold.getBody1()->getIslandTag() );
		if ( lengthBefore != h &&
			( hasChanged || isContactProxy( manifold.getBody0() ) || isContactProxy( manifold.getBody1() ) || bodies.isAwakeIn( island ) ) )
		{
			scaleImpulses( manifold, h / lengthBefore );
		}
	} );
}

void WorldStep::showPass()
{
	if ( !bodies.group.isSplit() )
	{
		return;
	}
	const bool isSubstep = bodies.pass() == StepPass::Substeps;
	m_view.show( *m_parts.dispatcher, [&]( btPersistentManifold& manifold ) {
		const btCollisionObject* const objects[2] = { manifold.getBody0(), manifold.getBody1() };
		const bool isMember[2] = { bodies.group.contains( *objects[0] ), bodies.group.contains( *objects[1] ) };
		if ( ( isMember[0] || isMember[1] ) != isSubstep )
		{
			return false;
		}
		for ( int side = 0; side < 2; ++side )
		{
			btCollisionObject& other = ownerOf( *objects[side] );
			if ( isMember[side] || !isSubstep || !SubstepGroup::canMove( other ) )
			{
				continue;
			}
			if ( manifold.getNumContacts() == 0 )
			{
				return false; // the object is in no island of this pass
			}
			bodies.group.noteContact( other, ownerOf( *objects[1 - side] ) );
			m_outside.add( other );
		}
		return true;
	} );
	m_parts.dispatcher = &m_view;
}

// The broadphase runs once a game step, as in Bullet's world: boxes of objects in the group contain their motion in all substeps. It runs
// again if an object leaves its box.
void WorldStep::updateBoxes()
{
	bool isOutdated = bodies.pass() == StepPass::Whole;
	for ( int i = 0; i < m_parts.objects.size(); ++i )
	{
		btCollisionObject& object = *m_parts.objects[i];
		if ( bodies.pass() == StepPass::Whole && bodies.group.contains( object ) )
		{
			const SweptBox box = broadphaseBoxOf( object, m_parts.world.getGravity(), m_gameStep );
			m_parts.world.getBroadphase()->setAabb( object.getBroadphaseHandle(), box.low, box.high, m_parts.dispatcher );
		}
		else if ( bodies.pass() == StepPass::Whole ? m_parts.world.getForceUpdateAllAabbs() || object.isActive()
												   : bodies.group.contains( object ) && !isInBroadphaseBox( object ) )
		{
			m_parts.world.updateSingleAabb( &object );
			isOutdated = true;
		}
		SweptBox swept;
		if ( bodies.pass() == StepPass::Whole && m_kinematic.boxOf( object, swept.low, swept.high ) )
		{
			m_parts.world.getBroadphase()->setAabb( object.getBroadphaseHandle(), swept.low, swept.high, m_parts.dispatcher );
		}
	}
	if ( isOutdated )
	{
		m_parts.world.computeOverlappingPairs();
	}
}

// btCollisionWorld::performDiscreteCollisionDetection, for the objects of the pass.
void WorldStep::detectPass()
{
	updateBoxes();
	PassPairs pairs( *static_cast<btCollisionDispatcher*>( m_parts.dispatcher ), m_parts.world.getDispatchInfo(), bodies, m_substep > 0 );
	m_parts.world.getBroadphase()->getOverlappingPairCache()->processAllOverlappingPairs(
		&pairs, m_parts.dispatcher, m_parts.world.getDispatchInfo() );
}

// The worlds' calculateSimulationIslands, for the objects of the pass.
void WorldStep::findPassIslands()
{
	BT_PROFILE( "calculateSimulationIslands" );
	btSimulationIslandManager& islands = *m_parts.islandManager;
	islands.updateActivationState( &m_parts.world, m_parts.dispatcher );
	const auto unite = [&]( const btCollisionObject* a, const btCollisionObject* b ) {
		if ( a && b && isDynamic( *a ) && isDynamic( *b ) && bodies.isInPass( *a ) && bodies.isInPass( *b ) )
		{
			islands.getUnionFind().unite( a->getIslandTag(), b->getIslandTag() );
		}
	};
	for ( int i = 0; i < m_parts.predictiveManifolds.size(); ++i )
	{
		unite( m_parts.predictiveManifolds[i]->getBody0(), m_parts.predictiveManifolds[i]->getBody1() );
	}
	for ( int i = 0; i < m_parts.constraints.size(); ++i )
	{
		if ( m_parts.constraints[i]->isEnabled() )
		{
			unite( &m_parts.constraints[i]->getRigidBodyA(), &m_parts.constraints[i]->getRigidBodyB() );
		}
	}
	for ( int i = 0; i < m_parts.multiBodies.size(); ++i )
	{
		const btCollisionObject* previous = nullptr;
		forEachCollider( *m_parts.multiBodies[i], [&]( const btCollisionObject& link ) {
			unite( previous, &link );
			previous = isDynamic( link ) ? &link : previous;
		} );
	}
	for ( int i = 0; i < m_parts.multiBodyJoints.size(); ++i )
	{
		const int a = m_parts.multiBodyJoints[i]->getIslandIdA(), b = m_parts.multiBodyJoints[i]->getIslandIdB();
		if ( std::min( a, b ) >= 0 && std::max( a, b ) < islands.getUnionFind().getNumElements() ) // else of an object outside the pass
		{
			islands.getUnionFind().unite( a, b );
		}
	}
	islands.storeIslandActivationState( &m_parts.world );
}

} // namespace pliant
