#include "world/step/soft_body_system.h"

#include "body/levels/levels.h"
#include "threads/constants.h"
#include "threads/parallel.h"
#include "world/bodies/soft_body_impl.h"
#include "world/constants.h"
#include "world/stopwatch.h"

#include <BulletCollision/CollisionDispatch/btCollisionConfiguration.h>
#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <LinearMath/btQuickprof.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

namespace pliant {

bool SoftBodySystem::moves( const SoftBody& body ) const
{
	return body.isActive() && body.isHealthy() && !body.isStaticOrKinematicObject();
}

bool SoftBodySystem::hasAwakeBody() const
{
	return std::any_of( m_bodies.begin(), m_bodies.end(), [this]( const SoftBody* body ) { return moves( *body ); } );
}

bool SoftBodySystem::isAwakeIn( int island ) const
{
	const auto isIn = [island]( const SoftBody* body ) { return body->getIslandTag() == island; };
	return island >= 0 && ( std::any_of( m_awake.begin(), m_awake.end(), isIn ) || std::any_of( m_rigid.begin(), m_rigid.end(), isIn ) );
}

void SoftBodySystem::beginPass( StepPass pass )
{
	m_pass = pass;
	m_contactsBefore = report.softContacts;
}

void SoftBodySystem::beginStep( btScalar gameStep, int substepCount )
{
	++m_steps;
	m_inBlocks.beginStep();
	m_gameStep = gameStep;
	m_substepCount = substepCount;
	report = StepReport{};
	report.substeps = substepCount;
	report.softBodies = int( m_bodies.size() );
	report.removedPieces = removedSinceStep;
	advanceFading( gameStep );
	limitDebris( gameStep );
	countNodes();
	moveHeldBodies();
	const btVector3 gravity = m_world.getGravity();
	const Vec3d up = gravity.isZero() ? Vec3d( Vec3d::Zero() ) : toVec3d( -gravity.normalized() );
	pairScratch.search.setCharacters( { up, double( m_world.getDispatchInfo().m_allowedCcdPenetration ), double( gameStep ) } );
	for ( SoftBody* body : m_bodies )
	{
		SoftBody::Impl& impl = body->impl();
		impl.plan = planOf( *body, gameStep, substepsOf( *body ) );
		impl.body->openLevelBudget();
		if ( impl.skin.fade.advance() )
		{
			impl.skin.isStale = true;
			impl.skin.isMapKnown = false;
		}
		report.awakeSoftBodies += moves( *body ) ? 1 : 0;
		report.implicitBodies += moves( *body ) && stepsImplicitly( *body ) ? 1 : 0;
		report.rigidBodies += impl.rigidProxy ? 1 : 0;
		report.quarantined += impl.isHealthy ? 0 : 1;
		report.unreachableStiffness += impl.plan.reachable || isReachableAwake( *body, gameStep ) ? 0 : 1;
	}
	keepDrawn();
}

void SoftBodySystem::keepDrawn()
{
	m_stale.clear();
	std::copy_if( m_bodies.begin(), m_bodies.end(), std::back_inserter( m_stale ),
		[]( const SoftBody* body ) { return body->impl().skin.blend != nullptr; } );
	auto keep = [this]( int k ) {
		SoftBody& body = *m_stale[std::size_t( k )];
		body.impl().keepDrawn( moves( body ) );
	};
	runTasks( m_stale.empty() ? nullptr : tasks(), int( m_stale.size() ), keep );
}

bool SoftBodySystem::isImplicitRigidPiece( const SoftBody& body ) const
{
	return body.material().elasticity != Elasticity::Explicit && body.impl().body->isInelastic();
}

/// Of a sleeping body, which takes one substep: whether its stiffness is in reach of those that it takes awake, or of the step that it
/// chooses.
bool SoftBodySystem::isReachableAwake( const SoftBody& body, btScalar gameStep ) const
{
	return !moves( body ) &&
		( body.material().elasticity == Elasticity::Automatic || planOf( body, gameStep, mostSubsteps( gameStep ) ).reachable );
}

StiffnessPlan SoftBodySystem::planOf( const SoftBody& body, btScalar gameStep, int count ) const
{
	Material material = body.material();
	material.elasticity = stepsImplicitly( body ) || isImplicitRigidPiece( body ) ? Elasticity::Implicit : Elasticity::Explicit;
	StiffnessPlan plan = planStiffness( material, body.bodyTemplate().cellSize(), float( gameStep ), count );
	stepsImplicitly( body ) ? limitStiffness( body, count, plan ) : void();
	return plan;
}

TaskRunner* SoftBodySystem::tasks() const
{
	return runner ? runner : ownRunner.get();
}

void SoftBodySystem::gatherAwake()
{
	m_awake.clear();
	m_rigid.clear();
	long long nodes = 0;
	for ( SoftBody* body : m_bodies )
	{
		if ( moves( *body ) && isInPass( *body ) )
		{
			if ( body->impl().rigidProxy )
			{
				m_rigid.push_back( body );
				continue;
			}
			m_awake.push_back( body );
			nodes += body->nodeCount();
		}
	}
	m_parallel.clear();
	m_serial.clear();
	for ( SoftBody* body : m_awake )
	{
		const int count = body->nodeCount();
		const bool exceedsMean = count >= 2 * kMinChunkSize && (long long)(count)*tasks()->threadCount() > nodes;
		( exceedsMean ? m_parallel : m_serial ).push_back( body );
	}
}

// Bodies with more nodes than the mean per thread are processed one after another by all threads together; each other body is one task.
// Results are bit-identical.
template <class F>
void SoftBodySystem::forAwake( F&& work )
{
	for ( SoftBody* body : m_parallel )
	{
		work( *body, tasks() );
	}
	auto alone = [&]( int k ) { work( *m_serial[std::size_t( k )], nullptr ); };
	runTasks( tasks(), int( m_serial.size() ), alone );
}

btVector3 SoftBodySystem::gravityOf( const SoftBody& body ) const
{
	return body.impl().hasOwnGravity ? body.impl().gravity : m_world.getGravity();
}

Vec3 SoftBodySystem::ownAcceleration( const SoftBody& body ) const
{
	const SoftBody::Impl& impl = body.impl();
	return toVec3( btScalar( impl.gravityShare ) * gravityOf( body ) + impl.centralForce / btScalar( impl.mass ) );
}

bool SoftBodySystem::isHeld( const SoftBody& body ) const
{
	return ( !attachments.isEmpty() && attachments.contain( body ) ) || frames.has( body );
}

// v' = v + g ( h0 + h ) / 2, h0 the last substep's length: the positions x' = x + h v' then lie on one parabola whatever the steps, as
// those of equal steps do. Not of bodies that can break: shards chatter on the ground in changing steps.
double SoftBodySystem::gravityShareOf( const SoftBody& body, double h ) const
{
	const SoftBody::Impl& impl = body.impl();
	const double last = impl.lastSubstep;
	const bool hasChanged = last > 0.0 && std::abs( last - h ) > kParallel * h;
	const bool isInFlight = hasChanged && body.fracture().rule == BreakRule::Never && impl.touched.empty() && impl.pins.empty() &&
		!impl.follower && !isHeld( body );
	return isInFlight ? 0.5 * ( last + h ) / h : 1.0;
}

void SoftBodySystem::accelerate( btScalar h, int substep )
{
	BT_PROFILE( "pliant: accelerate" );
	gatherAwake();
	placeFrames(); // bodies may have been teleported
	if ( breakBodies() )
	{
		gatherAwake();
	}
	adaptLevels( h );
	for ( SoftBody* body : m_awake )
	{
		body->impl().gravityShare = gravityShareOf( *body, double( h ) );
		body->impl().lastSubstep = double( h );
		drivePins( *body, h, substep );
		if ( PoseFollower* const follower = body->impl().follower.get() )
		{
			follower->pull( *body->impl().body, double( h ), substep, substepsOf( *body ), ownAcceleration( *body ) );
		}
	}
	pressFrames( true );
	{
		Stopwatch watch( report.matching );
		const ForceFields::Acting acting( fields );
		forAwake( [&]( SoftBody& body, TaskRunner* within ) {
			SoftBody::Impl& impl = body.impl();
			impl.isImplicit = stepsImplicitly( body );
			fields.push( body, gravityOf( body ), double( h ) );
			if ( impl.isImplicit )
			{
				impl.body->pushImplicitly( float( h ), impl.plan.alpha, ownAcceleration( body ), within );
				return;
			}
			impl.body->accelerateTowardGoals( float( h ), impl.plan.alpha, within );
		} );
	}
	{
		// After matching, which uses the positions and velocities of the last substep: damping must not reduce this substep's forces.
		Stopwatch watch( report.forces );
		forAwake( [&]( SoftBody& body, TaskRunner* within ) {
			if ( !body.impl().isImplicit )
			{
				body.impl().body->applyForces( float( h ), ownAcceleration( body ), within );
				drawToPose( body, h );
			}
		} );
	}
	accelerateRigid( h );
	pressFrames( false );
	for ( SoftBody* body : m_awake )
	{
		// Matching has rotated the cells: queries during the step must not use the surface drawn before it.
		body->impl().nodeAxes.clear();
		body->impl().skin.nodesMoved();
		++body->impl().skin.moves;
		body->impl().isBroken = !sweepBox( *body, h );
	}
	quarantineBroken();
}

void SoftBodySystem::equationsChanged( SoftBody& body ) const
{
	body.impl().isImplicit = body.impl().isImplicit && !areStagesRunning;
}

// The body's box must contain the swept spheres of its nodes in this step. This is also the last point where a number that is not finite
// can be caught before it reaches Bullet's broadphase, and with it every other body.
bool SoftBodySystem::sweepBox( SoftBody& body, btScalar h ) const
{
	SoftBody::Impl& impl = body.impl();
	const VelocityBounds& velocities = impl.body->velocities();
	const Vec3 low( velocities.low ), high( velocities.high );
	if ( velocities.worst != 0.0f || std::max( high.maxCoeff(), -low.minCoeff() ) > kSpeedLimit )
	{
		return false;
	}
	const btScalar overhang = btScalar( impl.overhang() );
	const btVector3 around( overhang, overhang, overhang );
	impl.shape->setSweep( h * toBt( low.cast<double>() ) - around, h * toBt( high.cast<double>() ) + around );
	return true;
}

void SoftBodySystem::quarantineBroken()
{
	for ( SoftBody* body : m_awake )
	{
		if ( body->impl().isBroken )
		{
			quarantine( *body );
		}
	}
}

void SoftBodySystem::quarantine( SoftBody& body )
{
	SoftBody::Impl& impl = body.impl();
	NodeState& nodes = impl.body->nodes();
	nodes.v.x[0] = std::numeric_limits<float>::quiet_NaN(); // makes integrate() restore the last finite state, for any error
	impl.body->integrate( 0.0f );
	impl.isHealthy = false;
	impl.stateBefore = body.getActivationState();
	impl.placeShape( body );
	body.forceActivationState( DISABLE_SIMULATION );
	++report.quarantined;
}

void SoftBodySystem::copyIslandTags()
{
	for ( SoftBody* body : m_bodies )
	{
		for ( ContactProxy* proxy : body->impl().touched )
		{
			proxy->setIslandTag( body->getIslandTag() );
		}
	}
}

void SoftBodySystem::solveImplicit(
	const btAlignedObjectArray<btTypedConstraint*>& joints, btDispatcher& dispatcher, const btContactSolverInfo& info )
{
	for ( SoftBody* body : m_bodies )
	{
		body->impl().block = -1; // may be the other pass's
	}
	double spent = 0.0; // s, counted as matching and not as Bullet's solver
	{
		Stopwatch watch( spent );
		implicitSolve().before(
			{ m_awake, attachments, joints, dispatcher, info, m_world.getGravity(), m_inBlocks, frames.partners( joints ) }, tasks() );
		noteImpacts( double( info.m_timeStep ) );
	}
	report.matching += spent;
	report.solve -= spent; // the caller's stopwatch includes it
	report.implicitPasses = std::max( report.implicitPasses, implicitSolve().count().passes );
	report.implicitProducts = std::max( report.implicitProducts, implicitSolve().count().products );
}

void SoftBodySystem::integrate( btScalar h, int substep )
{
	BT_PROFILE( "pliant: integrate" );
	forAwake( [&]( SoftBody& body, TaskRunner* within ) {
		SoftBody::Impl& impl = body.impl();
		impl.isBroken = false;
		if ( !moves( body ) )
		{
			return; // fell asleep in this substep
		}
		settlePins( body, h, substep );
		if ( impl.follower && impl.isImplicit )
		{
			impl.follower->sum( *impl.body, double( h ) ); // of the velocities of its solution
		}
		if ( impl.isImplicit && !isHeld( body ) )
		{
			impl.body->bendToArcs( float( h ), !impl.touched.empty() );
		}
		impl.body->noteTurns( float( h ) );
		impl.body->noteFrameTurn( float( h ) );
		impl.isBroken = impl.body->integrate( float( h ), within ) == BodyHealth::Quarantined;
		impl.placeSpheres( body, impl.body->motion(), within );
		impl.skin.nodesMoved();
	} );
	integrateRigid( h );
	quarantineBroken();
	placeFrames();
}

void SoftBodySystem::turnFrames()
{
	for ( SoftBody* body : m_awake )
	{
		body->impl().body->turnFrame();
	}
}

void SoftBodySystem::endStep()
{
	makeRigid( m_gameStep );
	attachments.endStep();
	countNodes();
	noteSleepers();
	for ( SoftBody* body : m_bodies )
	{
		if ( PoseFollower* const follower = body->impl().follower.get() )
		{
			follower->endStep( toVec3d( body->massCentre() ) );
		}
		if ( body->getActivationState() == ISLAND_SLEEPING )
		{
			NodeState& nodes = body->impl().body->nodes();
			nodes.v.resize( nodes.padded ); // all nodes of a sleeping body are at rest
			if ( body->impl().rigidProxy )
			{
				body->impl().body->setRigidVelocities( Vec3d::Zero(), Vec3d::Zero() );
			}
		}
	}
}

void SoftBodySystem::clearForces()
{
	for ( SoftBody* body : m_bodies )
	{
		SoftBody::Impl& impl = body->impl();
		impl.centralForce.setZero();
		if ( impl.hasNodeForces )
		{
			impl.body->nodes().force.resize( impl.body->nodes().padded );
			impl.hasNodeForces = false;
		}
	}
}

} // namespace pliant
