// A build without fracture or without skins draws no cracks: a body's skin is its template's.

#include "body/breaking.h"
#include "lattice/features.h"
#include "world/api/drawn_mesh.h"

namespace pliant {

bool SoftBody::Impl::hasNewCracks() const
{
	return false;
}

const SkinBinding& SoftBody::Impl::binding() const
{
	return bodyTemplate->skin();
}

void SoftBody::Impl::drawFamilyCracks() const {}
void showOwnCracks( const SoftBody::Impl&, const std::shared_ptr<const CrackPatches>&, CrackView& ) {}

void SoftBody::Impl::noteCracks( const BreakReport& )
{
	newCuts.clear();
}

void SoftBody::Impl::noteTraces( std::vector<CutTrace>, const Vec3& ) {}

Status SoftBody::prepareCracks()
{
	return requireFeature( hasFeature( Feature::Fracture ) ? Feature::Surface : Feature::Fracture );
}

} // namespace pliant
