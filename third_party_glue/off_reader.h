#pragma once

// Object File Format (.off): the reader that keeps every face.

#include "third_party_glue/model_file.h"

#include <string_view>

namespace pliant_glue {

/// Read the text of an OFF, COFF, NOFF, STOFF or CNOFF file. Comments may stand anywhere; colours are passed over; polygons are
/// cut into fans. A face with a vertex that is not there is an error, not a hole.
ReadResult readOff( std::string_view text, const ReadLimits& limits = {} );

} // namespace pliant_glue
