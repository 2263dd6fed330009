// For builds without skins: templates with a skin are refused (body_template.cpp), so this is never called.

#include "surface/skin/skinning.h"

namespace pliant {

SkinBinding bindSkin( const MeshView&, const Lattice&, const std::vector<std::uint32_t>&, Skinning )
{
	return {};
}

} // namespace pliant
