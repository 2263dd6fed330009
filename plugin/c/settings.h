#pragma once

// Structures of settings of the C face as those of the library.

#include "pliant/adaptivity.h"
#include "pliant/attachment.h"
#include "pliant/body_template.h"
#include "pliant/c/body.h"
#include "pliant/c/settings.h"
#include "pliant/c/template.h"
#include "pliant/fracture.h"
#include "pliant/material.h"
#include "pliant/soft_body.h"

namespace pliant::c {

// From C: the library's defaults where `given` is null. A size that is not known, and a number that is no enumerator, is refused; all else
// is left to the library's checks. `out` is written only where PLIANT_OK is returned.
pliant_result take( const pliant_material* given, Material& out );
pliant_result take( const pliant_fracture* given, Fracture& out );
pliant_result take( const pliant_adaptivity* given, Adaptivity& out );
pliant_result take( const pliant_debris_budget* given, DebrisBudget& out );
pliant_result take( const pliant_attachment_settings* given, AttachmentSettings& out );
/// Without runner and progress. `full`: the same with defaults where the caller's version has no field.
pliant_result take( const pliant_lattice_settings* given, LatticeSettings& out, pliant_lattice_settings& full );

/// A mesh, which is read during the call only.
pliant_result takeMesh( const pliant_mesh* mesh, MeshView& view );

// To C, without size.
pliant_surface inC( const SurfaceView& view );
pliant_material inC( const Material& material );
pliant_fracture inC( const Fracture& fracture );
pliant_adaptivity inC( const Adaptivity& adaptivity );

} // namespace pliant::c
