#pragma once

// The public settings as bytes.

#include "archive/archive.h"

#include "pliant/adaptivity.h"
#include "pliant/body_template.h"
#include "pliant/fracture.h"
#include "pliant/material.h"

namespace pliant {

void archive( Archive& archive, Material& material );
void archive( Archive& archive, Fracture& fracture );
void archive( Archive& archive, Adaptivity& adaptivity );
void archive( Archive& archive, CrackSettings& settings );
/// Without the runner and the progress function, which belong to the build.
void archive( Archive& archive, LatticeSettings& settings );
void archive( Archive& archive, BuildReport& report );
void archive( Archive& archive, StiffnessPlan& plan );

} // namespace pliant
