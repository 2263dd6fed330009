#pragma once

// A liver: the surface of a segmented scan, or a similar shape from code.

#include "third_party_glue/inr_reader.h"

namespace pliant_demos {

/// The surface around all voxels that are not 0, smoothed over `spacing` (in the file's unit, mm) and made of triangles of about that size;
/// y up along the scan's z. Closed.
pliant_glue::ModelMesh surfaceOfVolume( const pliant_glue::GreyVolume& volume, float spacing );

/// A similar shape: a thick lobe and a thin one.
pliant_glue::ModelMesh makeLiverLike();

} // namespace pliant_demos
