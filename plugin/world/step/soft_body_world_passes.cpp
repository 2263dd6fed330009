// What Bullet's stages see of the world in one pass over the step (substep_group.h): arrays, boxes, pairs, manifolds, islands.

#include "world/step/soft_body_world_impl.h"

#include "world/bodies/prefetch.h"
#include "world/bodies/soft_body_impl.h"
#include "world/step/island_manager.h"

#include <LinearMath/btQuickprof.h>

#include <algorithm>

namespace pliant {

namespace {

/// The pairs of one pass, handed to the game's or Bullet's own near callback.
struct PassPairs : btOverlapCallback
{
	PassPairs( btCollisionDispatcher& to, const btDispatcherInfo& how, const SoftBodySystem& whose ) :
		dispatcher( to ), info( how ), bodies( whose )
	{}

	bool processOverlap( btBroadphasePair& pair ) override
	{
		const auto& a = *static_cast<const btCollisionObject*>( pair.m_pProxy0->m_clientObject );
		const auto& b = *static_cast<const btCollisionObject*>( pair.m_pProxy1->m_clientObject );
		if ( bodies.isPairInPass( a, b ) )
		{
			dispatcher.getNearCallback()( pair, dispatcher, info );
		}
		return false;
	}

	btCollisionDispatcher& dispatcher;
	const btDispatcherInfo& info;
	const SoftBodySystem& bodies;
};

bool isDynamic( const btCollisionObject& object )
{
	return !object.isStaticOrKinematicObject();
}

/// The object of a contact: of a node's body, the soft body behind it.
btCollisionObject& ownerOf( const btCollisionObject& object )
{
	SoftBody* const owner = ownerOfContactProxy( &object );
	return owner ? static_cast<btCollisionObject&>( *owner ) : const_cast<btCollisionObject&>( object );
}

void scaleImpulses( btPersistentManifold& manifold, btScalar by )
{
	for ( int k = 0; k < manifold.getNumContacts(); ++k )
	{
		btManifoldPoint& point = manifold.getContactPoint( k );
		point.m_appliedImpulse *= by;
		point.m_appliedImpulseLateral1 *= by;
		point.m_appliedImpulseLateral2 *= by;
	}
}

} // namespace

void SoftBodyWorld::System::beginPass( SoftBodyWorld& world, StepPass pass )
{
	bodies.beginPass( pass );
	if ( !bodies.group.isSplit() )
	{
		return;
	}
	const auto belongs = [&]( const btCollisionObject& object ) { return bodies.isInPass( object ); };
	rigid.hide( world.m_nonStaticRigidBodies, belongs );
	joints.hide( world.m_constraints, [&]( const btTypedConstraint& joint ) {
		const btRigidBody &a = joint.getRigidBodyA(), &b = joint.getRigidBodyB();
		return bodies.group.contains( a ) || bodies.group.contains( b ) ? pass == StepPass::Substeps : pass == StepPass::Whole;
	} );
}

void SoftBodyWorld::System::endPass( SoftBodyWorld& world )
{
	if ( bodies.group.isSplit() )
	{
		rigid.restore( world.m_nonStaticRigidBodies );
		joints.restore( world.m_constraints );
	}
}

// Impulses that were found in a step of another length start the solver as hard as they pressed, in islands with an awake soft body and
// where something has entered the group or left it. Else they are Bullet's, which leaves them alone.
void SoftBodyWorld::System::carryImpulses( SoftBodyWorld& world, btScalar h )
{
	const Lengths before = lengths;
	if ( substep != 0 || before.whole == 0 || ( before.whole == h && before.substep == h ) )
	{
		return;
	}
	forEachManifold( *world.m_dispatcher1, prefetchEnd, [&]( btPersistentManifold& manifold ) {
		const bool wasSubstep = bodies.group.didContain( *manifold.getBody0() ) || bodies.group.didContain( *manifold.getBody1() );
		const bool hasChanged = wasSubstep != ( bodies.pass() == StepPass::Substeps );
		const btScalar then = wasSubstep ? before.substep : before.whole;
		const int island = std::max( manifold.getBody0()->getIslandTag(), manifold.getBody1()->getIslandTag() );
		if ( then != h &&
			( hasChanged || isContactProxy( manifold.getBody0() ) || isContactProxy( manifold.getBody1() ) || bodies.isAwakeIn( island ) ) )
		{
			scaleImpulses( manifold, h / then );
		}
	} );
}

void SoftBodyWorld::System::showPass( SoftBodyWorld& world )
{
	if ( !bodies.group.isSplit() )
	{
		return;
	}
	const bool isSubstep = bodies.pass() == StepPass::Substeps;
	view.show( *world.m_dispatcher1, [&]( btPersistentManifold& manifold ) {
		const btCollisionObject* const objects[2] = { manifold.getBody0(), manifold.getBody1() };
		const bool isMember[2] = { bodies.group.contains( *objects[0] ), bodies.group.contains( *objects[1] ) };
		if ( ( isMember[0] || isMember[1] ) != isSubstep )
		{
			return false;
		}
		for ( int side = 0; side < 2; ++side )
		{
			btCollisionObject& other = ownerOf( *objects[side] );
			if ( isMember[side] || !isSubstep || !isDynamic( other ) )
			{
				continue;
			}
			if ( manifold.getNumContacts() == 0 )
			{
				return false; // it is in no island of this pass
			}
			bodies.group.noteContact( other, ownerOf( *objects[1 - side] ) );
			lent.lend( other );
		}
		return true;
	} );
	world.m_dispatcher1 = &view;
}

// The broadphase runs once a game step, as in Bullet's world: objects of the group have boxes that hold what they may sweep in all
// substeps. Should one leave its box it runs again.
void SoftBodyWorld::System::updateBoxes( SoftBodyWorld& world )
{
	bool isOutdated = bodies.pass() == StepPass::Whole;
	for ( int i = 0; i < world.m_collisionObjects.size(); ++i )
	{
		btCollisionObject& object = *world.m_collisionObjects[i];
		if ( bodies.pass() == StepPass::Whole && bodies.group.contains( object ) )
		{
			const SubstepGroup::Box box = SubstepGroup::sweptBox( object, world.m_gravity, gameStep );
			world.m_broadphasePairCache->setAabb( object.getBroadphaseHandle(), box.low, box.high, world.m_dispatcher1 );
		}
		else if ( bodies.pass() == StepPass::Whole ? world.getForceUpdateAllAabbs() || object.isActive()
												   : bodies.group.contains( object ) && !SubstepGroup::isInBox( object ) )
		{
			world.updateSingleAabb( &object );
			isOutdated = true;
		}
	}
	if ( isOutdated )
	{
		world.computeOverlappingPairs();
	}
}

// As btCollisionWorld does it for all objects.
void SoftBodyWorld::System::detectPass( SoftBodyWorld& world )
{
	updateBoxes( world );
	PassPairs pairs( *static_cast<btCollisionDispatcher*>( world.m_dispatcher1 ), world.getDispatchInfo(), bodies );
	world.m_broadphasePairCache->getOverlappingPairCache()->processAllOverlappingPairs(
		&pairs, world.m_dispatcher1, world.getDispatchInfo() );
}

// Bullet's, for the objects of the pass.
void SoftBodyWorld::calculateSimulationIslands()
{
	SoftBodySystem& bodies = m_system->bodies;
	if ( !bodies.group.isSplit() )
	{
		btDiscreteDynamicsWorld::calculateSimulationIslands();
		return;
	}
	BT_PROFILE( "calculateSimulationIslands" );
	m_islandManager->updateActivationState( this, m_dispatcher1 );
	const auto unite = [&]( const btCollisionObject* a, const btCollisionObject* b ) {
		if ( a && b && isDynamic( *a ) && isDynamic( *b ) && bodies.isInPass( *a ) && bodies.isInPass( *b ) )
		{
			m_islandManager->getUnionFind().unite( a->getIslandTag(), b->getIslandTag() );
		}
	};
	for ( int i = 0; i < m_predictiveManifolds.size(); ++i )
	{
		unite( m_predictiveManifolds[i]->getBody0(), m_predictiveManifolds[i]->getBody1() );
	}
	for ( int i = 0; i < m_constraints.size(); ++i )
	{
		if ( m_constraints[i]->isEnabled() )
		{
			unite( &m_constraints[i]->getRigidBodyA(), &m_constraints[i]->getRigidBodyB() );
		}
	}
	m_islandManager->storeIslandActivationState( this );
}

} // namespace pliant
