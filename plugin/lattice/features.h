#pragma once

// Refusing what this build has been made without.

#include "pliant/build.h"
#include "pliant/result.h"

namespace pliant {

/// Ok, or the sentence that says that this build is without it.
Status needFeature( Feature feature );

} // namespace pliant
