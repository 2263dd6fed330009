#pragma once

// Stanford's PLY: the reader that a damaged file cannot crash.

#include "third_party_glue/model_file.h"

#include <string_view>

namespace pliant_glue {

/// Read the bytes of a PLY file: text or binary, either byte order. Properties that are not positions, normals, texture coordinates
/// or polygons are passed over; polygons are cut into fans. A face with a vertex that is not there is an error, not a hole.
ReadResult readPly( std::string_view bytes, const ReadLimits& limits = {} );

} // namespace pliant_glue
