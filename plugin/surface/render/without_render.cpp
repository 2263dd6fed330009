// For builds without skins: nothing is drawn, so there is nothing to publish or to blend.

#include "surface/render/skin_blend.h"
#include "surface/render/skin_tables.h"
#include "surface/render/vertex_data.h"

namespace pliant {

SkinTables makeSkinTables( const SkinBinding&, const SkinTriangles& )
{
	return {};
}

std::vector<float> tangentsFromTexture( const float*, const float*, const SkinTriangles&, const std::vector<Vec3>& )
{
	return {};
}

void SkinBlend::renumber( const std::vector<std::uint32_t>&, const Eigen::Vector3d& ) {}

SkinBlend SkinBlend::ofPiece( const std::vector<std::uint32_t>&, const Eigen::Vector3d& ) const
{
	return {};
}

} // namespace pliant
