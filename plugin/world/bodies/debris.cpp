// A world's budget of debris: which pieces fade because there are too many, how many may come off in a step, and which have settled and
// become scenery (DebrisBudget).

#include "world/bodies/soft_body_impl.h"
#include "world/step/world_step.h"

#include <algorithm>
#include <limits>
#include <tuple>

namespace pliant {

bool SoftBodySystem::maySettle( const SoftBody& body ) const
{
	const SoftBody::Impl& impl = body.impl();
	return impl.pins.empty() && !impl.isKept && impl.fading.time == 0.0f && !impl.follower && !body.isStaticOrKinematicObject() &&
		( attachments.isEmpty() || !attachments.contain( body ) ) && !frames.has( body );
}

void SoftBodySystem::settleDebris( btScalar gameStep )
{
	for ( SoftBody* body : owned )
	{
		SoftBody::Impl& impl = body->impl();
		if ( impl.isScenery )
		{
			continue;
		}
		impl.asleepTime = body->getActivationState() == ISLAND_SLEEPING ? impl.asleepTime + double( gameStep ) : 0.0;
		if ( debris.settleTime > 0.0f && impl.asleepTime >= double( debris.settleTime ) && maySettle( *body ) )
		{
			impl.isScenery = true;
			body->setCollisionFlags( body->getCollisionFlags() | btCollisionObject::CF_STATIC_OBJECT );
			impl.followRigidState( *body );
			++report.debrisSettled;
		}
	}
}

// Called at the start of a game step. Pieces that fade already count as removed, so that no others fade instead of them.
void SoftBodySystem::limitDebris( btScalar gameStep )
{
	m_clock += double( gameStep );
	m_piecesLeft = debris.piecesPerStep;
	settleDebris( gameStep );
	int live = 0, nodes = 0;
	for ( SoftBody* body : owned )
	{
		const SoftBody::Impl& impl = body->impl();
		if ( impl.isScenery )
		{
			continue;
		}
		const int own = impl.body->nodeCount();
		report.debrisPieces += 1;
		report.debrisNodes += own;
		live += impl.fading.time == 0.0f ? 1 : 0;
		nodes += impl.fading.time == 0.0f ? own : 0;
	}
	const auto isOver = [&] {
		return ( debris.maxPieces > 0 && live > debris.maxPieces ) || ( debris.maxNodes > 0 && nodes > debris.maxNodes );
	};
	if ( !isOver() )
	{
		return;
	}
	struct Piece
	{
		double agePerNode;
		unsigned serial;
		SoftBody* body;
	};
	std::vector<Piece> pieces;
	for ( SoftBody* body : owned )
	{
		const SoftBody::Impl& impl = body->impl();
		if ( impl.fading.time == 0.0f && !impl.isKept && !impl.isScenery )
		{
			pieces.push_back( Piece{ ( m_clock - impl.separatedAt ) / double( impl.body->nodeCount() ), impl.serial, body } );
		}
	}
	std::sort( pieces.begin(), pieces.end(),
		[]( const Piece& a, const Piece& b ) { return std::tie( b.agePerNode, a.serial ) < std::tie( a.agePerNode, b.serial ); } );
	for ( auto piece = pieces.begin(); piece != pieces.end() && isOver(); ++piece )
	{
		SoftBody::Impl& impl = piece->body->impl();
		impl.fading = Fading{ debris.fadeTime, double( debris.fadeTime ), false };
		--live;
		nodes -= impl.body->nodeCount();
		++report.debrisFading;
	}
}

/// Largest number of parts that body `k` of `count` breaking bodies may become in this substep: an equal part of the step's budget.
int SoftBodySystem::partsNow( int k, int count ) const
{
	if ( debris.piecesPerStep == 0 )
	{
		return std::numeric_limits<int>::max();
	}
	return 1 + m_piecesLeft / count + ( k < m_piecesLeft % count ? 1 : 0 );
}

Status SoftBodyHost::setDebrisBudget( const DebrisBudget& budget )
{
	Status status = check( budget );
	if ( status.ok() )
	{
		m_step->bodies.debris = budget;
	}
	return status;
}

void SoftBody::setKept( bool isKept )
{
	m_impl->isKept = isKept;
}

bool SoftBody::isKept() const
{
	return m_impl->isKept;
}

} // namespace pliant
