// In a build without self-collision it cannot be enabled.

#include "lattice/features.h"
#include "world/bodies/soft_body_impl.h"
#include "world/step/soft_body_system.h"

namespace pliant {

void SoftBodySystem::collideWithThemselves( btScalar )
{
	report.selfContacts = 0;
}

Status SoftBody::setSelfCollision( bool isOn )
{
	return isOn ? requireFeature( Feature::SelfCollision ) : Status{};
}

bool SoftBody::selfCollision() const
{
	return false;
}

const std::vector<NodeHit>& SelfSearch::find( const SoftBody&, double )
{
	return m_hits; // none
}

void SelfSearch::relink( const CellsNow& ) {}
void SelfSearch::renumber( const std::vector<std::uint32_t>& ) {}

void SelfSearch::archive( Archive& ) {}

} // namespace pliant
