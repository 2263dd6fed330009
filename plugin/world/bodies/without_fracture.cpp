// Stubs for builds without fracture: breaking and cutting are refused.

#include "lattice/features.h"
#include "world/bodies/soft_body_impl.h"
#include "world/step/world_step.h"

namespace pliant {

Status SoftBody::setFracture( const Fracture& fracture, const ToughnessField&, const ShardCentres& )
{
	return fracture.rule == BreakRule::Never ? Status{} : requireFeature( Feature::Fracture );
}

Fracture SoftBody::fracture() const
{
	return m_impl->body->fracture();
}

float SoftBody::fadeFraction() const
{
	return 1.0f;
}

int SoftBody::cutPlane( const btVector3&, const btVector3&, btScalar )
{
	return 0;
}

int SoftBody::cutSphere( const btVector3&, btScalar )
{
	return 0;
}

int SoftBody::cutSweep( const btVector3&, const btVector3&, const btVector3&, const btVector3& )
{
	return 0;
}

int SoftBody::heal( btScalar )
{
	return 0;
}

bool SoftBodySystem::breakBodies()
{
	return false;
}

bool SoftBodySystem::release( SoftBody& )
{
	return false;
}

void SoftBodySystem::noteImpacts( double ) {}
void SoftBodySystem::testLinks( btScalar ) {}
void SoftBodySystem::advanceFading( btScalar ) {}
void SoftBodySystem::limitDebris( btScalar ) {}
Status SoftBodyHost::setDebrisBudget( const DebrisBudget& budget )
{
	const bool isUsed = budget.maxPieces != 0 || budget.maxNodes != 0 || budget.piecesPerStep != 0 || budget.settleTime != 0;
	return isUsed ? requireFeature( Feature::Fracture ) : Status{};
}

void SoftBody::setKept( bool isKept )
{
	m_impl->isKept = isKept;
}

bool SoftBody::isKept() const
{
	return m_impl->isKept;
}

void SoftBodySystem::removeFaded() {}

} // namespace pliant
