// For builds without fracture or without skins: no crack is drawn.

#include "lattice/features.h"
#include "surface/crack_complex/cell_complex.h"
#include "surface/crack_state/crack_patches.h"
#include "surface/crack_state/crack_surface.h"

namespace pliant {

Result<std::shared_ptr<const CellComplex>> CellComplex::build(
	const MeshView&, const Lattice&, const SkinBinding&, const LatticeSettings&, const CrackSettings& )
{
	const Feature missing = hasFeature( Feature::Surface ) ? Feature::Fracture : Feature::Surface;
	return { requireFeature( missing ), nullptr };
}

IntactPanels::IntactPanels( const Panels& panels ) : m_panels( &panels ) {}

CrackSurface::CrackSurface( std::shared_ptr<const CellComplex> complex ) :
	m_complex( std::move( complex ) ), m_shift( Vec3::Zero() ), m_panels( m_complex->panels )
{}

std::shared_ptr<const CrackPatches> CrackPatches::make( const CrackSurface&, const float* )
{
	return nullptr;
}

} // namespace pliant
