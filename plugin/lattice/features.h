#pragma once

// Rejects features that this build does not contain.

#include "pliant/build.h"
#include "pliant/result.h"

namespace pliant {

/// Ok, or an error that names the missing feature.
Status requireFeature( Feature feature );

} // namespace pliant
