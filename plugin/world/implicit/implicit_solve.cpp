#include "world/implicit/implicit_solve.h"

#include "threads/parallel.h"
#include "world/bodies/soft_body_impl.h"
#include "world/constants.h"

#include <BulletCollision/BroadphaseCollision/btDispatcher.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>
#include <BulletDynamics/ConstraintSolver/btContactSolverInfo.h>

#include <algorithm>

namespace pliant {

namespace {

Vector6 speedOf( const btRigidBody& body )
{
	Vector6 speed;
	speed << toVec3d( body.getLinearVelocity() ), toVec3d( body.getAngularVelocity() );
	return speed;
}

/// What Bullet's solver adds by itself: h F / M and h I^-1 T.
Vector6 forceOf( const btRigidBody& body, double h )
{
	Vector6 force;
	force << h * double( body.getInvMass() ) * toVec3d( body.getTotalForce() ),
		h * toVec3d( body.getInvInertiaTensorWorld() * body.getTotalTorque() );
	return force;
}

void setSpeed( btRigidBody& body, const Vector6& speed )
{
	body.setLinearVelocity( toBt( speed.head<3>() ) );
	body.setAngularVelocity( toBt( speed.tail<3>() ) );
}

RigidPart makeRigid( btRigidBody& body )
{
	RigidPart part;
	part.body = &body;
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
	return part;
}

/// Whether a body wants its contacts solved in a block. A crumb of one cell has nothing elastic, but a heap of crumbs that Bullet's solver
/// leaves a little off in each step of a sixtieth of a second flows, for ever and at millimetres a second.
bool wantsBlock( const SoftBody& body )
{
	return body.impl().isImplicit || ( body.nodeCount() == 1 && body.material().elasticity != Elasticity::Explicit );
}

} // namespace

int ImplicitSolve::blockOf( const SoftBody& body ) const
{
	// A body that has fallen asleep since remembers a place that is another's now.
	const int block = body.impl().block;
	const bool isThere = block >= 0 && block < int( m_tagOf.size() ) &&
		std::size_t( body.impl().blockPart ) < m_blocks[std::size_t( block )].soft.size() &&
		m_blocks[std::size_t( block )].soft[std::size_t( body.impl().blockPart )].owner == &body;
	return isThere ? block : -1;
}

int ImplicitSolve::blockOfIsland( int tag ) const
{
	const auto found = std::find( m_tagOf.begin(), m_tagOf.end(), tag );
	return tag < 0 || found == m_tagOf.end() ? -1 : int( found - m_tagOf.begin() );
}

int ImplicitSolve::softPart( const SoftBody& body ) const
{
	return body.impl().blockPart;
}

int ImplicitSolve::rigidPart( int block, btRigidBody& body )
{
	std::vector<RigidPart>& parts = m_blocks[std::size_t( block )].rigid;
	for ( std::size_t k = 0; k < parts.size(); ++k )
	{
		if ( parts[k].body == &body )
		{
			return int( k );
		}
	}
	RigidPart part = makeRigid( body );
	OutsideImpulse& outside = outsideOf( body );
	outside.stamp = m_stamp;
	part.before = speedOf( body );
	part.free = part.before + forceOf( body, m_h ) + outside.change;
	for ( int k = 0; k < 3; ++k )
	{
		part.before[k] = part.moves[k] ? part.before[k] : 0.0;
		part.before[3 + k] = part.turns[k] ? part.before[3 + k] : 0.0;
		part.free[k] = part.moves[k] ? part.free[k] : 0.0;
		part.free[3 + k] = part.turns[k] ? part.free[3 + k] : 0.0;
	}
	parts.push_back( part );
	return int( parts.size() ) - 1;
}

OutsideImpulse& ImplicitSolve::outsideOf( const btRigidBody& body )
{
	for ( OutsideImpulse& outside : m_outside )
	{
		if ( outside.body == &body )
		{
			return outside;
		}
	}
	m_outside.push_back( OutsideImpulse{ &body } );
	return m_outside.back();
}

void ImplicitSolve::forget( const btRigidBody& body )
{
	m_outside.erase(
		std::remove_if( m_outside.begin(), m_outside.end(), [&]( const OutsideImpulse& outside ) { return outside.body == &body; } ),
		m_outside.end() );
}

// One block an island with an implicit body in it, or a crumb of one; explicit bodies of the island take part with their masses, so that no
// contact stands between two solvers.
void ImplicitSolve::makeBlocks( const std::vector<SoftBody*>& awake )
{
	m_tagOf.clear();
	for ( const SoftBody* body : awake )
	{
		if ( wantsBlock( *body ) && std::find( m_tagOf.begin(), m_tagOf.end(), body->getIslandTag() ) == m_tagOf.end() )
		{
			m_tagOf.push_back( body->getIslandTag() );
		}
	}
	while ( m_blocks.size() < m_tagOf.size() )
	{
		m_blocks.emplace_back();
	}
	for ( ImplicitBlock& block : m_blocks )
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
		ImplicitBlock& block = m_blocks[std::size_t( impl.block )];
		impl.blockPart = int( block.soft.size() );
		SoftPart part;
		part.owner = body;
		part.motion = impl.isImplicit ? impl.body->implicit() : &impl.body->joinFreely();
		part.before = &impl.body->velocityBefore();
		block.soft.push_back( part );
	}
}

void ImplicitSolve::before(
	const std::vector<SoftBody*>& awake, btDispatcher& dispatcher, const btContactSolverInfo& info, TaskRunner* runner )
{
	m_count = BlockCount{};
	m_h = double( info.m_timeStep );
	++m_stamp;
	makeBlocks( awake );
	const bool hadBlocks = m_hadBlocks;
	m_hadBlocks = !m_tagOf.empty();
	if ( m_tagOf.empty() )
	{
		if ( hadBlocks )
		{
			m_contacts.gather( dispatcher, info, *this, m_blocks ); // finds none, and lets go of what was theirs
		}
		m_outside.clear();
		return;
	}
	m_reach.choose( dispatcher, *this, int( m_tagOf.size() ) );
	m_contacts.gather( dispatcher, info, *this, m_blocks );
	m_outside.erase(
		std::remove_if( m_outside.begin(), m_outside.end(), [this]( const OutsideImpulse& outside ) { return outside.stamp != m_stamp; } ),
		m_outside.end() );

	// Many islands: each in one task. One: the threads share its products.
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
		ImplicitContacts::writeBack( m_blocks[std::size_t( k )] );
	}
}

// Bullet's solver will add the forces, and joints and rigid contacts what they did last time, as far as they do it again.
void ImplicitSolve::storeVelocities( ImplicitBlock& block )
{
	for ( RigidPart& part : block.rigid )
	{
		part.given = part.speed - outsideOf( *part.body ).change;
		Vector6 speed = part.given - forceOf( *part.body, m_h );
		const Vector6 own = speedOf( *part.body );
		for ( int k = 0; k < 6; ++k )
		{
			speed[k] = ( k < 3 ? part.moves[k] : part.turns[k - 3] ) ? speed[k] : own[k];
		}
		setSpeed( *part.body, speed );
	}
}

void ImplicitSolve::after()
{
	m_contacts.show();
	for ( std::size_t k = 0; k < m_tagOf.size(); ++k )
	{
		for ( const RigidPart& part : m_blocks[k].rigid )
		{
			// e += r ( dV - e ), dV what Bullet's solver did beyond the forces
			Vector6& expected = outsideOf( *part.body ).change;
			expected += kOutsideFraction * ( speedOf( *part.body ) - part.given - expected );
		}
	}
}

} // namespace pliant
