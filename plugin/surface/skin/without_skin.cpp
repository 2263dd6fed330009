// In a build without skins: templates that ask for one are refused (body_template.cpp), and this is never reached.

#include "surface/skin/skinning.h"

namespace pliant {

SkinBinding bindSkin( const MeshView&, const Lattice&, const std::vector<std::uint32_t>&, Skinning )
{
	return {};
}

} // namespace pliant
