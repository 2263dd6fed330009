#include "c/settings.h"

using namespace pliant;
using namespace pliant::c;

pliant_result pliant_material_init( pliant_material* material, uint32_t size )
{
	return initSized( inC<pliant_material>( Material{} ), material, size );
}

pliant_result pliant_fracture_init( pliant_fracture* fracture, uint32_t size )
{
	return initSized( inC<pliant_fracture>( Fracture{} ), fracture, size );
}

pliant_result pliant_adaptivity_init( pliant_adaptivity* adaptivity, uint32_t size )
{
	return initSized( inC<pliant_adaptivity>( Adaptivity{} ), adaptivity, size );
}

pliant_result pliant_debris_budget_init( pliant_debris_budget* budget, uint32_t size )
{
	return initSized( inC<pliant_debris_budget>( DebrisBudget{} ), budget, size );
}

pliant_result pliant_attachment_settings_init( pliant_attachment_settings* settings, uint32_t size )
{
	return initSized( inC<pliant_attachment_settings>( AttachmentSettings{} ), settings, size );
}

pliant_result pliant_lattice_settings_init( pliant_lattice_settings* settings, uint32_t size )
{
	return initSized( defaultLattice(), settings, size );
}
