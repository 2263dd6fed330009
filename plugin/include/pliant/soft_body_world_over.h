#pragma once

// Soft bodies in any of Bullet's worlds: btDiscreteDynamicsWorld (SoftBodyWorld), btDiscreteDynamicsWorldMt, btMultiBodyDynamicsWorld,
// btSoftRigidDynamicsWorld, or the game's own subclass of one of them. Without a soft body in it, it is that world, bit for bit.
//
//     pliant::SoftBodyWorldOver<btMultiBodyDynamicsWorld> world( &dispatcher, &broadphase, &solver, &configuration );
//     world.addSoftBody( body );

#include "pliant/soft_body_host.h"

#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorldMt.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <type_traits>
#include <utility>

namespace pliant {

/// @cond INTERNAL
/// The multibodies of a world of class `Base`: none, where it is not derived from btMultiBodyDynamicsWorld.
template <class Base, class = void>
class MultiBodiesOver : public Base
{
protected:
	using Base::Base;
	virtual void noteRemoval( btMultiBody& body ) = 0;
	virtual void noteRemoval( btMultiBodyConstraint& joint ) = 0;
	btAlignedObjectArray<btMultiBody*>& multiBodies() { return m_noBodies; }
	btAlignedObjectArray<btMultiBodyConstraint*>& multiBodyJoints() { return m_noJoints; }

private:
	btAlignedObjectArray<btMultiBody*> m_noBodies;
	btAlignedObjectArray<btMultiBodyConstraint*> m_noJoints;
};

template <class Base>
class MultiBodiesOver<Base, std::enable_if_t<std::is_base_of_v<btMultiBodyDynamicsWorld, Base>>> : public Base
{
public:
	void removeMultiBody( btMultiBody* body ) override
	{
		noteRemoval( *body );
		Base::removeMultiBody( body );
	}
	void removeMultiBodyConstraint( btMultiBodyConstraint* joint ) override
	{
		noteRemoval( *joint );
		Base::removeMultiBodyConstraint( joint );
	}

protected:
	using Base::Base;
	virtual void noteRemoval( btMultiBody& body ) = 0;
	virtual void noteRemoval( btMultiBodyConstraint& joint ) = 0;
	btAlignedObjectArray<btMultiBody*>& multiBodies() { return this->m_multiBodies; }
	btAlignedObjectArray<btMultiBodyConstraint*>& multiBodyJoints() { return this->m_multiBodyConstraints; }
};
/// @endcond

/// A world of class `Base`, which is btDiscreteDynamicsWorld or derived from it, that holds soft bodies too. SoftBodyHost declares the
/// calls beyond Bullet's own.
template <class Base>
class SoftBodyWorldOver : public MultiBodiesOver<Base>, public SoftBodyHost, private BulletStages
{
	static_assert(
		std::is_base_of_v<btDiscreteDynamicsWorld, Base>, "Soft bodies need a btDiscreteDynamicsWorld or a class derived from it" );

public:
	BT_DECLARE_ALIGNED_ALLOCATOR();

	/// Takes the arguments of Base's constructor.
	template <class... Arguments>
	explicit SoftBodyWorldOver( Arguments&&... arguments ) : MultiBodiesOver<Base>( std::forward<Arguments>( arguments )... )
	{
		using Discrete = btDiscreteDynamicsWorld;
		hostAttach( *this,
			Parts{ *this, this->m_nonStaticRigidBodies, this->m_constraints, this->multiBodies(), this->multiBodyJoints(), this->m_actions,
				this->m_predictiveManifolds, this->m_collisionObjects, this->m_dispatcher1, this->m_islandManager,
				this->m_internalPreTickCallback, this->m_internalTickCallback, this->m_localTime, this->m_fixedTimeStep,
				std::is_base_of_v<btDiscreteDynamicsWorldMt, Base>,
				!std::is_same_v<decltype( &Probe::internalSingleStepSimulation ), void ( Discrete::* )( btScalar )>,
				!std::is_same_v<decltype( &Probe::calculateSimulationIslands ), void ( Discrete::* )()> &&
					!std::is_same_v<decltype( &Probe::calculateSimulationIslands ), void ( btMultiBodyDynamicsWorld::* )()> } );
	}
	~SoftBodyWorldOver() override { hostDetach(); }

	/// As SoftBodyHost::addSoftBody.
	void addSoftBody( SoftBody* body, int group = btBroadphaseProxy::DefaultFilter, int mask = btBroadphaseProxy::AllFilter )
	{
		SoftBodyHost::addSoftBody( body, group, mask );
	}
	/// The base's own, where it has one for Bullet's soft bodies (btSoftRigidDynamicsWorld).
	template <class Body, class World = Base>
	auto addSoftBody( Body* body, int group = btBroadphaseProxy::DefaultFilter, int mask = btBroadphaseProxy::AllFilter )
		-> decltype( std::declval<World&>().addSoftBody( body, group, mask ) )
	{
		World::addSoftBody( body, group, mask );
	}
	/// As SoftBodyHost::removeSoftBody.
	void removeSoftBody( SoftBody* body ) { SoftBodyHost::removeSoftBody( body ); }
	/// The base's own, where it has one for Bullet's soft bodies.
	template <class Body, class World = Base>
	auto removeSoftBody( Body* body ) -> decltype( std::declval<World&>().removeSoftBody( body ) )
	{
		World::removeSoftBody( body );
	}

	/// As Bullet's. While a soft body is in the world a time step that is negative with maxSubSteps 0, NaN or infinite, and a fixedTimeStep
	/// that is no positive number, and a call out of a contact callback, do nothing and return 0; a single step (timeStep with maxSubSteps
	/// 0, else fixedTimeStep) is cut to 1 s.
	int stepSimulation( btScalar timeStep, int maxSubSteps = 1, btScalar fixedTimeStep = btScalar( 1. ) / btScalar( 60. ) ) override
	{
		return isPlain() || beginTick( timeStep, maxSubSteps, fixedTimeStep ) ? Base::stepSimulation( timeStep, maxSubSteps, fixedTimeStep )
																			  : 0;
	}
	/// A soft body is added as by addSoftBody; Bullet's default filter, which is for static objects, is replaced by a dynamic body's. The
	/// contact proxy of a soft body's node in a manifold is never added itself.
	void addCollisionObject( btCollisionObject* object, int group = btBroadphaseProxy::StaticFilter,
		int mask = btBroadphaseProxy::AllFilter ^ btBroadphaseProxy::StaticFilter ) override
	{
		hostAdd( object, group, mask );
	}
	/// As Bullet's. The contact proxy of a soft body's node in a manifold is ignored: it is in no world.
	void addRigidBody( btRigidBody* body ) override
	{
		if ( hostMayAdd( body ) )
		{
			Base::addRigidBody( body );
		}
	}
	/// As Bullet's; ignores the same as the other overload.
	void addRigidBody( btRigidBody* body, int group, int mask ) override
	{
		if ( hostMayAdd( body ) )
		{
			Base::addRigidBody( body, group, mask );
		}
	}
	/// Removes a soft body as by removeSoftBody, also if it is named by the contact proxy of one of its nodes in a manifold.
	void removeCollisionObject( btCollisionObject* object ) override { hostRemove( object ); }
	/// As Bullet's. Releases the pins to the body and wakes the objects that touch it. For the contact proxy of a soft body's node in a
	/// manifold that soft body is removed.
	void removeRigidBody( btRigidBody* body ) override
	{
		if ( !hostMayAdd( body ) )
		{
			hostRemove( body );
			return;
		}
		hostForget( *body );
		Base::removeRigidBody( body );
	}
	/// As Bullet's.
	void removeConstraint( btTypedConstraint* constraint ) override
	{
		hostForget( *constraint );
		Base::removeConstraint( constraint );
	}
	/// As Bullet's, and the forces on soft bodies. Ends the game step: FractureEvents of the next one replace the present ones.
	void clearForces() override
	{
		Base::clearForces();
		isPlain() ? void() : endTick();
	}
	/// As Bullet's; skins of soft bodies with SoftBody::setInterpolation are drawn at the same time.
	void synchronizeMotionStates() override
	{
		hostNoteTime( this->m_localTime, this->m_latencyMotionStateInterpolation ? this->m_fixedTimeStep : btScalar( 0 ) );
		Base::synchronizeMotionStates();
	}
	/// Soft bodies are drawn as the links of their surface (DBG_DrawWireframe) and crosses at pinned nodes (DBG_DrawConstraints), or as
	/// SoftBodyHost::setDebugDrawing says.
	void debugDrawWorld() override
	{
		Base::debugDrawWorld();
		hostDrawPins();
	}
	/// As Bullet's; soft bodies as stated at debugDrawWorld.
	void debugDrawObject( const btTransform& transform, const btCollisionShape* shape, const btVector3& colour ) override
	{
		if ( !hostDrawShape( shape, colour ) )
		{
			Base::debugDrawObject( transform, shape, colour );
		}
	}
	/// Writes the same as Bullet's world without soft bodies, their shapes and their contacts.
	void serialize( btSerializer* serializer ) override { hostSerialize( *serializer ); }
	/// As Bullet's, contacts of soft bodies included.
	void solveConstraints( btContactSolverInfo& info ) override { isPlain() ? Base::solveConstraints( info ) : solveStage( info ); }

protected:
	// The stages of a step, in Bullet's order. timeStep in s.
	/// As Bullet's, with soft substeps where soft bodies need them. The following stages may be called several times per step then.
	void internalSingleStepSimulation( btScalar timeStep ) override
	{
		isPlain() ? Base::internalSingleStepSimulation( timeStep ) : singleStep( timeStep );
	}
	/// As Bullet's; for soft bodies shape matching, forces, pins, breaking and levels of detail.
	void predictUnconstraintMotion( btScalar timeStep ) override
	{
		isPlain() ? Base::predictUnconstraintMotion( timeStep ) : predictStage( timeStep );
	}
	/// As Bullet's; finds contacts of fast rigid bodies with nodes too.
	void createPredictiveContacts( btScalar timeStep ) override
	{
		isPlain() ? Base::createPredictiveContacts( timeStep ) : predictiveContactsStage( timeStep );
	}
	/// As Bullet's, contacts of soft bodies included.
	void performDiscreteCollisionDetection() override { isPlain() ? Base::performDiscreteCollisionDetection() : detectStage(); }
	/// As Bullet's, with soft bodies as members of islands.
	void calculateSimulationIslands() override { isPlain() ? Base::calculateSimulationIslands() : islandsStage(); }
	/// As Bullet's; moves the nodes of soft bodies too.
	void integrateTransforms( btScalar timeStep ) override
	{
		isPlain() ? Base::integrateTransforms( timeStep ) : integrateStage( timeStep );
	}
	/// As Bullet's; soft bodies fall asleep too.
	void updateActivationState( btScalar timeStep ) override
	{
		isPlain() ? Base::updateActivationState( timeStep ) : activationStage( timeStep );
	}

private:
	/// Sees which class declares Base's protected functions.
	struct Probe : Base
	{
		using Base::calculateSimulationIslands;
		using Base::internalSingleStepSimulation;
	};

	void predict( btScalar h ) final { predictUnconstraintMotion( h ); }
	void findPredictiveContacts( btScalar h ) final { createPredictiveContacts( h ); }
	void detect() final { performDiscreteCollisionDetection(); }
	void findIslands() final { calculateSimulationIslands(); }
	void solve( btContactSolverInfo& info ) final { solveConstraints( info ); }
	void integrate( btScalar h ) final { integrateTransforms( h ); }
	void updateActivation( btScalar h ) final { updateActivationState( h ); }

	void basePredict( btScalar h ) final { Base::predictUnconstraintMotion( h ); }
	void baseFindPredictiveContacts( btScalar h ) final { Base::createPredictiveContacts( h ); }
	void baseDetect() final { Base::performDiscreteCollisionDetection(); }
	void baseFindIslands() final { Base::calculateSimulationIslands(); }
	void baseSolve( btContactSolverInfo& info ) final { Base::solveConstraints( info ); }
	void baseIntegrate( btScalar h ) final { Base::integrateTransforms( h ); }
	void baseUpdateActivation( btScalar h ) final { Base::updateActivationState( h ); }
	void baseSingleStep( btScalar h ) final { Base::internalSingleStepSimulation( h ); }

	void releasePredictiveContacts() final { Base::releasePredictiveContacts(); }
	void updateActions( btScalar h ) final { Base::updateActions( h ); }
	void baseAdd( btCollisionObject* object, int group, int mask ) final { Base::addCollisionObject( object, group, mask ); }
	void baseRemove( btCollisionObject* object ) final { Base::removeCollisionObject( object ); }
	void baseSerialize( btSerializer* serializer ) final { Base::serialize( serializer ); }
	void noteRemoval( btMultiBody& body ) final { hostForget( body ); }
	void noteRemoval( btMultiBodyConstraint& joint ) final { hostForget( joint ); }
};

} // namespace pliant
