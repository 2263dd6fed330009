// For builds without skins or without levels of detail: changes of levels never move a surface.

#include "surface/skin/skin_fade.h"

namespace pliant {

void SkinFade::reserveNodes( int, std::size_t, int ) {}
void SkinFade::keep( const NodeState&, const SkinPose&, int, AlignedArray<float>* ) {}
void SkinFade::start( const SkinBinding&, const Nodes& ) {}

bool SkinFade::advance()
{
	return false;
}

void SkinFade::clear() {}
void SkinFade::ease( const NodeState&, float* ) const {}
void SkinFade::addTo( float*, float*, const Eigen::Quaternionf& ) const {}
void SkinFade::spread( const SkinBinding&, std::vector<SkinOffset>& ) const {}

float SkinFade::fraction() const
{
	return 0.0f;
}

} // namespace pliant
