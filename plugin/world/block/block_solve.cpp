#include "world/block/block_solve.h"

#include "body/implicit/touched_nodes.h"
#include "threads/parallel.h"
#include "world/block/implicit_choice.h"
#include "world/bodies/soft_body_impl.h"
#include "world/constants.h"
#include "world/joints/attachments.h"

#include <BulletCollision/BroadphaseCollision/btDispatcher.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>
#include <BulletDynamics/ConstraintSolver/btContactSolverInfo.h>

#include <algorithm>

namespace pliant {

namespace {

/// Returns true if there is something of a body to solve: elasticity, contacts or attachments.
bool needsBlock( const SoftBody& body, const Attachments& attachments )
{
	const SoftBody::Impl& impl = body.impl();
	return impl.isImplicit || ( body.hasContactResponse() && !impl.touched.empty() ) ||
		( !attachments.isEmpty() && attachments.contain( body ) );
}

/// Bodies that break or flow need the strain of their impacts.
bool isFarSofterThanSet( const SoftBody& body )
{
	const SoftBody::Impl& impl = body.impl();
	const Material& material = body.material();
	return !impl.plan.reachable && impl.plan.reachedModulus < kRestitutionReach * material.youngsModulus &&
		material.method == Method::Lattice && material.yieldStrain == 0.0f && impl.body->fracture().rule == BreakRule::Never;
}

/// Lets a body that steps explicitly take part by its touched nodes, or by all of them where it must bounce as rigid; held bodies and those
/// in several parts have no rigid motion.
void join( SoftBody& body, SoftPart& part )
{
	Body& own = *body.impl().body;
	if ( isFarSofterThanSet( body ) )
	{
		part.motion = &own.joinFreely();
		part.bouncesAsRigid = !part.motion->hasHeldNodes() && !part.motion->parts().areSeveral();
	}
	else
	{
		part.touched = &own.joinByContacts();
		part.motion = &part.touched->motion();
	}
}

} // namespace

int BlockSolve::blockOf( const SoftBody& body ) const
{
	// A sleeping body keeps an index that another body may have now.
	const int block = body.impl().block;
	const bool isMember = block >= 0 && block < int( m_tagOf.size() ) &&
		std::size_t( body.impl().blockPart ) < m_blocks[std::size_t( block )].soft.size() &&
		m_blocks[std::size_t( block )].soft[std::size_t( body.impl().blockPart )].owner == &body;
	return isMember ? block : -1;
}

int BlockSolve::blockOfIsland( int tag ) const
{
	const auto found = std::find( m_tagOf.begin(), m_tagOf.end(), tag );
	return tag < 0 || found == m_tagOf.end() ? -1 : int( found - m_tagOf.begin() );
}

int BlockSolve::softPart( const SoftBody& body ) const
{
	return body.impl().blockPart;
}

int BlockSolve::rigidPart( int block, btCollisionObject& object )
{
	std::vector<RigidPart>& parts = m_blocks[std::size_t( block )].rigid;
	for ( std::size_t k = 0; k < parts.size(); ++k )
	{
		if ( parts[k].object == &object )
		{
			return int( k );
		}
	}
	RigidPart part;
	part.object = &object;
	if ( !m_moved.measure( object, part ) )
	{
		return -1;
	}
	OutsideImpulse& outside = outsideOf( object );
	outside.stamp = m_stamp;
	part.velocityBefore = m_moved.velocityOf( object );
	part.freeVelocity = part.velocityBefore + MovedObjects::forceOf( object, m_h ) + outside.change;
	for ( int k = 0; k < 3; ++k )
	{
		part.velocityBefore[k] = part.moves[k] ? part.velocityBefore[k] : 0.0;
		part.velocityBefore[3 + k] = part.turns[k] ? part.velocityBefore[3 + k] : 0.0;
		part.freeVelocity[k] = part.moves[k] ? part.freeVelocity[k] : 0.0;
		part.freeVelocity[3 + k] = part.turns[k] ? part.freeVelocity[3 + k] : 0.0;
	}
	parts.push_back( part );
	return int( parts.size() ) - 1;
}

OutsideImpulse& BlockSolve::outsideOf( const btCollisionObject& object )
{
	for ( OutsideImpulse& outside : m_outside )
	{
		if ( outside.object == &object )
		{
			return outside;
		}
	}
	m_outside.push_back( OutsideImpulse{ &object } );
	return m_outside.back();
}

void BlockSolve::forget( const btCollisionObject& object )
{
	std::erase_if( m_outside, [&]( const OutsideImpulse& outside ) { return outside.object == &object; } );
}

IslandBlock& BlockSolve::responseBlock( SoftBody& body, TaskRunner* runner )
{
	m_responseBlock.clear();
	SoftPart& part = m_responseBlock.soft.emplace_back();
	part.owner = &body;
	part.motion = body.impl().body->implicit();
	part.velocityBefore = &body.impl().body->velocityBefore();
	m_responseBlock.beginResponses( runner );
	return m_responseBlock;
}

// Makes one block per island with a deformable body. Bodies that step explicitly take part with their masses: their elastic forces are
// those of their own step.
void BlockSolve::makeBlocks( const std::vector<SoftBody*>& awake, const Attachments& attachments )
{
	m_tagOf.clear();
	for ( const SoftBody* body : awake )
	{
		if ( needsBlock( *body, attachments ) && std::find( m_tagOf.begin(), m_tagOf.end(), body->getIslandTag() ) == m_tagOf.end() )
		{
			m_tagOf.push_back( body->getIslandTag() );
		}
	}
	while ( m_blocks.size() < m_tagOf.size() )
	{
		m_blocks.emplace_back();
	}
	for ( IslandBlock& block : m_blocks )
	{
		block.clear();
	}
	for ( SoftBody* body : awake )
	{
		SoftBody::Impl& impl = body->impl();
		const auto found = std::find( m_tagOf.begin(), m_tagOf.end(), body->getIslandTag() );
		impl.block = impl.blockPart = -1;
		if ( found == m_tagOf.end() || ( !impl.isImplicit && !body->hasContactResponse() ) )
		{
			continue;
		}
		impl.block = int( found - m_tagOf.begin() );
		IslandBlock& block = m_blocks[std::size_t( impl.block )];
		impl.blockPart = int( block.soft.size() );
		SoftPart part;
		part.owner = body;
		part.velocityBefore = &impl.body->velocityBefore();
		if ( impl.isImplicit )
		{
			part.motion = impl.body->implicit();
			part.restitutionFraction = restitutionFraction( *body, m_h );
		}
		else
		{
			join( *body, part );
		}
		block.soft.push_back( part );
	}
}

void BlockSolve::before( const Scene& scene, TaskRunner* runner )
{
	Attachments& attachments = scene.attachments;
	const btContactSolverInfo& info = scene.info;
	m_count = BlockCount{};
	m_h = double( info.m_timeStep );
	++m_stamp;
	makeBlocks( scene.awake, attachments );
	std::for_each( m_blocks.begin(), m_blocks.end(),
		[&]( IslandBlock& block ) { block.bounceThreshold = double( info.m_restitutionVelocityThreshold ); } );
	if ( m_tagOf.empty() )
	{
		if ( scene.taken.mayContainAny() )
		{
			m_reach.choose( scene.dispatcher, attachments, *this, 0, scene.gravity, scene.taken, scene.onFrames );
			m_contacts.gather( m_reach.manifolds(), info, *this, m_blocks, scene.taken ); // finds none, and clears stale friction impulses
		}
		m_outside.clear();
		return;
	}
	m_reach.choose( scene.dispatcher, attachments, *this, int( m_tagOf.size() ), scene.gravity, scene.taken, scene.onFrames );
	m_contacts.gather( m_reach.manifolds(), info, *this, m_blocks, scene.taken );
	m_contacts.gatherAttachments( attachments, m_h, *this, m_blocks );
	for ( std::size_t k = 0; k < m_tagOf.size(); ++k )
	{
		m_moved.measureLinks( m_blocks[k] );
		if ( scene.joints.size() > 0 )
		{
			m_moved.measureJointed( m_blocks[k], attachments, scene.joints, m_h, double( info.m_erp ) );
		}
	}
	m_outside.erase(
		std::remove_if( m_outside.begin(), m_outside.end(), [this]( const OutsideImpulse& outside ) { return outside.stamp != m_stamp; } ),
		m_outside.end() );

	// Several islands: one task each. A single island: the threads share its products.
	const int blocks = int( m_tagOf.size() );
	std::vector<BlockCount> counts( m_tagOf.size() );
	TaskRunner* const within = blocks > 1 ? nullptr : runner;
	auto task = [&]( int k ) { counts[std::size_t( k )] = m_blocks[std::size_t( k )].solve( within ); };
	runTasks( blocks > 1 ? runner : nullptr, blocks, task );
	for ( int k = 0; k < blocks; ++k )
	{
		m_count.passes = std::max( m_count.passes, counts[std::size_t( k )].passes );
		m_count.products = std::max( m_count.products, counts[std::size_t( k )].products );
		storeVelocities( m_blocks[std::size_t( k )] );
		BlockContacts::writeBack( m_blocks[std::size_t( k )] );
		BlockContacts::storeForces( m_blocks[std::size_t( k )], attachments );
	}
}

// Subtracts what Bullet's solver will add: the forces, and the expected impulses of joints and rigid contacts.
void BlockSolve::storeVelocities( IslandBlock& block )
{
	for ( RigidPart& part : block.rigid )
	{
		if ( !isLink( *part.object ) )
		{
			part.expectedVelocity = part.isHit ? part.velocity : Vector6( part.velocity - outsideOf( *part.object ).change );
			if ( part.linked < 0 )
			{
				m_moved.move( part, part.expectedVelocity - MovedObjects::forceOf( *part.object, m_h ) );
			}
		}
	}
	m_moved.moveJointed( block );
	m_moved.moveLinks( block );
	for ( RigidPart& part : block.rigid )
	{
		if ( isLink( *part.object ) )
		{
			part.expectedVelocity = m_moved.velocityOf( *part.object );
		}
	}
}

void BlockSolve::after()
{
	m_contacts.unhide();
	for ( std::size_t k = 0; k < m_tagOf.size(); ++k )
	{
		for ( const RigidPart& part : m_blocks[k].rigid )
		{
			if ( part.isHit )
			{
				continue;
			}
			// e += r ( dV - e ), dV the change by Bullet's solver beyond the forces
			Vector6& expected = outsideOf( *part.object ).change;
			expected += kOutsideFraction * ( m_moved.velocityOf( *part.object ) - part.expectedVelocity - expected );
		}
		for ( const LinkedParts& whole : m_blocks[k].linked )
		{
			whole.joints ? whole.joints->reportImpulses() : void();
		}
	}
}

void BlockSolve::carryImpulses()
{
	for ( std::size_t k = 0; k < m_tagOf.size(); ++k )
	{
		BlockContacts::carryImpulses( m_blocks[k] );
	}
}

} // namespace pliant
