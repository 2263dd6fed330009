// For builds without fracture or without skins: no crack is drawn.

#include "lattice/features.h"
#include "surface/crack_complex/cell_complex.h"
#include "surface/crack_state/crack_patches.h"

namespace pliant {

Result<std::shared_ptr<const CellComplex>> CellComplex::build(
	const MeshView&, const Lattice&, const SkinBinding&, const LatticeSettings&, const CrackSettings& )
{
	const Feature missing = hasFeature( Feature::Surface ) ? Feature::Fracture : Feature::Surface;
	return { requireFeature( missing ), nullptr };
}

std::shared_ptr<const CrackPatches> CrackPatches::make( std::shared_ptr<const CellComplex>, const float* )
{
	return nullptr;
}

} // namespace pliant
